"""The lines at which the prims of a text layer begin: USD keeps none."""

from __future__ import annotations

import re

_PRIM = re.compile(rb'\n([ \t]*)(?:def|over|class)\b[ \t]*(?:[\w:]+[ \t]+)?"([^"\n]*)"')
"""The start of a prim. It begins with a newline, for which a search skips the long lines of meshes, unlike for `^`."""

Lines = dict[tuple[int, str], int]
"""The line of each prim, by the line of its parent (0 = it has none) and its name: linear in the text, however deep it is."""


def lines_of_prims(data: bytes) -> Lines:
    """The lines of the prims of a layer that are indented as they are nested; none in a binary layer."""
    lines: Lines = {}
    above: list[tuple[int, int]] = [(-1, 0)]  # the indents and lines of the prim and of those around it
    line, counted = 1, 0
    for found in _PRIM.finditer(data) if data.startswith((b"#usda", b"#sdf")) else ():
        indent = len(found[1].expandtabs(4))
        while above[-1][0] >= indent:
            above.pop()
        line += data.count(b"\n", counted, found.start(1))
        counted = found.start(1)
        above.append((indent, lines.setdefault((above[-1][1], found[2].decode("utf-8", "replace")), line)))
    return lines


def line_of(path: str, lines: Lines) -> int | None:
    """The line of a prim, or of the nearest one above that stands in the layer: the one that brings it from elsewhere."""
    line = 0
    for name in path.split("/")[1:]:
        below = lines.get((line, name))
        if below is None:
            break
        line = below
    return line or None
