"""The text of an element as it is written: tidy tags, one node a line. Only white space that means nothing changes."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

_VALUE = "(?:\"[^\"]*\"|'[^']*')"
_PART = re.compile(
    rf"<!--(?P<comment>.*?)-->|(?P<other><!\[CDATA\[.*?\]\]>|<\?.*?\?>)"
    rf"|<(?P<name>[^\s/>!?]+)(?P<attributes>(?:\s+[^\s=]+\s*=\s*{_VALUE})*)\s*(?P<ends>/?)>|</(?P<closed>[^\s>]+)\s*>|(?P<text>[^<]+)",
    re.DOTALL,
)
_ATTRIBUTE = re.compile(rf"([^\s=]+)\s*=\s*({_VALUE})")
_TIDY_LINE = re.compile(r"( *)<(?:(/)[^\s>]+>|[^\s/>!?]+(?: [^\s=]+=\"[^\"]*\")*+(?:/>|>[^<\s][^<]*</[^\s>]+>|(>)))")
"""A line with one tidy tag or one element with text: the indent, the sign of an end tag, and the end of a start tag."""
_STEP = "  "


def laid_out(text: str, depth: int, *, spread: bool = False) -> str:
    """An element's text with one blank before each attribute, none before the end of a tag, and one on each side of a comment.

    Where it has several lines, or with ``spread``, each node in it has a line of its own, unless an element holds text beside elements;
    ``depth`` counts the elements around it.
    """
    there = _depth_of(text)  # nearly always one, and ten times as fast as the rest: 15 % of reading a robot with many fragments
    if there is not None:
        return _shifted(text, there, depth)
    parts = list(_PART.finditer(text))
    if "".join(part[0] for part in parts) != text:
        return text
    lines = spread or any("\n" in part["text"] for part in parts if part["text"] is not None)
    inner = _depths(parts) if lines else None
    if inner is None:
        return "".join(map(_tidy, parts))
    return "".join(_lines(parts, inner, depth))


def at_depth(text: str, depth: int) -> str:
    """A text of which each line is one tidy tag, with its lines at this depth; any other one as it is."""
    if text.rpartition("\n")[2].startswith(f"{_STEP * depth}<"):
        return text
    there = _depth_of(text)
    return text if there is None else _shifted(text, there, depth)


def _shifted(text: str, there: int, depth: int) -> str:
    return text if there == depth else text.replace(f"\n{_STEP * there}", f"\n{_STEP * depth}")


def _depth_of(text: str) -> int | None:
    """How deep the text is indented where each line is one tidy tag, or one element with text, at its depth; else None."""
    depth: int | None = None
    inner = 0
    was_start = False
    for number, line in enumerate(text.split("\n")):
        found = _TIDY_LINE.fullmatch(line)
        if found is None or (was_start and found[2] is not None):
            return None
        inner -= found[2] is not None
        around, odd = divmod(len(found[1]) - len(_STEP) * inner, len(_STEP))
        depth = around if number == 1 else depth
        if odd or around < 0 or around != (depth if number else 0):
            return None
        was_start = found[3] is not None
        inner += was_start
    return None if inner else depth or 0


def _tidy(part: re.Match[str]) -> str:
    """A part without superfluous white space."""
    if part["comment"] is not None:
        return f"<!-- {part['comment'].strip()} -->" if part["comment"].strip() else part[0]
    if part["closed"] is not None:
        return f"</{part['closed']}>"
    if part["name"] is None:
        return part[0]
    values = ((word[1], word[2]) for word in _ATTRIBUTE.finditer(part["attributes"]))
    texts = (f" {name}={value}" if '"' in value[1:-1] else f' {name}="{value[1:-1]}"' for name, value in values)
    return f"<{part['name']}{''.join(texts)}{part['ends']}>"


def _depths(parts: Sequence[re.Match[str]]) -> list[int | None] | None:
    """For each part how deep its line is indented, None where it stands in the line before it; None where text stands beside elements."""
    depths: list[int | None] = [None] * len(parts)
    around: list[list[int]] = []  # for each open element the parts in it
    for place, part in enumerate(parts):
        if part["closed"] is not None:
            if not around:
                return None
            found = around.pop()
            nodes = [inner for inner in found if parts[inner]["text"] is None and not (parts[inner]["other"] or "").startswith("<![")]
            if nodes and any(not parts[inner][0].isspace() for inner in found if inner not in nodes):
                return None
            for inner in nodes:
                depths[inner] = len(around) + 1
            if nodes:
                depths[place] = len(around)
            continue
        if around:
            around[-1].append(place)
        if part["name"] is not None and not part["ends"]:
            around.append([])
    return None if around else depths


def _lines(parts: Sequence[re.Match[str]], depths: Sequence[int | None], depth: int) -> Iterator[str]:
    """The parts, those with a depth on lines of their own."""
    for place, (part, inner) in enumerate(zip(parts, depths, strict=True)):
        beside = inner is not None or (place + 1 < len(parts) and depths[place + 1] is not None)
        if part["text"] is not None and part[0].isspace() and beside:
            continue
        yield _tidy(part) if inner is None else f"\n{_STEP * (depth + inner)}{_tidy(part)}"
