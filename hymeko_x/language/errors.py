"""The message of a syntax error: the place, the line with a caret, what was expected, and a hint."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, Refusal, refuse
from hymeko_x.language.grammar import TOKENS, grammar_text

if TYPE_CHECKING:
    from lark import Lark
    from lark.exceptions import UnexpectedCharacters, UnexpectedToken

_WORDS = {"NAME": "a name"}
_WORDS |= dict.fromkeys(("NUMBER", "QUANTITY", "STRING", "NUMBERS", "MATRIX", "EXPRESSION", "QUERY", "LSQB"), "a value")
_WORDS |= {"DIRECTION": "a direction (+ - ~ -> <- <>)", "EQUAL": "'='", "COLON": "':'", "LBRACE": "'{'", "RBRACE": "'}'"}
_WORDS |= {"RSQB": "']'", "LPAR": "'('", "RPAR": "')'", "COMMA": "','", "DOT": "'.'", "LESSTHAN": "'<'", "MORETHAN": "'>'"}
_WORDS |= {"EDGE_WORD": "'@'", "USE": "'use'", "IMPORT": "'import'", "AS": "'as'", "QUOTED_REF": "'@>\"name\"'"}
_WORDS |= {"$END": "the end of the text"}
"""Terminals in the words of a user, in the order in which they are listed."""
_IGNORED = {"MODIFIER", "LEGACY_HEADER", "COMMENT", "SEMICOLON", "USING", "CONSTANT"}
_KEYWORDS = {"USE", "IMPORT", "USING", "AS", "EDGE_WORD"}
_PAIRS = {"}": "{", "]": "[", ")": "("}
_CLOSERS = {"RBRACE": "{", "RSQB": "[", "RPAR": "("}
_INDENT = re.compile(r"[ \t]*")
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_DIGIT_NAME = re.compile(r"\d+[^\W\d]\w*")
_WITH_NEIGHBOURS = re.compile(r"(?=[\d.+-])[+-]?(?:\d|\.\d)[\w.%°/*·^+-]*")
_GLUED = re.compile(r"(use|as|using|import)(?=\w)")
_WHOLE_WORD = re.compile(r"[\w.]+|\S")
_NAME_AND_PATH = re.compile(r"(?<![\w:.`])(?<![:@] )([^\W\d]\w*)\s+([^\W\d]\w*(?:\.(?:[^\W\d]\w*|`[^`\n]*`))+)\s*\Z")
"""A name and a path behind it, as in ``at left.flange``."""
_BEGINNINGS = {
    "<": "this looks like XML: --from urdf, --from xacro or --from mjcf reads it",
    "{": "a text begins with a name: robot { ... }",
}
_BEHIND = {":": "the name of a type follows ':'; a value stands behind '=' or behind the name alone: mass 1", "=": "a value follows '='"}

_CHARACTER_HINTS = {
    '"': "the string that begins here is never closed",
    "'": "the string that begins here is never closed",
    "`": "the quoted name that begins here is not closed in the same line",
    "/": "a name with characters other than letters, digits and _ is written in backticks: `left/arm`",
    ".": "a name with characters other than letters, digits and _ is written in backticks: `arm.1`",
    "$": "an expression is written ${2 * length}",
    "%": "a comment begins with # or //",
    "&": "two references are two arcs, each with its own direction: + a, + b",
    "!": "a comment begins with # or //",
    "*": "calculations are written ${a * b}",
}


def explain_syntax_error(text: str, name: str, offset: int) -> Refusal:
    """The refusal (HX060) for a text that is not HyMeKo: lark reads it again, for the terminals that it expected.

    ``offset`` is where the machine refuses it. lark takes some words for two, such as `useful`, where the machine does not.
    """
    from lark.exceptions import UnexpectedCharacters, UnexpectedToken

    try:
        _lark().parse(text)
    except UnexpectedToken as error:
        return _unexpected_token(error, text, name)
    except UnexpectedCharacters as error:
        return _unexpected_character(error, text, name)
    line, column = text.count("\n", 0, offset) + 1, offset - text.rfind("\n", 0, offset)
    word = _WHOLE_WORD.match(text, offset)
    found = word[0] if word else ""
    glued = _GLUED.match(found)
    hint = f"a blank stands behind '{glued[0]}'" if glued else ""
    return refuse(
        codes.SYNTAX, f"unexpected {_shown(found)}", Origin(name, line, column), hint=hint, excerpt=excerpt(text, line, column, len(found))
    )


@cache
def _lark() -> Lark:
    from lark import Lark

    return Lark(grammar_text(), parser="lalr", maybe_placeholders=False)


def _unexpected_character(error: UnexpectedCharacters, text: str, name: str) -> Refusal:
    offset = error.pos_in_stream or 0
    character = text[offset]
    message = f"the character {character!r} means nothing here; expected {_list(_possible(error.allowed or set(), text, offset))}"
    hint = _unclosed_before(text, offset) or _glued_hint(text, offset) or _character_hint(text, offset)
    place = Origin(name, error.line, error.column)
    return refuse(codes.SYNTAX, message, place, hint=hint, excerpt=excerpt(text, error.line, error.column, 1))


def _glued_hint(text: str, offset: int) -> str:
    """A hint for a number or a string that touches its neighbour."""
    number = _WITH_NEIGHBOURS.match(text, offset)
    if number is not None:
        return f"a number stands apart from what is beside it: '{number[0]}' is no number and no quantity"
    if text[offset] in "\"'" and text[offset - 1 : offset] in ('"', "'"):
        return "a blank or a comma stands between two strings"
    return ""


def _character_hint(text: str, offset: int) -> str:
    if text.startswith("/*", offset):
        return "the comment that begins here is never closed"
    if text.startswith("const", offset):
        return "a constant is written: const NAME = value;"
    return _CHARACTER_HINTS.get(text[offset], "")


def _unexpected_token(error: UnexpectedToken, text: str, name: str) -> Refusal:
    token = error.token
    at_end = token.type == "$END"
    line, column = _end_of(text) if at_end else (token.line or 1, token.column or 1)
    found = "the text ends" if at_end else f"unexpected {_shown(str(token))}"
    expected = _list(_possible(error.accepts or error.expected, text, len(text) if at_end else token.start_pos or 0))
    width = 1 if at_end else len(str(token).split("\n", 1)[0])
    return refuse(
        codes.SYNTAX,
        f"{found}; expected {expected}",
        Origin(name, line, column),
        hint=_token_hint(error, text, at_end),
        excerpt=excerpt(text, line, column, width),
    )


def _token_hint(error: UnexpectedToken, text: str, at_end: bool) -> str:
    """What the user may have meant."""
    token = str(error.token)
    offset = len(text) if at_end else error.token.start_pos or 0
    foreign = _other_language(text, offset)
    if foreign:
        return foreign
    unclosed, unopened = _brackets(text)
    if at_end and unclosed is not None:
        bracket, line = _unclosed_by_layout(text) or unclosed
        return f"the '{bracket}' in line {line} is never closed"
    if error.token.type == "CONSTANT":
        return "a constant stands between items"
    if error.token.type in _KEYWORDS and token.isidentifier():
        return f"'{token}' is a word of the language; as a name it is written in backticks: `{token}`"
    if token in _PAIRS and unclosed is not None:
        bracket, line = unclosed
        return f"the '{bracket}' in line {line} is still open"
    if token in _PAIRS and unopened == error.token.start_pos:
        return f"there is no '{_PAIRS[token]}' for this '{token}'"
    path = _NAME_AND_PATH.search(text, 0, offset)
    if path is not None:
        return f"a value that is a name stands behind '=': {path[1]}={path[2]}"
    return _unclosed_before(text, offset) or _expectation_hint(error.accepts or error.expected, token, text[:offset].rstrip()[-1:])


def _other_language(text: str, offset: int) -> str:
    """A hint for a text that begins like another language."""
    if text[:offset].strip(" \t\r\n\ufeff"):
        return ""
    return _BEGINNINGS.get(text[offset : offset + 1], "")


def _unclosed_before(text: str, offset: int) -> str:
    """A hint for a string over several lines just before the error: it probably begins where another one should have ended."""
    last = None
    for match in TOKENS.finditer(text, 0, offset):
        if match[0][0] in "\"'" and not match[0].startswith('"""'):
            last = match
    if last is None or "\n" not in last[0]:
        return ""
    begin = text.count("\n", 0, last.start()) + 1
    end = begin + last[0].count("\n")
    return f"the string that begins in line {begin} ends in line {end}; a quote may be missing"


def _expectation_hint(expected: set[str], token: str, before: str) -> str:
    """A hint from what was expected, the token that came, and the character before it."""
    if expected == {"STRING"}:
        return 'an import names a file: import "legs.hymeko"; as a name the word is written in backticks: `import`'
    if _NUMBER.fullmatch(token) and before.isdigit():
        return "a list of numbers stands in brackets: [1 2 3]"
    if token == ";" and not expected.isdisjoint({"RSQB", "RPAR"}):
        return "values and parameters are separated by white space or commas"
    if token.startswith("${") and "LBRACE" in expected:
        return "a block begins with '{'; '${ }' is a calculation, and stands where a value may stand"
    if token == "@" and before in ("+", "-", "~", ">"):
        return "behind a direction an edge stands without '@': + name"
    if token in ("+", "-", "~") and expected >= {"RPAR", "COMMA"}:
        return "arcs in parentheses are separated by commas: (+ a, - b)"
    if token == "{" and expected >= {"RPAR", "COMMA"}:
        return "an arc with a block stands outside of parentheses: + a { x 1 }"
    if before == ":":
        return _BEHIND[before]
    if token == ";" and expected == {"NAME"}:
        return "a short name for a path is defined so: using a.b as c;"
    if "RPAR" in expected and "NAME" in expected and "LBRACE" not in expected and token not in _PAIRS:
        lists = "; a list of numbers stands in brackets: [1 2 3]" if _NUMBER.fullmatch(token) else ""
        return f"parameters have names: part(mass=2){lists}"
    if "NAME" in expected and _DIGIT_NAME.fullmatch(token):
        return f"a name does not begin with a digit; as a name it is written in backticks: `{token}`"
    if token == "=":
        return "one '=' is enough, and only a name stands before it"
    if token == "{" and "NAME" in expected:
        return "a block follows a name: name { ... }"
    if "LBRACE" in expected and "EQUAL" not in expected:
        return "a node or edge has a block, even if it is empty: name : type { }"
    if expected <= {"NAME", "QUOTED_REF", "LESSTHAN"} and before in ("+", "-", "~", ">"):
        if _NUMBER.fullmatch(token):
            return "a blank stands between a name and a number with a sign"
        return "a direction is followed by the name of an element"
    return _BEHIND.get(before, "")


def _brackets(text: str) -> tuple[tuple[str, int] | None, int | None]:
    """The innermost bracket that is never closed, with its line, and the position of the first one that closes nothing."""
    stack: list[tuple[str, int]] = []
    for match in TOKENS.finditer(text):
        word = match[0]
        if word in _PAIRS.values():
            stack.append((word, match.start()))
        elif word in _PAIRS:
            if not stack or stack[-1][0] != _PAIRS[word]:
                return _with_line(stack, text), match.start()
            stack.pop()
    return _with_line(stack, text), None


def _unclosed_by_layout(text: str) -> tuple[str, int] | None:
    """The first open brace that is never closed if closing braces at the beginnings of lines close what is indented like them."""
    opened: list[tuple[int, int]] = []
    depth = begin = end = 0
    for match in TOKENS.finditer(text):
        line = text.rfind("\n", end, match.start()) + 1
        if line or not end:
            begin = line + len(_INDENT.match(text, line)[0])  # type: ignore[index]
            depth = begin - line
        end = match.end()
        if match[0] == "{":
            opened.append((depth, match.start()))
        elif match[0] == "}" and opened:
            if begin == match.start() and opened[-1][0] > depth:
                return _with_line([("{", opened[-1][1])], text)
            opened.pop()
    return None


def _with_line(stack: list[tuple[str, int]], text: str) -> tuple[str, int] | None:
    if not stack:
        return None
    bracket, position = stack[-1]
    return bracket, text.count("\n", 0, position) + 1


def _possible(terminals: set[str], text: str, offset: int) -> set[str]:
    """The terminals without the brackets that would close another one than the innermost open one."""
    unclosed, _ = _brackets(text[:offset])
    if unclosed is not None:
        terminals = terminals - {"IMPORT"}  # imports stand at the beginning
    if "EDGE_WORD" in terminals and "COLON" not in terminals:
        terminals = terminals - {"LPAR"}  # a group of arcs, as other tools write it
    if terminals <= {"NAME", "QUOTED_REF", "LESSTHAN"}:
        terminals = terminals - {"LESSTHAN"}  # a tag behind a direction
    return {name for name in terminals if name not in _CLOSERS or (unclosed is not None and _CLOSERS[name] == unclosed[0])}


def _list(terminals: set[str]) -> str:
    """What was expected, in words, in a fixed order."""
    words = list(dict.fromkeys(word for terminal, word in _WORDS.items() if terminal in terminals))
    unknown = terminals - set(_WORDS) - _IGNORED
    words += sorted(f"'{terminal.lower()}'" for terminal in unknown)
    if len(words) < 2:
        return words[0] if words else "nothing more"
    return f"{', '.join(words[:-1])} or {words[-1]}"


def _shown(token: str) -> str:
    first = token.split("\n", 1)[0]
    return f"'{first[:40]}...'" if len(first) > 40 or first != token else f"'{token}'"


def _end_of(text: str) -> tuple[int, int]:
    """Line and column behind the last character that is not white space."""
    rest = text.rstrip()
    return rest.count("\n") + 1, len(rest) - (rest.rfind("\n") + 1) + 1


_MAX_LINE = 160
_WORD = re.compile(r"@?\s*(?:`[^`]*`|[\w.]+)")


def with_excerpt(refusal: Refusal, text: str, name: str) -> Refusal:
    """The refusal with the line of the text that it is about, unless it shows one or is about another file."""
    diagnostic = refusal.diagnostic
    origin = diagnostic.origin
    if diagnostic.excerpt or origin is None or origin.file != name or origin.line is None:
        return refusal
    line, column = origin.line, origin.column or 1
    word = _WORD.match(text.split("\n")[line - 1], column - 1)
    return Refusal(replace(diagnostic, excerpt=excerpt(text, line, column, len(word[0]) if word else 1)))


def excerpt(text: str, line: int, column: int, width: int) -> tuple[str, ...]:
    """The source line and a caret line below it; a long line is cut around the place."""
    source = text.split("\n")[line - 1].rstrip("\r").replace("\t", " ")
    start = max(0, column - 1 - _MAX_LINE // 2) if len(source) > _MAX_LINE else 0
    shown = source[start : start + _MAX_LINE]
    room = max(1, min(width, len(shown) - (column - 1 - start)))
    gutter = f"{line:>5}"
    return (f"{gutter} | {shown}", f"{' ' * len(gutter)} | {' ' * (column - 1 - start)}{'^' * room}")
