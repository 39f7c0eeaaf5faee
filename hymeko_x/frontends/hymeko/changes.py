"""Changes of elements that an imported robot has: ``arm.link7 { mass 0.5 }``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.hymeko import DOF_WORDS, LIMIT_WORDS, PARTS, SHAPE_WORDS, TARGETS, TURNING
from hymeko_x.frontends.hymeko.block import Block
from hymeko_x.frontends.hymeko.bodies import add_shapes, change_inertial
from hymeko_x.frontends.hymeko.joints import axis_of
from hymeko_x.ir import parts
from hymeko_x.ir.ids import KINDS
from hymeko_x.language.syntax import Ref

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.frontends.hymeko.builder import HymekoBuilder
    from hymeko_x.ir.mechanism import Extra, Id
    from hymeko_x.language.expansion import Amendment
    from hymeko_x.language.syntax import Field, Item

_EDGES = tuple(name for name in KINDS.values() if name in TARGETS or name == "joint")
_VERTICES = tuple(kind for kind in KINDS.values() if kind not in (*_EDGES, "world", "shape"))


def change_element(builder: HymekoBuilder, change: Amendment) -> None:
    """Give an element the fields in the block of a change; what the block does not name stays.

    Raises: Refusal (HX040) when there is no such element, HX062 for fields that it cannot have.
    """
    key = _target(builder, change)
    block = Block(change.node.items, builder.reader, open=key.kind in PARTS and PARTS[key.kind].open)
    if key in builder.vertices:
        builder.vertices[key] = _changed(builder, key, builder.vertices[key], block, change)
    else:
        edge = builder.edges[key]
        builder.edges[key] = replace(edge, data=_changed(builder, key, edge.data, block, change))
    left: list[Item] = [*block.fields.values(), *block.nodes, *block.arcs]
    if left:
        name = getattr(left[0], "name", "") or getattr(left[0], "role", "") or "an arc"
        hint = "a change gives fields another value; arcs and poses stay as they are in the imported robot"
        raise builder.reader.refuse(left[0], f"'{name}' of {key} cannot be changed here", hint=hint)
    _change_extras(builder, key, block.extras)


def _target(builder: HymekoBuilder, change: Amendment) -> Id:
    kinds = tuple(kind.ref.dotted for kind in change.node.stereotypes) or (
        (*_EDGES, "shape") if change.node.edge else (*_VERTICES, "shape")
    )
    known = {"link": "body", **{kind: kind for kind in KINDS.values()}}
    unknown = next((kind for kind in kinds if kind not in known), None)
    if unknown is not None:
        hint = f"kinds: {', '.join(known)}"
        raise builder.reader.refuse(change.node, f"a change may name the kind of its element, and '{unknown}' is none", hint=hint)
    ref = Ref(change.path)
    found = builder.find(ref, change.scope, tuple(known[kind] for kind in kinds))
    if found is None or (found not in builder.vertices and found not in builder.edges):
        hint = builder.near(change.path[-1], ())
        message = f"'{ref.dotted}' is changed, and there is no such element"
        raise refuse(codes.UNDEFINED_REFERENCE, message, builder.reader.origin(change.node), hint=hint)
    return found


def _changed(builder: HymekoBuilder, key: Id, part: Any, block: Block, change: Amendment) -> Any:
    """The part with the fields of the block."""
    if isinstance(part, parts.Body):
        add_shapes(builder, key, block, change.node.items, change.scope)
        return change_inertial(part, block)
    if isinstance(part, parts.Joint):
        return _changed_joint(builder, key, part, block, change)
    if isinstance(part, parts.Shape):
        return replace(part, **block.take_words(SHAPE_WORDS))
    words = PARTS[key.kind]
    values = block.take_words(words.words)
    if words.open:
        given = block.take_rest(builder.reader.parameter)
        names = [name for name, _ in given]
        kept = [pair for pair in part.parameters if pair[0] not in names]
        values["parameters"] = (*kept, *given)
    return replace(part, **values)


def _changed_joint(builder: HymekoBuilder, key: Id, joint: parts.Joint, block: Block, change: Amendment) -> parts.Joint:
    if len(joint.dofs) != 1:
        message = f"{key} has {len(joint.dofs)} dofs; only the fields of a joint with one dof can be changed"
        raise builder.reader.refuse(change.node, message)
    dof = joint.dofs[0]
    motion = "angle" if dof.kind in TURNING else "length"
    values: dict[str, Any] = block.take_words(DOF_WORDS, motion)
    limits = block.take_words(LIMIT_WORDS, motion)
    span: Field | None = block.take("limit", "limits", "range")
    if span is not None:
        limits["lower"], limits["upper"] = block.reader.numbers(span.value, motion, span, 2)
    axis = axis_of(builder, block, change.scope)
    if axis is not None:
        values["axis"], values["written"] = axis
    return parts.Joint((replace(dof, limits=replace(dof.limits, **limits), **values),))


def _change_extras(builder: HymekoBuilder, key: Id, extras: Iterable[Extra]) -> None:
    """Add what is for one format alone; an attribute takes the place of the one that was there."""
    for extra in extras:
        there = builder.extras.get(key, [])
        kept = [old for old in there if "@" not in old.path or (old.format, old.path) != (extra.format, extra.path)]
        builder.extras[key] = [*kept, extra]
