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

_CALCULATION = "EXPRESSION"
"""A calculation in parentheses is several tokens where only a group of arcs may stand: ``(name - target)``."""

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


class _State(dict[str, Any]):
    """The actions of a state, by terminal and by rule. States lead to each other, so that their whole text would not end."""

    __slots__ = ()

    def __repr__(self) -> str:
        return f"<state of {len(self)} actions>"


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
        states = [_State() for _ in tables["states"]]
        for state, row in zip(states, tables["states"], strict=True):
            state.update({kind: states[action] if action >= 0 else reductions[-1 - action] for kind, action in row.items()})
        handing_on = {item for item in reductions if item.size == _ENTRY and item.pick is None and not item.origin.startswith("_")}
        _skip_handing_on(states, {item for item in handing_on if self._rules[item.number] not in names})
        _grow_in_place(states)
        _begin_in_place(states)
        self._start, self._end = states[tables["start"]], states[tables["end"]]
        self._keywords: dict[str, str] = tables["keywords"]
        opening = set(tables["opening"])
        comment, space = tables["ignored"]
        ignored = f"(?:{space})?+(?:(?:{comment})(?:{space})?+)*+"
        words = [["KEYWORD", rf"(?:{'|'.join(self._keywords)})\b"]]
        statements = [item for item in tables["terminals"] if item[0] in tables["statements"]]
        terminals = [item for item in tables["terminals"] if item not in statements]
        self.statements = {name for name, _ in statements}
        self._divisible = {*self.statements, _CALCULATION}
        self._skip = re.compile(ignored)
        inner = [*words, *(item for item in terminals if item[0] not in opening)]
        self._token = re.compile(_alternatives(inner) + ignored)
        self._part = re.compile(_alternatives([item for item in inner if item[0] != _CALCULATION]) + ignored)
        self._statement = re.compile(_alternatives([*statements, *inner]) + ignored)
        self._first = re.compile(_alternatives([*words, *terminals]) + ignored)

    def run(self, text: str, terminals: Mapping[str, Convert], actions: Mapping[str, Reduce], gaps: list[Gap]) -> Any:
        """The value of the start rule for a text.

        ``terminals`` turn the text and offset of a token into a value, ``actions`` the children of a rule and the offset of
        its first character. Statements are taken whole where the terminals have them. ``gaps`` collects the gaps between tokens
        that are longer than one character.

        Raises: ParseError, or TooDeep.
        """
        make = [_maker(name, actions) for name in self._rules]
        stack: list[Any] = [self._start, None, 0]  # state, value, offset; and again
        pattern = self._statement if self.statements <= terminals.keys() else self._token
        for kind, word, start in self._tokens(text, pattern, gaps):
            action = stack[-3].get(kind)
            if action is _GROW and kind in terminals:  # most tokens; 5 % of the time of reading
                stack[-2].append(terminals[kind](word, start))
            elif not self._take(stack, make, terminals, kind, word, start):
                for part in self.parts(text, start, start + len(word)):
                    self._take(stack, make, terminals, *part)
        return stack[-2]

    def _take(self, stack: list[Any], make: list[Reduce], terminals: Mapping[str, Convert], kind: str, word: str, start: int) -> bool:
        """Reduce what ends before the token and put the token on the stack.

        False for a statement or a calculation that cannot stand there as a whole: its tokens may. What was reduced is right for its first
        token as well, since every state that goes on with a statement goes on with that token.
        """
        action = stack[-3].get(kind)
        if action is None and kind not in self._divisible:
            kind = self._kind(word, stack[-3], start)
            action = stack[-3][kind]
        while type(action) is _Reduction:
            size, origin, number, pick = action
            children, first = (stack[1 - size :: 3], stack[2 - size]) if size else ([], start)
            if size:
                del stack[-size:]
            if pick is not None:
                children = pick(children)
            value = make[number](children, first)
            state = stack[-3]
            following = state[origin]
            if following is _GROW:
                stack[-2].append(value)
            else:
                if type(following) is _Begin:
                    following, value = following.state, Sequence((value,))
                stack += (following, value, first)
                state = following
            action = state.get(kind)
        if action is None:
            if kind in self._divisible:
                return False
            if kind == "$END" and stack[-3] is self._end:
                return True
            raise ParseError(start)
        convert = terminals.get(kind)
        value = word if convert is None else convert(word, start)
        _shift(stack, action, value, start)
        return True

    def _tokens(self, text: str, pattern: re.Pattern[str], gaps: list[Gap]) -> Iterator[tuple[str, str, int]]:
        """The tokens with the terminal and the offset of each; the last one is the end of the text."""
        depth, position = 0, self._first_place(text)
        if position > 1:
            gaps.append((0, position, 0))
        match = self._first.match(text, position)
        while match is not None:
            start, kind = position, match.lastgroup or ""
            end, position = match.end(kind), match.end()
            word = text[start:end]
            if word[-1] == "{" or word in _DEPTH:
                depth += _DEPTH.get(word, 1)
                if depth > MAX_DEPTH:
                    raise TooDeep(end - 1)
            if position - end > 1:
                gaps.append((end, position, depth))
            yield kind, word, start
            match = pattern.match(text, position)
        if position != len(text):
            raise ParseError(position)
        yield "$END", "", position

    def _first_place(self, text: str) -> int:
        """The offset of the first token."""
        skipped = self._skip.match(text)
        return 0 if skipped is None else skipped.end()

    def parts(self, text: str, position: int, end: int) -> Iterator[tuple[str, str, int]]:
        """The tokens of a statement, or of what looks like a calculation. Raises: ParseError for a calculation behind a dollar sign."""
        while position < end:
            match = self._part.match(text, position)
            if match is None:
                raise ParseError(position)
            kind = match.lastgroup or ""
            yield kind, text[position : match.end(kind)], position
            position = match.end()

    def _kind(self, word: str, state: _State, start: int) -> str:
        """The terminal of a keyword, where the grammar has room for it."""
        keyword = self._keywords.get(word)
        if keyword is None or keyword not in state:
            raise ParseError(start)
        return keyword


def _shift(stack: list[Any], action: Any, value: Any, start: int) -> None:
    """Put the value of a token on the stack, or into the sequence there."""
    if action is _GROW:
        stack[-2].append(value)
    elif type(action) is _Begin:
        stack += (action.state, Sequence((value,)), start)
    else:
        stack += (action, value, start)


def _skip_handing_on(states: list[_State], handing_on: set[_Reduction]) -> None:
    """Lead past the states that only hand a value on, to the state that awaits it: 15 % of the time of reading."""
    only: dict[int, str] = {}
    for state in states:
        actions = list(state.values())
        if actions and type(actions[0]) is _Reduction and actions[0] in handing_on and all(action is actions[0] for action in actions):
            only[id(state)] = actions[0].origin
    for state in states:
        for kind, target in state.items():
            while type(target) is _State and id(target) in only:
                target = state[only[id(target)]]
            state[kind] = target


_GROW = "grow"
"""The action of a symbol that makes the sequence before it longer by one item."""


def _grow_in_place(states: list[_State]) -> None:
    """Give symbols whose only use is to go on with a sequence that action, instead of a state that awaits the next token."""
    only = {}
    for state in states:
        first, *others = [*state.values()] or [None]
        if type(first) is _Reduction and first.pick is _grow and all(action is first for action in others):
            only[id(state)] = first.origin
    for origin in set(only.values()):
        for sequence in {id(s[origin]): s[origin] for s in states if origin in s}.values():
            for kind, target in sequence.items():
                if type(target) is _State and only.get(id(target)) == origin:
                    sequence[kind] = _GROW


class _Begin(NamedTuple):
    """The action of a symbol that is the first item of a sequence: the state behind the sequence."""

    state: _State


def _begin_in_place(states: list[_State]) -> None:
    """Give symbols whose only use is to begin a sequence that action, instead of a state that awaits the next token."""
    only = {}
    for state in states:
        first, *others = [*state.values()] or [None]
        is_first = type(first) is _Reduction and first.size == _ENTRY and first.pick is None and first.origin.startswith("_")
        if is_first and all(action is first for action in others):
            only[id(state)] = first.origin
    for state in states:
        for kind, target in state.items():
            if type(target) is _State and id(target) in only:
                state[kind] = _Begin(state[only[id(target)]])


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
    if symbols == (1, 2, 0):  # nodes, the most frequent rule; 2 % of the time of reading
        return lambda children: [children[0], *children[1]]
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
    return "(?:" + "|".join(f"(?:{_uncaptured(pattern)})(?P<{name}>)" for name, pattern in terminals) + ")"


def _uncaptured(pattern: str) -> str:
    """The pattern with its plain groups made non-capturing, so that the terminal's own group is the last one."""
    return re.sub(r"(?<!\\)\((?!\?)", "(?:", pattern)
