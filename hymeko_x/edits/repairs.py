"""`check --fix`: mechanical repairs of what `check` finds, in the author's text."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from msgspec import Struct, structs
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, Report, refuse
from hymeko_x.edits.text import EditedFiles, Texts, text_with_edits
from hymeko_x.edits.updating import Updated
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.names import free_name, rename
from hymeko_x.ir.parts import Body, Box, Capsule, Cylinder, Ellipsoid, Inertial, Joint, Shape, Sphere
from hymeko_x.residue.originals import files_of
from hymeko_x.rewrite.apart import names_apart
from hymeko_x.rewrite.context import Context
from hymeko_x.rewrite.decimals import shorten_computed
from hymeko_x.rewrite.densities import WATER, give_inertials
from hymeko_x.rewrite.inertia import physical
from hymeko_x.rewrite.mimics import driven_joints, leaders_first
from hymeko_x.rewrite.references import with_references
from hymeko_x.validation import LEAST_MASS, UNIT_LENGTH, tensor_fault

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from hymeko_x.diagnostics import Diagnostic
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Mechanism, RobotEdge
    from hymeko_x.ir.parts import Dof, Geometry
    from hymeko_x.rewrite import Options
    from hymeko_x.source import Source

_MARK = "#"
"""Behind it readers number the elements whose name another one has."""
_NOT_NEGATIVE = ("damping", "friction", "armature")
_BOUNDS = ("effort", "velocity")


def repaired(source: Source, format: Format, before: Mechanism, found: Sequence[Diagnostic], options: Options, report: Report) -> Updated:
    """A robot with its faults repaired as far as that is mechanical, and the texts that change; each repair is one note of the report.

    ``before`` is the robot as it was read, with what reading ``found``. ``options`` has the density of bodies without an inertial, which
    otherwise stay without one.

    Raises: HX003 where the text of the format cannot be edited.
    """
    if format.outline is None:
        raise refuse(codes.UNKNOWN_FORMAT, f"{format.name} is no text in which repairs could be placed", Origin(source.name))
    context = Context(report, files_of(before, source.files))
    named = _name_once(before, context, {one.origin for one in found if one.code == codes.DUPLICATE_NAME})
    if format.one_namespace:
        named = _lead_first(_name_apart(named, context), context)
    mended = _mend_joints(named, context, frozenset(one.element for one in found if one.code == codes.NOT_UNIT))
    after = _with_inertials(_mend_sizes(_mend_tensors(mended, context), context), options, context)
    after = shorten_computed(after, before)
    texts = text_with_edits(source, format, before, after, report) if after is not before else Texts({}, {})
    texts.report_printed(source, report)
    texts.report_missing(source, report)
    changed = texts.changed
    old = {path: source.data if path == source.name else source.files.read(path) for path in changed}
    return Updated(after, (), source.data, changed, old, {}, report)


def repaired_source(source: Source, found: Updated) -> Source:
    """A source with the texts that its repairs changed."""
    return replace(source, data=found.changed.get(source.name, source.data), files=EditedFiles(source.files, found.changed))


def _with_inertials(mechanism: Mechanism, options: Options, context: Context) -> Mechanism:
    """Bodies without a mass have that of their shapes, if the options ask for it."""
    if options.density is None and options.inertia_from is None:
        return mechanism
    density = WATER if options.density is None else options.density
    bare = {key: body.inertial for key, body in mechanism.vertices(Body) if not _is_whole(body.inertial)}
    emptied = mechanism.replace(vertices=dict.fromkeys(bare, Body()))
    weighed = give_inertials(emptied, density, options.inertia_from, Context(Report(), context.files))
    given: dict[Id, Body] = {}
    for key, own in bare.items():
        shaped = weighed.vertex(key, Body).inertial
        if shaped is None or not shaped.mass or shaped.tensor is None:
            continue
        if own is not None and own.mass is not None and _weighs(own.mass):
            tensor = tuple(value * own.mass / shaped.mass for value in shaped.tensor)
            given[key] = Body(replace(own, tensor=tensor, written=None))
            _note(context, mechanism, key, f"{key}: the inertia of its shapes, for its mass of {own.mass:.4g} kg")
        else:
            given[key] = Body(shaped)
            _note(context, mechanism, key, f"{key}: a mass of {shaped.mass:.4g} kg and the inertia of its shapes, with {density:g} kg/m^3")
    return mechanism.replace(vertices=given)


def _is_whole(inertial: Inertial | None) -> bool:
    """Whether an inertial has a mass and a tensor that a body can have."""
    return inertial is not None and _weighs(inertial.mass) and inertial.tensor is not None and tensor_fault(inertial) is None


def _weighs(mass: float | None) -> bool:
    return mass is not None and math.isfinite(mass) and mass >= LEAST_MASS


def _note(context: Context, mechanism: Mechanism, key: Id, message: str) -> None:
    context.report.note(codes.REPAIRED, message, mechanism.origin(key), element=str(key))


# ---- names -------------------------------------------------------------------------------------------------------------------


def _name_once(mechanism: Mechanism, context: Context, places: set[Origin | None]) -> Mechanism:
    """The second one of two links or joints of one name has a name of its own. References mean the first one, as they did."""
    keys = (*mechanism.graph.vertices, *mechanism.graph.edges)
    taken: dict[str, set[str]] = {}
    for key in keys:
        taken.setdefault(key.kind, set()).add(key.name)
    renamed: dict[Id, Id] = {}
    for key in keys:
        name = key.name.partition(_MARK)[0]
        if name == key.name or mechanism.origin(key) not in places:
            continue
        renamed[key] = Id(key.kind, free_name(name, taken[key.kind].__contains__, "_"))
        taken[key.kind].add(renamed[key].name)
        _note(context, mechanism, key, f"there are two of the name '{name}'; this {key.kind} is called '{renamed[key].name}'")
    return rename(mechanism, renamed)


def _name_apart(mechanism: Mechanism, context: Context) -> Mechanism:
    """A joint that is called as a link is gets a name of its own, which everything that refers to the joint has."""
    taken = {key.name for key in (*mechanism.graph.vertices, *mechanism.graph.edges)}
    renamed = names_apart(mechanism, taken)
    for key, new in renamed.items():
        _note(context, mechanism, key, f"a link is called '{key.name}' as well; the joint is called '{new.name}'")
    return with_references(rename(mechanism, renamed), renamed)


def _lead_first(mechanism: Mechanism, context: Context) -> Mechanism:
    """Joints follow the one of them that comes first in the tree, unless that takes the lead from a joint with an actuator."""
    turned, driven = leaders_first(mechanism), set(driven_joints(mechanism))
    left = {edge.arcs[1].target for edge in turned.values() if edge.arcs[0].target in driven}
    turned = {key: edge for key, edge in turned.items() if edge.arcs[1].target not in left}
    for key, edge in turned.items():
        if edge != mechanism.graph.edges[key]:
            _note(context, mechanism, key, f"{edge.arcs[0].target} follows {edge.arcs[1].target}, which comes first in the tree")
    return mechanism.replace(edges=turned)


# ---- joints ------------------------------------------------------------------------------------------------------------------


class _Mended(Struct):
    """A dof with the repairs that it got, in words."""

    dof: Dof
    repairs: list[str]


def _mend_joints(mechanism: Mechanism, context: Context, not_unit: frozenset[str]) -> Mechanism:
    """Lower limits are below upper ones, no bound, damping, friction or armature is negative, and those axes have length 1."""
    edges: dict[Id, RobotEdge] = {}
    for key, joint, arcs in mechanism.edges(Joint):
        mended = [_mended(dof, is_unit=str(key) not in not_unit) for dof in joint.dofs]
        for message in (message for each in mended for message in each.repairs):
            _note(context, mechanism, key, f"{key}: {message}")
        if any(each.repairs for each in mended):
            edges[key] = Edge(replace(joint, dofs=tuple([each.dof for each in mended])), arcs)
    return mechanism.replace(edges=edges)


def _mended(dof: Dof, *, is_unit: bool) -> _Mended:
    found = _Mended(dof, [])
    limits = dof.limits
    if limits.lower is not None and limits.upper is not None and limits.lower > limits.upper:
        found.repairs.append(f"lower limit {limits.lower!r} and upper limit {limits.upper!r} change places")
        limits = replace(limits, lower=limits.upper, upper=limits.lower)
    for name in _BOUNDS:
        if (value := getattr(limits, name)) is not None and value < 0.0:
            found.repairs.append(f"{name} limit {value!r} becomes {-value!r}")
            limits = replace(limits, **{name: -value})
    changed = {name: -value for name in _NOT_NEGATIVE if (value := getattr(dof, name)) is not None and value < 0.0}
    found.repairs += [f"{name} {-value!r} becomes {value!r}" for name, value in changed.items()]
    found.dof = replace(dof, limits=limits, **changed)
    if not is_unit and dof.written is not None and abs(math.hypot(*dof.written.numbers) - 1.0) > UNIT_LENGTH:
        found.repairs.append(f"axis {numbers_text(dof.written.numbers)} becomes {numbers_text(dof.axis)}, of length 1")
        found.dof = replace(found.dof, written=None)
    return found


# ---- bodies ------------------------------------------------------------------------------------------------------------------


def _mend_tensors(mechanism: Mechanism, context: Context) -> Mechanism:
    """A tensor that no body can have becomes the nearest one that a body can have."""
    found: dict[Id, Body] = {}
    for key, body in mechanism.vertices(Body):
        inertial = body.inertial
        if inertial is None or inertial.tensor is None or not all(map(math.isfinite, inertial.tensor)) or tensor_fault(inertial) is None:
            continue
        tensor = physical(inertial.tensor)
        mended = replace(inertial, tensor=tensor, written=None)
        if tensor_fault(mended) is None:
            found[key] = replace(body, inertial=mended)
            message = f"{key}: the inertia tensor {numbers_text(inertial.tensor)} becomes {numbers_text(tensor)}, which a body can have"
            _note(context, mechanism, key, message)
    return mechanism.replace(vertices=found)


# ---- shapes ------------------------------------------------------------------------------------------------------------------


def _mend_sizes(mechanism: Mechanism, context: Context) -> Mechanism:
    """Negative sizes lose their sign."""
    edges: dict[Id, RobotEdge] = {}
    for key, shape, arcs in mechanism.edges(Shape):
        sizes = dict(_positive(shape.geometry))
        if sizes:
            edges[key] = Edge(replace(shape, geometry=structs.replace(shape.geometry, **sizes)), arcs)
            _note(context, mechanism, key, f"{key}: a negative {' and '.join(sizes)} loses its sign")
    return mechanism.replace(edges=edges)


def _positive(geometry: Geometry) -> Iterator[tuple[str, float | tuple[float, ...]]]:
    """The sizes of a primitive that are negative, without their sign."""
    if not isinstance(geometry, Box | Ellipsoid | Sphere | Cylinder | Capsule):
        return
    for name, value in structs.asdict(geometry).items():
        new = tuple(map(abs, value)) if isinstance(value, tuple) else abs(value)
        if new != value:
            yield name, new
