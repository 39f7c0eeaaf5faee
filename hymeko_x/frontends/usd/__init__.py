"""USD in: a composed stage becomes bodies, joints, shapes and materials; whatever else is on any prim becomes extras.

Source: UsdPhysics as its own parser reads it, UsdGeom, and the MjcPhysics and Newton schemas; docs/mapping/usd.md has
the mapping.
"""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import Origin
from hymeko_x.formats import usd as words
from hymeko_x.formats.usd.actuators import PRIM as ACTUATOR
from hymeko_x.formats.usd.articulations import ARTICULATION
from hymeko_x.formats.usd.joints import TYPES as JOINTS
from hymeko_x.frontends.usd.actuators import read_actuator, read_drives
from hymeko_x.frontends.usd.bodies import BODY, ReadShape, read_body, read_mass
from hymeko_x.frontends.usd.builder import UsdBuilder
from hymeko_x.frontends.usd.contacts import read_collision_groups, read_filtered_pairs
from hymeko_x.frontends.usd.couplings import read_mimic
from hymeko_x.frontends.usd.dialects import is_passive_drive, is_world, join_bare_links, read_bare_links, read_named_mimic, with_dialect
from hymeko_x.frontends.usd.extras import gather_extras
from hymeko_x.frontends.usd.joints import DofRef, ReadJoint, dof_refs, read_joint
from hymeko_x.frontends.usd.materials import read_material
from hymeko_x.frontends.usd.mounts import read_camera, read_light, read_site
from hymeko_x.frontends.usd.shapes import is_shape, read_shape
from hymeko_x.frontends.usd.stage import OpenStage, open_scene
from hymeko_x.frontends.usd.tendons import read_tendons
from hymeko_x.frontends.usd.transforms import check_ops
from hymeko_x.frontends.usd.trees import build_trees, note_poses
from hymeko_x.ir.mechanism import ROOT, WORLD, Id, Mechanism, Provenance
from hymeko_x.ir.parts import Texture
from hymeko_x.source import Reading

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.diagnostics import Report
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.source import Source


def read(source: Source, report: Report) -> Reading:
    """The mechanism that a USD file describes, with everything that it refers to composed, and the residue that it contains.

    Raises: Refusal with HX001 (USD cannot read it), HX007 (too large).
    """
    with open_scene(source, report) as scene:
        residue = _take_residue(scene)
        builder = UsdBuilder(source, report, scene)
        prims = _prims(scene)
        for prim in prims:
            check_ops(prim, report, builder.origin_of(prim))
            if prim.has_api(BODY):
                read_body(prim, builder)
        bare = read_bare_links(prims, builder)
        for prim in prims:
            if prim.kind == "Material" and not prim.is_generated:
                read_material(prim, builder)
        _read_shapes(prims, builder)
        _read_mounted(prims, _read_joints(prims, bare, builder), builder)
        note_poses(builder)
        gather_extras(builder)
        return Reading(_finished(scene, builder, is_whole=source.is_whole(residue)), residue)


def _take_residue(scene: OpenStage) -> str:
    """The residue that the root layer contains, out of its custom data."""
    text = scene.stage.GetRootLayer().customLayerData.get(words.RESIDUE)
    if not isinstance(text, str):
        return ""
    for layer in (scene.stage.GetRootLayer(), scene.layer):  # the same, or one that everything was flattened into
        layer.customLayerData = {key: value for key, value in layer.customLayerData.items() if key != words.RESIDUE}
    return text


def _prims(scene: OpenStage) -> list[Prim]:
    """All prims in stage order, without the groups that the writer makes for prims of its own."""
    return [prim for prim in scene.prims.values() if prim.is_real and f"{words.PREFIX}scope" not in prim.types]


def _read_shapes(prims: list[Prim], builder: UsdBuilder) -> None:
    """Shapes first, then the masses that may follow from them."""
    on: dict[Id, list[ReadShape]] = {}
    for prim in prims:
        found = read_shape(prim, builder) if is_shape(prim) else None
        if found is not None:
            on.setdefault(found[0], []).append(found[1])
    for path, body in builder.bodies.items():
        read_mass(builder.prim_at(path), body, on.get(body, []), builder)


def _read_mounted(prims: list[Prim], ends: dict[str, DofRef], builder: UsdBuilder) -> None:
    """Mounts, tendons, actuators and contacts."""
    for prim in prims:
        kind = prim.kind
        if kind == "Camera":
            read_camera(prim, builder)
        elif kind in words.LIGHTS:
            read_light(prim, builder)
        elif any(prim.has_api(site) for site in words.SITES):
            read_site(prim, builder)
    read_tendons(prims, ends, builder)
    for prim in prims:
        if prim.kind == ACTUATOR:
            read_actuator(prim, ends, builder)
    for path in builder.bodies:
        read_filtered_pairs(builder.prim_at(path), builder)
    read_collision_groups(prims, builder)


def _read_joints(prims: list[Prim], bare: list[Prim], builder: UsdBuilder) -> dict[str, DofRef]:
    """The joints, with drives and mimics; returns the dof that each of their prims is."""
    joints = [joint for prim in prims if prim.kind in JOINTS for joint in [read_joint(prim, builder)] if joint is not None]
    joints = join_bare_links(bare, [with_dialect(joint, builder) for joint in joints], builder)
    joints = build_trees(joints, _articulation_roots(prims, joints, builder), _held(builder), builder)
    ends = {prim.path: end for joint in joints for prim, end in dof_refs(joint)}
    named = {end.dof or end.joint.name: end for end in ends.values()}
    for joint in joints:
        for prim, end in dof_refs(joint):
            if not is_passive_drive(prim):
                read_drives(prim, end, builder)
            read_mimic(prim, end, ends, builder)
            read_named_mimic(prim, end, named, builder)
    return ends


def _articulation_roots(prims: list[Prim], joints: list[ReadJoint], builder: UsdBuilder) -> list[Id]:
    """The bodies at which articulations begin: those that have the API, or an end of the joint that has it."""
    ends = {joint.prim.path: [end.body for end in joint.ends if end.body != WORLD] for joint in joints}
    roots: list[Id] = []
    for prim in prims:
        if prim.has_api(ARTICULATION):
            roots += [builder.bodies[prim.path]] if prim.path in builder.bodies else ends.get(prim.path, [])[:1]
    return roots


def _held(builder: UsdBuilder) -> list[Id]:
    """The bodies that are fixed unless a joint moves them: simulation switched off, kinematic, or another converter's world."""
    prims = {body: builder.prim_at(path) for path, body in builder.bodies.items()}
    return [body for body, prim in prims.items() if is_world(prim, builder) or _is_fixed(prim)]


def _is_fixed(prim: Prim) -> bool:
    return prim.value("physics:rigidBodyEnabled") is False or prim.value("physics:kinematicEnabled") is True


def _finished(scene: OpenStage, builder: UsdBuilder, *, is_whole: bool) -> Mechanism:
    default = scene.stage.GetDefaultPrim()
    first = next(iter(builder.bodies), "")
    root = default or scene.stage.GetPrimAtPath("/" + first.split("/")[1] if first else "/")
    origin = Origin(builder.source.name)
    name = str(default.GetName()) if default else builder.source.stem
    if root and not root.IsPseudoRoot():
        builder.note(ROOT, words.ROOT_PRIM, str(root.GetPath()))
    if not builder.bodies and not builder.edges and is_whole:
        builder.report.error(codes.MISSING_PART, "the stage has no rigid bodies, joints or shapes; the result is empty", origin)
    elif not builder.bodies and is_whole:
        builder.report.warn(codes.MISSING_PART, "the stage has no rigid bodies; what it has belongs to the world", origin)
    return replace(builder.build(name, Provenance(words.FORMAT, file=builder.source.name)), places=dict(_packed_images(builder)))


def _packed_images(builder: UsdBuilder) -> Iterator[tuple[str, str]]:
    """How the images in a package are called outside of it."""
    package = PurePath(builder.source.name.replace("\\", "/")).name
    if not builder.source.data.startswith(b"PK") or not package.lower().endswith(".usdz"):
        return
    for part in builder.vertices.values():
        if isinstance(part, Texture) and part.uri is not None:
            yield part.uri, f"{package}[{part.uri}]"
