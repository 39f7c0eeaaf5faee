"""Joints of several bodies: the elements that one edge with several children stands for (:mod:`hymeko_x.formats.hymeko.sharing`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct, field

from hymeko_x.formats.hymeko import ROLE_MOVES
from hymeko_x.formats.hymeko.sharing import RATIO, follower_dof, follower_name
from hymeko_x.frontends.hymeko.block import is_written
from hymeko_x.frontends.hymeko.builder import sign_of
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import coupling_edge
from hymeko_x.language.markup import is_foreign
from hymeko_x.language.syntax import ArcItem, Comment, Field, Node, Ref, is_field

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from hymeko_x.frontends.hymeko.builder import HymekoBuilder
    from hymeko_x.frontends.hymeko.values import ValueReader
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.language.expansion import Expanded, ExpandedElement, Scope
    from hymeko_x.language.syntax import Item

FOLLOWS = "<follows>"
"""The role of the arc from a joint to the one that it follows; no text has it."""
_ROLES = frozenset({"", "parent", "child", "at"})
_LEFT_OUT = frozenset({"class", "extra", "written", "unnamed"})
_KINDS = frozenset({parts.DofKind.HINGE, parts.DofKind.SLIDE, parts.DofKind.SCREW})


class _Ends(Struct):
    """The arcs of an edge to its parents and children, and to springs and dampers."""

    parents: list[ArcItem] = field(default_factory=list)
    children: list[ArcItem] = field(default_factory=list)
    compliant: list[ArcItem] = field(default_factory=list)


def with_followers(
    expanded: Expanded, elements: Sequence[ExpandedElement], kinds: list[str], reader: ValueReader
) -> tuple[Expanded, list[str]]:
    """The text with a joint for every child of an edge, and the kinds of its elements; before, they are ``elements`` and ``kinds``.

    Raises: Refusal (HX062) for a block on the arc of a child that holds no ratio.
    """
    by_name: dict[str, set[str]] = {"world": {"body"}}
    for element, kind in zip(elements, kinds, strict=True):
        by_name.setdefault(element.name, set()).add(kind)
    split: dict[int, list[ExpandedElement]] = {}
    for element, kind in zip(elements, kinds, strict=True):
        if kind == "joint" and element.node.edge and len((ends := _ends(element, by_name)).children) > 1:
            split[id(element)] = _split(element, ends, reader)
    if not split:
        return expanded, kinds
    items = tuple(found for item in expanded.items for found in split.get(id(item), (item,)))
    counts = [len(split.get(id(element), (element,))) for element in elements]
    return expanded._replace(items=items), [kind for kind, count in zip(kinds, counts, strict=True) for _ in range(count)]


def _ends(element: ExpandedElement, by_name: Mapping[str, set[str]]) -> _Ends:
    """The arcs of an edge by what they lead to; of arrows alone (``-> base, -> tip``) the first one leads to the parent."""
    ends = _Ends()
    for arc in element.node.items:
        if not isinstance(arc, ArcItem) or not (arc.role in _ROLES or arc.role.upper() in ROLE_MOVES):
            continue
        kinds = {kind for name in element.scope.meanings(arc.ref.path) for kind in by_name.get(name, ())}
        if "body" in kinds:
            (ends.parents if sign_of(arc) > 0 or arc.role == "parent" else ends.children).append(arc)
        elif kinds & {"spring", "damper"}:
            ends.compliant.append(arc)
    if not ends.parents and ends.children and all(arc.ref.direction == "->" for arc in ends.children):
        ends.parents.append(ends.children.pop(0))
    return ends


def _split(element: ExpandedElement, ends: _Ends, reader: ValueReader) -> list[ExpandedElement]:
    """The joints of an edge: the one of its first child, and those that follow it."""
    node = element.node
    first, *others = ends.children
    beside = _comments_beside(node.items, others)
    if first.items:
        message = f"the first child of '{node.name}' moves by the joint's own coordinate; '{RATIO}' is for the others"
        raise reader.refuse(first, message, hint="the child that moves by 1 stands first")
    left_out = {id(item) for item in (*ends.parents, *ends.children, *(item for found in beside.values() for item in found))}
    own = [item for item in node.items if id(item) not in left_out]
    common = [item for item in own if id(item) not in map(id, ends.compliant) and not _is_of_first(item)]
    split = [element._replace(node=node._replace(items=(*own, *_joined(ends.parents, first))))]
    for number, arc in enumerate(others, 2):
        name = follower_name(node.name, number)
        leader = ArcItem(Ref((node.name,), "-"), FOLLOWS, (_ratio(arc, reader),), (), arc.line, arc.column)
        role = arc.role or (first.role if first.role.upper() in ROLE_MOVES else "")
        items = (*beside[id(arc)], *common, *_joined(ends.parents, arc._replace(items=(), role=role)), leader)
        element.scope.elements.add(name)
        follower = node._replace(name=name, items=items, line=arc.line, column=arc.column)
        split.append(element._replace(name=element.scope.full(name), node=follower))
    return split


def _comments_beside(items: Sequence[Item], children: Sequence[ArcItem]) -> dict[int, list[Item]]:
    """The comments right before each child's arc, or behind it in the same line, by the arc's id."""
    found: dict[int, list[Item]] = {id(arc): [] for arc in children}
    waiting: list[Item] = []
    last: Item | None = None
    for item in items:
        if not isinstance(item, Comment):
            found.get(id(item), []).extend(waiting)
            waiting, last = [], item
        elif last is None or last.line != item.line:
            waiting.append(item)
        else:
            found.get(id(last), []).append(item)
    return found


def _joined(parents: list[ArcItem], child: ArcItem) -> list[ArcItem]:
    """The arcs of one joint; a pose on the child's own arc stands for the one on the parent's."""
    if child.weight is None or child.role == "at":
        return [*parents, child]
    return [*(arc._replace(weight=None) for arc in parents), child]


def _is_of_first(item: Item) -> bool:
    """Whether an item is about the first joint alone: what it follows, its springs and classes, and what other formats have of it."""
    if isinstance(item, ArcItem):
        return item.role == "mimic"
    if isinstance(item, Node):
        return is_foreign(item) or is_written(item) or item.name in ("safety", "calibration")
    return not isinstance(item, Field) or is_field(item, _LEFT_OUT)


def _ratio(arc: ArcItem, reader: ValueReader) -> float:
    """The ratio in the block of a child's arc.

    Raises: Refusal (HX062) for anything else in it, and for 0.
    """
    ratio = 1.0
    for item in arc.items:
        if not is_field(item, (RATIO,)):
            hint = f"the fields of the joint stand in its own block, those of '{arc.ref.dotted}' in that body's"
            raise reader.refuse(item, f"the block of the arc to '{arc.ref.dotted}' holds a '{RATIO}' alone", hint=hint)
        ratio = reader.number(item.value, "", item)
        if not ratio:
            raise reader.refuse(item, f"a {RATIO} of 0 would not move '{arc.ref.dotted}'", hint="a fixed joint holds it")
    return ratio


def follow(builder: HymekoBuilder, key: Id, leader: ArcItem, dofs: tuple[parts.Dof, ...], scope: Scope) -> tuple[parts.Dof, ...]:
    """The dofs of a joint that follows another one; the coupling of the two is added.

    Raises: Refusal (HX062) for a joint whose motion is more than one number, and for a ratio where there is no motion.
    """
    ratio = builder.reader.numbers(leader.weight, "", leader, 1)[0]
    if not dofs and ratio != 1.0:
        message = f"'{leader.ref.dotted}' holds its children without motion, and a '{RATIO}' needs one"
        raise builder.reader.refuse(leader, message, hint="leave it out, or give the joint another type")
    if not dofs:
        return dofs
    if len(dofs) > 1 or dofs[0].kind not in _KINDS:
        message = f"'{leader.ref.dotted}' has several children, and they can share one angle or one length, not a motion of several numbers"
        raise builder.reader.refuse(leader, message, hint="give each child a joint of its own")
    target = builder.target(leader.ref, scope, ("joint",), leader)
    builder.edges[builder.reserve("coupling", key.name, leader)] = coupling_edge(key, ((target, (0.0, ratio)),))
    return (follower_dof(dofs[0], ratio),)
