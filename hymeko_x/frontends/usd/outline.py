"""The outline of USD text: prims with their attributes and relationships; metadata in parentheses are a block in the one that they are of.

Source: the grammar of .usda files in OpenUSD (``pxr/usd/sdf/textFileFormatParser``).
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.outline import BlockStyle, Outline, OutlineBlock, OutlineField, TextFile

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.source import Source

NAME = "name of the prim"
METADATA = "metadata"
"""The tag of the block that the metadata of a prim or of the layer are."""
STYLE = BlockStyle("\n{", "\n}", rb"[ \t]*(?:#[^\n]*)?", has_lines=True, derived=frozenset({"extent"}), head_tag=METADATA)

_TOKEN = re.compile(
    rb'"""(?s:.)*?"""|\'\'\'(?s:.)*?\'\'\'|"(?:[^"\\\n]|\\.)*"|\'(?:[^\'\\\n]|\\.)*\'|@@@(?s:.)*?@@@|@[^@\n]*@|<[^>\n]*>|#[^\n]*'
    rb"|[()\[\]{}]|\n|=|[ \t\r;]+|[^\s;=\"'@<#()\[\]{}]+|[\"'@<]"
)
_BLANK = (b" ", b"\t", b"\r", b"\n", b"#", b";")
_PAIRS = {b"(": b")", b"[": b"]", b"{": b"}"}
_OPENING, _CLOSING = tuple(_PAIRS), tuple(_PAIRS.values())
_PRIM = re.compile(rb'(def|over|class)[ \t]+(?:([\w:]+)[ \t]+)?("[^"\n]*"|\'[^\'\n]*\')')
_VARIANT_SET = re.compile(rb'variantSet[ \t]+("[^"\n]*")[ \t]*=[ \t]*')
_VARIANT = re.compile(rb'("[^"\n]*")\s*(?=[({])')


def outline(source: Source, report: Report) -> Outline:
    """Where everything stands in the text of a layer. Raises: Refusal when it is no text."""
    data = source.data
    if not data.startswith(b"#usda") and not data.startswith(b"#sdf"):
        raise refuse(codes.UNKNOWN_FORMAT, "the layer is binary: its text cannot be edited", Origin(source.name))
    whole = OutlineBlock("", "", source.name, 0, len(data), 0, 0, (0, len(data)))
    _Reader(data, source.name).read(whole)
    return Outline(whole, {source.name: TextFile(source.name, data)}, source.name, STYLE)


class _Reader:
    """Reads the blocks of one layer from its first byte to its last. Not recursive."""

    def __init__(self, data: bytes, file: str) -> None:
        self.data, self.file, self.at = data, file, 0

    def read(self, whole: OutlineBlock) -> None:
        """Read everything into the block of the whole layer."""
        open_blocks = [whole]
        while True:
            self._skip()
            block = open_blocks[-1]
            if self.at >= len(self.data):
                return
            if self.data[self.at : self.at + 1] in _CLOSING:
                self._close(open_blocks.pop())
                if not open_blocks:
                    raise self._broken("a bracket closes nothing")
                continue
            inner = self._prim() or self._metadata(whole if block is whole else None) or self._variants(block)
            if inner is None:
                self._field(block)
            else:
                block.add(inner)
                open_blocks.append(inner)

    def _broken(self, why: str) -> Exception:
        return refuse(codes.UNKNOWN_FORMAT, f"the text cannot be edited: {why}", Origin(self.file, self.data.count(b"\n", 0, self.at) + 1))

    def _close(self, block: OutlineBlock) -> None:
        assert block.inside is not None
        block.inside = block.inside[0], self.at
        self.at += 1
        block.end = self.at

    def _skip(self) -> None:
        """Go to the next byte that is neither blank nor in a comment."""
        while (found := _TOKEN.match(self.data, self.at)) is not None and found[0][:1] in _BLANK:
            self.at = found.end()

    # ---- blocks --------------------------------------------------------------------------------------------------------------

    def _prim(self) -> OutlineBlock | None:
        found = _PRIM.match(self.data, self.at)
        if found is None:
            return None
        name = found[3][1:-1].decode("utf-8", "replace")
        fields = {NAME: OutlineField(name, found.start(3), found.end(3), found.start(3) + 1, found.end(3) - 1)}
        self.at = found.end()
        return self._opened((found[2] or found[1]).decode(), name, found.start(), fields)

    def _opened(self, tag: str, name: str, start: int, fields: dict[str, OutlineField]) -> OutlineBlock:
        """A block whose head has been read; metadata in its head become a block in it."""
        self._skip()
        metadata = None
        if self.data[self.at : self.at + 1] == b"(":
            metadata = OutlineBlock(METADATA, "", self.file, self.at, self.at, self.at + 1, self.at + 1, (self.at + 1, self.at + 1))
            self.at += 1
            self._fields_of(metadata)
            self._skip()
        if self.data[self.at : self.at + 1] != b"{":
            raise self._broken("a prim has no content in braces")
        self.at += 1
        block = OutlineBlock(tag, name, self.file, start, self.at, self.at, self.at, (self.at, self.at), fields)
        if metadata is not None:
            block.add(metadata)
        return block

    def _fields_of(self, block: OutlineBlock) -> None:
        """Read the fields of metadata up to their closing parenthesis."""
        while True:
            self._skip()
            if self.at >= len(self.data):
                raise self._broken("metadata have no end")
            if self.data[self.at : self.at + 1] == b")":
                self._close(block)
                return
            self._field(block)

    def _metadata(self, whole: OutlineBlock | None) -> OutlineBlock | None:
        """The metadata of the layer, which stand alone."""
        if whole is None or self.data[self.at : self.at + 1] != b"(":
            return None
        self.at += 1
        return OutlineBlock(METADATA, "", self.file, self.at - 1, self.at, self.at, self.at, (self.at, self.at))

    def _variants(self, block: OutlineBlock) -> OutlineBlock | None:
        """A set of variants, or a variant in one."""
        found = _VARIANT_SET.match(self.data, self.at)
        tag = "variantSet" if found is not None else "variant"
        found = found or (_VARIANT.match(self.data, self.at) if block.tag == "variantSet" else None)
        if found is None:
            return None
        self.at = found.end()
        return self._opened(tag, found[1][1:-1].decode("utf-8", "replace"), found.start(), {})

    # ---- fields --------------------------------------------------------------------------------------------------------------

    def _field(self, block: OutlineBlock) -> None:
        """Read a statement: up to the end of its line, or further where brackets are open."""
        start, words, value = self.at, b"", None
        while self.at < len(self.data):
            token = self._token()
            if token[:1] in (b"\n", b"#", b";") or token in _CLOSING:
                self.at -= len(token)
                break
            if token == b"=" and value is None:
                value = self._value()
            elif token in _OPENING:
                self._group(token)
            elif value is None and not token.isspace():
                words = token
        if self.at == start:
            raise self._broken("a statement was expected")
        end = start + len(self.data[start : self.at].rstrip())
        first, last = value or (end, end)
        before = len(self.data[:start].rstrip()) if self.data[max(start - 1, 0) : start].isspace() else start
        text = self.data[first:last].decode("utf-8", "replace")
        block.fields[words.decode("utf-8", "replace")] = OutlineField(text, before, end, first, last)

    def _token(self) -> bytes:
        found = _TOKEN.match(self.data, self.at)
        if found is None:
            raise self._broken("a letter was not expected")
        self.at = found.end()
        return found[0]

    def _value(self) -> tuple[int, int]:
        """Where the value stands that begins here."""
        while self._blank_ahead():
            self.at += 1
        start = self.at
        token = self._token()
        if token in _OPENING:
            self._group(token)
        if self.data[self.at : self.at + 1] == b"<":  # the prim of an asset
            self._token()
        return start, self.at

    def _blank_ahead(self) -> bool:
        return self.data[self.at : self.at + 1] in (b" ", b"\t")

    def _group(self, bracket: bytes) -> None:
        """Go behind the bracket that closes the one that was read last."""
        waiting = [_PAIRS[bracket]]
        while waiting:
            token = self._token() if self.at < len(self.data) else b""
            if token in _OPENING:
                waiting.append(_PAIRS[token])
            elif (token in _CLOSING or not token) and token != waiting.pop():
                raise self._broken("a bracket has no end")
