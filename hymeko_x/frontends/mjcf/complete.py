"""What MuJoCo computes, made explicit for formats that have no such thing: inertias from geoms, springs, meshes, fitted primitives.

MuJoCo itself is asked, so that meshes, <compiler> and everything that changes masses count as they do there. Where nothing but plain
solids counts, it is asked about these alone, each on a body of its own: the inertia of a body in its own frame depends neither on
its pose nor on its children.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.formats.mjcf.places import PLACE, GeomPlace
from hymeko_x.formats.mjcf.tree import parse_text
from hymeko_x.formats.mjcf.words import NAME, compiler_has, compilers, joined, mentions, settings_of
from hymeko_x.frontends.mjcf.colours import with_mean_colours
from hymeko_x.frontends.mjcf.points import is_made, with_points
from hymeko_x.ir.mechanism import ROOT, Id, Mechanism, shape_edge
from hymeko_x.ir.parts import Body, Box, Camera, Capsule, Cylinder, DofKind, Ellipsoid, Inertial, Joint, Mesh, NoShape, Sphere
from hymeko_x.ir.values import pose, rotate_tensor, unit_quat

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.formats.mjcf.codec import Settings
    from hymeko_x.ir.mechanism import RobotEdge, ShapeView
    from hymeko_x.ir.parts import Dof, Geometry
    from hymeko_x.ir.values import Tensor
    from hymeko_x.source import Files

Printed = Callable[[], tuple[Mechanism, bytes]]
"""Gives the mechanism as it is legal in MJCF, and its text; called only where MuJoCo needs the whole model."""

_SCALES = ("settotalmass", "boundmass", "boundinertia", "balanceinertia")
"""Attributes of <compiler> that change inertias which are given."""
_LEAST = 1e-14
"""Moving bodies with a mass in kg or a moment in kg m^2 of up to 1e-15 are refused by MuJoCo."""
_NOISE = 1e-13
"""The largest product of inertia, relative to the largest moment, that is rounding of the principal axes."""
_FOVY = math.radians(45.0)
"""The vertical field of view of a camera without one."""


def complete(mechanism: Mechanism, printed: Printed, files: Files, report: Report) -> Mechanism:
    """The mechanism, which came from MJCF and goes there as it is ``printed``, with what MuJoCo computes of it.

    That is the mass, centre of mass and tensor of every body, stiffness and damping of springs, the points of meshes, the sizes of
    fitted primitives, the field of view of cameras, and the colours of patterns. Bodies without mass stay without an inertial. Where MuJoCo
    is not installed or refuses the text, only cameras and colours change, with an error (a warning where files are missing).
    """
    mechanism = with_mean_colours(_with_fields_of_view(mechanism), files=files)
    wanted = [key for key, body in mechanism.vertices(Body) if body.inertial is None and mechanism.shapes.get(key)]
    scaled = compiler_has(mechanism, _SCALES)
    sprung = mentions(mechanism, "springdamper")
    meshes = [key for key, mesh in mechanism.vertices(Mesh) if is_made(mechanism, key, mesh)]
    fitted = [view for view in mechanism.every_shape() if _is_fitted(mechanism, view)]
    if not (wanted or scaled or sprung or meshes or fitted):
        return mechanism
    try:
        import mujoco
    except ImportError:
        message = "MuJoCo computes inertias from geoms and some meshes, and is not installed; they are left out"
        report.error(codes.ENGINE_MISSING, message, hint="pip install mujoco")
        return mechanism
    alone = None if scaled or sprung or meshes or fitted else _computed_alone(mujoco, mechanism, wanted)
    if alone is not None:
        return mechanism.replace(vertices=alone)
    legal, text = printed()
    assets, missing = _assets(mechanism, files)
    try:
        model = _compiled(mujoco, text, assets)
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        reason = str(error).strip().partition("\n")[0]
        record = report.warn if missing else report.error  # a missing file is reported by itself, and is no reason to stop
        record(codes.ENGINE_REFUSED, f"MuJoCo refuses the model, so that inertias and meshes that it computes are left out: {reason}")
        return mechanism
    order = {key: number for number, key in enumerate(legal.depth_first(), 1)}
    chosen = [key for key, _ in mechanism.vertices(Body)] if scaled else wanted
    bodies = _with_inertials(mechanism, model, {key: order[key] for key in chosen if key in order})
    edges = _with_springs(mechanism, model, order) if sprung and b"springdamper=" in text else {}
    edges |= _fitted(mechanism, mujoco, model, fitted, order)
    points = {key: with_points(mechanism, mujoco, model, key, assets) for key in meshes}
    return mechanism.replace(vertices={**bodies, **points}, edges=edges)


def _with_fields_of_view(mechanism: Mechanism) -> Mechanism:
    cameras = {key: replace(camera, fovy=_FOVY) for key, camera in mechanism.vertices(Camera) if _has_usual_lens(camera)}
    return mechanism.replace(vertices=cameras)


def _has_usual_lens(camera: Camera) -> bool:
    parameters = dict(camera.parameters)
    return camera.fovy is None and not {"focal", "focalpixel"} & parameters.keys() and parameters.get("projection") != "orthographic"


# ---- the whole model -----------------------------------------------------------------------------------------------------------


def _compiled(mujoco: Any, text: bytes, assets: dict[str, bytes]) -> Any:
    """The model with every body frame where its author put it."""
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        spec = mujoco.MjSpec.from_string(text.decode(), assets=assets)
        for key in spec.keys:
            spec.delete(key)  # a pose has no mass, and may be of another number of joints
        _remove_appearance(spec)
        spec.compiler.fusestatic = False
        spec.compiler.alignfree = False
        spec.compiler.discardvisual = False
        for joint in spec.joints if b"align=" in text else ():
            with contextlib.suppress(AttributeError):
                joint.align = 0
        return spec.compile()


def _remove_appearance(spec: Any) -> None:
    """Delete what has no mass, whose files may be far away."""
    for skin in tuple(spec.skins):
        spec.delete(skin)
    for material in spec.materials:
        material.textures = [""] * len(material.textures)
    for texture in tuple(spec.textures):
        spec.delete(texture)


def _assets(mechanism: Mechanism, files: Files) -> tuple[dict[str, bytes], set[str]]:
    """Every file that counts for masses and shapes, by its path from the model; and the paths of those that are not there."""
    uris = [part.uri for part in mechanism.graph.vertices.values() if isinstance(part, Mesh) and part.uri]
    settings = _settings(mechanism)
    for extra in mechanism.extras.get(ROOT, ()):
        if extra.format == NAME and extra.path == "asset":
            uris.append(joined(settings.mesh_folder, parse_text(extra.text).attributes.get("file", ""), settings))
    found: dict[str, bytes] = {}
    for uri in uris:
        path = files.find(uri)
        if path is not None:
            with contextlib.suppress(OSError):
                found[uri] = files.read(path)
    return found, {uri for uri in uris if uri} - found.keys()


def _settings(mechanism: Mechanism) -> Settings:
    return settings_of([parse_text(text).attributes for text in compilers(mechanism)])


# ---- inertias and springs ------------------------------------------------------------------------------------------------------


def _with_inertials(mechanism: Mechanism, model: Any, numbers: dict[Id, int]) -> dict[Id, Body]:
    """These bodies, which have these numbers in the model, with their inertials there."""
    masses, places = model.body_mass.tolist(), model.body_ipos.tolist()
    turns, moments = model.body_iquat.tolist(), model.body_inertia.tolist()
    found: dict[Id, Body] = {}
    for key, number in numbers.items():
        body = mechanism.vertex(key, Body)
        if masses[number] == 0.0:
            found[key] = body
            continue
        a, b, c = moments[number]
        px, py, pz = places[number]
        w, x, y, z = turns[number]
        tensor = _without_noise(rotate_tensor(unit_quat((w, x, y, z)), (a, b, c, 0.0, 0.0, 0.0)))
        found[key] = replace(body, inertial=Inertial(masses[number], (px, py, pz), tensor))
    return found


def _without_noise(tensor: Tensor) -> Tensor:
    """The tensor whose products of inertia are zero where MuJoCo's principal axes leave nothing but rounding."""
    most = _NOISE * max(tensor[:3])
    xx, yy, zz, *products = tensor
    xy, xz, yz = (0.0 if abs(value) <= most else value for value in products)
    return xx, yy, zz, xy, xz, yz


def _with_springs(mechanism: Mechanism, model: Any, order: dict[Id, int]) -> dict[Id, RobotEdge]:
    """The joints whose stiffness and damping follow from a time constant and a damping ratio (<joint springdamper>)."""
    found: dict[Id, RobotEdge] = {}
    for view in mechanism.joints.values():
        first = int(model.body_jntadr[order[view.child]]) if view.child in order else -1
        if first < 0 or any(dof.kind in (DofKind.BALL, DofKind.FREE) for dof in view.joint.dofs):
            continue
        dofs = tuple(_with_spring(dof, model, first + number) for number, dof in enumerate(view.joint.dofs))
        if dofs != view.joint.dofs:
            found[view.id] = replace(mechanism.graph.edges[view.id], data=Joint(dofs))
    return found


def _with_spring(dof: Dof, model: Any, number: int) -> Dof:
    return replace(dof, stiffness=float(model.jnt_stiffness[number]), damping=float(model.dof_damping[model.jnt_dofadr[number]]))


# ---- bodies of plain solids ----------------------------------------------------------------------------------------------------

_SOLIDS = (Box, Capsule, Cylinder, Ellipsoid, Sphere)
_HARMLESS = frozenset(
    (
        *("angle", "eulerseq", "autolimits", "coordinate", "meshdir", "texturedir", "assetdir", "strippath", "convexhull", "fitaabb"),
        *("discardvisual", "fusestatic", "alignfree", "usethread", "saveinertial", "LRopt"),
    )
)
"""Attributes of <compiler> that do not change the inertia of solids, or that :func:`_model_of` heeds."""
_PLACED = frozenset((*(f"@{name}" for name in PLACE.names), "frame"))
"""The notations of a shape whose pose only the writer of the whole model can write."""


def _computed_alone(mujoco: Any, mechanism: Mechanism, wanted: list[Id]) -> dict[Id, Body] | None:
    """These bodies with their inertials, without printing the rest; None where more than their solids may count."""
    if not are_solids_alone(mechanism, wanted):
        return None
    try:
        model = _model_of(mujoco, mechanism, wanted, _settings(mechanism))
    except (ValueError, RuntimeError, mujoco.FatalError):
        return None
    if model.body_mass[1:].min() < _LEAST or model.body_inertia[1:].min() < _LEAST:
        return None
    return _with_inertials(mechanism, model, {key: number for number, key in enumerate(wanted, 1)})


def are_solids_alone(mechanism: Mechanism, bodies: list[Id]) -> bool:
    """Whether the inertias of these bodies depend on nothing but their solids, whose poses are known."""
    if not all(_is_harmless(parse_text(text).attributes) for text in compilers(mechanism)) or mentions(mechanism, "shellinertia"):
        return False
    reached = set(mechanism.depth_first())
    return all(key in reached and _is_solid(mechanism, key) for key in bodies)


def _model_of(mujoco: Any, mechanism: Mechanism, bodies: list[Id], settings: Settings) -> Any:
    """MuJoCo's model of these bodies in this order, each a child of the world with nothing but its solids.

    Raises: ValueError, RuntimeError or mujoco.FatalError when MuJoCo refuses it.
    """
    spec = mujoco.MjSpec()
    spec.compiler.degree = settings.degree
    for place, axis in enumerate(settings.eulerseq):
        spec.compiler.eulerseq[place] = axis
    for key in bodies:
        body = spec.worldbody.add_body()
        for view in mechanism.shapes[key]:
            body.add_geom(**_geom(mujoco, view, settings))
    return spec.compile()


def _is_harmless(attributes: dict[str, str]) -> bool:
    inertia = attributes.get("inertiafromgeom", "auto")
    return inertia in ("auto", "true") and _HARMLESS.issuperset(attributes.keys() - {"inertiafromgeom"})


def _is_solid(mechanism: Mechanism, body: Id) -> bool:
    """Whether a body has nothing but solids whose poses are in the parts, and no element that the IR cannot represent."""
    return not _has_elements(mechanism, body) and all(
        isinstance(view.shape.geometry, _SOLIDS)
        and _PLACED.isdisjoint(mechanism.notations.get(view.id, ()))
        and not _has_elements(mechanism, view.id)
        for view in mechanism.shapes[body]
    )


def _has_elements(mechanism: Mechanism, key: Id) -> bool:
    return any(extra.format == NAME and extra.text.startswith("<") for extra in mechanism.extras.get(key, ()))


def _geom(mujoco: Any, view: ShapeView, settings: Settings) -> dict[str, Any]:
    attributes = PLACE.write(GeomPlace(view.shape.geometry, view.pose), settings)
    found: dict[str, Any] = {"type": getattr(mujoco.mjtGeom, f"mjGEOM_{attributes.pop('type').upper()}")}
    found |= {name: [float(number) for number in text.split()] for name, text in attributes.items()}
    found["size"] += [0.0] * (3 - len(found["size"]))
    if view.shape.mass is not None:
        found["mass"] = view.shape.mass
    if view.shape.density is not None:
        found["density"] = view.shape.density
    return found


# ---- fitted primitives -------------------------------------------------------------------------------------------------------


def _is_fitted(mechanism: Mechanism, view: ShapeView) -> bool:
    """Whether a shape is a primitive that MuJoCo fits to a mesh."""
    if not isinstance(view.shape.geometry, NoShape):
        return False
    return any(extra.format == NAME and extra.path == "@mesh" for extra in mechanism.extras.get(view.id, ()))


def _fitted(mechanism: Mechanism, mujoco: Any, model: Any, views: list[ShapeView], order: dict[Id, int]) -> dict[Id, RobotEdge]:
    """The primitives that MuJoCo fits to meshes."""
    found: dict[Id, RobotEdge] = {}
    for view in views:
        place = [other.id for other in mechanism.shapes[view.body]].index(view.id)
        geom = int(model.body_geomadr[order.get(view.body, 0)]) + place
        geometry = _geometry(mujoco, model, geom)
        if geometry is not None:
            x, y, z = model.geom_pos[geom].tolist()
            at = pose((x, y, z), tuple(model.geom_quat[geom].tolist()))
            found[view.id] = shape_edge(replace(view.shape, geometry=geometry), view.body, at, None, view.material)
    return found


def _geometry(mujoco: Any, model: Any, geom: int) -> Geometry | None:
    a, b, c = model.geom_size[geom].tolist()
    kinds = mujoco.mjtGeom
    match int(model.geom_type[geom]):
        case kinds.mjGEOM_SPHERE:
            return Sphere(a)
        case kinds.mjGEOM_CAPSULE:
            return Capsule(a, 2.0 * b)
        case kinds.mjGEOM_CYLINDER:
            return Cylinder(a, 2.0 * b)
        case kinds.mjGEOM_BOX:
            return Box((2.0 * a, 2.0 * b, 2.0 * c))
        case kinds.mjGEOM_ELLIPSOID:
            return Ellipsoid((a, b, c))
        case _:
            return None
