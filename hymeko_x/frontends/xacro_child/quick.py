"""A DOM that stays fast when a root has very many children.

minidom looks for a node among its siblings from the first one on, several times for each macro call, so that a robot
with thousands of links would take a time that grows with their square. xacro goes through the siblings in order: the
node looked for is next to the one before.
"""

from __future__ import annotations

from typing import Any
from xml.dom.minicompat import NodeList

MANY = 200
BEHIND = 16
AHEAD = 64


def install() -> None:
    """Teach minidom's lists of nodes to look near the last find first. What they find is the same."""
    last: dict[int, int] = {}

    def index(nodes: list[Any], node: Any, *bounds: int) -> int:
        if bounds or len(nodes) < MANY:
            return list.index(nodes, node, *bounds)
        hint = last.get(id(nodes), 0)
        near = range(max(0, hint - BEHIND), min(len(nodes), hint + AHEAD))
        found = next((place for place in near if nodes[place] is node), None)
        last[id(nodes)] = list.index(nodes, node) if found is None else found
        return last[id(nodes)]

    def remove(nodes: list[Any], node: Any) -> None:
        del nodes[index(nodes, node)]

    NodeList.index = index  # type: ignore[method-assign, assignment]
    NodeList.remove = remove  # type: ignore[method-assign]
