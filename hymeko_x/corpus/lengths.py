"""How long a robot description is: bytes, characters, tokens of its format's own lexer, and compressed bytes."""

from __future__ import annotations

import gzip
import re

from msgspec import Struct

from hymeko_x import formats

_XML_PARTS = re.compile(r"<!--.*?-->|<!\[CDATA\[.*?\]\]>|<[^<>\"']*(?:\"[^\"]*\"[^<>\"']*|'[^']*'[^<>\"']*)*>|[^<]+|<", re.DOTALL)
_XML_TOKEN = re.compile(r"\"[^\"]*\"|'[^']*'|</|/>|<\?|\?>|<!|[<>=]|[^\s<>=\"'/?]+")
_BINARY = (b"PXR-USDC", b"PK\x03\x04")
MOST_BYTES = 2**20
"""Longer texts hold the points of meshes, which are no measure of the language; of them only the bytes are counted."""


class Lengths(Struct, frozen=True):
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
    lexer = formats.by_name(format).tokens
    tokens = formats.loaded(lexer)(text) if lexer else text.split()
    return Lengths(len(data), _black(text), sum(map(_black, tokens)), len(tokens), len(gzip.compress(data, 9, mtime=0)))


def xml_tokens(text: str) -> list[str]:
    """The tokens of XML, without comments and white space: brackets, names, equal signs and quoted values, and runs of text.

    A list of numbers in an attribute is one token.
    """
    found: list[str] = []
    for part in _XML_PARTS.finditer(text):
        word = part[0]
        if word.startswith("<!--"):
            continue
        if word.startswith("<") and not word.startswith("<![CDATA["):
            found += [token[0] for token in _XML_TOKEN.finditer(word)]
        elif not word.isspace():
            found.append(word)
    return found


def _black(text: str) -> int:
    """The characters that are no white space."""
    return sum(map(len, text.split()))
