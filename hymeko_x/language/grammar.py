"""The grammar hymeko.lark, and tables.json made from it: lark checks the grammar and computes the LALR(1) table of the machine.

Run it after every change of the grammar: ``python -m hymeko_x.language.grammar``. A test fails while it was not run.
"""

from __future__ import annotations

import json
import re
from functools import cache
from importlib.resources import files
from typing import Any

TOKENS = re.compile(
    r'"""[\s\S]*?"""|"[^"\\]*(?:\\[\s\S][^"\\]*)*"|\'[^\'\\]*(?:\\[\s\S][^\'\\]*)*\'|`[^`\\\n]*(?:\\.[^`\\\n]*)*`'
    r"|#[^\n]*|//[^\n]*|/\*[\s\S]*?\*/|[{}\[\]()]"
)
"""Everything in which a bracket or comment sign means something else, comments, and brackets."""


def grammar_text() -> str:
    """The grammar, as lark reads it."""
    return _text("hymeko.lark")


def _text(name: str) -> str:
    return files("hymeko_x.language").joinpath(name).read_text(encoding="utf-8")


def tables_text() -> str:
    """The content of tables.json for the grammar as it is now."""
    from lark import Lark
    from lark.grammar import Rule
    from lark.lexer import TerminalDef

    statements = _text("statements.lark")
    lark = Lark(grammar_text() + statements, parser="lalr", maybe_placeholders=False)
    data, memo = lark.memo_serialize([TerminalDef, Rule])
    machine = data["parser"]["parser"]
    rules = sorted((item for item in memo.items() if item[1]["__type__"] == "Rule"), key=lambda item: _rule_order(item[1]))
    numbers = {key: number for number, (key, _) in enumerate(rules)}
    tokens = machine["tokens"]
    rows = {
        state: {tokens[token]: argument if action == 0 else -1 - numbers[argument["@"]] for token, (action, argument) in row.items()}
        for state, row in machine["states"].items()
    }
    states, renumbered = _renumbered(rows, machine["start_states"]["start"])
    start = 0
    tables = {
        "start": start,
        "end": renumbered[machine["end_states"]["start"]],
        "ignored": [_pattern(item) for item in _terminals(memo, ignored=True, data=data)],
        "terminals": [[item["name"], _pattern(item)] for item in _terminals(memo, ignored=False, data=data)],
        "statements": re.findall(r"^([A-Z_]+)\.\d+:", statements, re.MULTILINE),
        "opening": _only_at_start(states, start),
        "keywords": {item["pattern"]["value"]: item["name"] for item in _all_terminals(memo) if _is_keyword(item)},
        "rules": [_rule(rule) for _, rule in rules],
        "states": states,
    }
    return json.dumps(tables, indent=None, separators=(",", ":"), sort_keys=True).replace("],[", "],\n[").replace("},{", "},\n{") + "\n"


def tokens(text: str) -> list[str]:
    """The tokens of a text in the order of the terminals, without comments and white space; a list of numbers is one token."""
    return [match[0] for match in _token_pattern().finditer(text) if match.lastgroup == "token"]


@cache
def _token_pattern() -> re.Pattern[str]:
    tables = json.loads(files("hymeko_x.language").joinpath("tables.json").read_text(encoding="utf-8"))
    comment, space = tables["ignored"]
    left_out = {*tables["opening"], *tables["statements"]}
    words = rf"\b(?:{'|'.join(tables['keywords'])})\b"
    terminals = "|".join(f"(?:{pattern})" for name, pattern in tables["terminals"] if name not in left_out)
    return re.compile(f"(?P<space>{space})|(?P<comment>{comment})|(?P<token>{words}|{terminals}|.)", re.DOTALL)


def _rule_order(rule: dict[str, Any]) -> tuple[str, int]:
    return rule["origin"]["name"], rule["order"]


def _renumbered(rows: dict[int, dict[str, int]], start: int) -> tuple[list[dict[str, int]], dict[int, int]]:
    """The states in the order in which they are reached from the start by sorted symbols: lark's own numbers vary."""
    numbers = {start: 0}
    order = [start]
    for state in order:
        for _, action in sorted(rows[state].items()):
            if action >= 0 and action not in numbers:
                numbers[action] = len(order)
                order.append(action)
    return [{name: numbers[a] if a >= 0 else a for name, a in sorted(rows[state].items())} for state in order], numbers


def _all_terminals(memo: dict[int, Any]) -> list[dict[str, Any]]:
    return [item for item in memo.values() if item["__type__"] == "TerminalDef"]


def _terminals(memo: dict[int, Any], *, ignored: bool, data: dict[str, Any]) -> list[dict[str, Any]]:
    """The terminals in the order in which they are tried: by priority, then by how much they may match."""
    names = set(data["parser"]["lexer_conf"]["ignore"])
    found = [item for item in _all_terminals(memo) if (item["name"] in names) == ignored and not _is_keyword(item)]
    return sorted(found, key=lambda item: (-item["priority"], -_width(item), -len(item["pattern"]["value"]), item["name"]))


def _width(item: dict[str, Any]) -> int:
    pattern = item["pattern"]
    return int(pattern["_width"][1]) if pattern["__type__"] == "PatternRE" else len(pattern["value"])


def _is_keyword(item: dict[str, Any]) -> bool:
    """A fixed word that would be a name elsewhere: it is one only where the grammar has room for it."""
    return bool(item["pattern"]["__type__"] == "PatternStr" and item["pattern"]["value"].isidentifier())


def _pattern(item: dict[str, Any]) -> str:
    pattern = item["pattern"]
    return re.escape(pattern["value"]) if pattern["__type__"] == "PatternStr" else str(pattern["value"])


def _only_at_start(states: list[dict[str, int]], start: int) -> list[str]:
    """The terminals that only the start state takes: they are tried for the first token alone."""
    elsewhere = {name for number, row in enumerate(states) if number != start for name, action in row.items() if action >= 0}
    return sorted(name for name, action in states[start].items() if action >= 0 and name.isupper() and name not in elsewhere)


def _rule(rule: dict[str, Any]) -> dict[str, Any]:
    """Name (alias if there is one), origin, and for every symbol whether it is kept (1), unfolded (2) or dropped (0)."""
    keep_all = rule["options"]["keep_all_tokens"]
    symbols = []
    for symbol in rule["expansion"]:
        if symbol["__type__"] == "Terminal":
            symbols.append(int(keep_all or not symbol["filter_out"]))
        else:
            symbols.append(2 if symbol["name"].startswith("_") else 1)
    return {
        "origin": rule["origin"]["name"],
        "name": rule["alias"] or rule["origin"]["name"],
        "symbols": symbols,
    }


if __name__ == "__main__":
    from pathlib import Path

    Path(__file__).with_name("tables.json").write_text(tables_text(), encoding="utf-8")
