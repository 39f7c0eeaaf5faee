"""The lines at which the prims of a text layer begin: USD keeps none."""

from __future__ import annotations

import re

_PRIM = re.compile(rb'^([ \t]*)(?:def|over|class)\b[ \t]*(?:[\w:]+[ \t]+)?"([^"\n]*)"', re.MULTILINE)


def lines_of_prims(data: bytes) -> dict[str, int]:
    """The line of each prim by its path, in a layer whose prims are indented as they are nested; none in a binary layer."""
    lines: dict[str, int] = {}
    above: list[tuple[int, str]] = []
    line, counted = 1, 0
    for found in _PRIM.finditer(data) if data.startswith((b"#usda", b"#sdf")) else ():
        indent = len(found[1].expandtabs(4))
        while above and above[-1][0] >= indent:
            above.pop()
        path = f"{above[-1][1] if above else ''}/{found[2].decode('utf-8', 'replace')}"
        above.append((indent, path))
        line += data.count(b"\n", counted, found.start())
        counted = found.start()
        lines.setdefault(path, line)
    return lines


def line_of(path: str, lines: dict[str, int]) -> int | None:
    """The line of a prim, or of the nearest one above that stands in the layer: the one that brings it from elsewhere."""
    while path not in lines and path:
        path = path.rpartition("/")[0]
    return lines.get(path)
