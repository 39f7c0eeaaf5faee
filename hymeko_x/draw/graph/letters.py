"""Text in pictures: how wide it is, and how names from anywhere are written."""

from __future__ import annotations

import textwrap
import unicodedata

LETTER = 0.61
"""The width of a letter by its size. Labels are in a monospaced font: DejaVu Sans Mono and Menlo have 0.602, the others less."""
WIDE_LETTER = 1.22
"""The same of East Asian wide letters, which take two columns."""
HEIGHT = 1.2
"""The height of a line by the size of its letters; the base line is at 0.9 of it."""
_LONGEST = 48
_INVISIBLE = frozenset({"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"})


def width(text: str, size: float) -> float:
    """How wide a line is at most, in the unit of the letters' size."""
    if text.isascii():
        return len(text) * LETTER * size
    return sum(WIDE_LETTER if unicodedata.east_asian_width(letter) in "WF" else LETTER for letter in text) * size


def shown(name: str) -> str:
    """A name in one line of at most 48 visible letters."""
    return cut(visible(name))


def visible(text: str) -> str:
    """A text in one line of visible letters: controls and marks that turn the direction of writing are escapes, as in HyMeKo text."""
    if text.isascii() and text.isprintable():
        return text
    return "".join(rf"\u{ord(letter):04x}" if unicodedata.category(letter) in _INVISIBLE else letter for letter in text)


def cut(text: str) -> str:
    """A text of at most 48 letters: of a longer one the beginning and the end."""
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST // 2]}…{text[1 - _LONGEST // 2 :]}"


def lines(words: list[str], longest: int = 72) -> list[str]:
    """Words as lines of about so many letters, none of them broken."""
    joined = textwrap.wrap(" ".join(word.replace(" ", "\u00a0") for word in words), longest, break_long_words=False, break_on_hyphens=False)
    return [line.replace("\u00a0", " ") for line in joined]
