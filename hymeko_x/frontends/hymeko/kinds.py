"""The kinds of elements without a type: from the root, from their fields, and from their place in the edges."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats.hymeko import AXES
from hymeko_x.ir.ids import KINDS
from hymeko_x.language.prototypes import meaning_of, role_of
from hymeko_x.language.syntax import ArcItem, Comment, Field, Node, QuotedName, Value, is_field, is_list

if TYPE_CHECKING:
    from hymeko_x.language.expansion import Expanded, ExpandedElement

_EDGES = {"+": 1, "<-": 1, "-": -1, "->": -1}
_SPRING = frozenset({"spring_constant", "stiffness", "k"})
_DAMPER = frozenset({"damping_const", "damping", "c"})
_BODY_WORDS = frozenset({"mass", "com", "inertia", "visual", "collision", "geometry", "shape", "translation"})
_NO_ENDS = frozenset({"limit", "origin", "rpy", "axis", "mimic"})
"""Roles of a joint's arcs that lead to no body."""
_COMPLIANT = frozenset({"spring", "damper", "port"})
_ALL = frozenset(KINDS.values()) | {"axis"}


def infer_kinds(expanded: Expanded, elements: list[ExpandedElement]) -> list[str]:
    """The kind of every element, in order."""
    by_name: dict[str, list[int]] = {}
    for number, element in enumerate(elements):
        by_name.setdefault(element.name, []).append(number)
    kinds = [typed_kind(element) for element in elements]
    mode = next((name for name in expanded.types if name in ("robot", "graph")), "")
    if mode != "robot" and "body" not in kinds and any(map(_holds_joints, elements)):
        mode = "graph"
        kinds = ["" if kind == "joint" else kind for kind in kinds]
    if not mode and _is_bare_graph(elements, kinds, by_name):
        mode = "graph"
    if not mode:
        _infer_from_edges(elements, kinds, by_name)
    for number, element in enumerate(elements):
        if not kinds[number]:
            kinds[number] = _default(element, mode)
    return kinds


def _holds_joints(element: ExpandedElement) -> bool:
    """Whether joints stand inside of a vertex: the parts of a whole that is described as a graph, and no robot."""
    stack = [] if element.node.edge else [item for item in element.node.items if isinstance(item, Node)]
    while stack:
        node = stack.pop()
        if node.edge and any(meaning_of(kind.ref.path[-1]) for kind in node.stereotypes):
            return True
        stack.extend(item for item in node.items if isinstance(item, Node))
    return False


def _is_bare_graph(elements: list[ExpandedElement], kinds: list[str], by_name: dict[str, list[int]]) -> bool:
    """Whether there are names and arrows alone, and the arrows make no tree of bodies: two lead to one vertex, or one to each."""
    ends: list[int | None] = []
    for element, kind in zip(elements, kinds, strict=True):
        arcs = [item for item in element.node.items if isinstance(item, ArcItem)]
        plain = len(arcs) == len([item for item in element.node.items if not isinstance(item, Comment)])
        if kind or element.types or not plain or any(arc.role or arc.weight is not None or arc.items for arc in arcs):
            return False
        found = [_target(arc, element, by_name) for arc in arcs]
        if is_direction(element) or None in found:
            return False
        ends.extend(end for arc, end in zip(arcs, found, strict=True) if _EDGES.get(arc.ref.direction) == -1)
    vertices = sum(not element.node.edge for element in elements)
    return len(ends) > len(set(ends)) or len(ends) >= vertices > 0


def is_direction(element: ExpandedElement) -> bool:
    """Whether an untyped node is one of the standard directions, or gives a direction by `axis` or `ax`."""
    node = element.node
    if node.edge or any(isinstance(item, Node | ArcItem) for item in node.items):
        return False
    fields = {item.name for item in node.items if isinstance(item, Field)}
    return (not fields and element.name in AXES) or (len(fields) == 1 and bool(fields & {"axis", "ax", "direction"}))


def typed_kind(element: ExpandedElement) -> str:
    """The kind that the element's types preset, or nothing."""
    if (
        element.has_prototype
        and element.node.edge
        and not any(isinstance(item, ArcItem) and not role_of(item) for item in element.node.items)
    ):
        return ""
    for item in element.node.items:
        if is_field(item, ("kind",)) and isinstance(item.value, str):
            return item.value if item.value in _ALL and element.types else ""
    if element.name == "world" and not element.node.edge and not element.types:
        return "" if isinstance(element.node.name, QuotedName) else "world"
    if element.name == "world" and not element.node.edge and element.types and not isinstance(element.node.name, QuotedName):
        return "world"
    return ""


def _default(element: ExpandedElement, mode: str) -> str:
    if element.node.edge:
        return "joint" if mode == "robot" else "relation"
    if is_direction(element):
        return "axis"
    return "body" if mode == "robot" else "datum"


def _infer_from_edges(elements: list[ExpandedElement], kinds: list[str], by_name: dict[str, list[int]]) -> None:
    """In an untyped root: an edge with one body on each side is a joint, one with a spring or damper is constitutive."""
    for number, element in enumerate(elements):
        if not element.node.edge or kinds[number] or element.types or _is_plain(element.node):
            continue
        ends = [(arc, _target(arc, element, by_name)) for arc in element.node.items if isinstance(arc, ArcItem)]
        lumped = any(end is not None and (kinds[end] or _lumped(elements[end])) in _COMPLIANT for _, end in ends)
        if lumped:
            kinds[number] = "constitutive"
            for _, end in ends:
                if end is not None and not kinds[end]:
                    kinds[end] = _lumped(elements[end]) or ("body" if _fields(elements[end]) & _BODY_WORDS else "port")
        elif _is_joint(ends, elements):
            kinds[number] = "joint"
            for _, end in ends:
                if end is not None and not kinds[end] and not is_direction(elements[end]):
                    kinds[end] = "body"
    for number, element in enumerate(elements):
        if kinds[number] == "joint":
            for arc in element.node.items:
                is_end = isinstance(arc, ArcItem) and role_of(arc) not in _NO_ENDS
                end = _target(arc, element, by_name) if is_end else None  # type: ignore[arg-type]
                if end is not None and not kinds[end] and not is_direction(elements[end]):
                    kinds[end] = "body"
    for number, element in enumerate(elements):
        if not kinds[number] and not element.node.edge and _fields(element) & _BODY_WORDS:
            kinds[number] = "body"


def _is_plain(node: Node) -> bool:
    """Whether an edge is one of plain data: edges stand inside of it, or a weight is no pose."""
    if any(isinstance(item, Node) and item.edge for item in node.items):
        return True
    return any(isinstance(item, ArcItem) and item.weight is not None and not _may_be_pose(item.weight) for item in node.items)


def _may_be_pose(weight: tuple[Value, ...]) -> bool:
    """Whether a weight has the form of a pose, or of numbers at all."""
    if not any(map(is_list, weight)):
        return True
    return (
        len(weight) <= 3
        and is_list(weight[0])
        and len(weight[0]) == 3
        and all(not is_list(part) or len(part) in (3, 4, 6) for part in weight)
    )


def _target(arc: ArcItem, element: ExpandedElement, by_name: dict[str, list[int]]) -> int | None:
    name = element.scope.resolve(arc.ref.path)
    found = by_name.get(name or "", [])
    return found[0] if found else None


def _is_joint(ends: list[tuple[ArcItem, int | None]], elements: list[ExpandedElement]) -> bool:
    """One tail and one head that are no directions, and nothing else but directions."""
    signs: list[int] = []
    for arc, end in ends:
        names_axis = arc.ref.path[-1] in AXES if end is None else is_direction(elements[end])
        if not names_axis and (len(arc.ref.path) > 1 if end is None else _is_data(elements[end])):
            return False
        if not names_axis and arc.role not in ("axis", "mimic"):
            signs.append(_EDGES.get(arc.ref.direction, 0))
    return sorted(signs) == [-1, 1]


def _is_data(element: ExpandedElement) -> bool:
    """Whether a vertex has fields, and none that a body has."""
    fields = {item.name for item in element.node.items if isinstance(item, Field) and item.value is not None}
    return bool(fields) and fields.isdisjoint(_BODY_WORDS | {"name", "color", "origin", "rotation", "axes"})


def _fields(element: ExpandedElement) -> set[str]:
    return {getattr(item, "name", "") for item in element.node.items}


def _lumped(element: ExpandedElement) -> str:
    """The lumped element of the dynamics dialect that a node's fields describe, or nothing."""
    fields = {item.name for item in element.node.items if isinstance(item, Field)}
    if fields & _SPRING:
        return "spring"
    if fields & _DAMPER:
        return "damper"
    return "mass" if fields == {"mass"} else ""
