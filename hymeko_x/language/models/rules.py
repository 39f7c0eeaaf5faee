"""The rules of hymeko.lark as plain rules: without left recursion, and with the blanks that keep words apart.

The parser of the language finds words by their longest match; rules over characters have to say where a blank must stand. Which blank
may be missing depends on the words beside it, so each rule comes in variants: for what stands before it, and for how it ends.
"""

from __future__ import annotations

from enum import Enum
from itertools import product
from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x.language.grammar import grammar_text
from hymeko_x.language.models.terminals import DROPPED, PLAIN, WITHIN

if TYPE_CHECKING:
    from collections.abc import Iterator

Rules = dict[str, list[tuple[str, ...]]]
"""By name the alternatives of a rule; names of terminals are in capitals."""

START = "start"
BLANKS, GAP = "BLANKS", "GAP"
"""Blanks or comments that must stand, and that may."""


class Before(Enum):
    """What stands before a word: a name, a number, a string, or a sign, behind which nothing needs a blank."""

    NAME = "n"
    NUMBER = "v"
    STRING = "t"
    SIGN = "s"


_SIGNS = frozenset("{}()[],:=<>.")
_NEEDS_A_BLANK = MappingProxyType(
    {
        "NAME": {Before.NAME, Before.NUMBER},
        "NUMBER": {Before.NAME, Before.NUMBER},
        "QUANTITY": {Before.NAME, Before.NUMBER},
        "STRING": {Before.STRING},
        "DIRECTION": {Before.NUMBER},
        "MODIFIER": {Before.NUMBER},
    }
)
"""Before which words a terminal needs a blank; keywords are as names."""
_ENDS = MappingProxyType({"NUMBER": Before.NUMBER, "QUANTITY": Before.NUMBER, "STRING": Before.STRING})
_ENDS_IN_A_SIGN = frozenset({"DIRECTION", "MODIFIER", "EDGE_WORD", "EXPRESSION", "QUERY"})
_WAYS = MappingProxyType(
    {
        "NUMBER": (("UNSIGNED",), ("PLUS-MINUS", "UNSIGNED")),
        "QUANTITY": (("WITH-UNIT", "unit-rest"), ("PLUS-MINUS", "WITH-UNIT", "unit-rest")),
        "DIRECTION": (("PLUS-MINUS",), ("ARROW",)),
    }
)
"""Terminals as sequences of parts without a blank between: a sign is a part of its own, for programs with a lexer do not go back to it."""
_UNIT_REST = [("TIMES", "UNIT", "unit-rest"), ("MINUS", "UNIT", "unit-rest"), ("POWER", "unit-rest"), ()]
"""The rule of what follows the first unit: ``2N*m/rad``."""


def plain_rules() -> tuple[Rules, dict[str, str]]:
    """The rules from ``start``, and the patterns of the terminals that they name."""
    rules, patterns = _lark_rules()
    rules = _useful(_without_left_recursion(_useful(rules)), START)
    spaced = _useful(_renamed(_spaced(rules, patterns)), START)
    used = {symbol for choices in spaced.values() for choice in choices for symbol in choice}
    return spaced, {name: pattern for name, pattern in {**patterns, **WITHIN}.items() if name in used}


def _lark_rules() -> tuple[Rules, dict[str, str]]:
    """The rules as lark expands them, without those that need a dropped terminal; patterns of the terminals."""
    from lark import Lark
    from lark.lexer import PatternStr

    lark = Lark(grammar_text(), parser="lalr", maybe_placeholders=False)
    patterns: dict[str, str] = {}
    for terminal in lark.terminals:
        found = terminal.pattern
        patterns[terminal.name] = PLAIN.get(terminal.name) or (_escaped(found.value) if isinstance(found, PatternStr) else found.value)
    rules: Rules = {}
    for rule in lark.rules:
        symbols = tuple(symbol.name if symbol.is_term else _named(symbol.name) for symbol in rule.expansion)
        if DROPPED.isdisjoint(symbols):
            rules.setdefault(_named(rule.origin.name), []).append(symbols)
    rules[START] = [choice for choice in rules[START] if choice]
    return rules, patterns


def _escaped(text: str) -> str:
    return "".join(rf"\{letter}" if letter in r"\[](){}*+?|.^$" else letter for letter in text)


def _named(name: str) -> str:
    """The name of a rule without the signs that not every program takes: ``__block_star_0`` becomes ``block_star_0``."""
    return name.lstrip("_").replace("_", "-")


# ---- recursion -----------------------------------------------------------------------------------------------------------


def _without_left_recursion(rules: Rules) -> Rules:
    """The same language without left recursion.

    Rules that begin with each other are an automaton: ``A -> B x`` is a step from B to A. What A derives begins with an alternative that
    leaves the group, and goes on along the steps that lead to A.
    """
    result = dict(rules)
    for group in _groups(rules):
        entries = [(name, choice) for name in group for choice in rules[name] if choice[:1] == () or choice[0] not in group]
        steps = [(choice[0], choice[1:], name) for name in group for choice in rules[name] if choice and choice[0] in group]
        for name in group:
            result[name] = [(*choice, f"{first}-to-{name}") for first, choice in entries]
            for first in group:
                onward = [(*rest, f"{then}-to-{name}") for before, rest, then in steps if before == first]
                result[f"{first}-to-{name}"] = [*onward, ()] if first == name else onward
    return result


def _groups(rules: Rules) -> list[list[str]]:
    """The rules that begin with each other, and those that begin with themselves."""
    reach = {name: {choice[0] for choice in choices if choice and choice[0] in rules} for name, choices in rules.items()}
    for through, name in product(reach, reach):
        if through in reach[name]:
            reach[name] |= reach[through]
    found: list[list[str]] = []
    for name in rules:
        group = [other for other in rules if other in reach[name] and name in reach[other]]
        if name in group and group not in found:
            found.append(group)
    return found


# ---- blanks ------------------------------------------------------------------------------------------------------------------


def _spaced(rules: Rules, patterns: dict[str, str]) -> Rules:
    """The rules in variants ``name-b-e``: b is what stands before, e what it ends with."""
    spaced: Rules = {START: [(GAP, f"{START}-s-{end.value}", GAP) for end in Before], "unit-rest": _UNIT_REST}
    for name, choices in rules.items():
        for before in Before:
            for choice in choices:
                for end, symbols in _ways(choice, before, rules, patterns):
                    spaced.setdefault(f"{name}-{before.value}-{end.value}", []).append(symbols)
    return spaced


def _ways(choice: tuple[str, ...], before: Before, rules: Rules, patterns: dict[str, str]) -> Iterator[tuple[Before, tuple[str, ...]]]:
    """How an alternative goes on from what stands before: what it ends with, and its symbols with blanks."""
    ways: list[tuple[Before, tuple[str, ...]]] = [(before, ())]
    for symbol in choice:
        if symbol in rules:
            ways = [(end, (*done, f"{symbol}-{now.value}-{end.value}")) for now, done in ways for end in Before]
        else:
            ways = [(end, (*done, *more)) for now, done in ways for end, more in _after(symbol, patterns[symbol], now)]
    yield from ways


def _after(symbol: str, pattern: str, now: Before) -> Iterator[tuple[Before, tuple[str, ...]]]:
    """Behind what stands there a terminal, with the blank that must or may stand between: each way."""
    is_sign = pattern.replace("\\", "") in _SIGNS or symbol in _ENDS_IN_A_SIGN
    needs = _NEEDS_A_BLANK.get(symbol, set() if is_sign else _NEEDS_A_BLANK["NAME"])
    end = Before.SIGN if is_sign else _ENDS.get(symbol, Before.NAME)
    for parts in _WAYS.get(symbol, ((symbol,),)):
        yield end, (BLANKS if now in needs else GAP, *parts)


# ---- order -------------------------------------------------------------------------------------------------------------------


def _renamed(rules: Rules) -> Rules:
    """The rules, of which those with the same alternatives are one."""
    while True:
        first: dict[tuple[tuple[str, ...], ...], str] = {}
        same = {name: first.setdefault(tuple(dict.fromkeys(choices)), name) for name, choices in rules.items()}
        if all(name == other for name, other in same.items()):
            return rules
        kept = {name: choices for name, choices in rules.items() if same[name] == name}
        rules = {
            name: [*dict.fromkeys(tuple(same.get(symbol, symbol) for symbol in choice) for choice in choices)]
            for name, choices in kept.items()
        }


def _useful(rules: Rules, start: str = START) -> Rules:
    """The rules that derive a text and are reached from the start."""
    good: set[str] = set()

    def is_good(choice: tuple[str, ...]) -> bool:
        return all(symbol in good or symbol.isupper() for symbol in choice)

    while more := {name for name, choices in rules.items() if name not in good and any(map(is_good, choices))}:
        good |= more
    kept = {name: [choice for choice in choices if is_good(choice)] for name, choices in rules.items() if name in good}
    todo, reached = [start], {start: None}
    for name in todo:
        inside = [symbol for choice in kept[name] for symbol in choice if symbol in kept and symbol not in reached]
        reached |= dict.fromkeys(inside)
        todo += list(dict.fromkeys(inside))
    return {name: kept[name] for name in reached}
