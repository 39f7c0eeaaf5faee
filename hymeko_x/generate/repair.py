"""Repairs of HyMeKo text that need no model: misspelt, repeated and undefined names, values that do not fit, brackets.

Each is the smallest change that removes one error. Where no other helps, the statement is removed, and only then the block around it.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.api import loads
from hymeko_x.diagnostics import Diagnostic, Refusal
from hymeko_x.formats import OWN
from hymeko_x.language.outline import NAME, TYPES, block_of
from hymeko_x.language.printer import print_name

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from hymeko_x.outline import OutlineBlock, OutlineField

_MOST = 100
"""Errors that are mended in one text; each costs a reading."""
_CUTS = 8
"""Statements that are taken from the end of a text that breaks off."""
_SUGGESTED = re.compile(r"did you mean ([^?]+)\?")
_PLAIN_NAME = re.compile(r"[^\W\d]\w*")
_SKIPPED = r'#[^\n]*|//[^\n]*|/\*[\s\S]*?\*/|"""[\s\S]*?"""|"(?:\\[\s\S]|[^"\\])*"|\'(?:\\[\s\S]|[^\'\\])*\'|`(?:\\.|[^`\\\n])*`'
_BRACKETS = re.compile(rf"{_SKIPPED}|(?P<open>[{{\[(])|(?P<close>[}}\])])")
_PAIRS = {"{": "}", "[": "]", "(": ")"}


class ChangedText(Struct, frozen=True):
    """A text with one change, and which that is."""

    text: str
    done: str


class Repair(Struct, frozen=True):
    """A text after its repairs: each with the error that it removed, and the error that is left."""

    text: str
    changes: tuple[str, ...] = ()
    left: Diagnostic | None = None


def repair(text: str) -> Repair:
    """The text, changed until it can be read or until no change helps."""
    changes: list[str] = []
    fault = _fault(text)
    while fault is not None and len(changes) < _MOST:
        better = next(_helping(text, fault), None)
        if better is None:
            break
        text, following = better[0].text, better[1]
        changes.append(f"{fault.origin}: {fault.message}; {better[0].done}")
        fault = following
    return Repair(text, tuple(changes), fault)


def _fault(text: str) -> Diagnostic | None:
    """The first error of a text; None when it can be read."""
    try:
        loads(text, OWN.name)
    except Refusal as refusal:
        return refusal.diagnostic
    return None


def _helping(text: str, fault: Diagnostic) -> Iterator[tuple[ChangedText, Diagnostic | None]]:
    """The changes that leave a text without an error at this place, each with the next error."""
    for change in _closed(text) if fault.code is codes.SYNTAX else _changes(text, fault):
        following = _fault(change.text)
        is_gone = following is None or (following.origin != fault.origin and following.code is not codes.SYNTAX)
        if is_gone and _content(change.text):
            yield change, following


def _content(text: str) -> str:
    """A text without comments, commas and white space."""
    return re.sub(r"//[^\n]*|#[^\n]*|/\*[\s\S]*?\*/|[\s,;]", "", text)


# ---- brackets --------------------------------------------------------------------------------------------------------------------


def _closed(text: str) -> Iterator[ChangedText]:
    """The text with its brackets in pairs, whole or without the last statements, of which a part may be missing."""
    paired = _paired(text)
    yield ChangedText(paired, "its brackets are in pairs")
    for _ in range(_CUTS):
        text = re.sub(r"(?:(?<=[{}])|\n|^)[^\n{}]*[{}\s]*$", "", text)
        yield ChangedText(_paired(text), "it ends before the statement that is not complete")


def _paired(text: str) -> str:
    """A text without brackets that close nothing, and with those that are missing at its end."""
    open_: list[str] = []
    pieces: list[str] = []
    last = 0
    for match in _BRACKETS.finditer(text):
        if match["open"]:
            open_.append(_PAIRS[match["open"]])
        elif match["close"] and match["close"] in open_:
            missing = open_[open_.index(match["close"], -1 - open_[::-1].index(match["close"])) + 1 :]
            pieces += [text[last : match.start()], *reversed(missing)]
            del open_[len(open_) - len(missing) - 1 :]
            last = match.start()
        elif match["close"]:
            pieces.append(text[last : match.start()])
            last = match.end()
    rest = text[last:].rstrip() + "\n" if open_ else text[last:]
    return "".join([*pieces, rest, *reversed(open_), "\n" if open_ else ""])


# ---- names and values ------------------------------------------------------------------------------------------------------------


def _changes(text: str, fault: Diagnostic) -> Iterator[ChangedText]:
    """The changes that may remove an error of meaning, the smallest first."""
    if fault.origin is None or fault.origin.line is None or fault.origin.column is None:
        return
    whole = block_of(text, "")
    lines = text.split("\n")
    before = "\n".join([*lines[: fault.origin.line - 1], lines[fault.origin.line - 1][: fault.origin.column - 1]])
    place = len(before.encode())
    path = _path(whole, place)
    for change in (_spelt, *_BY_CODE.get(fault.code, ())):
        yield from change(text.encode(), fault, place, path)
    yield from _removals(text.encode(), place, path)


def _path(block: OutlineBlock, place: int) -> list[OutlineBlock]:
    """The blocks around a byte, from the whole text to the innermost."""
    found = [block]
    while inner := next((child for child in found[-1].children if child.start <= place < child.end), None):
        found.append(inner)
    return found


def _spelt(data: bytes, fault: Diagnostic, place: int, path: list[OutlineBlock]) -> Iterator[ChangedText]:
    """The name that the hint suggests."""
    suggested = _SUGGESTED.search(fault.hint)
    written = re.findall(r"'([^']+)'", fault.message)
    if suggested is None or not written:
        return
    last = written[-1].rpartition(".")[2]
    found = re.search(rf"(?<!\w){re.escape(last)}(?!\w)".encode(), data[place:])
    name = suggested[1].split(" or ")[0]
    if found is not None:
        yield _replaced(data, place + found.start(), place + found.end(), print_name(name), f"it is now '{name}'")


def _renamed(data: bytes, fault: Diagnostic, place: int, path: list[OutlineBlock]) -> Iterator[ChangedText]:
    """Another name for what is defined twice: the references mean the first one."""
    found = _PLAIN_NAME.search(data[place:].decode())
    if found is None:
        return
    text, number = data.decode(), 2
    while re.search(rf"\b{found[0]}_{number}\b", text):
        number += 1
    start = place + len(data[place:].decode()[: found.start()].encode())
    name = f"{found[0]}_{number}"
    yield _replaced(data, start, start + len(found[0].encode()), name, f"the second is now '{name}'")


def _defined(data: bytes, fault: Diagnostic, place: int, path: list[OutlineBlock]) -> Iterator[ChangedText]:
    """An empty element of the name, before the block that refers to it."""
    name = next(iter(re.findall(r"'([^'.]+)'", fault.message)), None)
    is_element = "is not defined" in fault.message and len(path) > 2
    if name is not None and is_element:
        yield _replaced(data, path[-1].start, path[-1].start, f"{print_name(name)} {{}}\n", f"'{name}' is now defined, without fields")


def _untyped(data: bytes, fault: Diagnostic, place: int, path: list[OutlineBlock]) -> Iterator[ChangedText]:
    """The element without its type."""
    types = path[-1].fields.get(TYPES)
    if types is not None and path[-1].start <= place < path[-1].head:
        yield _replaced(data, *_trimmed(data, types), "", "the element has no type now")


def _trimmed(data: bytes, field: OutlineField) -> tuple[int, int]:
    """The bytes of the types with the colon before them."""
    colon = data.rfind(b":", 0, field.value_end - len(field.text.encode()) + 1)
    return (colon if data[field.start : field.start + 1] != b":" else field.start), field.end


_BY_CODE: dict[object, tuple[Callable[[bytes, Diagnostic, int, list[OutlineBlock]], Iterator[ChangedText]], ...]] = {
    codes.DUPLICATE_NAME: (_renamed,),
    codes.UNDEFINED_REFERENCE: (_defined,),
    codes.UNKNOWN_TYPE: (_untyped,),
    codes.BAD_VALUE: (_untyped,),
}


def _removals(data: bytes, place: int, path: list[OutlineBlock]) -> Iterator[ChangedText]:
    """The text without the statement at a place, or without a block around it; the whole text is no block."""
    innermost = path[-1]
    for name, field in innermost.fields.items():
        if name in (NAME, TYPES) or not field.start <= place < field.end:
            continue
        if place < field.value_start:
            yield _replaced(data, place, field.end, name, f"the value of '{name}' is removed")
        yield _without(data, field.start, field.end, f"field '{name}'")
    for block in path[:0:-1]:
        yield _without(data, block.start, block.end, f"block '{block.name}'")


def _without(data: bytes, start: int, end: int, what: str) -> ChangedText:
    """The text without some bytes, and without the comma behind them."""
    comma = re.match(rb"\s*[,;]", data[end:])
    return _replaced(data, start, end + (comma.end() if comma else 0), " ", f"{what} is removed")


def _replaced(data: bytes, start: int, end: int, new: str, done: str) -> ChangedText:
    return ChangedText((data[:start] + new.encode() + data[end:]).decode(), done)
