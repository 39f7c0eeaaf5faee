"""Canonical XML of SDF: what two files have in common that mean the same to every reader, letter by letter."""

from __future__ import annotations

from lxml import etree

from hymeko_x.xml.tree import read_numbers


def canonical(data: bytes) -> list[str]:
    """A line for each element: attributes sorted, numbers as doubles, children sorted by tag and name, others of one tag as they are."""
    root = etree.fromstring(data, etree.XMLParser(remove_blank_text=True, huge_tree=True, recover=True))
    lines: list[str] = []
    stack = [(root, 0)]
    while stack:
        node, depth = stack.pop()
        if not isinstance(node.tag, str):
            lines.append(f"{' ' * depth}<!--{(node.text or '').strip()}-->" if depth < 2 else "")
            continue
        attributes = " ".join(f"{name}={_value(text)}" for name, text in sorted(node.attrib.items()))
        lines.append(f"{' ' * depth}{node.tag} {attributes} {_value(node.text or '')}".rstrip())
        members = sorted(node, key=lambda child: (child.tag, child.get("name", "")) if isinstance(child.tag, str) else ("", ""))
        stack += [(child, depth + 1) for child in reversed(members)]
    return [line for line in lines if line]


def _value(text: str) -> str:
    numbers = read_numbers(text)
    return " ".join(repr(number + 0.0) for number in numbers) if numbers else " ".join(text.split())
