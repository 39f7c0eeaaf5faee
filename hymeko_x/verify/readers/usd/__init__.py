"""USD as Pixar's UsdPhysics parser reads it: bodies, joints with both local frames, limits, collision shapes.

Masses come from MassAPI, tensors that have no principal moments from NewtonMassAPI, poses at rest and visual shapes from
UsdGeom, couplings from NewtonMimicAPI and MjcEqualityJointAPI, tendons from MjcTendon, since UsdPhysics cannot represent
them. Physics is float32 and degrees in USD; lengths are in stage units. Everything is converted to SI, and to z up.
Source: UsdPhysics schema and parseDesc.h (OpenUSD); newton-usd-schemas for NewtonMimicAPI.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np
from pxr import Gf, Sdf, Tf, Usd, UsdPhysics

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.verify.features import Feature
from hymeko_x.verify.model import WORLD, Array, Body, Dof, Joint, Kind, KinematicModel, world_body
from hymeko_x.verify.readers import native_output
from hymeko_x.verify.readers.usd.joints import JointEdge, read_couplings, read_joint, read_loop
from hymeko_x.verify.readers.usd.scene import MeasuredStage, value_of
from hymeko_x.verify.readers.usd.shapes import read_shapes
from hymeko_x.verify.readers.usd.tendons import limits_are_automatic, read_tendons, tendon_paths
from hymeko_x.verify.spatial import rotation_from_quat

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from hymeko_x.verify.readers.lookup import Lookup

FEATURES = frozenset(
    {
        *(Feature.POSITION_LIMITS, Feature.VISUALS, Feature.COLLISIONS, Feature.FLAT_COLLISIONS, Feature.FIXED_JOINT_NAMES),
        *(Feature.LOOPS, Feature.SLIDING_LOOPS, Feature.HELD_BASES, Feature.OPEN_LOOPS, Feature.CURVES, Feature.TENDONS),
    }
)
UNREPRESENTED = frozenset({(Feature.POSITION_LIMITS, Kind.BALL)})
"""The cone of a spherical joint bounds the swing of one axis, and no engine's ball has such limits."""
SINGLE = 1.2e-7
"""The relative precision of what UsdPhysics stores."""
_IDENTITY = 1e-6
"""In m and as a matrix entry: a pose this close to the identity is it, in single precision."""

_MOST_NESTED = 32  # variant sets within variants

_JOINTS = ("FixedJoint", "RevoluteJoint", "PrismaticJoint", "SphericalJoint", "D6Joint", "DistanceJoint", "CustomJoint")


def read(path: Path, lookup: Lookup) -> KinematicModel:
    """The robot that UsdPhysics sees. Raises: Refusal HX302 in USD's words."""
    with native_output() as output:
        try:
            stage = Usd.Stage.Open(str(path))
        except Tf.ErrorException as error:
            reason = output() or " ".join(str(error).split())
            raise refuse(codes.ENGINE_REFUSED, f"USD refuses the file: {reason}", Origin(str(path))) from error
        for _ in range(_MOST_NESTED if lookup.variants else 0):  # a variant may contain prims that have sets themselves
            if not _choose(stage, lookup.variants, path):
                break
        found = UsdPhysics.UsdPhysicsLoadStageFromPrimRange(stage, [Sdf.Path.absoluteRootPath])
    return _model(MeasuredStage.of(stage), path.stem, found)


def _choose(stage: Any, variants: Mapping[str, str], path: Path) -> bool:
    """Select these variants in the session, wherever the stage has their sets; returns whether that changed anything."""
    names = [(prim, name) for prim in stage.Traverse() for name in prim.GetVariantSets().GetNames() if name in variants]
    sets = [(prim.GetVariantSet(name), variants[name]) for prim, name in names]
    changed = [(item, variant) for item, variant in sets if item.GetVariantSelection() != variant]
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for item, variant in changed:
            if variant not in item.GetVariantNames():
                message, known = f"the variant set '{item.GetName()}' has no variant '{variant}'", sorted(item.GetVariantNames())
                raise refuse(codes.UNDEFINED_REFERENCE, message, Origin(str(path)), hint=f"it has: {', '.join(known)}")
            item.SetVariantSelection(variant)
    return bool(changed)


def _model(scene: MeasuredStage, name: str, found: Mapping[Any, Any]) -> KinematicModel:
    kinds = UsdPhysics.ObjectType
    rigid_bodies = {str(desc.primPath): desc for desc in found.get(kinds.RigidBody, ((), ()))[1] if desc.rigidBodyEnabled}
    joints = [desc for word in _JOINTS for desc in found.get(getattr(kinds, word), ((), ()))[1] if desc.jointEnabled and desc.isValid]
    prims = list(scene.stage.Traverse(Usd.TraverseInstanceProxies()))
    ranks: dict[str, int] = {str(prim.GetPath()): rank for rank, prim in enumerate(prims)}
    joints.sort(key=lambda desc: ranks.get(str(desc.primPath), len(ranks)))
    joint_names = _names(scene.stage, [str(desc.primPath) for desc in joints])
    edges = [read_joint(scene, desc, joint_names[str(desc.primPath)]) for desc in joints]
    order, tree, closing = _spanning_tree(list(rigid_bodies), edges)
    names = _names(scene.stage, sorted(order, key=lambda path: ranks.get(path, len(ranks))))
    ground = [path for path in order if names[path] == "world" and _is_ground(scene, path, tree.get(path))]
    order = [path for path in order if path not in ground]
    numbers = {path: index for index, path in enumerate(order, start=1)} | dict.fromkeys(("", *ground), WORLD)
    shapes = read_shapes(scene, found, set(rigid_bodies))
    bodies = [world_body(shapes=tuple(shape for path in ("", *ground) for shape in shapes.get(path, ())))]
    for path in order:
        prim = scene.stage.GetPrimAtPath(path)
        edge = tree.get(path)
        joint = edge.joint() if edge is not None else _root_joint(scene, prim, rigid_bodies[path].kinematicBody)
        parent = numbers[edge.parent] if edge is not None else WORLD
        known, mass, com, tensor = _inertia(scene, prim, bool(shapes.get(path)))
        bodies.append(Body(names[path], parent, joint, mass, com, tensor, tuple(shapes.get(path, ())), inertia_is_known=known))
    default = scene.stage.GetDefaultPrim()
    model = KinematicModel(
        name=str(default.GetName()) if default else name,
        format="usd",
        engine=f"UsdPhysics in OpenUSD {'.'.join(map(str, Usd.GetVersion()))}",
        bodies=tuple(bodies),
        loops=tuple(read_loop(edge, numbers.get(edge.parent, WORLD), numbers.get(edge.child, WORLD)) for edge in closing),
        features=FEATURES,
        unrepresented=UNREPRESENTED,
        precision=SINGLE,
    )
    tendons = _names(scene.stage, tendon_paths(prims))
    if tendons:
        model = read_tendons(scene, model, tendons, tree, numbers, automatic=limits_are_automatic(prims))
    return read_couplings(scene, model, tree)


def _is_ground(scene: MeasuredStage, path: str, edge: JointEdge | None) -> bool:
    """Whether a body called ``world`` is the world itself, as in a URDF: it has no mass and is fixed to it at its origin."""
    if edge is None or edge.parent or edge.dofs or edge.more or scene.stage.GetPrimAtPath(path).GetAttribute("physics:mass").Get():
        return False
    return bool(np.abs(edge.joint().placement - np.eye(4)).max() < _IDENTITY)


def _names(stage: Any, paths: Iterable[str]) -> dict[str, str]:
    """Display names where there are any, else prim names; in the order of the stage the second of a name is ``name#2``."""
    names = {path: stage.GetPrimAtPath(path).GetDisplayName() or path.rpartition("/")[2] for path in paths}
    taken, counts = set(names.values()), Counter[str]()
    for path, name in names.items():
        counts[name] += 1
        while counts[name] > 1 and f"{name}#{counts[name]}" in taken:
            counts[name] += 1
        if counts[name] > 1:
            names[path] = f"{name}#{counts[name]}"
    return names


# ---- the tree --------------------------------------------------------------------------------------------------------


def _spanning_tree(bodies: Sequence[str], edges: Sequence[JointEdge]) -> tuple[list[str], dict[str, JointEdge], list[JointEdge]]:
    """Bodies with parents first, the joint of each (turned round where body 1 is the parent), and the joints that close loops.

    Trees begin at the world, then at bodies that are no joint's child, then anywhere. In the order of the stage, a joint between two
    bodies that are connected already closes a loop.
    """
    beside: dict[str, list[JointEdge]] = {}
    for edge in _acyclic(edges):
        beside.setdefault(edge.parent, []).append(edge)
        beside.setdefault(edge.child, []).append(edge)
    children = {edge.child for edge in edges if not edge.closes}
    unseen = set(bodies)
    order: list[str] = []
    joints: dict[str, JointEdge] = {}
    used: set[int] = set()
    for start in ("", *(path for path in bodies if path not in children), *bodies):
        if start and start not in unseen:
            continue
        stack = [start]
        if start:
            unseen.discard(start)
            order.append(start)
        while stack:
            body = stack.pop()
            for edge in beside.get(body, ()):
                other = edge.child if edge.parent == body else edge.parent
                if other in joints and joints[other].stacks(edge) and id(edge) not in used:
                    used.add(id(edge))
                    joints[other] = joints[other].with_more(edge)
                elif other in unseen:
                    unseen.discard(other)
                    used.add(id(edge))
                    order.append(other)
                    joints[other] = edge if edge.child == other else edge.turned()
                    stack.append(other)
    return order, joints, [edge for edge in edges if id(edge) not in used]


def _acyclic(edges: Sequence[JointEdge]) -> list[JointEdge]:
    """The joints that connect what was not connected before, and those beside one of them, which may be further dofs of it."""
    leader: dict[str, str] = {}

    def leader_of(body: str) -> str:
        """The representative of all bodies that are connected with this one (union-find, with paths halved)."""
        while leader.setdefault(body, body) != body:
            leader[body] = leader[leader[body]]
            body = leader[body]
        return body

    pairs: set[frozenset[str]] = set()
    found = []
    for edge in edges:
        pair = frozenset((edge.parent, edge.child))
        first, second = leader_of(edge.parent), leader_of(edge.child)
        if not edge.closes and (first != second or pair in pairs):
            leader[second] = first
            pairs.add(pair)
            found.append(edge)
    return found


def _root_joint(scene: MeasuredStage, prim: Any, kinematic: bool) -> Joint:
    """A body without a joint to a parent falls freely, unless it is kinematic."""
    return Joint(None, scene.pose(prim), () if kinematic else (Dof(Kind.FREE, np.array([0.0, 0.0, 1.0])),))


# ---- inertia ---------------------------------------------------------------------------------------------------------


def _inertia(scene: MeasuredStage, prim: Any, has_shapes: bool) -> tuple[bool, float, Array, Array]:
    """Whether it is known, mass, centre and tensor by MassAPI. Zeros mean "not authored": engines then compute them from the shapes."""
    api = UsdPhysics.MassAPI(prim)
    mass = float(api.GetMassAttr().Get() or 0.0) * scene.kilograms
    com = np.array(api.GetCenterOfMassAttr().Get() or (0.0, 0.0, 0.0), dtype=float)
    com = np.where(np.isfinite(com), com, 0.0) * scene.metres
    moments = np.array(api.GetDiagonalInertiaAttr().Get() or (0.0, 0.0, 0.0), dtype=float) * scene.kilograms * scene.metres**2
    axes = api.GetPrincipalAxesAttr().Get() or Gf.Quatf(0)
    quat = np.array([axes.GetReal(), *axes.GetImaginary()], dtype=float)
    turn = rotation_from_quat(quat) if quat.any() else np.eye(3)
    tensor = turn @ np.diag(moments) @ turn.T if moments.any() else _newton_tensor(prim) * scene.kilograms * scene.metres**2
    known = bool(mass and tensor.any()) or not has_shapes
    return known, mass, com, tensor


def _newton_tensor(prim: Any) -> Array:
    """The tensor by NewtonMassAPI, which represents tensors that moments and axes cannot, like moments of zero; without one zeros."""
    numbers = value_of(prim, "newton:inertia")
    if numbers is None or len(numbers) != 6:
        return np.zeros((3, 3))
    xx, yy, zz, xy, xz, yz = map(float, numbers)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
