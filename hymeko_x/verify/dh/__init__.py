"""Denavit-Hartenberg tables of any chain of hinges and slides: standard, modified (Craig) and Hayati-Roberts.

A chain is T(q) = J_0 L_0 J_1 L_1 ... J_n L_n J_n+1 with J_i = Rz(theta_i) Tz(d_i) about axis i and L_i = Tx(a_i) Rx(alpha_i)
from axis i to axis i+1; axis 0 is the z axis of the base's frame, axis n+1 that of the tip's. A coordinate adds to theta_i of
a hinge or to d_i of a slide. Standard rows are (J_i, L_i), Craig's are (L_i-1, J_i): the same numbers, another grouping.

Between axes that are parallel to within a few degrees the common normal may be anywhere, and a and d grow without bound.
There a link is Hayati and Roberts's Tx(a) Rx(alpha) Ry(beta), which is smooth through exact parallelism; in their own
convention such a link has no d either, because it starts where the last one ended.
Every table is exact: J_0 and J_n+1 take up whatever the rows cannot represent.

Source: Denavit and Hartenberg 1955; Craig, Introduction to Robotics, 3.4; Hayati and Mirmirani 1985; Roberts 1988.
"""

from __future__ import annotations

import itertools
import math
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.verify.dh.lines import AxisLine, DhFrame, DhLink, link_between, motion
from hymeko_x.verify.dh.sheet import settled, turn_of_base
from hymeko_x.verify.kinematics import draw, prepare
from hymeko_x.verify.model import WORLD, Array, Kind, KinematicModel
from hymeko_x.verify.spatial import rigid, rotation_about

if TYPE_CHECKING:
    from collections.abc import Sequence


class Convention(Enum):
    """How a table groups its numbers."""

    STANDARD = "standard"
    MODIFIED = "modified"
    HAYATI = "hayati"


class DhRow(Struct, frozen=True):
    """One joint: theta in rad and d in m, to which its coordinate adds (theta of a hinge, d of a slide), and its link.

    The link is that behind the joint in the standard convention and before it in the modified one; ``beta`` in rad is not
    zero only where the two axes are nearly parallel.
    """

    joint: str
    kind: Kind
    theta: float
    d: float
    a: float
    alpha: float
    beta: float = 0.0


class Table(Struct, frozen=True, eq=False):
    """The rows of a chain between two constants: T(q) = ``base`` * rows(q) * ``tool``, the tip's pose in the base's frame.

    ``base_rows`` and ``tool_rows`` are these constants as rows of the convention, none for the identity. ``dofs`` are the
    indices of the rows' dofs in the model, ``ends`` the bodies at both ends, ``start`` and ``tip`` their names.
    """

    convention: Convention
    start: str
    tip: str
    rows: tuple[DhRow, ...]
    base: Array
    tool: Array
    dofs: tuple[int, ...]
    ends: tuple[int, int]
    base_rows: tuple[DhLink, ...] = ()
    tool_rows: tuple[DhLink, ...] = ()

    def poses(self, q: Array) -> Array:
        """Poses (n, 4, 4) of the tip at coordinates (n, rows)."""
        out = np.broadcast_to(self.base, (len(q), 4, 4)).copy()
        for row, values in zip(self.rows, q.T, strict=True):
            link = motion(row.a, row.alpha, row.beta)
            joint = _joint_motions(row, values)
            out = out @ (link @ joint if self.convention is Convention.MODIFIED else joint @ link)
        return out @ self.tool


def table(
    model: KinematicModel, tip: str | int | None = None, convention: Convention = Convention.STANDARD, *, as_data_sheet: bool = False
) -> Table:
    """The table of the chain from the base to a body by name or index (to the end of the longest chain by default).

    ``as_data_sheet``: normals point so that theta has no offset wherever that is possible, as :mod:`hymeko_x.verify.dh.sheet` says;
    else so that a > 0.

    Where a ball or a free joint is on the way to the tip, the chain starts at the child of the last one of them.
    Raises: Refusal HX303 when there is no such body or no joint on the way to it moves.
    """
    body = _tip(model, tip)
    start, dofs = chain(model, body)
    if not dofs:
        raise refuse(codes.NO_CHAIN, f"nothing moves between {model.body_label(start)} and {model.body_label(body)}")
    lines, frames = lines_of(model, start, body, dofs, zero_poses(model))
    links, last = _through(lines, frames[0], frames[1], keep=convention is Convention.HAYATI)
    turn = 0.0
    if as_data_sheet:
        slides = convention is not Convention.STANDARD or model.dofs[dofs[-1]].kind is Kind.SLIDE
        links, last = settled(links, last, sliding_end=slides)
        turn = turn_of_base((links, last))
    return _grouped(model, convention, (start, body), dofs, links, last, turn)


def chains(model: KinematicModel) -> tuple[int, ...]:
    """The tips: moving bodies without a moving descendant; the deepest of a fixed group."""
    moving = [bool(body.joint.dofs) for body in model.bodies]
    below = [False] * len(model.bodies)
    for i in range(len(model.bodies) - 1, 0, -1):
        parent = model.bodies[i].parent
        below[parent] = below[parent] or moving[i] or below[i]
    return tuple(i for i in range(1, len(model.bodies)) if moving[i] and not below[i])


def chain(model: KinematicModel, body: int) -> tuple[int, list[int]]:
    """The body where a chain of scalar dofs to ``body`` starts, and those dofs from the base on."""
    dofs: list[int] = []
    while body != WORLD:
        joint = model.bodies[body].joint
        if any(not dof.kind.scalar for dof in joint.dofs) or joint.open:
            return body, dofs
        first = model.first_dof[body]
        dofs[:0] = range(first, first + len(joint.dofs))
        body = model.bodies[body].parent
    return body, dofs


def zero_poses(model: KinematicModel, coordinates: Array | None = None) -> Array:
    """World poses (bodies, 4, 4) with every coordinate at 0 (or at ``coordinates``), wherever a format's references are."""
    rest = np.zeros(model.width) if coordinates is None else coordinates.copy()
    for dof, column in zip(model.dofs, model.columns, strict=True):
        if not dof.kind.scalar:
            rest[column : column + dof.kind.width] = 0.0
            rest[column + dof.kind.width - 4] = 1.0
    poses: Array = prepare(model).poses(rest[None])[0]
    return poses


def lines_of(
    model: KinematicModel, start: int, body: int, dofs: Sequence[int], poses: Array, coordinates: Array | None = None
) -> tuple[list[AxisLine], tuple[DhFrame, DhFrame]]:
    """The dofs' axes and the frames of the chain's two ends, in the frame of ``start``, in these world poses (of :func:`zero_poses`)."""
    back = np.linalg.inv(poses[start])
    rest = np.zeros(model.width) if coordinates is None else coordinates
    lines = [_line(model, dof, back @ poses[model.bodies[model.body_of_dof[dof]].parent], rest) for dof in dofs]
    return lines, (DhFrame.of(np.eye(4)), DhFrame.of(back @ poses[body]))


def _line(model: KinematicModel, index: int, parent: Array, rest: Array) -> AxisLine:
    """The axis of one dof: through its anchor, behind the dofs of the same joint that come before it, at these coordinates."""
    body = model.body_of_dof[index]
    joint = model.bodies[body].joint
    place = parent @ joint.placement
    first = model.first_dof[body]
    for dof, column in zip(joint.dofs[: index - first], model.columns[first:index], strict=True):
        place = place @ _displaced(dof.kind, dof.axis, dof.anchor, float(rest[column]) - dof.ref, dof.pitch)
    dof = model.dofs[index]
    point, axis = place[:3, :3] @ dof.anchor + place[:3, 3], place[:3, :3] @ dof.axis
    (px, py, pz), (x, y, z) = point.tolist(), axis.tolist()
    return AxisLine((px, py, pz), (x, y, z), sliding=dof.kind is Kind.SLIDE)


def _displaced(kind: Kind, axis: Array, anchor: Array, by: float, pitch: float) -> Array:
    if kind is Kind.SLIDE:
        return rigid(np.eye(3), by * axis)
    turn = rotation_about(axis, np.asarray(by))
    return rigid(turn, anchor - turn @ anchor + pitch * by * axis)


def _tip(model: KinematicModel, tip: str | int | None) -> int:
    if isinstance(tip, int):
        return tip
    if tip is None:
        ends = chains(model)
        if not ends:
            raise refuse(codes.NO_CHAIN, f"nothing moves in '{model.name}'")
        return max(ends, key=lambda end: len(chain(model, end)[1]))
    if tip not in model.index:
        known = ", ".join(str(model.bodies[i].name) for i in chains(model)[:10])
        raise refuse(codes.NO_CHAIN, f"there is no body '{tip}'", hint=f"chains end at: {known}")
    return model.index[tip]


# ---- from lines to rows ----------------------------------------------------------------------------------------------


def _through(lines: Sequence[AxisLine], base: DhFrame, tip: DhFrame, *, keep: bool) -> tuple[list[DhLink], tuple[float, float]]:
    """The links L_0 ... L_n with the J_i in front of them, and the last J (theta, d)."""
    frame = base
    links: list[DhLink] = []
    ends = [AxisLine(base.o, base.z), *lines, AxisLine(tip.o, tip.z)]
    for line, following in itertools.pairwise(ends):
        link, frame = link_between(frame, line, following, keep=keep)
        links.append(link)
    return links, (frame.turn_to(tip.x), frame.height_of(tip.o))


def _grouped(
    model: KinematicModel,
    convention: Convention,
    ends: tuple[int, int],
    dofs: Sequence[int],
    links: Sequence[DhLink],
    last: tuple[float, float],
    turn: float = 0.0,
) -> Table:
    """The same numbers grouped by the convention; the base takes this turn from the first theta, and then all of the first link."""
    first, end = links[0], links[-1]
    turned = DhLink(turn, 0.0, 0.0, 0.0)
    if turn:
        links = [DhLink(0.0, 0.0, 0.0, 0.0), replace(links[1], theta=0.0), *links[2:]]
    if convention is Convention.MODIFIED:
        shapes = links[:-1]
        before = [replace(first, a=0.0, alpha=0.0, beta=0.0), *([replace(first, theta=turn, d=0.0)] if turn else ())]
        behind = [replace(end, theta=last[0], d=last[1])]
    else:
        shapes = links[1:]
        before, behind = [first, turned], [DhLink(*last, 0.0, 0.0)]
    base, tool = (_product(rows, convention) for rows in (before, behind))
    rows = tuple(
        DhRow(_name(model, dof), model.dofs[dof].kind, joint.theta, joint.d, shape.a, shape.alpha, shape.beta)
        for dof, joint, shape in zip(dofs, links[1:], shapes, strict=True)
    )
    names = [model.bodies[end].name or f"body {end}" for end in ends]
    base_rows, tool_rows = (tuple(row for row in constant if row != DhLink(0.0, 0.0, 0.0, 0.0)) for constant in (before, behind))
    return Table(convention, names[0], names[1], rows, base, tool, tuple(dofs), ends, base_rows, tool_rows)


def _product(rows: Sequence[DhLink], convention: Convention) -> Array:
    """The transformation of rows without a coordinate."""
    out = np.eye(4)
    for row in rows:
        joint, link = _joint_matrix(row.theta, row.d), row.matrix()
        out = out @ (link @ joint if convention is Convention.MODIFIED else joint @ link)
    return out


def _name(model: KinematicModel, dof: int) -> str:
    body = model.bodies[model.body_of_dof[dof]]
    return model.dofs[dof].name or body.joint.name or f"above {body.name}"


def _joint_matrix(theta: float, d: float) -> Array:
    c, s = math.cos(theta), math.sin(theta)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, d], [0, 0, 0, 1]])


def _joint_motions(row: DhRow, values: Array) -> Array:
    """J of one row at coordinates (n,), as (n, 4, 4)."""
    sliding = row.kind is Kind.SLIDE
    theta = np.full(len(values), row.theta) if sliding else row.theta + values
    out = np.zeros((len(values), 4, 4))
    out[:, 0, 0] = out[:, 1, 1] = np.cos(theta)
    out[:, 1, 0] = np.sin(theta)
    out[:, 0, 1] = -out[:, 1, 0]
    out[:, 2, 2] = out[:, 3, 3] = 1.0
    out[:, 2, 3] = row.d + values if sliding else row.d
    return out


# ---- proof -----------------------------------------------------------------------------------------------------------


def error_against_pinocchio(model: KinematicModel, found: Table, samples: int = 100, seed: int = 0) -> float:
    """The largest entry in which the table's pose of the tip differs from Pinocchio's at random configurations."""
    from hymeko_x.verify.pinocchio import build

    start, tip = found.ends
    root = tip
    while model.bodies[root].parent != WORLD:
        root = model.bodies[root].parent
    native = build(model, root)
    q = draw(model, samples, np.random.default_rng(seed))
    poses = native.poses(q)
    order = list(native.frames)
    ends = poses[:, order.index(tip)]
    starts = poses[:, order.index(start)] if start != WORLD else np.broadcast_to(np.eye(4), ends.shape)
    coordinates = q[:, [model.columns[dof] for dof in found.dofs]]
    return float(np.abs(np.linalg.inv(starts) @ ends - found.poses(coordinates)).max())
