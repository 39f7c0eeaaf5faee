"""The incidence graph for other programs: DOT of Graphviz, Mermaid, and D2. They make their own layout."""

from __future__ import annotations

import json
from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x.draw.graph.letters import shown

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.draw.graph.diagram import Diagram, DrawnArc, DrawnNode


def dot(shape: Diagram) -> str:
    """Graphviz: circles and boxes; arcs without direction have no arrow."""
    numbers = _numbers(shape)
    nodes = (
        f"  {numbers[node.key]} [shape={'box' if node.is_edge else 'ellipse'}, label={_dot_label(node)}];" for node in shape.nodes.values()
    )
    lines = (
        f"  {_joined(line, numbers, '->', '->')} [label={_text(line.label)}{'' if line.sign else ', dir=none'}];" for line in shape.lines
    )
    return "\n".join((f"digraph {_text(shown(shape.name))} {{", "  rankdir=LR;", *nodes, *lines, "}\n"))


def mermaid(shape: Diagram) -> str:
    """A Mermaid flowchart, as Markdown pages of GitHub and GitLab show it."""
    numbers = _numbers(shape)
    nodes = (f"  {numbers[node.key]}{_mermaid_shape(node)}" for node in shape.nodes.values())
    lines = (f"  {_mermaid_line(line, numbers)}" for line in shape.lines)
    return "\n".join(("flowchart LR", *nodes, *lines, ""))


def d2(shape: Diagram) -> str:
    """D2: ovals and rectangles."""
    numbers = _numbers(shape)
    nodes = (
        f"{numbers[node.key]}: {_d2_text(_words(node, ' · '))} {{shape: {'rectangle' if node.is_edge else 'oval'}}}"
        for node in shape.nodes.values()
    )
    lines = (f"{_joined(line, numbers, '->', '--')}: {_d2_text(line.label)}" for line in shape.lines)
    return "\n".join(("direction: right", *nodes, *lines, ""))


WRITERS: Mapping[str, Callable[[Diagram], str]] = MappingProxyType({".dot": dot, ".mmd": mermaid, ".d2": d2})
"""The writer of each suffix."""


_PLAIN = frozenset(" _-+~.°·−…")


def _numbers(shape: Diagram) -> dict[object, str]:
    """Names of nodes that every language takes: the names of elements are only labels."""
    return {key: f"n{number}" for number, key in enumerate(shape.nodes)}


def _joined(line: DrawnArc, numbers: Mapping[object, str], arrow: str, undirected: str) -> str:
    """The two ends of an arc along its direction, with an arrow between them."""
    ends = (numbers[line.target], numbers[line.edge])
    start, end = ends[::-1] if line.sign < 0 else ends
    return f"{start} {arrow if line.sign else undirected} {end}"


def _words(node: DrawnNode, between: str) -> str:
    return between.join(filter(None, (node.label, node.facts)))


def _dot_label(node: DrawnNode) -> str:
    return _text(_words(node, "\n"))


def _mermaid_line(line: DrawnArc, numbers: Mapping[object, str]) -> str:
    label = f"|{_mermaid_text(line.label)}|"
    return _joined(line, numbers, f"-->{label}", f"---{label}")


def _text(words: str) -> str:
    """A text in double quotes for DOT, which knows the escapes of JSON, and entities of HTML."""
    return json.dumps(words.replace("&", "&amp;"), ensure_ascii=False)


def _mermaid_shape(node: DrawnNode) -> str:
    words = _mermaid_text(node.label) + (f"<br/>{_mermaid_text(node.facts)}" if node.facts else "")
    return f'["{words}"]' if node.is_edge else f'(["{words}"])'


def _mermaid_text(words: str) -> str:
    """Text in which nothing is markup of HTML or Mermaid: all but letters, digits and a few signs are entities."""
    return "".join(letter if letter.isalnum() or letter in _PLAIN else f"#{ord(letter)};" for letter in words)


def _d2_text(words: str) -> str:
    """A text in single quotes, within which D2 knows neither escapes nor variables."""
    return "'" + words.replace("'", "''") + "'"
