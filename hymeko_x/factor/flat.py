"""Forms as arrays: every form has a number in document order, and forms of the same shape share a shape number.

The shape of a form is its tag, the names of its leaves and the shapes of its children; the texts of two forms of one shape
can be compared column by column. Shapes are numbered from the leaves up, so that comparing two is comparing two integers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.factor.forms import Call, FormElement, Hole, Signed

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterable, Iterator

    from hymeko_x.factor.forms import Dialect, Item, Text


class Form:
    """A form or a call while it is worked on; the only mutable thing in factoring."""

    __slots__ = ("children", "hint", "is_call", "leaves", "tag", "texts")

    def __init__(self, tag: str, leaves: tuple[str, ...], texts: tuple[Text, ...], *, is_call: bool = False, hint: str = "") -> None:
        self.tag = tag
        self.leaves = leaves
        self.texts = texts
        self.children: list[Form] | tuple[()] = ()
        self.is_call = is_call
        self.hint = hint


class OpenMacro:
    """A macro while it is worked on: its name, parameters in order, the value that most calls give for each, and its body."""

    __slots__ = ("body", "name", "parameters", "usual")

    def __init__(self, name: str, parameters: tuple[str, ...], usual: tuple[Text | None, ...], body: list[Form]) -> None:
        self.name = name
        self.parameters = parameters
        self.usual = usual
        self.body = body


class FactoringState:
    """All forms under work: the items at top level, and the macros found so far."""

    def __init__(self, items: list[Form]) -> None:
        self.items = items
        self.macros: dict[str, OpenMacro] = {}

    @property
    def lists(self) -> list[list[Form]]:
        """The rows of forms: the items, then the bodies of the macros."""
        return [self.items, *(macro.body for macro in self.macros.values())]


def every_form(lists: Iterable[list[Form]]) -> Iterator[Form]:
    """The forms of these rows, and those in them."""
    stack = [form for row in lists for form in row]
    while stack:
        form = stack.pop()
        yield form
        stack += form.children


def to_forms(forms: Iterable[FormElement]) -> list[Form]:
    """Forms to work on."""
    top: list[Form] = []
    stack: list[tuple[FormElement, list[Form]]] = [(form, top) for form in reversed(list(forms))]
    while stack:
        form, out = stack.pop()
        names = tuple([name for name, _ in form.leaves])
        made = Form(form.tag, names, tuple([text for _, text in form.leaves]), hint=form.hint)
        out.append(made)
        if form.children:
            children: list[Form] = []
            made.children = children
            stack += [(kid, children) for kid in reversed(form.children) if isinstance(kid, FormElement)]
    return top


def to_items(forms: list[Form], items_of: dict[int, Call]) -> tuple[Item, ...]:
    """Forms as items. ``items_of`` are the finished calls, by the id of their form."""
    top: list[Item] = []
    work: list[tuple[Form, list[Item], list[Item] | None]] = [(form, top, None) for form in reversed(forms)]
    while work:
        form, out, children = work.pop()
        if form.is_call:
            out.append(items_of[id(form)])
        elif children is None and form.children:
            children = []
            work.append((form, out, children))
            work += [(kid, children, None) for kid in reversed(form.children)]
        else:
            leaves = tuple(zip(form.leaves, form.texts, strict=True))
            out.append(FormElement(form.tag, leaves, tuple(children or ()), form.hint))
    return tuple(top)


class Flat:
    """Arrays over all forms, by number. Texts of a run of siblings are one slice of ``texts``."""

    def __init__(self, workspace: FactoringState, dialect: Dialect) -> None:
        self._sizes: dict[str, int] = {}
        self._macros = workspace.macros
        self._dialect = dialect
        self.forms: list[Form] = []
        self.end: list[int] = []
        """One past the last form inside each form."""
        self.up: list[int] = []
        """The number of the form around each one; -1 - n at top level of list n."""
        self.texts: list[Text] = []
        self.start: list[int] = []
        """Where each form's texts start; one entry more than there are forms."""
        self._number(workspace.lists)
        self.size = self._measured()
        self.shape = self.labels(self._shape_of)

    def __len__(self) -> int:
        return len(self.forms)

    def _number(self, lists: list[list[Form]]) -> None:
        for place, top in enumerate(lists):
            stack: list[tuple[Form, int]] = [(form, -1 - place) for form in reversed(top)]
            while stack:
                form, up = stack.pop()
                number = len(self.forms)
                self.forms.append(form)
                self.up.append(up)
                self.start.append(len(self.texts))
                self.texts += form.texts
                if form.children:
                    stack += [(kid, number) for kid in reversed(form.children)]
        self.start.append(len(self.texts))
        self.end = list(range(1, len(self.forms) + 1))
        for number in range(len(self.forms) - 1, -1, -1):
            if self.up[number] >= 0:
                self.end[self.up[number]] = max(self.end[self.up[number]], self.end[number])

    def _measured(self) -> list[int]:
        size = [0] * len(self.forms)
        for number in range(len(self.forms) - 1, -1, -1):
            form = self.forms[number]
            size[number] += self._own_call(form) if form.is_call else self._own(form)
            if self.up[number] >= 0:
                size[self.up[number]] += size[number]
        return size

    def _own(self, form: Form) -> int:
        costs = self._dialect
        own = costs.element + len(form.tag) + sum([len(name) + costs.leaf for name in form.leaves])
        if form.children:
            own += costs.block + (len(form.tag) if costs.closes_by_tag else 0)
        return own + sum([self.length(text) for text in form.texts])

    def _own_call(self, form: Form) -> int:
        costs = self._dialect
        usual = self._macros[form.tag].usual
        given = zip(form.leaves, form.texts, usual, strict=True)
        arguments = [costs.argument + len(name) + self.length(text) for name, text, default in given if text != default]
        return costs.call + len(form.tag) + sum(arguments)

    def labels(self, key_of: Callable[[int], Hashable]) -> list[int]:
        """A label for each form; the same where the keys of forms and everything in them are the same."""
        known: dict[Hashable, int] = {}
        labels = [0] * len(self.forms)
        below: dict[int, list[int]] = {}
        for number in range(len(self.forms) - 1, -1, -1):
            labels[number] = known.setdefault((key_of(number), tuple(below.pop(number, ()))), len(known))
            if self.up[number] >= 0:
                below.setdefault(self.up[number], []).append(labels[number])
        return labels

    def _shape_of(self, number: int) -> Hashable:
        form = self.forms[number]
        return form.tag, form.is_call, form.leaves

    def length(self, text: Text) -> int:
        """The cost of a text."""
        if isinstance(text, str):
            found = self._sizes.get(text)
            if found is None:
                found = self._sizes[text] = len(text) - sum(map(text.count, " \n\t"))
            return found
        return sum([self.length(piece) if isinstance(piece, str) else self.length_of_hole(piece) for piece in text])

    def length_of_hole(self, hole: Hole | Signed) -> int:
        """The cost of a hole."""
        if isinstance(hole, Hole):
            return self._dialect.hole + len(hole.name)
        return self._dialect.hole + sum([len(name) + 1 for name in hole.factors]) + hole.negative + len(hole.magnitude)
