"""From forms under work to the result: defaults of parameters, macros in order, and named values for texts in many places."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from hymeko_x.factor.find import is_usual
from hymeko_x.factor.flat import every_form, to_items
from hymeko_x.factor.forms import Call, Factored, FormElement, Hole, Macro, MacroParameter, Value, joined
from hymeko_x.factor.macros import identifier
from hymeko_x.ir.names import free_name

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.factor.flat import FactoringState, Form, OpenMacro
    from hymeko_x.factor.forms import Dialect, Item, Piece, Text


def finish(workspace: FactoringState, dialect: Dialect) -> Factored:
    """The result: calls without arguments that are defaults, macros before those that call them."""
    lists = workspace.lists
    called: dict[str, list[Form]] = {name: [] for name in workspace.macros}
    for form in every_form(lists):
        if form.is_call:
            called[form.tag].append(form)
    parameters = {name: _parameters(draft, called[name], dialect) for name, draft in workspace.macros.items()}
    calls = {id(form): _call(form, parameters[name]) for name, forms in called.items() for form in forms}
    macros = [Macro(name, parameters[name], to_items(workspace.macros[name].body, calls)) for name in _ordered(workspace)]
    return Factored(to_items(workspace.items, calls), tuple(macros))


def _parameters(draft: OpenMacro, calls: list[Form], dialect: Dialect) -> tuple[MacroParameter, ...]:
    """The parameters, with the most common value as default where half of the calls have it, and that is shorter."""
    found = []
    for place, name in enumerate(draft.parameters):
        values = Counter(call.texts[place] for call in calls)
        usual = [(text, uses) for text, uses in values.items() if isinstance(text, str) and is_usual(uses, len(calls))]
        texts = [(text, uses) for text, uses in usual if dialect.can_be_default(text) and (not text or dialect.has_default(name))]
        best = max(texts, key=lambda item: item[1], default=("", 0))
        saved = best[1] * (dialect.argument + len(name) + len(best[0])) - dialect.default - len(best[0])
        found.append(MacroParameter(name, best[0] if best[1] > 1 and saved > 0 else None))
    return tuple(found)


def _call(form: Form, parameters: tuple[MacroParameter, ...]) -> Call:
    given = zip(parameters, form.texts, strict=True)
    return Call(form.tag, tuple([(parameter.name, text) for parameter, text in given if text != parameter.default]))


def _ordered(workspace: FactoringState) -> list[str]:
    """The names of the macros, each behind those that it calls."""
    needs = {name: {form.tag for form in every_form([draft.body]) if form.is_call} for name, draft in workspace.macros.items()}
    done: dict[str, None] = {}
    stack = list(reversed(workspace.macros))
    while stack:
        name = stack[-1]
        missing = [other for other in sorted(needs[name]) if other not in done]
        if name in done or not missing:
            done[stack.pop()] = None
        else:
            stack += missing
    return list(done)


# ---- named values -------------------------------------------------------------------------------------------------------------

_LEAST_TEXT = 16
_LEAST_NUMBER = 9
"""Shorter ones are easier to read where they are."""


def name_texts(factored: Factored, dialect: Dialect) -> Factored:
    """The same with named values where that is shorter; a line is easier to understand than a macro, so that it may save less."""
    uses: Counter[str] = Counter()
    places: dict[str, str] = {}
    for wish, text in _texts(factored, dialect):
        for part in _parts(text, dialect):
            uses[part] += 1
            places.setdefault(part, wish)
    taken = {*dialect.taken, *(parameter.name for macro in factored.macros for parameter in macro.parameters)}
    named: dict[str, str] = {}
    for part, count in sorted(uses.items(), key=lambda item: (-item[1] * len(item[0]), item[0])):
        name = _name(part, places[part], taken)
        saved = count * (len(part) - dialect.hole - len(name)) - dialect.value - len(name) - len(part)
        if saved >= dialect.least // 4 and dialect.can_be_value(part):
            named[part] = name
            taken.add(name)
    if not named:
        return factored
    macros = tuple([macro._replace(body=_rewritten(macro.body, named, dialect)) for macro in factored.macros])
    values = tuple([Value(name, text) for text, name in named.items()])
    return Factored(_rewritten(factored.items, named, dialect), macros, values)


def _texts(factored: Factored, dialect: Dialect) -> Iterator[tuple[str, Text]]:
    """Every text with the name that a value in it would have."""
    stack: list[Item] = [*reversed(factored.items), *(item for macro in factored.macros for item in macro.body)]
    while stack:
        item = stack.pop()
        if isinstance(item, Call):
            yield from item.arguments
        else:
            yield from ((dialect.leaf_name(item.tag, name), text) for name, text in item.leaves)
            stack += reversed(item.children)


def _parts(text: Text, dialect: Dialect) -> Iterator[str]:
    """The parts of a text that could have a name: all of it, the folder of a file, long numbers."""
    if isinstance(text, str) and len(text) >= _LEAST_TEXT and " " not in text:
        yield text
    first = text if isinstance(text, str) else text[0]
    if isinstance(first, str) and "://" in first:
        yield first.rpartition("/")[0]
    for piece in (text,) if isinstance(text, str) else text:
        if isinstance(piece, str):
            yield from (part for part in dialect.cut(piece) if len(part) >= _LEAST_NUMBER and part[0].isdigit() and part != text)


def _name(part: str, wish: str, taken: set[str]) -> str:
    base = part.rpartition("/")[2] if "/" in part else wish
    return free_name(identifier(base) if any(map(str.isalnum, base)) else "value", taken.__contains__, "")


def _rewritten(items: tuple[Item, ...], named: Mapping[str, str], dialect: Dialect) -> tuple[Item, ...]:
    """The items with holes for named values. Iterative: rows under construction wait for their content."""
    top: list[Item] = []
    work: list[tuple[Item, list[Item], list[Item] | None]] = [(item, top, None) for item in reversed(items)]
    while work:
        item, out, children = work.pop()
        if isinstance(item, Call):
            out.append(item._replace(arguments=tuple([(name, _with_holes(text, named, dialect)) for name, text in item.arguments])))
        elif children is None and item.children:
            children = []
            work.append((item, out, children))
            work += [(kid, children, None) for kid in reversed(item.children)]
        else:
            leaves = tuple([(name, _with_holes(text, named, dialect)) for name, text in item.leaves])
            out.append(FormElement(item.tag, leaves, tuple(children or ()), item.hint))
    return tuple(top)


def _with_holes(text: Text, named: Mapping[str, str], dialect: Dialect) -> Text:
    if isinstance(text, str) and text in named:
        return (Hole(named[text]),)
    pieces: list[Piece] = []
    for place, piece in enumerate((text,) if isinstance(text, str) else text):
        if not isinstance(piece, str):
            pieces.append(piece)
            continue
        folder = piece.rpartition("/")[0]
        if place == 0 and folder in named and "://" in folder:
            pieces += [Hole(named[folder]), piece.removeprefix(folder)]
        else:
            pieces += [Hole(named[part]) if part in named else part for part in dialect.cut(piece)]
    return joined(pieces)
