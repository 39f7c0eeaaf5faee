"""A lexer and an LALR(1) machine in one loop, run on the tables that lark computed (tables.json). Knows no HyMeKo.

Where lark's own driver spends most of its time on token objects and call layers, this one keeps plain strings and
offsets; it accepts the same texts (a test compares them on generated ones).
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
    from collections.abc import Mapping

MAX_DEPTH = 200
"""Brackets inside brackets; far more than any robot has, and less than what the stages behind can nest."""

GAP_DEPTH = 2
"""What is skipped is told outside of all brackets, and inside this many."""

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
    """What a rule whose name begins with an underscore makes: its children, to be put in its parent's place."""


Gap = tuple[int, int, int]
Convert = Callable[[str, int], Any]
Reduce = Callable[[list[Any], int], Any]


class _Reduction(NamedTuple):
    """A rule of the grammar: entries on the stack, what it makes, its number, and what picks the children that count.

    ``pick`` is None where every symbol is a child as it is, and :func:`_grow` for a sequence and one item more.
    """

    size: int
    origin: str
    number: int
    pick: Callable[[list[Any]], list[Any]] | None


class Machine:
    """The tables, ready to run: a state is the dictionary of what it does, by terminal and by rule.

    A terminal leads to the next state or to a reduction, a rule's name to the next state.
    """

    def __init__(self, names: frozenset[str]) -> None:
        """``names``: the rules that something is made of; other rules of one symbol hand its value on."""
        tables = json.loads(files("hymeko_x.language").joinpath("tables.json").read_text(encoding="utf-8"))
        self._rules: list[str] = [rule["name"] for rule in tables["rules"]]
        self._symbols = [tuple(rule["symbols"]) for rule in tables["rules"]]
        reductions = [_reduction(number, rule) for number, rule in enumerate(tables["rules"])]
        handing_on = {item for item in reductions if item.size == _ENTRY and self._rules[item.number] not in names and item.pick is None}
        handing_on = {item for item in handing_on if not item.origin.startswith("_")}
        states: list[_State] = [{} for _ in tables["states"]]
        for state, row in zip(states, tables["states"], strict=True):
            state.update({kind: states[action] if action >= 0 else reductions[-1 - action] for kind, action in row.items()})
        _skip_handing_on(states, handing_on)
        self._start, self._end = states[tables["start"]], states[tables["end"]]
        self._keywords: dict[str, str] = tables["keywords"]
        opening = set(tables["opening"])
        ignored = f"(?:{'|'.join(_atomic(pattern) for pattern in tables['ignored'])})*+"
        words = [["KEYWORD", rf"(?:{'|'.join(self._keywords)})\b"]]
        self._skip = re.compile(ignored)
        self._token = re.compile(ignored + _alternatives([*words, *(item for item in tables["terminals"] if item[0] not in opening)]))
        self._first = re.compile(ignored + _alternatives([*words, *tables["terminals"]]))

    def run(self, text: str, terminals: Mapping[str, Convert], actions: Mapping[str, Reduce], gaps: list[Gap]) -> Any:
        """What the start rule makes of a text.

        ``terminals`` turn the text and offset of a token into a value, ``actions`` the children of a rule and the offset
        of its first character.

        ``gaps`` collects what is skipped at the outermost levels, if it is more than a few blanks: offset, end and depth.

        Raises: ParseError, or TooDeep.
        """
        make = [_maker(name, symbols, actions) for name, symbols in zip(self._rules, self._symbols, strict=True)]
        end, next_token = self._end, self._token.match
        stack: list[Any] = [self._start, None, 0]  # state, value, offset; and again
        match = self._first.match(text, 0)
        position = depth = 0
        while True:
            if match is None:
                kind, word, start = self._ending(text, position)
                gaps.append((position, start, depth))
            else:
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
            action = stack[-3].get(kind)
            if action is None:
                kind = self._kind(kind, word, stack[-3], start)
                action = stack[-3][kind]
            while type(action) is _Reduction:
                size, origin, number, pick = action
                if pick is _grow:
                    item = stack[-2]
                    del stack[-3:]
                    stack[-2].append(item)
                    state = stack[-3] = stack[-6][origin]
                elif size == 3 and pick is None:
                    state = stack[-3] = stack[-6][origin]
                    stack[-2] = make[number]([stack[-2]], stack[-1])
                else:
                    children, first = (stack[1 - size :: 3], stack[2 - size]) if size else ([], start)
                    if size:
                        del stack[-size:]
                    if pick is not None:
                        children = pick(children)
                    state = stack[-3][origin]
                    stack += (state, make[number](children, first), first)
                if kind == "$END" and state is end:
                    return stack[-2]
                action = state.get(kind)
            if action is None:
                raise ParseError(start)
            convert = terminals.get(kind)
            stack += (action, word if convert is None else convert(word, start), start)
            match = next_token(text, position)

    def _ending(self, text: str, position: int) -> tuple[str, str, int]:
        """The end of the text, if nothing but white space and comments is left."""
        skipped = self._skip.match(text, position)
        end = position if skipped is None else skipped.end()
        if end != len(text):
            raise ParseError(end)
        return "$END", "", end

    def _kind(self, kind: str, word: str, state: _State, start: int) -> str:
        """A word of the language is one only where the grammar has room for it, and a name elsewhere."""
        keyword = self._keywords.get(word)
        if keyword is not None and keyword in state:
            return keyword
        if kind != "NUMBER" and word.isidentifier() and "NAME" in state:  # the numbers inf and nan are never names
            return "NAME"
        raise ParseError(start)


_State = dict[str, Any]
_ENTRY = 3  # places on the stack for one symbol


def _reduction(number: int, rule: dict[str, Any]) -> _Reduction:
    symbols = tuple(rule["symbols"])
    sequence = rule["origin"].startswith("_")
    plain = all(symbol == 1 for symbol in symbols) or (sequence and symbols == (2,))
    pick = _grow if sequence and symbols == (2, 1) else None if plain else _picker(symbols)
    return _Reduction(_ENTRY * len(symbols), rule["origin"], number, pick)


def _picker(symbols: tuple[int, ...]) -> Callable[[list[Any]], list[Any]]:
    """What picks the children of a rule: 0 drops a symbol, 1 keeps it, 2 puts the items of a sequence in its place."""
    kept = [number for number, symbol in enumerate(symbols) if symbol]
    if len(kept) == 1 and symbols[kept[0]] == 2:
        return itemgetter(kept[0])
    if 2 not in symbols:
        return lambda children: [children[number] for number in kept]
    return lambda children: _collect(children, symbols)


def _skip_handing_on(states: list[_State], handing_on: set[_Reduction]) -> None:
    """Lead past the states that can do nothing but hand a value on: to where the value is then awaited."""
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


def _maker(name: str, symbols: tuple[int, ...], actions: Mapping[str, Reduce]) -> Reduce:
    """What makes the value of a rule; a rule without an action makes a sequence or hands its only child on."""
    if name.startswith("_"):
        return _same if symbols == (2,) else _as_sequence
    return actions.get(name, _same)


def _same(children: list[Any], _: int) -> Any:
    return children[0]


def _grow(children: list[Any]) -> list[Any]:
    """A sequence and one item more; the loop does it in place, so that long lists stay linear."""
    sequence: list[Any] = children[0]
    sequence.append(children[1])
    return sequence


def _as_sequence(children: list[Any], _: int) -> Any:
    return children if type(children) is Sequence else Sequence(children)


def _collect(children: list[Any], symbols: tuple[int, ...]) -> list[Any]:
    """The children that count, with those of sequences in their place; a leading sequence grows instead of being copied."""
    result: list[Any] | None = None
    for child, symbol in zip(children, symbols, strict=True):
        if symbol == 2:
            if result is None:
                result = child
            else:
                result.extend(child)
        elif symbol == 1:
            if result is None:
                result = Sequence()
            result.append(child)
    return Sequence() if result is None else result


def _alternatives(terminals: list[list[str]]) -> str:
    return "(?:" + "|".join(f"(?P<{name}>{_uncaptured(pattern)})" for name, pattern in terminals) + ")"


def _uncaptured(pattern: str) -> str:
    """The pattern with its plain groups made non-capturing, so that the terminal's own group is the last one."""
    return re.sub(r"(?<!\\)\((?!\?)", "(?:", pattern)


def _atomic(pattern: str) -> str:
    """A pattern that never gives back what it matched: white space and comments need not be tried twice."""
    return f"(?>{_uncaptured(pattern)})"
