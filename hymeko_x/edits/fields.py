"""The fields of one block: what differs between two prints of it, carried over to the author's text."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from hymeko_x.edits.matching import value_of

if TYPE_CHECKING:
    from hymeko_x.edits.splicing import Splices
    from hymeko_x.outline import OutlineBlock, OutlineField

_AFTER_FIELD = (b" ", b"\t", b"\r", b"\n", b"/", b">")
_NAME_WITH_EXPRESSION = re.compile(rb"([^\s$]*)(\$\{[^{}]*\}|\$\([^()]*\))([^\s$]*)")
_WORD = re.compile(rb"[^\s,()\[\]]+")


def edit_fields(splices: Splices, own: OutlineBlock, before: OutlineBlock, after: OutlineBlock, print: bytes) -> None:
    """Carry the fields over that differ between ``before`` and ``after``; ``print`` are the bytes of ``after``."""
    for name, field in after.fields.items():
        earlier, mine = before.fields.get(name), own.fields.get(name)
        if earlier is not None and earlier.text == field.text:
            continue
        if mine is not None:
            _change(splices, mine, earlier, field, print)
        elif name not in splices.style.derived or earlier is None:
            _add(splices, own, after, name, print)
    for name in before.fields:
        if name not in after.fields and name in own.fields:
            gone = own.fields[name]
            splices.put(gone.start, gone.end, b"")


def _change(splices: Splices, mine: OutlineField, earlier: OutlineField | None, field: OutlineField, print: bytes) -> None:
    """Replace a value: where it is a row of words, only those that differ."""
    new = print[field.value_start : field.value_end]
    escape = splices.style.escapes.get(splices.data[mine.value_start - 1 : mine.value_start])
    if escape is not None:
        new = new.replace(splices.data[mine.value_start - 1 : mine.value_start], escape)
    words = [found.span() for found in _WORD.finditer(splices.data, mine.value_start, mine.value_end)]
    wanted, had = _WORD.findall(new), [] if earlier is None else _WORD.findall(earlier.text.encode())
    if not len(words) == len(wanted) == len(had) > 1:
        written = splices.data[mine.value_start : mine.value_end]
        new = new if earlier is None else _with_expression(written, earlier.text.encode(), new)
        splices.put(mine.value_start, mine.value_end, new)
        return
    for (start, end), word, old in zip(words, wanted, had, strict=True):
        if value_of(word.decode()) != value_of(old.decode()):
            splices.put(start, end, word)


def _with_expression(written: bytes, had: bytes, wanted: bytes) -> bytes:
    """A name that becomes another one, with the expression that the author has for a part of it where that part stays."""
    found = _NAME_WITH_EXPRESSION.fullmatch(written)
    if found is None:
        return wanted
    before, expression, after = found.groups()
    value = had[len(before) : len(had) - len(after)]
    if not (before or after) or not value or before + value + after != had:
        return wanted
    if wanted.startswith(before + value):
        return before + expression + wanted[len(before + value) :]
    return wanted[: -len(value + after)] + expression + after if wanted.endswith(value + after) else wanted


def _add(splices: Splices, own: OutlineBlock, after: OutlineBlock, name: str, print: bytes) -> None:
    """Write a field that the author does not have behind the one that precedes it in the print."""
    names = [*after.fields]
    before = (own.fields[other] for other in reversed(names[: names.index(name)]) if other in own.fields)
    behind = next((field for field in before if field.start >= own.first), None)
    text = print[after.fields[name].start : after.fields[name].end]
    if splices.style.has_lines:
        _add_line(splices, own.first if behind is None else behind.end, text)
        return
    if behind is None:
        following = splices.data[own.first : own.first + 1]
        splices.put(own.first, own.first, b" " + text.strip() + (b"" if following in _AFTER_FIELD else b" "))
        return
    blanks = splices.data[behind.start : behind.end]
    blanks = blanks[: len(blanks) - len(blanks.lstrip())]
    splices.put(behind.end, behind.end, (blanks or b" ") + text.lstrip())


def _add_line(splices: Splices, place: int, text: bytes) -> None:
    """Write a field into a line of its own, behind a place and the comment that follows there."""
    end = splices.end_of_line(place)
    splices.put(place if end is None else end, place if end is None else end, text + (b"\n" if end is None else b""))
