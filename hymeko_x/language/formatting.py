"""HyMeKo text in its usual layout: tokens, comments, their order and separating blank lines stay, only white space changes.

An author's line breaks stay as well. A block that is broken anywhere has its braces at line ends and its items indented; what is wider than
the page is broken between items, and then inside of blocks.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x import codes
from hymeko_x.collector import uncollected
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.language.machine import ParseError
from hymeko_x.language.parser import machine, parse
from hymeko_x.language.printer import INDENT, WIDTH
from hymeko_x.language.terminals import TERMINALS, Malformed

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from hymeko_x.language.machine import Convert, Reduce

_COMMENT = re.compile(r"#[^\n]*|//[^\n]*|/\*[\s\S]*?\*/")
_WORDS = re.compile(rf'''{_COMMENT.pattern}|"""[\s\S]*?"""|"(?:\\[\s\S]|[^"\\])*"|`(?:\\.|[^`\\])*`|[^\s{{}}\[\](),]+|\S''')
"""What white space, brackets and commas divide a text into: tokens, and runs of tokens without white space between them."""
_PIECES = re.compile(r"[\[\],]|[^\s,\[\]]+")
_ITEMS = (
    *(
        "bare",
        "field",
        "import_",
        "short_import",
        "using",
        "constant",
        "tagged_node",
        "group",
        "node",
        "edge",
        "typed_edge",
        "changed_node",
        "changed_edge",
        "array",
        "edge_array",
    ),
    *("plain_arc", "role_arc", "weighted_arc", "quoted_arc", "legacy_edge"),
)
_SIGNATURE = ("signature", "stereotypes", "stereotype", "use", "parameters", "parameter", "arguments", "argument")
_RULES = ("start", "block", "group_arc", "ref", "path", "relation", "vector", "type", *_SIGNATURE)
_OPENING, _CLOSING = frozenset("{[("), frozenset("}])")
_TIGHT_BEFORE = frozenset({",", ";", ")", "]", ".", "="})
_TIGHT_AFTER = frozenset({"(", "[", ".", "=", "@"})
_SIGNS = frozenset({"DIRECTION", "MODIFIER"})
_COMMENTS = frozenset({"LINE_COMMENT", "BLOCK_COMMENT"})
_LISTS = frozenset({"NUMBERS", "MATRIX"})
_FALLIBLE = frozenset({"STRING", "NAME", *_LISTS})
"""Tokens that may have no value."""
_STATEMENT = "STATEMENT"


class Token(NamedTuple):
    """A token or a comment: its terminal, its text, the line breaks before it, and whether an item of a block begins with it."""

    kind: str
    text: str
    breaks: int = 0
    begins_item: bool = False


class _Line(NamedTuple):
    depth: int
    tokens: tuple[Token, ...]
    is_after_blank: bool = False


@uncollected()
def format_text(text: str, name: str = "<text>") -> str:
    """The text in the usual layout; formatting that again changes nothing. ``name`` is the file's name for messages.

    Raises: Refusal (HX060, HX007) as :func:`hymeko_x.language.parser.parse` does.
    """
    try:
        tokens = _tokens(text)
    except (ParseError, Malformed):
        parse(text, name)
        raise
    lines: list[str] = []
    for line, words in _fitted(_lines(tokens)):
        if line.is_after_blank and lines:
            lines.append("")
        lines.append(INDENT * line.depth + words)
    found = "".join(f"{line}\n" for line in lines)
    if found != text and _words(found) != _words(text) and [*_plain(_tokens(found))] != [*_plain(tokens)]:
        raise refuse(codes.BUG, "the text in its usual layout is another text; it is left as it is", Origin(name))
    return found


def _words(text: str) -> list[str]:
    """The words and brackets of a text. Where two texts have the same they have the same tokens."""
    return [word.rstrip() for word in _WORDS.findall(text)]


def _plain(tokens: Sequence[Token]) -> Iterator[tuple[str, str]]:
    """The terminals and texts of tokens; those of a list of numbers one by one, whether or not there are line breaks in it."""
    for token in tokens:
        if token.kind == "NUMBERS":
            yield from (("" if piece in "[]," else "NUMBER", piece) for piece in _PIECES.findall(token.text))
        else:
            yield "" if token.text in "[]," else token.kind, token.text.rstrip() if token.kind in _COMMENTS else token.text


# ---- tokens --------------------------------------------------------------------------------------------------------------------


class _Collector(dict[str, "Convert"]):
    """Collects every token and every whole statement that the machine reads, with its place, and the places where other items begin."""

    def __init__(self) -> None:
        super().__init__({kind: self._reader(kind) for kind in TERMINALS} | dict.fromkeys(machine().statements, self._statement))
        self.found: list[tuple[str, str, int]] = []
        self.starts: set[int] = set()

    def _statement(self, word: str, offset: int) -> None:
        self.found.append((_STATEMENT, word, offset))

    def get(self, kind: str, default: object = None) -> Convert:
        return super().get(kind) or self._reader(kind)

    def _reader(self, kind: str) -> Convert:
        def convert(text: str, offset: int) -> str:
            self.found.append((kind, text, offset))
            return text

        return convert


def _tokens(text: str) -> list[Token]:
    """The tokens of a text, with the comments between them. Raises: ParseError, Malformed."""
    collector = _Collector()

    def item(parts: list[object], offset: int) -> None:
        collector.starts.add(offset)

    def other(parts: list[object], offset: int) -> None:
        return None

    actions: dict[str, Reduce] = {**dict.fromkeys(_RULES, other), **dict.fromkeys(_ITEMS, item)}
    machine().run(text, collector, actions, [])
    tokens: list[Token] = []
    end = 0
    for kind, word, start in (*collector.found, ("$END", "", len(text))):
        gap = text[end:start]
        if gap and not gap.isspace():
            comments, gap = _comments(gap)
            tokens += comments
        breaks = gap.count("\n")
        if kind == _STATEMENT:
            tokens += _statement_tokens(word, breaks)
        elif kind != "$END":
            tokens += _item_tokens(kind, word, start, breaks, begins_item=start in collector.starts)
        end = start + len(word)
    return tokens


@lru_cache(maxsize=1 << 13)
def _statement_tokens(statement: str, breaks: int) -> tuple[Token, ...]:
    """The tokens of a statement, with the line breaks before it. Most were in the version that was formatted before."""
    tokens: list[Token] = []
    end = 0
    for kind, word, start in machine().parts(statement, 0, len(statement)):
        before = statement.count("\n", end, start) if start else breaks
        tokens += _item_tokens(kind, word, start, before, begins_item=not start)
        end = start + len(word)
    return tuple(tokens)


def _item_tokens(kind: str, word: str, start: int, breaks: int, *, begins_item: bool) -> Iterator[Token]:
    """A token, or the tokens of a list of numbers. Raises: Malformed for one that has no value."""
    if kind in _FALLIBLE:
        TERMINALS[kind](word, start)
    if kind in _LISTS:
        yield from _list_tokens(word, breaks, begins_item=begins_item)
    else:
        yield Token(kind, word, breaks, begins_item)


def _comments(gap: str) -> tuple[list[Token], str]:
    """The comments between two tokens, and what stands behind the last of them."""
    found, end = [], 0
    for comment in _COMMENT.finditer(gap):
        kind = "BLOCK_COMMENT" if comment[0].startswith("/*") else "LINE_COMMENT"
        found.append(Token(kind, comment[0].rstrip(), gap.count("\n", end, comment.start())))
        end = comment.end()
    return found, gap[end:]


def _list_tokens(text: str, breaks: int, *, begins_item: bool) -> Iterator[Token]:
    """A list of numbers as one token; the brackets, commas and numbers of one with line breaks in it."""
    if "\n" not in text:
        words = " ".join(_PIECES.findall(text))
        yield Token("NUMBERS", words.replace("[ ", "[").replace(" ]", "]").replace(" ,", ","), breaks, begins_item)
        return
    end = 0
    for piece in _PIECES.finditer(text):
        before = breaks if piece.start() == 0 else text.count("\n", end, piece.start())
        yield Token(piece[0] if piece[0] in "[]," else "NUMBER", piece[0], before, begins_item and piece.start() == 0)
        end = piece.end()


# ---- lines ---------------------------------------------------------------------------------------------------------------------


def _lines(tokens: Sequence[Token]) -> Iterator[_Line]:
    """The lines that the author's line breaks make, with those that the braces of broken blocks have."""
    broken = _broken(tokens)
    line: list[Token] = []
    opened: list[str] = []
    depth = 0
    is_after_blank = False
    for number, token in enumerate(tokens):
        if number and _breaks_before(tokens, number, broken):
            yield _Line(depth, tuple(line), is_after_blank)
            line = []
            is_after_blank = token.breaks > 1 and tokens[number - 1].text != "{" and token.text not in _CLOSING
        if not line:
            begins = token.begins_item or token.kind in _COMMENTS or token.text in _CLOSING or not number
            continues = not begins and opened[-1:] in ([], ["{"])
            depth = len(opened) - (token.text in _CLOSING) + continues
        line.append(token)
        if token.text in _OPENING:
            opened.append(token.text)
        elif token.text in _CLOSING:
            opened.pop()
    if line:
        yield _Line(depth, tuple(line), is_after_blank)


def _broken(tokens: Sequence[Token]) -> set[int]:
    """The numbers of the braces, opening and closing, of blocks with a line break in them."""
    found: set[int] = set()
    stack: list[tuple[int, int]] = []
    breaks = 0
    for number, token in enumerate(tokens):
        breaks += token.breaks > 0 or (token.kind == "BLOCK_COMMENT" and "\n" in token.text)
        if token.kind == "LBRACE":
            stack.append((number, breaks))
        elif token.kind == "RBRACE":
            opening, before = stack.pop()
            if breaks > before and (number > opening + 1):
                found |= {opening, number}
    return found


def _breaks_before(tokens: Sequence[Token], number: int, broken: set[int]) -> bool:
    """Whether a line begins with the token of this number."""
    token, previous = tokens[number], tokens[number - 1]
    if previous.kind == "LINE_COMMENT":
        return True
    if token.kind in _COMMENTS:
        return token.breaks > 0
    if token.text in (",", "{") and previous.kind not in _COMMENTS:
        return False
    if previous.kind == "LBRACE" and token.kind == "RBRACE":
        return False
    opens = previous.kind == "LBRACE" and number - 1 in broken
    closes = token.kind == "RBRACE" and number in broken
    follows = previous.kind == "RBRACE" and number - 1 in broken and token.begins_item
    return token.breaks > 0 or opens or closes or follows


# ---- width ---------------------------------------------------------------------------------------------------------------------


def _fitted(lines: Iterator[_Line]) -> Iterator[tuple[_Line, str]]:
    """The lines with their words, those wider than the page broken where that is possible."""
    stack: list[_Line] = []
    for line in lines:
        stack.append(line)
        while stack:
            one = stack.pop()
            words = _joined(one.tokens)
            parts = _parts(one) if _is_wide(one, words) else [one]
            if len(parts) == 1:
                yield one, words
            else:
                stack.extend(reversed(parts))


def _is_wide(line: _Line, words: str) -> bool:
    """Whether a line with these words is wider than the page; a comment at its end does not count."""
    counted = _joined(line.tokens[:-1]) if line.tokens[-1].kind == "LINE_COMMENT" else words
    return len(INDENT) * line.depth + len(counted) > WIDTH


def _parts(line: _Line) -> list[_Line]:
    """The lines of a line: its items, as many in each as fit, or else the first block in it broken."""
    items = _items(line.tokens)
    if items is None:
        return [line]
    if len(items) > 1:
        runs = _filled(items, WIDTH - len(INDENT) * line.depth)
        return [_Line(line.depth, run, line.is_after_blank and not number) for number, run in enumerate(runs)]
    opening = next((number for number, token in enumerate(line.tokens) if token.kind == "LBRACE"), None)
    if opening is None:
        return [line]
    closing = _closing(line.tokens, opening)
    if closing is None or closing == opening + 1:
        return [line]
    return [
        _Line(line.depth, line.tokens[: opening + 1], line.is_after_blank),
        _Line(line.depth + 1, line.tokens[opening + 1 : closing]),
        _Line(line.depth, line.tokens[closing:]),
    ]


def _items(tokens: Sequence[Token]) -> list[tuple[Token, ...]] | None:
    """The items that a line holds as a whole, each with what follows it; None for a line that begins or ends within one."""
    if not tokens[0].begins_item:
        return None
    items: list[list[Token]] = []
    depth = 0
    for token in tokens:
        if token.begins_item and depth == 0:
            items.append([])
        items[-1].append(token)
        depth += (token.text in _OPENING) - (token.text in _CLOSING)
        if depth < 0:
            return None
    return [tuple(item) for item in items] if depth == 0 else None


def _closing(tokens: Sequence[Token], opening: int) -> int | None:
    depth = 0
    for number in range(opening, len(tokens)):
        depth += (tokens[number].kind == "LBRACE") - (tokens[number].kind == "RBRACE")
        if depth == 0:
            return number
    return None


def _filled(items: Sequence[tuple[Token, ...]], room: int) -> list[tuple[Token, ...]]:
    """Runs of items that fit; an item with a block stands alone."""
    runs: list[tuple[Token, ...]] = []
    was_block = True
    for item in items:
        is_block = any(token.kind == "LBRACE" for token in item)
        if was_block or is_block or len(_joined((*runs[-1], *item))) > room:
            runs.append(item)
        else:
            runs[-1] = (*runs[-1], *item)
        was_block = is_block
    return runs


# ---- spaces --------------------------------------------------------------------------------------------------------------------


def _joined(tokens: Sequence[Token]) -> str:
    """The tokens of a line with the spaces between them."""
    words: list[str] = []
    for number, token in enumerate(tokens):
        if number and not _is_tight(tokens, number):
            words.append(" ")
        words.append(token.text)
    return "".join(words)


def _is_tight(tokens: Sequence[Token], number: int) -> bool:
    """Whether no space stands before the token of this number."""
    token, previous = tokens[number], tokens[number - 1]
    if token.kind in _COMMENTS or previous.kind in _COMMENTS:
        return False
    if previous.text == "{":
        return token.text == "}"
    if token.text in _TIGHT_BEFORE or previous.text in _TIGHT_AFTER:
        return True
    if previous.kind == "LESSTHAN" or token.kind == "MORETHAN":
        return True
    if token.text == "(":
        return not token.begins_item
    return previous.kind in _SIGNS and number > 1 and tokens[number - 2].text == "="
