"""A TextMate grammar, as far as ours goes: rules with `match`, or with `begin` and `end`, whose patterns Python understands as well."""

from __future__ import annotations

import re
from functools import cache
from typing import Any

Grammar = dict[str, Any]
Scopes = list[tuple[str, ...]]


def scopes(grammar: Grammar, text: str) -> Scopes:
    """The scopes of each character, from the outermost."""
    found: Scopes = [(grammar["scopeName"],)] * len(text)
    open_: list[Grammar] = []
    start = 0
    for line in text.splitlines(keepends=True):
        place = 0
        while place <= len(line):
            around = (grammar["scopeName"], *(rule["name"] for rule in open_ if "name" in rule))
            rules = _rules(grammar, (open_[-1] if open_ else grammar).get("patterns", []))
            end = _pattern(open_[-1]["end"]).search(line, place) if open_ else None
            matches = ((hit.start(), number, hit, rule) for number, rule in enumerate(rules) if (hit := _hit(rule, line, place)))
            first = min(matches, default=None, key=lambda found: found[:2])
            if end is not None and (first is None or end.start() <= first[0]):
                _paint(found, start + place, start + end.end(), around)
                open_.pop()
                place = end.end()
                continue
            if first is None:
                _paint(found, start + place, start + len(line), around)
                break
            _, _, hit, rule = first
            _paint(found, start + place, start + hit.start(), around)
            inner = (*around, rule["name"]) if "name" in rule else around
            _paint(found, start + hit.start(), start + hit.end(), inner)
            for number, capture in rule.get("captures", {}).items():
                _paint(found, start + hit.start(int(number)), start + hit.end(int(number)), (*inner, capture["name"]))
            if "begin" in rule:
                open_.append(rule)
            place = hit.end() if hit.end() > place or "begin" in rule else place + 1
        start += len(line)
    return found


def _paint(found: Scopes, start: int, end: int, names: tuple[str, ...]) -> None:
    found[start:end] = [names] * (end - start)


def _rules(grammar: Grammar, patterns: list[Grammar]) -> list[Grammar]:
    """The rules of a list, those of the repository in the place of their names."""
    found: list[Grammar] = []
    for rule in patterns:
        found += _rules(grammar, grammar["repository"][rule["include"][1:]]["patterns"]) if "include" in rule else [rule]
    return found


@cache
def _pattern(text: str) -> re.Pattern[str]:
    return re.compile(text, re.MULTILINE)


def _hit(rule: Grammar, line: str, place: int) -> re.Match[str] | None:
    return _pattern(rule.get("match") or rule["begin"]).search(line, place)
