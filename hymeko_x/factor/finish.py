"""From forms under work to what is handed out: defaults of parameters, macros in order, texts that deserve a name."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from hymeko_x.factor.flat import rest
from hymeko_x.factor.forms import Call, Factored, Macro, Parameter

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.factor.dialect import Dialect
    from hymeko_x.factor.flat import Draft, Form, Grown


def finish(grown: Grown, dialect: Dialect) -> Factored:
    """The result: calls without what is a default, macros before those that call them."""
    lists = grown.lists
    called: dict[str, list[Form]] = {name: [] for name in grown.macros}
    for form in _all(lists):
        if form.is_call:
            called[form.tag].append(form)
    parameters = {name: _parameters(draft, called[name], dialect) for name, draft in grown.macros.items()}
    calls = {id(form): _call(form, parameters[name]) for name, forms in called.items() for form in forms}
    macros = [Macro(name, parameters[name], rest(grown.macros[name].body, calls)) for name in _ordered(grown)]
    return Factored(rest(grown.items, calls), tuple(macros))


def _all(lists: list[list[Form]]) -> Iterator[Form]:
    stack = [form for row in lists for form in row]
    while stack:
        form = stack.pop()
        yield form
        stack += form.kids


def _parameters(draft: Draft, calls: list[Form], dialect: Dialect) -> tuple[Parameter, ...]:
    """The parameters, with the most common value as default where that is shorter than saying it."""
    found = []
    for place, name in enumerate(draft.parameters):
        values = Counter(call.texts[place] for call in calls)
        texts = [(text, uses) for text, uses in values.items() if uses > 1 and isinstance(text, str) and dialect.can_be_default(text)]
        best = max(texts, key=lambda item: item[1], default=("", 0))
        saved = best[1] * (dialect.argument + len(name) + len(best[0])) - dialect.default - len(best[0])
        found.append(Parameter(name, best[0] if best[1] > 1 and saved > 0 else None))
    return tuple(found)


def _call(form: Form, parameters: tuple[Parameter, ...]) -> Call:
    given = zip(parameters, form.texts, strict=True)
    return Call(form.tag, tuple([(parameter.name, text) for parameter, text in given if text != parameter.default]))


def _ordered(grown: Grown) -> list[str]:
    """The names of the macros, each behind those that it calls."""
    needs = {name: {form.tag for form in _all([draft.body]) if form.is_call} for name, draft in grown.macros.items()}
    done: dict[str, None] = {}
    stack = list(reversed(grown.macros))
    while stack:
        name = stack[-1]
        missing = [other for other in sorted(needs[name]) if other not in done]
        if name in done or not missing:
            done[stack.pop()] = None
        else:
            stack += missing
    return list(done)
