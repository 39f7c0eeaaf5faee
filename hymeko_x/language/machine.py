"""A lexer and an LALR(1) machine, run on the tables that lark computed (tables.json). Independent of the language.

lark's own driver spends most of its time on token objects and call layers; this one keeps plain strings and offsets and
reads four times as fast (benchmarks/parse.py). It accepts the same texts (a test compares them on generated ones).
"""

from __future__ import annotations

import json
import re
from bisect import bisect_right
from collections.abc import Callable
from importlib.resources import files
from operator import itemgetter
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

MAX_DEPTH = 200
"""Brackets inside brackets; far more than any robot has, and less than what the later stages can nest."""

GAP_DEPTH = 2
"""Gaps between tokens are collected outside of all brackets, and inside this many."""

_DEPTH = {"{": 1, "[": 1, "(": 1, "}": -1, "]": -1, ")": -1}


class ParseError(Exception):
    """The text is not in the language; ``offset`` is where that shows. lark's own parser finds the words for it."""

    def __init__(self, offset: int) -> None:
        super().__init__(offset)
        self.offset = offset


class TooDeep(ParseError):
    """More brackets inside brackets than the limit."""


class Lines:
    """Offsets to one-based lines and columns."""

    def __init__(self, text: str) -> None:
        self._starts = [0, *(match.end() for match in re.finditer("\n", text))]

    def place(self, offset: int) -> tuple[int, int]:
        """Line and column of a character."""
        line = bisect_right(self._starts, offset)
        return line, offset - self._starts[line - 1] + 1


class Sequence(list[Any]):
    """The value of a rule whose name begins with an underscore: its children, to be put in its parent's place."""


Gap = tuple[int, int, int]
"""White space and comments between two tokens: offset, end, and the number of brackets around it."""
Convert = Callable[[str, int], Any]
Reduce = Callable[[list[Any], int], Any]
_State = dict[str, Any]
_ENTRY = 3  # places on the stack for one symbol


class _Reduction(NamedTuple):
    """A rule of the grammar: its entries on the stack, its origin, its number, and what picks the children to keep (None: all)."""

    size: int
    origin: str
    number: int
    pick: Callable[[list[Any]], list[Any]] | None


class Machine:
    """The tables, ready to run: a state is the dictionary of its actions, by terminal and by rule.

    A terminal leads to the next state or to a reduction, a rule's name to the next state.
    """

    def __init__(self, names: frozenset[str]) -> None:
        """``names``: the rules that have an action; other rules of one symbol hand its value on."""
        tables = json.loads(files("hymeko_x.language").joinpath("tables.json").read_text(encoding="utf-8"))
        self._rules: list[str] = [rule["name"] for rule in tables["rules"]]
        reductions = [
            _Reduction(_ENTRY * len(rule["symbols"]), rule["origin"], number, _picker(tuple(rule["symbols"])))
            for number, rule in enumerate(tables["rules"])
        ]
        states: list[_State] = [{} for _ in tables["states"]]
        for state, row in zip(states, tables["states"], strict=True):
            state.update({kind: states[action] if action >= 0 else reductions[-1 - action] for kind, action in row.items()})
        handing_on = {item for item in reductions if item.size == _ENTRY and item.pick is None and not item.origin.startswith("_")}
        _skip_handing_on(states, {item for item in handing_on if self._rules[item.number] not in names})
        self._start, self._end = states[tables["start"]], states[tables["end"]]
        self._keywords: dict[str, str] = tables["keywords"]
        opening = set(tables["opening"])
        ignored = f"(?:{'|'.join(_atomic(pattern) for pattern in tables['ignored'])})*+"
        words = [["KEYWORD", rf"(?:{'|'.join(self._keywords)})\b"]]
        self._skip = re.compile(ignored)
        self._token = re.compile(ignored + _alternatives([*words, *(item for item in tables["terminals"] if item[0] not in opening)]))
        self._first = re.compile(ignored + _alternatives([*words, *tables["terminals"]]))

    def run(self, text: str, terminals: Mapping[str, Convert], actions: Mapping[str, Reduce], gaps: list[Gap]) -> Any:
        """The value of the start rule for a text.

        ``terminals`` turn the text and offset of a token into a value, ``actions`` the children of a rule and the offset of
        its first character. ``gaps`` collects the gaps between tokens at the outermost levels that are longer than one character.

        Raises: ParseError, or TooDeep.
        """
        make = [_maker(name, actions) for name in self._rules]
        stack: list[Any] = [self._start, None, 0]  # state, value, offset; and again
        for kind, word, start in self._tokens(text, gaps):
            action = stack[-3].get(kind)
            if action is None:
                kind = self._kind(kind, word, stack[-3], start)
                action = stack[-3][kind]
            while type(action) is _Reduction:
                size, origin, number, pick = action
                children, first = (stack[1 - size :: 3], stack[2 - size]) if size else ([], start)
                if size:
                    del stack[-size:]
                if pick is not None:
                    children = pick(children)
                state = stack[-3][origin]
                stack += (state, make[number](children, first), first)
                action = state.get(kind)
            if action is None:
                if kind == "$END" and stack[-3] is self._end:
                    break
                raise ParseError(start)
            convert = terminals.get(kind)
            stack += (action, word if convert is None else convert(word, start), start)
        return stack[-2]

    def _tokens(self, text: str, gaps: list[Gap]) -> Iterator[tuple[str, str, int]]:
        """The tokens with the terminal and the offset of each; the last one is the end of the text."""
        next_token = self._token.match
        match = self._first.match(text, 0)
        position = depth = 0
        while match is not None:
            kind = match.lastgroup or ""
            word = match[kind]
            before, position = position, match.end()
            start = position - len(word)
            if start - before > 1 and depth <= GAP_DEPTH:
                gaps.append((before, start, depth))
            if word in _DEPTH:
                depth += _DEPTH[word]
                if depth > MAX_DEPTH:
                    raise TooDeep(start)
            yield kind, word, start
            match = next_token(text, position)
        skipped = self._skip.match(text, position)
        end = position if skipped is None else skipped.end()
        if end != len(text):
            raise ParseError(end)
        gaps.append((position, end, depth))
        yield "$END", "", end

    def _kind(self, kind: str, word: str, state: _State, start: int) -> str:
        """A keyword is one only where the grammar has room for it, and a name elsewhere."""
        keyword = self._keywords.get(word)
        if keyword is not None and keyword in state:
            return keyword
        if kind != "NUMBER" and word.isidentifier() and "NAME" in state:  # the numbers inf and nan are never names
            return "NAME"
        raise ParseError(start)


def _skip_handing_on(states: list[_State], handing_on: set[_Reduction]) -> None:
    """Lead past the states that only hand a value on, to the state that awaits it: 15 % of the time of reading."""
    only: dict[int, str] = {}
    for state in states:
        actions = list(state.values())
        if actions and type(actions[0]) is _Reduction and actions[0] in handing_on and all(action is actions[0] for action in actions):
            only[id(state)] = actions[0].origin
    for state in states:
        for kind, target in state.items():
            while type(target) is dict and id(target) in only:
                target = state[only[id(target)]]
            state[kind] = target


def _maker(name: str, actions: Mapping[str, Reduce]) -> Reduce:
    """The action of a rule; a rule without one makes a sequence or hands its only child on."""
    return _as_sequence if name.startswith("_") else actions.get(name, lambda children, _: children[0])


def _as_sequence(children: list[Any], _: int) -> Any:
    return children if type(children) is Sequence else Sequence(children)


def _picker(symbols: tuple[int, ...]) -> Callable[[list[Any]], list[Any]] | None:
    """The function that picks the children of a rule: 0 drops a symbol, 1 keeps it, 2 puts the items of a sequence in its place."""
    if all(symbol == 1 for symbol in symbols):
        return None
    kept = [number for number, symbol in enumerate(symbols) if symbol]
    if len(kept) == 1 and symbols[kept[0]] == 2:
        return itemgetter(kept[0])
    if symbols == (2, 1):
        return _grow
    if 2 not in symbols:
        return lambda children: [children[number] for number in kept]
    return lambda children: _collect(children, symbols)


def _grow(children: list[Any]) -> list[Any]:
    """A sequence with one item more, by far the most frequent case of :func:`_collect`."""
    sequence: list[Any] = children[0]
    sequence.append(children[1])
    return sequence


def _collect(children: list[Any], symbols: tuple[int, ...]) -> list[Any]:
    """The children to keep, with those of sequences in their place; a leading sequence grows, so that long lists stay linear."""
    result: list[Any] = children[0] if symbols[0] == 2 else Sequence()
    for number, symbol in enumerate(symbols):
        if symbol == 1:
            result.append(children[number])
        elif symbol == 2 and number:
            result.extend(children[number])
    return result


def _alternatives(terminals: list[list[str]]) -> str:
    return "(?:" + "|".join(f"(?P<{name}>{_uncaptured(pattern)})" for name, pattern in terminals) + ")"


def _uncaptured(pattern: str) -> str:
    """The pattern with its plain groups made non-capturing, so that the terminal's own group is the last one."""
    return re.sub(r"(?<!\\)\((?!\?)", "(?:", pattern)


def _atomic(pattern: str) -> str:
    """A pattern that never gives back a match: white space and comments need not be tried twice."""
    return f"(?>{_uncaptured(pattern)})"
