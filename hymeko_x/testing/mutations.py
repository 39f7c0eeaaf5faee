"""Damaged texts, for fuzzing: cheap enough for a million cases, and the same for the same seed.

A mutator takes bytes and a random generator and returns bytes. :func:`mutated` picks a few of them, from single bits to
whole subtrees, so that every layer of a reader is tested: decoding, lexing, parsing, and semantics.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import random
    from collections.abc import Callable, Sequence

    Mutator = Callable[[bytes, random.Random, "Sequence[bytes]"], bytes]

MOST_BYTES = 60_000
"""A case never grows larger: large inputs have tests of their own."""

ODD_NUMBERS = (
    *b"nan -nan inf -inf Infinity 1e999 -1e999 1e-999 1e308 1e154 4.9e-324 0 -0 -1 1e9 2147483648 -9223372036854775809".split(),
    *b"99999999999999999999 0x10 0x1p-3 1,5 1_000 1e . + --1 1.2.3 \xd9\xa1 True 1d3 1f".split(),
    *(b"1 2", b"", b" "),
)
"""Numbers, and texts that look like one."""

ODD_WORDS = (
    *b"/ .. ../../etc/passwd /etc/passwd /dev/zero file:///etc/passwd package:// package://a/../../b ~ - --help".split(),
    *b"$(id) ${x} `id` %s %n \\ \\u0000 &#0; &#xD800; &lt; &amp; world true none __class__".split(),
    *b"\xc3\xa9 \xe9 \xf0\x9f\xa4\x96 \xed\xa0\x80 \xef\xbf\xbe \xe2\x80\xae".split(),
    *(b"", b" ", b"a b", b"$(find a)", b"a" * 300),
)
"""Names and paths that lead elsewhere, and bytes that are no text."""

ODD_BYTES = (
    *b"\0 \xff \xfe\xff \xef\xbb\xbf \x1a < > & \" ' ]]> <!-- --> <? <![CDATA[ { } [ ] ( ) @ # // /* \\ = : , ;".split(b" "),
    *(b"\r", b"\x0b", b"\x85"),
)
"""Bytes that no text should have, and those with a meaning in one of the formats."""

_TOKEN = re.compile(rb"[\w.+-]+|\s+|.", re.DOTALL)
_NUMBER = re.compile(rb"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_QUOTED = re.compile(rb'"[^"\n]*"')
_TAG = re.compile(rb"<(/?)([A-Za-z_][\w:.-]*)((?:[^<>\"']|\"[^\"]*\"|'[^']*')*?)(/?)>")
_ATTRIBUTE = re.compile(rb'\s[\w:.-]+="[^"]*"')


def mutated(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """The data after one to four mutations. ``others`` are texts of the same format, from which pieces are taken."""
    ways = MUTATORS
    for _ in range(1 + int(rng.random() ** 2 * 4)):
        data = ways[rng.randrange(len(ways))](data, rng, others)[:MOST_BYTES]
    return data


def _position(data: bytes, rng: random.Random) -> int:
    return rng.randrange(len(data) + 1)


def flip_bits(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """A few bytes become others."""
    if not data:
        return b"\0"
    changed = bytearray(data)
    for _ in range(rng.randint(1, 4)):
        changed[rng.randrange(len(changed))] ^= 1 << rng.randrange(8)
    return bytes(changed)


def cut(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """The end is missing."""
    return data[: _position(data, rng)]


def lose(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """A piece is missing."""
    at = _position(data, rng)
    return data[:at] + data[at + rng.randint(1, 40) :]


def put_bytes(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """Odd bytes are inserted."""
    at = _position(data, rng)
    return data[:at] + rng.choice(ODD_BYTES) * rng.choice((1, 1, 1, 2, 50)) + data[at:]


def swap_tokens(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """Two tokens change places, or one is lost or repeated."""
    start = _position(data, rng)
    pieces = _TOKEN.findall(data[start : start + 200])
    if len(pieces) < 2:
        return data
    i, j = rng.randrange(len(pieces)), rng.randrange(len(pieces))
    match rng.randrange(3):
        case 0:
            pieces[i], pieces[j] = pieces[j], pieces[i]
        case 1:
            pieces[i] = b""
        case _:
            pieces.insert(i, pieces[j])
    return data[:start] + b"".join(pieces) + data[start + 200 :]


def odd_number(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """One of the numbers becomes something else."""
    return _replaced(data, _NUMBER, rng, rng.choice(ODD_NUMBERS))


def odd_word(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """One of the quoted texts becomes something else."""
    word = rng.choice(ODD_WORDS if rng.random() < 0.7 else ODD_NUMBERS)
    return _replaced(data, _QUOTED, rng, b'"' + word + b'"')


def same_word(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """One of the quoted texts becomes another one of them: names clash, references lead elsewhere, cycles close."""
    found = _near(data, _QUOTED, rng)
    other = _near(data, _QUOTED, rng)
    if found is None or other is None:
        return data
    return data[: found.start()] + other[0] + data[found.end() :]


def splice(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """A piece of another text is inserted."""
    other = rng.choice(others)
    start, at = _position(other, rng), _position(data, rng)
    return data[:at] + other[start : start + rng.randint(1, 300)] + data[at:]


def repeat(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """A piece is repeated many times."""
    at = _position(data, rng)
    return data[:at] + data[at : at + rng.randint(1, 60)] * rng.randint(2, 30) + data[at:]


def move_element(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """An element of an XML text is lost, repeated, or moved."""
    element = _element(data, rng)
    if element is None:
        return data
    start, end = element
    piece, way = data[start:end], rng.randrange(3)
    rest = data if way == 1 else data[:start] + data[end:]
    if way == 0:
        return rest
    tag = _near(rest, _TAG, rng)
    at = tag.end() if tag is not None else len(rest)
    return rest[:at] + piece + rest[at:]


def take_element(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """An element of another XML text is inserted."""
    other = rng.choice(others)
    element, tag = _element(other, rng), _near(data, _TAG, rng)
    if element is None or tag is None:
        return data
    return data[: tag.end()] + other[element[0] : element[1]] + data[tag.end() :]


def rename_element(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """An element of an XML text gets the name of another one."""
    tag, other = _near(data, _TAG, rng), _near(rng.choice(others), _TAG, rng)
    if tag is None or other is None:
        return data
    renamed = data[: tag.start(2)] + other[2] + data[tag.end(2) :]
    closing = b"</" + tag[2] + b">"
    at = renamed.find(closing, tag.end())
    if tag[4] or at < 0:
        return renamed
    return renamed[:at] + b"</" + other[2] + b">" + renamed[at + len(closing) :]


def change_attribute(data: bytes, rng: random.Random, others: Sequence[bytes]) -> bytes:
    """An attribute of an XML text is lost, or one of another text is inserted."""
    if rng.random() < 0.5:
        return _replaced(data, _ATTRIBUTE, rng, b"")
    tag, other = _near(data, _TAG, rng), _near(rng.choice(others), _ATTRIBUTE, rng)
    if tag is None or other is None or tag[1]:
        return data
    return data[: tag.end(2)] + other[0] + data[tag.end(2) :]


MUTATORS: tuple[Mutator, ...] = (
    flip_bits,
    cut,
    lose,
    put_bytes,
    swap_tokens,
    swap_tokens,
    odd_number,
    odd_number,
    odd_word,
    odd_word,
    same_word,
    same_word,
    splice,
    repeat,
    move_element,
    move_element,
    take_element,
    rename_element,
    change_attribute,
    change_attribute,
)
"""Every way to damage a text; those that leave it readable are listed twice, because they reach furthest."""


def _near(data: bytes, pattern: re.Pattern[bytes], rng: random.Random) -> re.Match[bytes] | None:
    """The first match behind a random position."""
    return pattern.search(data, _position(data, rng)) or pattern.search(data)


def _replaced(data: bytes, pattern: re.Pattern[bytes], rng: random.Random, new: bytes) -> bytes:
    found = _near(data, pattern, rng)
    return data if found is None else data[: found.start()] + new + data[found.end() :]


def _element(data: bytes, rng: random.Random) -> tuple[int, int] | None:
    """Start and end of a random element of an XML text, roughly: an empty tag, or up to the first closing tag of its name."""
    tag = _near(data, _TAG, rng)
    if tag is None or tag[1]:
        return None
    if tag[4]:
        return tag.start(), tag.end()
    closing = b"</" + tag[2] + b">"
    at = data.find(closing, tag.end())
    return (tag.start(), at + len(closing)) if at >= 0 else None
