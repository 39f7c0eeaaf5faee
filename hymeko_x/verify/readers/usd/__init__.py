"""USD as Pixar's UsdPhysics parser sees it: bodies, joints with both local frames, limits, collision shapes.

Masses come from MassAPI, tensors that have no principal moments from NewtonMassAPI, poses at rest and visual shapes from
UsdGeom. Couplings are what NewtonMimicAPI and MjcEqualityJointAPI say, tendons what MjcTendon says, since UsdPhysics has no
words for them. Physics is float32 and degrees in USD; lengths are in stage units. Everything is converted to SI, and to z up.
Source: UsdPhysics schema and parseDesc.h (OpenUSD); newton-usd-schemas for NewtonMimicAPI.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np
from pxr import Gf, Sdf, Tf, Usd, UsdPhysics

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.verify.model import WORLD, Array, Body, Dof, Feature, Joint, Kind, KinematicModel, Loop, grounded
from hymeko_x.verify.readers import overheard
from hymeko_x.verify.readers.usd.joints import JointEdge, read_couplings, read_joint, read_loop
from hymeko_x.verify.readers.usd.scene import Scene, value_of
from hymeko_x.verify.readers.usd.shapes import read_shapes
from hymeko_x.verify.readers.usd.tendons import limits_are_automatic, read_tendons, tendon_paths
from hymeko_x.verify.spatial import rotation_from_quat

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from hymeko_x.verify.readers import Places

SAYS = frozenset({Feature.VISUALS, Feature.COLLISIONS, Feature.FIXED_JOINT_NAMES, Feature.LOOPS, Feature.CURVES, Feature.TENDONS})
SINGLE = 1.2e-7
"""The relative precision of what UsdPhysics stores."""
NEAR = 1e-6
WORLD_NAME = "world"
_MOST_NESTED = 32

_JOINTS = ("FixedJoint", "RevoluteJoint", "PrismaticJoint", "SphericalJoint", "D6Joint", "DistanceJoint", "CustomJoint")


def read(path: Path, places: Places) -> KinematicModel:
    """The robot that UsdPhysics sees. Raises: Refusal HX302 in USD's words."""
    with overheard() as said:
        try:
            stage = Usd.Stage.Open(str(path))
        except Tf.ErrorException as error:
            words = said() or " ".join(str(error).split())
            raise refuse(codes.ENGINE_REFUSED, f"USD refuses the file: {words}", Origin(str(path))) from error
        for _ in range(_MOST_NESTED if places.variants else 0):  # a variant may bring forth prims that have sets themselves
            if not _choose(stage, places.variants, path):
                break
        found = UsdPhysics.UsdPhysicsLoadStageFromPrimRange(stage, [Sdf.Path.absoluteRootPath])
    return _model(Scene.of(stage), path.stem, found)


def _choose(stage: Any, variants: Mapping[str, str], path: Path) -> bool:
    """Select these variants in the session, wherever the stage has their sets; returns whether that changed anything."""
    sets = [(prim.GetVariantSet(name), variants[name]) for prim in stage.Traverse() for name in _sets_of(prim, variants)]
    changed = [(item, variant) for item, variant in sets if item.GetVariantSelection() != variant]
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for item, variant in changed:
            if variant not in item.GetVariantNames():
                said = f"the variant set '{item.GetName()}' has no variant '{variant}'"
                raise refuse(
                    codes.UNDEFINED_REFERENCE, said, Origin(str(path)), hint=f"it has: {', '.join(sorted(item.GetVariantNames()))}"
                )
            item.SetVariantSelection(variant)
    return bool(changed)


def _sets_of(prim: Any, variants: Mapping[str, str]) -> list[str]:
    return [name for name in prim.GetVariantSets().GetNames() if name in variants]


def _model(scene: Scene, name: str, found: Mapping[Any, Any]) -> KinematicModel:
    kinds = UsdPhysics.ObjectType
    rigid_bodies = {str(desc.primPath): desc for desc in found.get(kinds.RigidBody, ((), ()))[1] if desc.rigidBodyEnabled}
    joints = [desc for word in _JOINTS for desc in found.get(getattr(kinds, word), ((), ()))[1] if desc.jointEnabled and desc.isValid]
    prims = list(scene.stage.Traverse(Usd.TraverseInstanceProxies()))
    ranks: dict[str, int] = {str(prim.GetPath()): rank for rank, prim in enumerate(prims)}
    joints.sort(key=lambda desc: ranks.get(str(desc.primPath), len(ranks)))
    called = _names(scene.stage, [str(desc.primPath) for desc in joints])
    edges = [read_joint(scene, desc, called[str(desc.primPath)]) for desc in joints]
    order, tree, closing = _spanning_tree(list(rigid_bodies), edges)
    names = _names(scene.stage, sorted(order, key=lambda path: ranks.get(path, len(ranks))))
    ground = [path for path in order if names[path] == WORLD_NAME and _is_ground(scene, path, tree.get(path))]
    order = [path for path in order if path not in ground]
    places = {path: index for index, path in enumerate(order, start=1)} | dict.fromkeys(("", *ground), WORLD)
    shapes = read_shapes(scene, found, set(rigid_bodies))
    bodies = [grounded(shapes=tuple(shape for path in ("", *ground) for shape in shapes.get(path, ())))]
    for path in order:
        bodies.append(_body(scene, path, names[path], tree.get(path), places, rigid_bodies[path].kinematicBody, shapes))
    default = scene.stage.GetDefaultPrim()
    model = KinematicModel(
        name=str(default.GetName()) if default else name,
        format="usd",
        engine=f"UsdPhysics in OpenUSD {'.'.join(map(str, Usd.GetVersion()))}",
        bodies=tuple(bodies),
        loops=tuple(_loop(edge, places) for edge in closing),
        says=SAYS,
        precision=SINGLE,
    )
    cables = tendon_paths(prims)
    if cables:
        named = _names(scene.stage, cables)
        model = read_tendons(scene, model, named, tree, places, automatic=limits_are_automatic(prims))
    return read_couplings(scene, model, tree)


def _is_ground(scene: Scene, path: str, edge: JointEdge | None) -> bool:
    """Whether a body called ``world`` is the world itself, as in a URDF: it has no mass and is fixed where the world is."""
    if edge is None or edge.parent or edge.dofs or edge.more or scene.stage.GetPrimAtPath(path).GetAttribute("physics:mass").Get():
        return False
    return bool(np.abs(edge.joint().placement - np.eye(4)).max() < NEAR)


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
    """Bodies with parents first, the joint above each (turned round where body 1 is the parent), and the joints that close loops.

    Trees begin at the world, then at bodies that are nobody's child, then anywhere. In the order of the stage, a joint whose two
    bodies hang together already closes a loop.
    """
    below: dict[str, list[JointEdge]] = {}
    for edge in _acyclic(edges):
        below.setdefault(edge.parent, []).append(edge)
        below.setdefault(edge.child, []).append(edge)
    children = {edge.child for edge in edges if not edge.closes}
    starts = ["", *(path for path in bodies if path not in children), *bodies]
    known = set(bodies)
    seen = {""}
    order: list[str] = []
    above: dict[str, JointEdge] = {}
    used: set[int] = set()
    for start in starts:
        if start and start in seen:
            continue
        stack = [start]
        if start:
            seen.add(start)
            order.append(start)
        while stack:
            body = stack.pop()
            for edge in below.get(body, ()):
                other = edge.child if edge.parent == body else edge.parent
                if other in above and above[other].stacks(edge) and id(edge) not in used:
                    used.add(id(edge))
                    above[other] = above[other].with_more(edge)
                    continue
                if other in seen or other not in known:
                    continue
                seen.add(other)
                used.add(id(edge))
                order.append(other)
                above[other] = edge if edge.child == other else edge.turned()
                stack.append(other)
    return order, above, [edge for edge in edges if id(edge) not in used]


def _acyclic(edges: Sequence[JointEdge]) -> list[JointEdge]:
    """The joints that connect what was not connected before, and those beside one of them, which may be further dofs of it."""
    leader: dict[str, str] = {}
    pairs: set[frozenset[str]] = set()
    found = []
    for edge in edges:
        pair = frozenset((edge.parent, edge.child))
        first, second = _leader(edge.parent, leader), _leader(edge.child, leader)
        if edge.closes or (first == second and pair not in pairs):
            continue
        leader[second] = first
        pairs.add(pair)
        found.append(edge)
    return found


def _leader(body: str, leader: dict[str, str]) -> str:
    """The body that stands for all that hang together with this one; the way there is halved on each visit."""
    while leader.setdefault(body, body) != body:
        leader[body] = leader[leader[body]]
        body = leader[body]
    return body


def _body(
    scene: Scene,
    path: str,
    name: str,
    edge: JointEdge | None,
    places: Mapping[str, int],
    kinematic: bool,
    shapes: Mapping[str, tuple[Any, ...]],
) -> Body:
    prim = scene.stage.GetPrimAtPath(path)
    weighed, mass, com, tensor = _inertia(scene, prim, bool(shapes.get(path)))
    joint = edge.joint() if edge is not None else _root_joint(scene, prim, kinematic)
    return Body(
        name=name,
        parent=places[edge.parent] if edge is not None else WORLD,
        joint=joint,
        mass=mass,
        com=com,
        tensor=tensor,
        shapes=tuple(shapes.get(path, ())),
        weighed=weighed,
    )


def _root_joint(scene: Scene, prim: Any, kinematic: bool) -> Joint:
    """A body that no joint holds falls freely, unless it is kinematic."""
    place = scene.pose(prim)
    return Joint(None, place) if kinematic else Joint(None, place, (Dof(Kind.FREE, np.array([0.0, 0.0, 1.0])),))


def _loop(edge: JointEdge, places: Mapping[str, int]) -> Loop:
    return read_loop(edge, places.get(edge.parent, WORLD), places.get(edge.child, WORLD))


# ---- inertia ---------------------------------------------------------------------------------------------------------


def _inertia(scene: Scene, prim: Any, has_shapes: bool) -> tuple[bool, float, Array, Array]:
    """Whether it is known, mass, centre and tensor by MassAPI. Zeros mean "not authored": engines then go by the shapes."""
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
    """The tensor by NewtonMassAPI, for what no principal moments can say, like moments of zero; without one nothing."""
    numbers = value_of(prim, "newton:inertia")
    if numbers is None or len(numbers) != 6:
        return np.zeros((3, 3))
    xx, yy, zz, xy, xz, yz = map(float, numbers)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
