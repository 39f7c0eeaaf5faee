"""Where comments go: into a macro where every instance has the same one, else before the call.

xacro drops comments right before its own elements unless an empty line is between.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.factor.forms import Call, FormElement

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from hymeko_x.backends.xacro.elements import Remarks
    from hymeko_x.factor.forms import Factored, Item

Placed = dict[tuple[str, int], list[str]]
"""Comments by the item that they stand before: its macro ("" = the file itself), and its place there."""


def placed(factored: Factored, remarks: Remarks) -> Placed:
    """The place of every comment. Those behind the last form come behind the last item."""
    bodies: dict[str, Sequence[Item]] = {"": factored.items, **{macro.name: macro.body for macro in factored.macros}}
    spans = _spans(factored)
    found: Placed = {}
    waiting: dict[str, list[tuple[tuple[str, int], dict[int, list[str]]]]] = {"": [(("", 0), remarks)]}
    for name in ("", *(macro.name for macro in reversed(factored.macros))):
        instances = waiting.pop(name, [])
        shared = dict(instances[0][1]) if name == "" else _shared(instances, found)
        _hand_down(name, bodies[name], spans, shared, found, waiting)
    return found


def _shared(instances: list[tuple[tuple[str, int], dict[int, list[str]]]], found: Placed) -> dict[int, list[str]]:
    """The comments that all instances of a macro have at the same place; others go before the calls."""
    if not instances:
        return {}
    first = instances[0][1]
    shared = {offset: comments for offset, comments in first.items() if all(own.get(offset) == comments for _, own in instances)}
    for place, own in instances:
        rest = [line for offset in sorted(own) if offset not in shared for line in own[offset]]
        if rest:
            found.setdefault(place, []).extend(rest)
    return shared


def _hand_down(
    name: str,
    body: Sequence[Item],
    spans: Mapping[str, int],
    remarks: dict[int, list[str]],
    found: Placed,
    waiting: dict[str, list[tuple[tuple[str, int], dict[int, list[str]]]]],
) -> None:
    """Give each item of a body the comments before it or, where it is a call, in it."""
    offset = 0
    for place, item in enumerate(body):
        length = 1 if isinstance(item, FormElement) else spans[item.macro]
        own = {at - offset: remarks[at] for at in range(offset, offset + length) if at in remarks}
        if isinstance(item, Call):
            waiting.setdefault(item.macro, []).append(((name, place), own))
        elif own:
            found.setdefault((name, place), []).extend(own[0])
        offset += length
    last = [line for at in sorted(remarks) if at >= offset for line in remarks[at]]
    if last:
        found.setdefault((name, len(body)), []).extend(last)


def _spans(factored: Factored) -> dict[str, int]:
    """How many forms each macro expands to."""
    spans: dict[str, int] = {}
    for macro in factored.macros:
        spans[macro.name] = sum(spans[item.macro] if isinstance(item, Call) else 1 for item in macro.body)
    return spans
