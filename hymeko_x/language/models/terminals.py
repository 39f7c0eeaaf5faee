"""The terminals in plain regular expressions: without priorities, look-around and classes of Unicode, which those programs do not have.

A terminal that hymeko.lark defines plainly is taken from there; the others are written here, each as a part of the original.
"""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x.language.terminals import KEYWORDS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

_FIRST = "A-Za-z_"
_NEXT = "A-Za-z0-9_"
_OTHER_LETTERS = "À-ÖØ-öø-ʯΑ-ΡΣ-ώА-ҁぁ-ゖァ-ヺ一-鿯가-힣"
"""Letters beyond ASCII that names may have without quotes: Latin, Greek, Cyrillic, kana, CJK, Hangul. In backticks any letter may stand."""


def words_except(words: Iterable[str]) -> str:
    """The pattern of names that are none of these words of small ASCII letters."""
    return _except(frozenset(words), _FIRST)


def _except(words: frozenset[str], letters: str) -> str:
    """The pattern of what is none of the words, whose first letter is one of these. No deeper than the words are long."""
    heads = sorted({word[0] for word in words if word})
    tail = f"[{_NEXT}{_OTHER_LETTERS}]*"
    found = [f"[{_without(letters, heads)}{_OTHER_LETTERS}]{tail}"]
    for head in heads:
        rests = frozenset(word[1:] for word in words if word.startswith(head))
        inner = _except(rests - {""}, _NEXT) if rests - {""} else f"[{_NEXT}{_OTHER_LETTERS}]{tail}"
        found.append(f"{head}(?:{inner})" + ("" if "" in rests else "?"))
    return "|".join(found)


def _without(letters: str, left_out: list[str]) -> str:
    """A class of ASCII letters without some."""
    kept = [chr(code) for code in range(128) if re.match(f"[{letters}]", chr(code)) and chr(code) not in left_out]
    return "".join(kept)


_QUOTED_NAME = r"`(?:[^`\\\n]|\\[^\n])+`"
_DECIMAL = r"(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_IN_UNITS = f"A-Za-z0-9_%{_OTHER_LETTERS}"

PLAIN: Mapping[str, str] = MappingProxyType(
    {
        "NAME": f"{words_except(KEYWORDS)}|{_QUOTED_NAME}",
        "STRING": r'"(?:[^"\\]|\\[^\n])*"|' + r"'(?:[^'\\]|\\[^\n])*'|" + r'"""(?:"?"?[^"])*"""',
        "EXPRESSION": r"\$\{[^{}]*\}",
        "EDGE_WORD": "@",
    }
)
"""Instead of the terminals of these names."""
WITHIN: Mapping[str, str] = MappingProxyType(
    {
        "PLUS-MINUS": "[+-]",
        "MINUS": "-",
        "ARROW": "->|<-|<>|~",
        "UNSIGNED": f"{_DECIMAL}|inf|nan",
        "WITH-UNIT": f"{_DECIMAL}(?:[A-DF-Za-df-z%°µ][{_IN_UNITS}]*|[eE][A-Za-z_%][{_IN_UNITS}]*)",
        "TIMES": "[/*·]",
        "UNIT": f"[{_IN_UNITS}]+",
        "POWER": r"\^-?[0-9]+",
    }
)
"""The parts of numbers, quantities and directions."""
DROPPED = frozenset({"NUMBERS", "MATRIX", "QUOTED_REF", "LEGACY_HEADER", "CONSTANT", "USING", "SEMICOLON", "group"})
"""Lists are the rule `vector`; the others, the group of arcs among them, are forms that no text is printed in."""

_COMMENT = r"(?:#|//)[^\n]*\n|/\*(?:[^*]|\*+[^*/])*\*+/"
BLANKS = rf"(?:[ \t\r\n]|{_COMMENT})+"
"""What stands between two words."""
