"""Joints, their dofs and limits, for formats with hinges, slides, balls and free roots."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.kinematics import dof_number, edges_to_moved_dofs
from hymeko_x.ir.mechanism import WORLD, Id, JointView, Mechanism, coupling_edge, joint_edge
from hymeko_x.ir.names import free_name, names_in_use
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import UNLIMITED, Body, Coupling, Dof, DofKind, Drive, Joint, Limits, Sense, Tendon
from hymeko_x.ir.values import IDENTITY, X, Y, Z
from hymeko_x.rewrite.names import usable_name

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism, RobotArc, RobotEdge
    from hymeko_x.ir.values import Vec3
    from hymeko_x.rewrite.context import Context


# ---- dofs --------------------------------------------------------------------------------------------------------------


VELOCITIES = {DofKind.HINGE: 1, DofKind.SLIDE: 1, DofKind.SCREW: 1, DofKind.BALL: 3, DofKind.FREE: 6}
_MOST_VELOCITIES = 6
_TURNS = (DofKind.HINGE, DofKind.BALL)
_LETTERS: Mapping[Vec3, str] = {X: "X", Y: "Y", Z: "Z"}


def expand_screws(mechanism: Mechanism, context: Context) -> Mechanism:
    """A screw becomes a hinge and a slide along the same axis that is coupled to it by the pitch."""
    screws = [view for view in mechanism.joints.values() if DofKind.SCREW in [dof.kind for dof in view.joint.dofs]]
    if not screws:
        return mechanism
    edges: dict[Id, RobotEdge] = {}
    moved: dict[tuple[Id, int], tuple[Id, str]] = {}
    names = names_in_use(mechanism)
    for view in screws:
        dofs: list[Dof] = []
        for number, dof in enumerate(view.joint.dofs):
            name = dof.name or (view.id.name if len(view.joint.dofs) == 1 else f"{view.id.name}_{number}")
            moved[view.id, number] = (view.id, name)
            if dof.kind is not DofKind.SCREW:
                dofs.append(replace(dof, name=name))
                continue
            slide = Dof(DofKind.SLIDE, dof.axis, anchor=dof.anchor, name=f"{name}_slide")
            dofs += [replace(dof, kind=DofKind.HINGE, pitch=0.0, name=name), slide]
            edges[names.take("coupling", usable_name(f"{name}_screw"))] = _screw(view.id, name, f"{name}_slide", dof)
            context.report.note(
                codes.REWRITTEN,
                f"{view.id} is a screw; it is written as hinge '{name}' and slide '{name}_slide', coupled by the pitch",
                mechanism.origin(view.id),
                element=str(view.id),
            )
        edges[view.id] = _with_dofs(mechanism, view.id, tuple(dofs))
    return _with_edges(mechanism, edges, moved)


def lower_inner_free_joints(mechanism: Mechanism, context: Context) -> Mechanism:
    """A free joint that is not the only one above a child of the world becomes three slides and a ball."""
    edges: dict[Id, RobotEdge] = {}
    for view in mechanism.joints.values():
        dofs = view.joint.dofs
        if DofKind.FREE not in [dof.kind for dof in dofs] or (len(dofs) == 1 and view.parent == WORLD):
            continue
        new: list[Dof] = []
        for dof in dofs:
            new += _three_slides_and_ball(dof) if dof.kind is DofKind.FREE else [dof]
        edges[view.id] = _with_dofs(mechanism, view.id, tuple(new))
        context.report.note(
            codes.REWRITTEN,
            f"{view.id} floats below {view.parent}, where only a child of the world may; it is written as three slides and a ball",
            mechanism.origin(view.id),
            element=str(view.id),
        )
    return _with_edges(mechanism, edges, {})


def name_dofs(mechanism: Mechanism, context: Context) -> Mechanism:
    """Every dof gets a name of its own: the joint's where it is the only one, else that with what moves (``_TX``, ``_RZ``)."""
    alone = {full_name(view, 0) for view in mechanism.joints.values() if len(view.joint.dofs) == 1}
    if len(alone) == sum([len(view.joint.dofs) for view in mechanism.joints.values()]):
        return mechanism  # each is the only one of its joint, and no two have one name
    edges: dict[Id, RobotEdge] = {}
    moved: dict[tuple[Id, int], tuple[Id, str]] = {}
    seen: set[str] = set()
    for view in mechanism.joints.values():
        dofs = view.joint.dofs
        new = []
        for number, dof in enumerate(dofs):
            wanted = full_name(view, number)
            name = free_name(wanted, (seen if len(dofs) == 1 else alone | seen).__contains__)
            if wanted != name:
                _warn_of_name(mechanism, view.id, wanted, name, context.report)
            seen.add(name)
            if len(dofs) > 1 or wanted != name:
                dof = replace(dof, name=name)
                moved[view.id, number] = (view.id, name)
            new.append(dof)
        if tuple(new) != dofs:
            edges[view.id] = _with_dofs(mechanism, view.id, tuple(new))
    return _with_edges(mechanism, edges, moved)


def name_dofs_in_use(mechanism: Mechanism, _context: Context) -> Mechanism:
    """A dof that an actuator, a sensor, a coupling or a tendon is on has a name, where other dofs need none."""
    used = {(arc.target, number) for arc in _arcs_to_dofs(mechanism) if (number := _number_at(mechanism, arc)) is not None}
    own = {key: _own_names(mechanism, mechanism.joints[key]) for key, _ in used}
    nameless = sorted((key, number) for key, number in used if not own[key][number])
    if not nameless:
        return mechanism
    taken = {name for view in mechanism.joints.values() for name in _own_names(mechanism, view) if name}
    changed: dict[Id, list[Dof]] = {}
    moved: dict[tuple[Id, int], tuple[Id, str]] = {}
    for key, number in nameless:
        view = mechanism.joints[key]
        name = free_name(full_name(view, number), taken.__contains__)
        taken.add(name)
        changed.setdefault(key, list(view.joint.dofs))[number] = replace(view.joint.dofs[number], name=name)
        moved[key, number] = (key, name)
    return _with_edges(mechanism, {key: _with_dofs(mechanism, key, tuple(dofs)) for key, dofs in changed.items()}, moved)


def _arcs_to_dofs(mechanism: Mechanism) -> Iterator[RobotArc]:
    for part in (Drive, Sense, Coupling, Tendon):
        for _, _, arcs in mechanism.edges(part):
            yield from (arc for arc in arcs if arc.target in mechanism.joints)


def _number_at(mechanism: Mechanism, arc: RobotArc) -> int | None:
    return dof_number(mechanism.joints[arc.target].joint, arc.role)


def name_dofs_once(mechanism: Mechanism, context: Context) -> Mechanism:
    """A name that two dofs have, as edits may leave it, stays with the first one. Dofs without a name stay without."""
    named = [(view, number, name) for view in mechanism.joints.values() for number, name in enumerate(_own_names(mechanism, view)) if name]
    taken = {name for _, _, name in named}
    if len(taken) == len(named):
        return mechanism
    changed: dict[Id, list[Dof]] = {}
    moved: dict[tuple[Id, int], tuple[Id, str]] = {}
    seen: set[str] = set()
    for view, number, wanted in named:
        if wanted not in seen:
            seen.add(wanted)
            continue
        name = free_name(wanted, taken.__contains__)
        _warn_of_name(mechanism, view.id, wanted, name, context.report)
        taken.add(name)
        changed.setdefault(view.id, list(view.joint.dofs))[number] = replace(view.joint.dofs[number], name=name)
        moved[view.id, number] = (view.id, name)
    return _with_edges(mechanism, {key: _with_dofs(mechanism, key, tuple(dofs)) for key, dofs in changed.items()}, moved)


def _own_names(mechanism: Mechanism, view: JointView) -> list[str | None]:
    """The names of a joint's dofs, for formats in which dofs need none."""
    if len(view.joint.dofs) == 1:
        only = view.joint.dofs[0].name
        return [only or (None if mechanism.notation(view.id, UNNAMED) else view.id.name)]
    return [dof.name for dof in view.joint.dofs]


def split_overfull_joints(mechanism: Mechanism, context: Context) -> Mechanism:
    """Dofs that cannot sit on one body (more than six, or a rotation below a ball) are spread over bodies in between."""
    overfull = [view for view in mechanism.joints.values() if len(_legal_groups(view.joint.dofs)) > 1]
    if not overfull:
        return mechanism
    vertices: dict[Id, Body] = {}
    edges: dict[Id, RobotEdge] = {}
    moved: dict[tuple[Id, int], tuple[Id, str]] = {}
    names = names_in_use(mechanism)
    for view in overfull:
        groups = _legal_groups(view.joint.dofs)
        above, pose = view.parent, view.parent_pose
        for number, group in enumerate(groups[:-1]):
            first = sum(map(len, groups[:number]))
            body = names.take("body", f"{view.child.name}_carrier")
            joint = names.take("joint", f"{view.id.name}_carrier")
            vertices[body] = Body()
            edges[joint] = joint_edge(Joint(group), above, body, pose)
            moved |= {(view.id, place): (joint, dof.name or "") for place, dof in enumerate(group, first)}
            above, pose = body, IDENTITY
        edges[view.id] = joint_edge(Joint(groups[-1]), above, view.child, pose, view.child_pose)
        context.report.note(
            codes.REWRITTEN,
            f"the dofs of {view.id} cannot all sit on one body; {len(groups) - 1} body in between carries the first ones",
            mechanism.origin(view.id),
            element=str(view.id),
        )
    return _with_edges(mechanism.replace(vertices=vertices), edges, moved)


# ---- parts of the rules ----------------------------------------------------------------------------------------------------


def _screw(joint: Id, hinge: str, slide: str, dof: Dof) -> RobotEdge:
    """The slide's coordinate: the pitch times the turn from the reference."""
    edge = coupling_edge(joint, ((joint, (-dof.pitch * dof.ref + 0.0, dof.pitch)),))
    follower, leader = edge.arcs
    return replace(edge, arcs=(replace(follower, role=slide), replace(leader, role=hinge)))


def _three_slides_and_ball(dof: Dof) -> list[Dof]:
    """Damping, friction and the like act on each of the six velocities, as they do in a free joint."""
    same = replace(dof, kind=DofKind.SLIDE, limits=UNLIMITED, ref=0.0, written=None)
    prefix = dof.name
    slides = [replace(same, axis=axis, name=f"{prefix}_T{_LETTERS[axis]}" if prefix else None) for axis in (X, Y, Z)]
    return [*slides, replace(same, kind=DofKind.BALL, axis=X, name=f"{prefix}_R" if prefix else None)]


def full_name(view: JointView, number: int) -> str:
    """The name of a dof: its own, the joint's where it is the only one, else that with what moves.

    That is ``_TX`` for a slide along x, ``_RZ`` for a hinge about z, ``_R`` for a ball; numbered where the axis has no letter.
    """
    dofs = view.joint.dofs
    dof = dofs[number]
    if dof.name or len(dofs) == 1:
        return dof.name or view.id.name
    move = "T" if dof.kind is DofKind.SLIDE else "R"
    where = "" if dof.kind in (DofKind.BALL, DofKind.FREE) else _LETTERS.get(dof.axis, dofs.index(dof) + 1)
    return f"{view.id.name}_{move}{where}"


def _warn_of_name(mechanism: Mechanism, joint: Id, wanted: str, name: str, report: Report) -> None:
    message = f"'{wanted}' would name two dofs; the one of {joint} is written as '{name}'"
    report.warn(codes.RENAMED, message, mechanism.origin(joint), element=str(joint))


def _legal_groups(dofs: tuple[Dof, ...]) -> list[tuple[Dof, ...]]:
    """The dofs in as few runs as possible that may each sit on one body."""
    if len(dofs) < 2:
        return [dofs] if dofs else []
    groups: list[tuple[Dof, ...]] = []
    run: tuple[Dof, ...] = ()
    for dof in dofs:
        too_many = sum(VELOCITIES[d.kind] for d in (*run, dof)) > _MOST_VELOCITIES
        below_ball = dof.kind in _TURNS and any(d.kind is DofKind.BALL for d in run)
        if run and (too_many or below_ball):
            groups.append(run)
            run = ()
        run = (*run, dof)
    return [*groups, run] if run else groups


def _with_dofs(mechanism: Mechanism, joint: Id, dofs: tuple[Dof, ...]) -> RobotEdge:
    return Edge(Joint(dofs), mechanism.graph.edges[joint].arcs)


def _with_edges(mechanism: Mechanism, edges: Mapping[Id, RobotEdge], moved: Mapping[tuple[Id, int], tuple[Id, str]]) -> Mechanism:
    """The mechanism with these edges, and with the arcs to dofs that move following them."""
    if not edges:
        return mechanism
    followed = edges_to_moved_dofs(mechanism, moved) if moved else {}
    return mechanism.replace(edges={**followed, **edges})


# ---- limits ------------------------------------------------------------------------------------------------------------


FAR = 1e10
"""Stands for "no bound" on the other side of a one-sided limit, in rad or m."""
_PLAY = 1e-9
"""The width of the interval that stands for a locked coordinate, in rad or m."""

Findings = list[tuple[bool, str]]
"""What was changed: whether it deserves a warning, and the words."""


def make_limits_intervals(mechanism: Mechanism, context: Context) -> Mechanism:
    """Every dof has either no position limits or lower < upper, and either no effort limit or a positive one."""
    edges: dict[Id, RobotEdge] = {}
    for view in mechanism.joints.values():
        findings: Findings = []
        dofs = tuple(legal_dof(dof, findings) for dof in view.joint.dofs)
        for serious, words in findings:
            tell = context.report.warn if serious else context.report.note
            tell(codes.REWRITTEN, f"{view.id}: {words}", mechanism.origin(view.id), element=str(view.id))
        if dofs != view.joint.dofs:
            edges[view.id] = Edge(Joint(dofs), mechanism.graph.edges[view.id].arcs)
    return mechanism.replace(edges=edges)


def legal_dof(dof: Dof, findings: Findings) -> Dof:
    """The dof with position limits that are an interval or none, and an effort limit that is positive or none."""
    lower, upper = _interval(dof, findings)
    old, effort = dof.limits, _effort(dof.limits, findings)
    if (lower, upper, effort) == (old.lower, old.upper, old.effort):
        return dof
    return replace(dof, limits=replace(old, lower=lower, upper=upper, effort=effort))


def _interval(dof: Dof, findings: Findings) -> tuple[float | None, float | None]:
    if dof.kind not in (DofKind.FREE, DofKind.BALL):
        return interval(dof.limits, findings)
    lower, upper = _finite(dof.limits.lower), _finite(dof.limits.upper)
    if dof.kind is DofKind.BALL:
        return None if lower else lower, upper  # the angle from straight, whose lower bound is 0 in MJCF
    if lower is not None or upper is not None:
        findings.append((True, "position limits on a free joint have no meaning; they are left out"))
    return None, None


def interval(limits: Limits, findings: Findings) -> tuple[float | None, float | None]:
    """The bounds of one coordinate with lower < upper, or none."""
    lower, upper = _finite(limits.lower), _finite(limits.upper)
    if lower is None and upper is None:
        return None, None
    if lower is None or upper is None:
        side = "lower" if lower is None else "upper"
        findings.append((False, f"has no {side} limit; {FAR:g} stands for the missing bound"))
        return _below(upper) if lower is None else lower, _above(lower) if upper is None else upper
    if lower > upper:
        findings.append((True, f"lower limit {lower!r} is above upper limit {upper!r}; it is written without position limits"))
        return None, None
    if lower == upper == 0.0:
        findings.append((True, "both limits are 0, as where URDF leaves them out; it is written without position limits"))
        return None, None
    if lower == upper:
        findings.append((False, f"both limits are {lower!r}; {_PLAY:g} of play stands for a locked joint"))
        return lower, max(lower + _PLAY, math.nextafter(lower, math.inf))
    return lower, upper


def _effort(limits: Limits, findings: Findings) -> float | None:
    effort = _finite(limits.effort)
    if effort is None:
        return None
    if effort == 0.0:
        findings.append((False, "effort limit 0 cannot be told from no limit; it is left out"))
        return None
    if effort < 0.0:
        findings.append((True, f"effort limit {effort!r} is negative; {-effort!r} is written"))
    return abs(effort)


def _below(upper: float | None) -> float:
    return -FAR if upper is None else min(-FAR, math.nextafter(upper, -math.inf))


def _above(lower: float | None) -> float:
    return FAR if lower is None else max(FAR, math.nextafter(lower, math.inf))


def _finite(value: float | None) -> float | None:
    """The bound, or None where it means none: infinite, or beyond what stands for no bound."""
    return value if value is not None and abs(value) <= 2.0 * FAR else None
