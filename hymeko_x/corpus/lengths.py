"""How long a robot description is: bytes, characters, tokens of its format's own lexer, and compressed bytes."""

from __future__ import annotations

import gzip
import json
import re
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING

from hymeko_x.frozen import frozen

if TYPE_CHECKING:
    from collections.abc import Iterator

_XML_PARTS = re.compile(r"<!--.*?-->|<!\[CDATA\[.*?\]\]>|<[^<>\"']*(?:\"[^\"]*\"[^<>\"']*|'[^']*'[^<>\"']*)*>|[^<]+|<", re.DOTALL)
_XML_TOKEN = re.compile(r"\"[^\"]*\"|'[^']*'|</|/>|<\?|\?>|<!|[<>=]|[^\s<>=\"'/?]+")
_USD_TOKEN = re.compile(
    r"(?P<space>\s+)|(?P<comment>(?!#usda)#[^\n]*|//[^\n]*|/\*.*?\*/)"
    r"|(?P<token>#usda[^\n]*|\"{3}.*?\"{3}|'{3}.*?'{3}|\"(?:[^\"\\\n]|\\.)*\"|'(?:[^'\\\n]|\\.)*'|@{3}.*?@{3}|@[^@\n]*@|<[^>\n]*>"
    r"|[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[^\W\d][\w:]*|.)",
    re.DOTALL,
)
_BINARY = (b"PXR-USDC", b"PK\x03\x04")
MOST_BYTES = 2**20
"""Longer texts hold the points of meshes, which says nothing about the language; of them only the bytes are counted."""


@frozen
class Lengths:
    """``characters`` are those that are no white space, ``code`` those of them that stand outside comments.

    Binary files, and texts beyond 1 MiB, have bytes only; the rest is None. ``gzip`` is the size at level 9, without name and time.
    """

    bytes: int
    characters: int | None = None
    code: int | None = None
    tokens: int | None = None
    gzip: int | None = None


def lengths(data: bytes, format: str) -> Lengths:
    """How long a file of this format is."""
    if data.startswith(_BINARY) or len(data) > MOST_BYTES:
        return Lengths(len(data))
    text = data.decode("utf-8", "replace")
    tokens = tokens_of(text, format)
    return Lengths(len(data), _black(text), sum(map(_black, tokens)), len(tokens), len(gzip.compress(data, 9, mtime=0)))


def tokens_of(text: str, format: str) -> list[str]:
    """The tokens of a text as its format's own lexer sees them, without comments and white space.

    XML: brackets, names, equal signs and quoted values, and runs of text; a list of numbers in an attribute is one token,
    as is a list of numbers in HyMeKo. USD: names, numbers, strings, paths, asset references and punctuation.
    """
    if format in ("urdf", "xacro", "mjcf", "sdf"):
        return list(_xml_tokens(text))
    return _plain_tokens(text, _USD_TOKEN if format.startswith("usd") else _hymeko_token())


def _black(text: str) -> int:
    """The characters that are no white space."""
    return sum(map(len, text.split()))


def _plain_tokens(text: str, pattern: re.Pattern[str]) -> list[str]:
    return [match[0] for match in pattern.finditer(text) if match.lastgroup == "token"]


def _xml_tokens(text: str) -> Iterator[str]:
    for part in _XML_PARTS.finditer(text):
        word = part[0]
        if word.startswith("<!--"):
            continue
        if word.startswith("<") and not word.startswith("<![CDATA["):
            yield from (token[0] for token in _XML_TOKEN.finditer(word))
        elif not word.isspace():
            yield word


@cache
def _hymeko_token() -> re.Pattern[str]:
    """The language's terminals, in the order in which its lexer tries them."""
    tables = json.loads(files("hymeko_x.language").joinpath("tables.json").read_text(encoding="utf-8"))
    comment, space = tables["ignored"]
    terminals = "|".join(f"(?:{pattern})" for name, pattern in tables["terminals"] if name not in tables["opening"])
    return re.compile(f"(?P<space>{space})|(?P<comment>{comment})|(?P<token>{terminals}|.)", re.DOTALL)
