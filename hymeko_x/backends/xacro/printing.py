"""The text of a xacro file: properties, macros, then the robot; sections under comments that xacro drops when it expands."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.xacro.elements import INSTRUCTION, TEXT
from hymeko_x.backends.xacro.spelling import argument, arguments_to_quote, default, spelled
from hymeko_x.factor.forms import Call
from hymeko_x.formats.xacro import NAMESPACE
from hymeko_x.xml.text import escaped

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hymeko_x.backends.urdf.document import UrdfDocument
    from hymeko_x.backends.xacro.remarks import Placed
    from hymeko_x.factor.forms import Factored, FormElement, Item, Macro, MacroParameter

_INDENT = "  "


def print_file(document: UrdfDocument, factored: Factored, remarks: Placed, included: str | None = None) -> list[str]:
    """The lines of the file but the end of its root; where macros stand in a file that is ``included``, without them."""
    page = FileLines(factored, remarks)
    page.lines += ['<?xml version="1.0"?>', *document.before, root_start(document)]
    if included is None:
        page.definitions()
    else:
        page.lines.append(f'{_INDENT}<xacro:include filename="{included}"/>')
    page.heading("The robot", factored.macros and factored.items)
    if included is None and (factored.macros or factored.values) and not isinstance(factored.items[0], Call):
        page.lines.append("")
    page.body("", factored.items, 1)
    return page.lines


def print_macros(document: UrdfDocument, factored: Factored, remarks: Placed) -> str:
    """The file that is included: properties and macros, under the prefixes that the robot declares."""
    page = FileLines(factored, remarks)
    page.lines += ['<?xml version="1.0"?>', root_start(document, "xmlns:")]
    page.definitions()
    page.lines += ["</robot>", ""]
    return "\n".join(page.lines)


def root_start(document: UrdfDocument, beginning: str = "") -> str:
    """The start tag of the root, which declares xacro's prefix; of its attributes those whose names begin so."""
    own = {name: value for name, value in document.root.attributes.items() if name != "xmlns:xacro" and name.startswith(beginning)}
    attributes = "".join([f' {name}="{escaped(spelled(value))}"' for name, value in own.items()])
    return f'<robot{attributes} xmlns:xacro="{NAMESPACE}">'


class FileLines:
    """Lines of a file under construction."""

    def __init__(self, factored: Factored, remarks: Placed) -> None:
        self.lines: list[str] = []
        self._factored = factored
        self._remarks = remarks
        self._quoted = arguments_to_quote(factored)

    def heading(self, words: str, section: Sequence[object]) -> None:
        """A comment over a section that begins with a call, so that it is gone after expansion."""
        if section and isinstance(section[0], Call) and not self._remarks.get(("", 0)):
            self.lines += ["", f"{_INDENT}<!-- {words} -->"]

    def definitions(self) -> None:
        """The properties, then the macros."""
        self._values()
        for macro in self._factored.macros:
            self._macro(macro)

    def _values(self) -> None:
        if self._factored.values:
            self.lines += ["", f"{_INDENT}<!-- Values -->"]
        for value in self._factored.values:
            text = escaped(argument(value.text, quoted=False))
            self.lines.append(f'{_INDENT}<xacro:property name="{value.name}" value="{text}"/>')

    def _macro(self, macro: Macro) -> None:
        names = " ".join(map(_parameter, macro.parameters))
        self.lines += ["", f"{_INDENT}<!-- {_about(macro)} -->", f'{_INDENT}<xacro:macro name="{macro.name}" params="{escaped(names)}">']
        self.body(macro.name, macro.body, 2)
        self.lines.append(f"{_INDENT}</xacro:macro>")

    def body(self, name: str, items: Sequence[Item], depth: int) -> None:
        """The items of the file ("") or of a macro, with the comments between them."""
        for place, item in enumerate(items):
            self._comments((name, place), depth, spaced=isinstance(item, Call))
            self._item(item, depth)
        self._comments((name, len(items)), depth, spaced=False)

    def _comments(self, place: tuple[str, int], depth: int, *, spaced: bool) -> None:
        comments = self._remarks.get(place, ())
        self.lines += [_INDENT * depth + comment for comment in comments]
        if comments and spaced:
            self.lines.append("")

    def _item(self, top: Item, depth: int) -> None:
        """An item with everything in it, line by line."""
        stack: list[tuple[Item | str, int]] = [(top, depth)]
        while stack:
            item, level = stack.pop()
            indent = _INDENT * level
            if isinstance(item, str):
                self.lines.append(indent + item)
            elif isinstance(item, Call):
                self.lines.append(indent + self._call(item))
            elif item.children:
                self.lines.append(f"{indent}{_start(item)}>")
                stack.append((f"</{item.tag}>", level))
                stack += [(child, level + 1) for child in reversed(item.children)]
            else:
                self.lines.append(indent + _leaf(item))

    def _call(self, call: Call) -> str:
        given = [(name, argument(text, quoted=(id(call), name) in self._quoted)) for name, text in call.arguments]
        return f"<xacro:{call.macro}" + "".join([f' {name}="{escaped(text)}"' for name, text in given]) + "/>"


def _about(macro: Macro) -> str:
    """The heading of a macro."""
    return macro.name.replace("_", " ")


def _parameter(parameter: MacroParameter) -> str:
    return parameter.name if parameter.default is None else f"{parameter.name}:={default(parameter.default)}"


def _start(element: FormElement) -> str:
    return f"<{element.tag}" + "".join([f' {name}="{escaped(spelled(text))}"' for name, text in element.leaves if name])


def _leaf(element: FormElement) -> str:
    words = next((spelled(text) for name, text in element.leaves if not name), None)
    if element.tag == TEXT:
        return escaped(words or "")
    if element.tag == INSTRUCTION:
        return f"<?{words}?>"
    if element.tag.startswith("<!--"):
        return element.tag
    return _start(element) + ("/>" if words is None else f">{escaped(words)}</{element.tag}>")
