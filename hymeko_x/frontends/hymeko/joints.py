"""Joints and their dofs from HyMeKo text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.hymeko import AXES, CALIBRATION_WORDS, DOF_WORDS, LIMIT_WORDS, MOVES, ROLE_MOVES, SAFETY_WORDS, default_axis
from hymeko_x.frontends.hymeko.block import Block
from hymeko_x.frontends.hymeko.build import sign_of
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import coupling_edge, joint_edge
from hymeko_x.ir.values import IDENTITY, ZERO, Pose, Vec3, Written, numbers_text, rotate, scaled, unit
from hymeko_x.language.syntax import ArcItem, Field, Node, QuotedName, Ref

if TYPE_CHECKING:
    from hymeko_x.frontends.hymeko.build import Build
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.language.expansion import Element, Scope
    from hymeko_x.language.syntax import Item

_BODIES = ("body", "world")
_CHILD_ROLES = ("", "child", "at")
_MOVES_OF = {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide", "spherical": "ball", "floating": "free"}
_TURNING = frozenset({parts.DofKind.HINGE, parts.DofKind.BALL, parts.DofKind.SCREW})


def read_joint(build: Build, key: Id, element: Element, moves: str | None) -> None:
    """A joint: its ends, its dofs, and the coupling that `mimic` adds. ``moves`` is what its type says, if anything."""
    block = Block(element.node.items, build.context)
    scope = element.scope
    block.take("kind"), block.take("moves")
    mimic = _take_all(block, "mimic")
    axis_arc = _take_axis_arc(build, block, scope)
    if _has_own_child(build, key, block):
        block.arcs.append(ArcItem(Ref(("body", key.name), "-"), line=element.node.line, column=element.node.column))
    parent, child, told = _ends(build, key, block, scope, element.node)
    pose, child_pose = _poses(build, parent, child, key)
    target = build.target(child.ref, scope, _BODIES, child)
    dofs = _dofs(build, block, scope, told or moves, axis_arc, element.node)
    above = build.target(parent.ref, scope, _BODIES, parent)
    build.edges[key] = joint_edge(parts.Joint(dofs), above, target, pose, child_pose)
    if mimic:
        leaders = tuple((build.target(arc.ref, scope, ("joint", "tendon"), arc), _polynomial(build, arc)) for arc in mimic)
        build.edges[build.reserve("coupling", key.name, element.node)] = coupling_edge(key, leaders)
    block.rest(str(key))
    build.keep(key, block)


def _has_own_child(build: Build, key: Id, block: Block) -> bool:
    """Whether a joint names no child, and there is a body of its name."""
    return "body" in build.kinds.get(key.name, ()) and not any(sign_of(arc) < 0 and arc.role not in ("mimic", "axis") for arc in block.arcs)


def _take_all(block: Block, role: str) -> list[ArcItem]:
    found = [arc for arc in block.arcs if arc.role == role]
    block.arcs = [arc for arc in block.arcs if arc.role != role]
    return found


def _polynomial(build: Build, arc: ArcItem) -> tuple[float, ...]:
    return (0.0, 1.0) if arc.weight is None else build.context.numbers(arc.weight, "", arc)


# ---- ends ----------------------------------------------------------------------------------------------------------------


def _ends(build: Build, key: Id, block: Block, scope: Scope, item: Item) -> tuple[ArcItem, ArcItem, str | None]:
    """The parent's arc, the child's arc, and what the child's role tells about the joint's type."""
    parents = [arc for arc in block.arcs if sign_of(arc) > 0 and arc.role in ("", "parent")]
    children = [arc for arc in block.arcs if sign_of(arc) < 0 and (arc.role in _CHILD_ROLES or arc.role.upper() in ROLE_MOVES)]
    if len(parents) != 1 or len(children) != 1:
        message = f"{key} has {len(parents)} parents and {len(children)} children; a joint joins one '+ parent' and one '- child'"
        raise refuse(codes.MISSING_PART, message, build.context.origin(item), element=str(key), hint=_end_hint(block))
    for arc in (*parents, *children):
        block.arcs.remove(arc)
    child = children[0]
    return parents[0], child, ROLE_MOVES.get(child.role.upper())


def _end_hint(block: Block) -> str:
    """What a user may have meant who did not give a joint its ends."""
    for arc in block.arcs:
        if arc.role and sign_of(arc):
            text = f"{arc.role} {arc.ref.direction} {arc.ref.dotted}"
            return f"'{text}' is an arc of the role '{arc.role}'; a comma separates a flag from an arc: {text.replace(' ', ', ', 1)}"
    return "@joint { + base - tip } joins the bodies base and tip"


def _poses(build: Build, parent: ArcItem, child: ArcItem, key: Id) -> tuple[Pose, Pose]:
    """The joint frame in the parent, and in the child.

    A weight on the parent's arc is the joint frame in the parent; so is one on the child's arc, as other published
    examples write it. The joint frame in the child is the weight of a child's arc of role ``at``.
    """
    context = build.context
    framed = child.role == "at"
    weighted = [arc for arc in (parent, child) if arc.weight is not None and not (framed and arc is child)]
    if len(weighted) == 2:
        hint = "write the joint frame in the child as [pose] at - child"
        raise context.refuse(weighted[1], f"{key} has a pose on both arcs; it is not clear which of them is meant", hint=hint)
    pose = context.pose(weighted[0].weight, weighted[0]) if weighted else IDENTITY
    child_pose = context.pose(child.weight, child) if framed and child.weight is not None else IDENTITY
    return pose, child_pose


# ---- dofs ----------------------------------------------------------------------------------------------------------------


def _dofs(
    build: Build, block: Block, scope: Scope, moves: str | None, axis_arc: tuple[Vec3, Written | None] | None, item: Item
) -> tuple[parts.Dof, ...]:
    """The dofs in order: from `dof` blocks, or the single one that the joint's type and fields describe."""
    dofs = read_dofs(build, block, scope)
    if dofs or moves == "several":
        return dofs
    return tuple(_dof(build, block, scope, kind, axis_arc, item) for kind in MOVES[moves or "hinge"])


def read_dofs(build: Build, block: Block, scope: Scope) -> tuple[parts.Dof, ...]:
    """What the blocks of dofs say, in order: ``dof { moves=slide }``, ``dof : slide {}``, or with a name ``lift : slide {}``."""
    nodes = [node for node in block.nodes if _is_dof(node)]
    block.nodes = [node for node in block.nodes if not _is_dof(node)]
    return tuple(_dof_block(build, node, scope) for node in nodes)


def _is_dof(node: Node) -> bool:
    if node.name == "dof" and not isinstance(node.name, QuotedName):
        return True
    return bool(node.stereotypes) or any(isinstance(item, Field) and item.name == "moves" for item in node.items)


def _dof_block(build: Build, node: Node, scope: Scope) -> parts.Dof:
    block = Block(node.items, build.context)
    block.take("kind")
    typed = node.stereotypes[0].ref.dotted if node.stereotypes else "hinge"
    moves = block.take_text("moves") or _MOVES_OF.get(typed, typed)
    if moves not in MOVES or not MOVES[moves]:
        raise build.context.refuse(node, f"a dof moves as {', '.join(name for name in MOVES if name != 'none')}, not as '{moves}'")
    dof = _dof(build, block, scope, MOVES[moves][0], None, node)
    block.rest("a dof")
    named = node.name != "dof" or isinstance(node.name, QuotedName)
    return replace(dof, name=str(node.name)) if named else dof


def _dof(
    build: Build, block: Block, scope: Scope, kind: parts.DofKind, axis_arc: tuple[Vec3, Written | None] | None, item: Item
) -> parts.Dof:
    motion = "angle" if kind in _TURNING else "length"
    axis, written = axis_arc or _axis(build, block, scope) or (default_axis(kind), None)
    return parts.Dof(
        kind,
        axis,
        read_limits(block, motion),
        safety=_safety(block, motion, item),
        calibration=_calibration(block, motion),
        written=written,
        **block.take_words(DOF_WORDS, motion),  # type: ignore[arg-type]
    )


def read_limits(block: Block, motion: str) -> parts.Limits:
    """``limit [lower upper]`` and the other bounds; ``motion`` is the dimension of the coordinate."""
    context = block.context
    span = block.take("limit", "limits", "range")
    found = block.take_words(LIMIT_WORDS, motion)
    if span is not None:
        found["lower"], found["upper"] = context.numbers(span.value, motion, span, 2)
    return parts.Limits(**found) if found else parts.UNLIMITED  # type: ignore[arg-type]


def _safety(block: Block, motion: str, item: Item) -> parts.Safety | None:
    node = block.take_node("safety")
    if node is None:
        return None
    inner = Block(node.items, block.context)
    found = inner.take_words(SAFETY_WORDS, motion)
    inner.rest("a safety controller")
    if "k_velocity" not in found:
        raise block.context.refuse(node, "a safety controller needs 'k_velocity'")
    return parts.Safety(**found)  # type: ignore[arg-type]


def _calibration(block: Block, motion: str) -> parts.Calibration | None:
    node = block.take_node("calibration")
    if node is None:
        return None
    inner = Block(node.items, block.context)
    found = inner.take_words(CALIBRATION_WORDS, motion)
    inner.rest("a calibration")
    return parts.Calibration(**found)  # type: ignore[arg-type]


# ---- axes ----------------------------------------------------------------------------------------------------------------


def _axis(build: Build, block: Block, scope: Scope) -> tuple[Vec3, Written | None] | None:
    """``axis [x y z]`` (normalised, as written remembered), ``axis=Y`` or ``axis=-Z``."""
    item = block.take("axis")
    if item is None:
        return None
    if isinstance(item.value, Ref):
        sign = -1.0 if item.value.direction == "-" else 1.0
        found = build.directions.get(scope.resolve(item.value.path) or "") or AXES.get(item.value.path[-1])
        if found is None:
            raise build.context.refuse(item, f"'{item.value.dotted}' is not a direction; there are {', '.join(AXES)} and [x y z]")
        return _signed(found, sign), None
    return unit_axis(build, item)


def _signed(axis: Vec3, sign: float) -> Vec3:
    return axis if sign > 0 else (-axis[0] + 0.0, -axis[1] + 0.0, -axis[2] + 0.0)


def unit_axis(build: Build, item: Field) -> tuple[Vec3, Written | None]:
    """The direction of the vector that a field holds, and the vector where it is no unit vector."""
    vector = build.context.vec3(item.value, "", item)
    try:
        axis = unit(vector)
    except ZeroDivisionError as error:
        raise build.context.refuse(item, "the axis [0 0 0] has no direction") from error
    return axis, None if axis == vector else Written("axis", vector)


def _take_axis_arc(build: Build, block: Block, scope: Scope) -> tuple[Vec3, Written | None] | None:
    """An arc to a direction (``+ AXIS_Z``, ``axis -> AXIS_Z``), its weight the rotation that turns it, taken out of the block."""
    for arc in block.arcs:
        direction = _direction(build, arc.ref, scope)
        if direction is None or (arc.role not in ("", "axis")):
            continue
        block.arcs.remove(arc)
        sign = -1.0 if sign_of(arc) < 0 and arc.ref.direction == "-" else 1.0
        turned = _turned(build, arc, direction)
        return (_signed(turned, sign) if sign < 0 else scaled(turned, 1.0)), None
    return None


def _turned(build: Build, arc: ArcItem, direction: Vec3) -> Vec3:
    """A direction as the weight of its arc turns it. The position that is written with the rotation has no meaning there."""
    if arc.weight is None:
        return direction
    pose = build.context.pose(arc.weight, arc)
    if pose.xyz != ZERO:
        said = f"only the rotation of the weight turns the axis; the position {numbers_text(pose.xyz)} means nothing"
        build.context.report.warn(codes.BAD_VALUE, said, build.context.origin(arc))
    return rotate(pose.quat, direction)


def _direction(build: Build, ref: Ref, scope: Scope) -> Vec3 | None:
    """The direction that a reference means: one defined in the text, or a standard one that no body takes the name of."""
    name = scope.resolve(ref.path) or ref.path[-1]
    if name in build.directions:
        return build.directions[name]
    if build.find(ref, scope, _BODIES) is not None:
        return None
    return AXES.get(ref.path[-1])
