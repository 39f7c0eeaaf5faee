"""Joints and their dofs from HyMeKo text."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats import hymeko as words
from hymeko_x.formats.hymeko.references import child_names
from hymeko_x.frontends.hymeko.block import Block
from hymeko_x.frontends.hymeko.builder import sign_of
from hymeko_x.frontends.hymeko.lumped import take_compliant, with_compliance
from hymeko_x.frontends.hymeko.sharing import FOLLOWS, follow
from hymeko_x.ir import parts
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.mechanism import coupling_edge, joint_edge
from hymeko_x.ir.values import IDENTITY, ZERO, Pose, Vec3, Written, rotate, scaled, unit
from hymeko_x.language.syntax import ArcItem, Field, Node, QuotedName, Ref

if TYPE_CHECKING:
    from hymeko_x.frontends.hymeko.builder import HymekoBuilder
    from hymeko_x.frontends.hymeko.values import ValueReader
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.language.expansion import ExpandedElement, Scope
    from hymeko_x.language.syntax import Item

_BODIES = ("body", "world")
_CHILD_ROLES = ("", "child", "at")
_MOVES_OF = {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide", "spherical": "ball", "floating": "free"}
_NESTED = {"safety": (words.SAFETY_WORDS, "a safety controller"), "calibration": (words.CALIBRATION_WORDS, "a calibration")}

T = TypeVar("T")
_Axis = tuple[Vec3, Written | None]
"""A unit vector, and the vector as written where that is another one."""


def read_joint(builder: HymekoBuilder, key: Id, element: ExpandedElement, moves: str | None) -> None:
    """A joint: its ends, its dofs, and the coupling that `mimic` adds. ``moves`` is the preset of its type, if there is one.

    Raises: Refusal (HX045) for a joint without its ends, HX062 for values, HX040 for references.
    """
    block = Block(element.node.items, builder.reader)
    scope = element.scope
    block.take("kind"), block.take("moves")
    typed = _type_of(block)
    mimic, shared = _take_all(block, "mimic"), _take_all(block, FOLLOWS)
    axis_arc = _take_axis_arc(builder, block, scope)
    if (child_name := _implied_child(builder, key, block)) is not None:
        block.arcs.append(ArcItem(Ref(("body", child_name), "-"), line=element.node.line, column=element.node.column))
    compliant = take_compliant(builder, block, scope)
    parent, child = _ends(builder, key, block, element.node)
    pose, child_pose = _poses(builder.reader, parent, child, key)
    pose = _origin(block, pose)
    child_pose = builder.in_root(child.ref, scope, child_pose)
    target = builder.target(child.ref, scope, _BODIES, child)
    dofs = _dofs(builder, block, scope, words.ROLE_MOVES.get(child.role.upper()) or typed or moves, axis_arc)
    dofs = with_compliance(builder, key, compliant, dofs)
    for leader in shared:
        dofs = follow(builder, key, leader, dofs, scope)
    builder.edges[key] = joint_edge(parts.Joint(dofs), builder.target(parent.ref, scope, _BODIES, parent), target, pose, child_pose)
    if mimic:
        targets = [builder.target(arc.ref, scope, words.TARGETS["coupling"], arc) for arc in mimic]
        coefficients = [(0.0, 1.0) if arc.weight is None else builder.reader.numbers(arc.weight, "", arc) for arc in mimic]
        leaders = tuple(zip(targets, coefficients, strict=True))
        builder.edges[builder.reserve("coupling", key.name, element.node)] = coupling_edge(key, leaders)
    block.rest(str(key))
    builder.keep(key, block)


def _type_of(block: Block) -> str | None:
    """How a joint moves by its field ``type "revolute"``, as published meta-models have it."""
    item = block.fields.get("type")
    moves = (
        _MOVES_OF.get(item.value, "none" if item.value == "fixed" else None) if item is not None and isinstance(item.value, str) else None
    )
    if moves is not None:
        block.take("type")
    return moves


def _implied_child(builder: HymekoBuilder, key: Id, block: Block) -> str | None:
    """The body that a joint leads to by its own name; None where it names its child, or there is no such body."""
    if any(sign_of(arc) < 0 and arc.role not in ("mimic", "axis") for arc in block.arcs):
        return None
    return next((name for name in child_names(key.name) if "body" in builder.kinds.get(name, ())), None)


def _take_all(block: Block, role: str) -> list[ArcItem]:
    found = [arc for arc in block.arcs if arc.role == role]
    block.arcs = [arc for arc in block.arcs if arc.role != role]
    return found


def _ends(builder: HymekoBuilder, key: Id, block: Block, item: Item) -> tuple[ArcItem, ArcItem]:
    """The arc of the parent and the arc of the child, taken out of the block."""
    parents = [arc for arc in block.arcs if sign_of(arc) > 0 and arc.role in ("", "parent")]
    children = [arc for arc in block.arcs if sign_of(arc) < 0 and (arc.role in _CHILD_ROLES or arc.role.upper() in words.ROLE_MOVES)]
    if not parents and len(children) == 2 and all(arc.ref.direction == "->" for arc in children):
        parents = [children.pop(0)]  # as published: the first of two heads is the parent
    if len(parents) != 1 or len(children) != 1:
        message = (
            f"{key} has {len(parents)} parents and {len(children)} children; a joint joins one '+ parent' and one '- child' or several"
        )
        hint = _end_hint(block) if len(parents) < 2 else "a second parent closes a loop: @name : connect, weld or loop { ~ one ~ other }"
        raise refuse(codes.MISSING_PART, message, builder.reader.origin(item), element=str(key), hint=hint)
    for arc in (*parents, *children):
        block.arcs.remove(arc)
    return parents[0], children[0]


def _end_hint(block: Block) -> str:
    """A hint for the author of a joint without its ends."""
    for arc in block.arcs:
        if arc.role and sign_of(arc):
            text = f"{arc.role} {arc.ref.direction} {arc.ref.dotted}"
            return f"'{text}' is an arc of the role '{arc.role}'; a comma separates a flag from an arc: {text.replace(' ', ', ', 1)}"
    return "@joint { + base - tip } joins the bodies base and tip"


def _origin(block: Block, pose: Pose) -> Pose:
    """The joint frame by the fields ``origin [x y z]`` and ``rpy [roll pitch yaw]``, where the text has them."""
    origin, rpy = block.take("origin"), block.take("rpy")
    item = rpy or origin
    if item is None:
        return pose
    xyz = ZERO if origin is None else origin.value
    return block.reader.pose(xyz if rpy is None else (xyz, rpy.value), item)  # type: ignore[arg-type]


def _poses(reader: ValueReader, parent: ArcItem, child: ArcItem, key: Id) -> tuple[Pose, Pose]:
    """The joint frame in the parent, and in the child.

    A weight on the parent's arc is the joint frame in the parent; so is one on the child's arc, as other published
    examples write it. The joint frame in the child is the weight of a child's arc of role ``at``.
    """
    framed = child.role == "at"
    weighted = [arc for arc in (parent, child) if arc.weight is not None and not (framed and arc is child)]
    if len(weighted) == 2:
        hint = "write the joint frame in the child as [pose] at - child"
        raise reader.refuse(weighted[1], f"{key} has a pose on both arcs; it is not clear which of them is meant", hint=hint)
    pose = reader.pose(weighted[0].weight, weighted[0]) if weighted else IDENTITY
    child_pose = reader.pose(child.weight, child) if framed and child.weight is not None else IDENTITY
    return pose, child_pose


def _dofs(builder: HymekoBuilder, block: Block, scope: Scope, moves: str | None, axis: _Axis | None) -> tuple[parts.Dof, ...]:
    """The dofs in order: from `dof` blocks, or the single one that the joint's type and fields describe."""
    dofs = read_dofs(builder, block, scope)
    if dofs or moves == "several":
        return dofs
    return tuple(_dof(builder, block, scope, kind, axis) for kind in words.MOVES[moves or "hinge"])


def read_dofs(builder: HymekoBuilder, block: Block, scope: Scope) -> tuple[parts.Dof, ...]:
    """The dofs of the blocks in a block, in order: ``dof { moves=slide }``, ``dof : slide {}``, with a name ``lift : slide {}``."""
    nodes = [node for node in block.nodes if _is_dof(node)]
    block.nodes = [node for node in block.nodes if not _is_dof(node)]
    return tuple(_dof_block(builder, node, scope) for node in nodes)


def _is_dof(node: Node) -> bool:
    if node.edge:
        return False
    if node.name == "dof" and not isinstance(node.name, QuotedName):
        return True
    return bool(node.stereotypes) or any(isinstance(item, Field) and item.name == "moves" for item in node.items)


def _dof_block(builder: HymekoBuilder, node: Node, scope: Scope) -> parts.Dof:
    block = Block(node.items, builder.reader)
    block.take("kind")
    typed = node.stereotypes[0].ref.dotted if node.stereotypes else "hinge"
    moves = block.take_text("moves") or _MOVES_OF.get(typed, typed)
    if moves not in words.MOVES or not words.MOVES[moves]:
        raise builder.reader.refuse(node, f"a dof moves as {', '.join(name for name in words.MOVES if name != 'none')}, not as '{moves}'")
    dof = _dof(builder, block, scope, words.MOVES[moves][0], None)
    block.rest("a dof")
    named = node.name != "dof" or isinstance(node.name, QuotedName)
    return replace(dof, name=str(node.name)) if named else dof


def _dof(builder: HymekoBuilder, block: Block, scope: Scope, kind: parts.DofKind, axis: _Axis | None) -> parts.Dof:
    motion = "angle" if kind in words.TURNING else "length"
    direction, written = axis or axis_of(builder, block, scope) or (words.default_axis(kind), None)
    limits = read_limits(block, motion)
    safety, calibration = _nested(block, "safety", parts.Safety, motion), _nested(block, "calibration", parts.Calibration, motion)
    fields: dict[str, Any] = block.take_words(words.DOF_WORDS, motion)
    return parts.Dof(kind, direction, limits, safety=safety, calibration=calibration, written=written, **fields)


def read_limits(block: Block, motion: str) -> parts.Limits:
    """``limit [lower upper]`` and the other bounds; ``motion`` is the dimension of the coordinate."""
    span, group = block.take("limit", "limits", "range"), block.take_node("limit")
    found: dict[str, Any] = block.take_words(words.LIMIT_WORDS, motion)
    if group is not None:
        inner = Block(group.items, block.reader)
        found = {**inner.take_words(words.LIMIT_WORDS, motion), **found}
        inner.rest("a limit")
    if span is not None:
        found["lower"], found["upper"] = block.reader.numbers(span.value, motion, span, 2)
    return parts.Limits(**found) if found else parts.UNLIMITED


def _nested(block: Block, name: str, kind: type[T], motion: str) -> T | None:
    """The safety controller or the calibration of a dof, from the block of this name."""
    node = block.take_node(name)
    if node is None:
        return None
    known, title = _NESTED[name]
    inner = Block(node.items, block.reader)
    found = inner.take_words(known, motion)
    inner.rest(title)
    if name == "safety" and "k_velocity" not in found:
        raise block.reader.refuse(node, f"{title} needs 'k_velocity'")
    return kind(**found)


def axis_of(builder: HymekoBuilder, block: Block, scope: Scope) -> _Axis | None:
    """``axis [x y z]`` (normalised), ``axis=Y`` or ``axis=-Z``."""
    item = block.take("axis")
    if item is None:
        return None
    if isinstance(item.value, Ref):
        sign = -1.0 if item.value.direction == "-" else 1.0
        found = builder.directions.get(scope.resolve(item.value.path) or "") or words.AXES.get(item.value.path[-1])
        if found is None:
            raise builder.reader.refuse(item, f"'{item.value.dotted}' is not a direction; there are {', '.join(words.AXES)} and [x y z]")
        return _signed(found, sign), None
    return unit_axis(builder, item)


def _signed(axis: Vec3, sign: float) -> Vec3:
    return axis if sign > 0 else (-axis[0] + 0.0, -axis[1] + 0.0, -axis[2] + 0.0)


def unit_axis(builder: HymekoBuilder, item: Field) -> _Axis:
    """The direction of the vector that a field holds, and the vector where it is no unit vector."""
    vector = builder.reader.vec3(item.value, "", item)
    try:
        axis = unit(vector)
    except ZeroDivisionError as error:
        raise builder.reader.refuse(item, "the axis [0 0 0] has no direction") from error
    return axis, None if axis == vector else Written("axis", vector)


def _take_axis_arc(builder: HymekoBuilder, block: Block, scope: Scope) -> _Axis | None:
    """An arc to a direction (``+ AXIS_Z``, ``axis -> AXIS_Z``), its weight the rotation that turns it, taken out of the block."""
    for arc in block.arcs:
        direction = _direction(builder, arc.ref, scope)
        if direction is None or (arc.role not in ("", "axis")):
            continue
        block.arcs.remove(arc)
        return scaled(_turned(builder, arc, direction), 1.0), None
    return None


def _turned(builder: HymekoBuilder, arc: ArcItem, direction: Vec3) -> Vec3:
    """A direction as the weight of its arc turns it. The position that is written with the rotation has no meaning there."""
    if arc.weight is None:
        return direction
    pose = builder.reader.pose(arc.weight, arc)
    if pose.xyz != ZERO:
        message = f"only the rotation of the weight turns the axis; the position {numbers_text(pose.xyz)} means nothing"
        builder.reader.report.warn(codes.BAD_VALUE, message, builder.reader.origin(arc))
    return rotate(pose.quat, direction)


def _direction(builder: HymekoBuilder, ref: Ref, scope: Scope) -> Vec3 | None:
    """The direction that a reference means: one defined in the text, or a standard one that no body takes the name of."""
    name = scope.resolve(ref.path) or ref.path[-1]
    if name in builder.directions:
        return builder.directions[name]
    if builder.find(ref, scope, _BODIES) is not None:
        return None
    return words.AXES.get(ref.path[-1])
