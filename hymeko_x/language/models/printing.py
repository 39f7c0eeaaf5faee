"""The grammar in the notations of the programs that hold models to it."""

from __future__ import annotations

from re import _constants as kinds
from re import _parser as patterns
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from hymeko_x.language.grammar import grammar_text
from hymeko_x.language.models.rules import BLANKS, GAP, START, plain_rules
from hymeko_x.language.models.terminals import BLANKS as BLANKS_PATTERN

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from hymeko_x.language.models.rules import Rules

_TITLE = "The HyMeKo language for models that are held to a grammar; made by hymeko-x from hymeko.lark."


def lark() -> str:
    """The grammar of the language itself, for lark."""
    return grammar_text()


def llguidance() -> str:
    """For llguidance, and the programs that use it (vLLM, SGLang, llama.cpp): its variant of lark's notation."""
    rules, terminals = plain_rules()

    def symbol(name: str) -> str:
        return f"{BLANKS}?" if name == GAP else name.replace("-", "_")

    lines = [f"// {_TITLE}", "%llguidance {}", "", *_rule_lines(rules, symbol, ": ", "\n    | "), ""]
    lines += (f"{symbol(name)}: /{_slashes(pattern)}/" for name, pattern in _all_terminals(terminals).items())
    return "\n".join(lines) + "\n"


def gbnf() -> str:
    """For llama.cpp, and for xgrammar, which takes the same notation."""
    rules, terminals = plain_rules()

    def symbol(name: str) -> str:
        return "root" if name == START else name.lower().replace("_", "-")

    lines = [f"# {_TITLE}", *_rule_lines(rules, symbol, " ::= ", " |\n  "), "gap ::= blanks?"]
    lines += (f"{symbol(name)} ::= {_gbnf(patterns.parse(pattern))}" for name, pattern in _all_terminals(terminals).items())
    return "\n".join(lines) + "\n"


PRINTERS: Mapping[str, Callable[[], str]] = MappingProxyType({"lark": lark, "gbnf": gbnf, "llguidance": llguidance, "xgrammar": gbnf})
"""By name the grammar for each program."""


def _rule_lines(rules: Rules, symbol: Callable[[str], str], defined_as: str, otherwise: str) -> Iterator[str]:
    """One text for each rule, with its alternatives."""
    for name, choices in rules.items():
        yield symbol(name) + defined_as + otherwise.join(" ".join(map(symbol, choice)) or '""' for choice in choices)


def _all_terminals(terminals: dict[str, str]) -> dict[str, str]:
    return {**terminals, BLANKS: BLANKS_PATTERN}


def _slashes(pattern: str) -> str:
    """A pattern between two slashes."""
    return pattern.replace("\\/", "/").replace("/", "\\/").replace("\n", "\\n")


# ---- patterns in GBNF --------------------------------------------------------------------------------------------------------


def _gbnf(parsed: Any) -> str:
    """A pattern of Python in GBNF. No deeper than the pattern is nested."""
    return " ".join(_gbnf_item(kind, value) for kind, value in parsed) or '""'


def _gbnf_item(kind: Any, value: Any) -> str:
    if kind is kinds.LITERAL:
        return f'"{_gbnf_escaped(value)}"'
    if kind is kinds.NOT_LITERAL:
        return f"[^{_gbnf_letter(value)}]"
    if kind is kinds.IN:
        return _gbnf_class(value)
    if kind is kinds.SUBPATTERN:
        return f"({_gbnf(value[-1])})"
    if kind is kinds.BRANCH:
        return f"({' | '.join(map(_gbnf, value[1]))})"
    if kind is kinds.MAX_REPEAT:
        least, most, inner = value
        sign = {(0, 1): "?", (0, kinds.MAXREPEAT): "*", (1, kinds.MAXREPEAT): "+"}[least, most]
        return f"({_gbnf(inner)}){sign}"
    raise ValueError(f"{kind} is no plain pattern")


def _gbnf_class(items: Any) -> str:
    texts = []
    for kind, value in items:
        if kind is kinds.NEGATE:
            texts.append("^")
        elif kind is kinds.RANGE:
            texts.append(f"{_gbnf_letter(value[0])}-{_gbnf_letter(value[1])}")
        elif kind is kinds.LITERAL:
            texts.append(_gbnf_letter(value))
        else:
            raise ValueError(f"{kind} is no plain class")
    return f"[{''.join(texts)}]"


def _gbnf_letter(code: int) -> str:
    """A letter within a class."""
    return {"]": "\\]", "[": "\\[", "^": "\\x5E", "-": "\\x2D"}.get(chr(code)) or _gbnf_escaped(code)


def _gbnf_escaped(code: int) -> str:
    return {"\n": "\\n", "\r": "\\r", "\t": "\\t", '"': '\\"', "\\": "\\\\"}.get(chr(code), chr(code))
