"""Which arguments need quotes: those that xacro would read as another number or truth value than they are written as."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.factor.forms import Call, fill
from hymeko_x.formats.xacro import survives

if TYPE_CHECKING:
    from hymeko_x.factor.forms import Factored, Item


def arguments_to_quote(factored: Factored) -> set[tuple[int, str]]:
    """Identity of the call and name of each argument that is not a plain text and, in one of its expansions, would change."""
    macros = {macro.name: macro for macro in factored.macros}
    known = {value.name: value.text for value in factored.values}
    found: set[tuple[int, str]] = set()
    stack: list[tuple[Item, dict[str, str]]] = [(item, known) for item in factored.items]
    while stack:
        item, scope = stack.pop()
        if not isinstance(item, Call):
            stack += [(child, scope) for child in item.children]
            continue
        given = {name: fill(text, scope) for name, text in item.arguments}
        found.update((id(item), name) for name, text in given.items() if not survives(text))
        macro = macros[item.macro]
        inner = known | {parameter.name: parameter.default for parameter in macro.parameters if parameter.default is not None} | given
        stack += [(part, inner) for part in macro.body]
    return found
