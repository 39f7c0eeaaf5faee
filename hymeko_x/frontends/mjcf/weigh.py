"""What MuJoCo computes, made explicit for formats that have no such thing: inertias from geoms, springs, meshes, fitted shapes.

MuJoCo itself is asked, so that meshes, <compiler> and everything that changes masses count as they do there.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.formats.mjcf.tree import parse_text
from hymeko_x.formats.mjcf.words import NAME, joined, settings_of
from hymeko_x.frontends.mjcf.lean import can_be_lean, lean_model
from hymeko_x.frontends.mjcf.solids import fitted_shape, solid_mesh, unsolid
from hymeko_x.ir.mechanism import ROOT, Id, Mechanism
from hymeko_x.ir.parts import Body, DofKind, Inertial, Joint, Mesh
from hymeko_x.ir.values import rotate_tensor, unit_quat
from hymeko_x.rewrite.native import compiler_says, compilers, someone_says

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import RobotEdge, ShapeView
    from hymeko_x.ir.parts import Dof
    from hymeko_x.source import Files

Printed = Callable[[], tuple[Mechanism, bytes]]
"""Gives the mechanism as it is legal in MJCF, and its text; asked only where MuJoCo has to be."""

_SCALES = ("settotalmass", "boundmass", "boundinertia", "balanceinertia")
"""Attributes of <compiler> that change inertias which are said."""

_LEAST = 1e-14
"""Moving bodies that weigh no more than 1e-15 are refused by MuJoCo, in kg and kg m^2."""


def weigh(mechanism: Mechanism, printed: Printed, files: Files, report: Report) -> Mechanism:
    """The mechanism, which came from MJCF and goes there as it is ``printed``, with what only MuJoCo knows.

    That is the mass, centre of mass and tensor of every body, the points of meshes and the sizes of primitives. Bodies
    that weigh nothing stay without. Where MuJoCo is not there or refuses the text, nothing changes, with a warning.
    """
    wanted = [key for key, body in mechanism.vertices(Body) if body.inertial is None and mechanism.shapes.get(key)]
    scaled = compiler_says(mechanism, _SCALES)
    sprung = someone_says(mechanism, "springdamper")
    meshes, fitted = unsolid(mechanism)
    if not (wanted or scaled or sprung or meshes or fitted):
        return mechanism
    try:
        import mujoco
    except ImportError:
        report.warn(codes.ENGINE_MISSING, "MuJoCo computes inertias from geoms and some meshes, and is not installed; they are left out")
        return mechanism
    alone = None if scaled or sprung or meshes or fitted else _weighed_alone(mujoco, mechanism, wanted)
    if alone is not None:
        return mechanism.with_graph(mechanism.graph.replace(vertices=alone))
    native, text = printed()
    try:
        model = _compiled(mujoco, text, _assets(mechanism, files))
    except (ValueError, mujoco.FatalError) as error:
        said = str(error).strip().splitlines()[0]
        report.warn(codes.ENGINE_REFUSED, f"MuJoCo refuses the model, so that inertias and meshes that it computes are left out: {said}")
        return mechanism
    order = {key: number for number, key in enumerate(native.depth_first(), 1)}
    chosen = [key for key, _ in mechanism.vertices(Body)] if scaled else wanted
    bodies = _weighed(mechanism, model, {key: order[key] for key in chosen if key in order})
    edges = _sprung(mechanism, model, order) if sprung and b"springdamper=" in text else {}
    edges |= _fitted(mechanism, mujoco, model, fitted, order)
    solid = {key: solid_mesh(mechanism, mujoco, model, key) for key in meshes}
    return mechanism.with_graph(mechanism.graph.replace(vertices={**bodies, **solid}, edges=edges))


def _weighed_alone(mujoco: Any, mechanism: Mechanism, wanted: list[Id]) -> dict[Id, Body] | None:
    """These bodies with what they weigh, without printing the rest; None where the whole model has to be asked, or might be refused."""
    if not can_be_lean(mechanism, wanted):
        return None
    try:
        model = lean_model(mujoco, mechanism, wanted, _settings(mechanism))
    except (ValueError, mujoco.FatalError):
        return None
    if model.body_mass[1:].min() < _LEAST or model.body_inertia[1:].min() < _LEAST:
        return None
    return _weighed(mechanism, model, {key: number for number, key in enumerate(wanted, 1)})


def _compiled(mujoco: Any, text: bytes, assets: dict[str, bytes]) -> Any:
    """The model with every body frame where its author put it."""
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        spec = mujoco.MjSpec.from_string(text.decode(), assets=assets)
        for key in spec.keys:
            spec.delete(key)  # a pose weighs nothing, and may be of another number of joints
        _undress(spec)
        spec.compiler.fusestatic = False
        spec.compiler.alignfree = False
        spec.compiler.discardvisual = False
        for joint in spec.joints if b"align=" in text else ():
            with contextlib.suppress(AttributeError):
                joint.align = 0
        return spec.compile()


def _undress(spec: Any) -> None:
    """Take off what weighs nothing, whose files may be far away."""
    for skin in tuple(spec.skins):
        spec.delete(skin)
    for material in spec.materials:
        material.textures = [""] * len(material.textures)
    for texture in tuple(spec.textures):
        spec.delete(texture)


def _assets(mechanism: Mechanism, files: Files) -> dict[str, bytes]:
    """Every file that counts for masses and shapes, by its path from the model."""
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
    return found


def _settings(mechanism: Mechanism) -> Any:
    return settings_of([parse_text(text).attributes for text in compilers(mechanism)])


def _weighed(mechanism: Mechanism, model: Any, numbers: dict[Id, int]) -> dict[Id, Body]:
    """These bodies, which have these numbers in the model, with what they weigh there."""
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
        tensor = rotate_tensor(unit_quat((w, x, y, z)), (a, b, c, 0.0, 0.0, 0.0))
        found[key] = replace(body, inertial=Inertial(masses[number], (px, py, pz), tensor))
    return found


def _fitted(mechanism: Mechanism, mujoco: Any, model: Any, views: list[ShapeView], order: dict[Id, int]) -> dict[Id, RobotEdge]:
    """The primitives that MuJoCo fits to meshes."""
    found: dict[Id, RobotEdge] = {}
    for view in views:
        place = [other.id for other in mechanism.shapes[view.body]].index(view.id)
        edge = fitted_shape(mujoco, model, view, int(model.body_geomadr[order.get(view.body, 0)]) + place)
        if edge is not None:
            found[view.id] = edge
    return found


def _sprung(mechanism: Mechanism, model: Any, order: dict[Id, int]) -> dict[Id, RobotEdge]:
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
