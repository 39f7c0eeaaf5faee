"""The tokens of USD text: names, numbers, strings, paths, asset references and punctuation."""

from __future__ import annotations

import re

_TOKEN = re.compile(
    r"(?P<space>\s+)|(?P<comment>(?!#usda)#[^\n]*|//[^\n]*|/\*.*?\*/)"
    r"|(?P<token>#usda[^\n]*|\"{3}.*?\"{3}|'{3}.*?'{3}|\"(?:[^\"\\\n]|\\.)*\"|'(?:[^'\\\n]|\\.)*'|@{3}.*?@{3}|@[^@\n]*@|<[^>\n]*>"
    r"|[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[^\W\d][\w:]*|.)",
    re.DOTALL,
)


def tokens(text: str) -> list[str]:
    """The tokens of a text, without comments and white space."""
    return [match[0] for match in _TOKEN.finditer(text) if match.lastgroup == "token"]
