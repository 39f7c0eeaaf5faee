"""The second and the third try to read XML: known mistakes repaired in the text, then libxml2's recovery, which may leave things out."""

from __future__ import annotations

import codecs
import re
from typing import TYPE_CHECKING, Any
from xml.parsers import expat

from lxml import etree

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.xml.text import without_hyphens_in_a_row
from hymeko_x.xml.tree import TreeBuilder

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.source import Source
    from hymeko_x.xml.tree import XmlDocument


def read_again(source: Source, report: Report, error: expat.ExpatError, *, comments: bool, deepest: int | None) -> XmlDocument:
    """The second try on repaired text, repair by repair; then the third with libxml2's recovery."""
    if not source.data.strip(b"\0 \t\r\n\xef\xbb\xbf"):
        raise refuse(codes.NOT_XML, "the file is empty", Origin(source.name)) from error
    place = _place(source, error)
    text, message = decoded(source.data)
    repairs = [message] if message else []
    still = error
    for step in _REPAIRS:
        text, message = step(text)
        if not message and step is not without_declaration:
            continue
        repairs += [message] if message else []
        try:
            document = TreeBuilder(source.name, text.encode(), report, comments=comments, deepest=deepest).document()
        except expat.ExpatError as next_error:
            still = next_error
            continue
        for message in repairs:
            report.warn(codes.REPAIRED_XML, message, place)
        return document
    return _recover(source, text, repairs, report, still, comments=comments, deepest=deepest)


def _recover(
    source: Source, text: str, repairs: list[str], report: Report, error: expat.ExpatError, *, comments: bool, deepest: int | None
) -> XmlDocument:
    place = _place(source, error)
    parser = etree.XMLParser(resolve_entities=False, no_network=True, huge_tree=True, strip_cdata=False, recover=True)
    try:
        root = etree.fromstring(text.encode(), parser)
    except (etree.XMLSyntaxError, ValueError):
        root = None
    if root is None:
        raise refuse(codes.NOT_XML, f"not XML: {expat.errors.messages[error.code]}", place) from error
    for message in repairs:
        report.warn(codes.REPAIRED_XML, message, place)
    message = f"not well-formed: {expat.errors.messages[error.code]}; what could be read was read, and what could not is missing"
    report.error(codes.NOT_WELL_FORMED, message, place)
    _tidy(root)
    around = [*reversed(list(root.itersiblings(preceding=True))), root, *root.itersiblings()]
    data = b"\n".join(etree.tostring(node, encoding="utf-8", with_tail=False) for node in around if not _is_declaration(node))
    lines = iter([element.sourceline for element in root.iter("*")])
    try:
        return TreeBuilder(source.name, data, report, lines, comments=comments, deepest=deepest).document()
    except expat.ExpatError as worse:
        raise refuse(codes.NOT_XML, f"not XML: {expat.errors.messages[error.code]}", place) from worse


def _place(source: Source, error: expat.ExpatError) -> Origin:
    return Origin(source.name, error.lineno, error.offset + 1)


def _is_declaration(node: Any) -> bool:
    """Whether a recovered tree took a misplaced XML declaration for a processing instruction."""
    return node.tag is etree.PI and node.target.lower() == "xml"


def _tidy(root: Any) -> None:
    """Make a recovered tree writable again: no ``--`` in comments, names that are names, no attribute twice."""
    for element in [*root.itersiblings(preceding=True), *root.iter(), *root.itersiblings()]:
        if element.getparent() is not None and (_is_declaration(element) or element.tag is etree.Entity):
            _drop(element)
        elif element.tag is etree.Comment:
            element.text = _comment_text(element.text or "")
        elif isinstance(element.tag, str):
            if not _NAME.fullmatch(element.tag):
                element.tag = "_" + re.sub(r"[^\w.-]", "_", element.tag)
            _tidy_attributes(element)


def _comment_text(text: str) -> str:
    """The text of a comment without hyphens that XML does not allow, also not at its end."""
    plain = without_hyphens_in_a_row(text)
    return f"{plain} " if plain.endswith("-") else plain


def _drop(node: Any) -> None:
    """Take a node out, but leave the text behind it."""
    parent, before, text = node.getparent(), node.getprevious(), node.tail or ""
    if before is not None:
        before.tail = (before.tail or "") + text
    else:
        parent.text = (parent.text or "") + text
    parent.remove(node)


def _tidy_attributes(element: Any) -> None:
    items = element.items()
    good = {name: value for name, value in reversed(items) if _NAME.fullmatch(name)}
    if len(good) == len(items):
        return
    element.attrib.clear()
    for name, value in reversed(good.items()):
        element.set(name, value)


# ---- repairs of the text -----------------------------------------------------------------------------------------------------

_NAME = re.compile(r"(?:\{[^}]*\})?[^\W\d][\w.-]*")
_PIECES = re.compile(r"<!--.*?(?:-->|\Z)|<!\[CDATA\[.*?(?:\]\]>|\Z)|<\?.*?(?:\?>|\Z)|<[^\s<>!?][^<>]*>?|[^<]+|<", re.DOTALL)
_DECLARATION = re.compile(r"<\?xml\s[^?>]*\?>")
_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")
_REFERENCE = re.compile(r"&#(\d{1,30}|x[0-9a-fA-F]{1,30});")
_BARE_AMPERSAND = re.compile(r"&(?![A-Za-z_][\w.-]*;|#\d+;|#x[0-9a-fA-F]+;)")
_NO_BLANK = re.compile(r"""(=\s*(?:"[^"]*"|'[^']*'))(?=[\w:])""")
_OTHER_BLANKS = re.compile(r"""("[^"]*"|'[^']*')|[\xa0\u2000-\u200b\u202f\u205f\u3000\ufeff]""")
"""A quoted value, or a blank of typesetting, such as the no-break spaces in text that was copied from a page."""


def decoded(data: bytes) -> tuple[str, str]:
    """The text of a file, and a note about its encoding; no note where the encoding is the declared one."""
    for mark, name in ((codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be")):
        if data.startswith(mark):
            return data[len(mark) :].decode(name, "replace"), ""
    declared = re.search(rb"""<\?xml[^?>]*encoding\s*=\s*["']([\w.-]+)""", data[:1000])
    name = declared[1].decode() if declared else "utf-8"
    for candidate in (name, "utf-8"):
        try:
            text = data.decode(candidate)
        except (UnicodeError, LookupError):
            continue
        return text, "" if candidate == name else f"the text is not {name}, as declared; read as {candidate}"
    return data.decode("latin-1"), f"the text is not {name}; read as latin-1"


def without_declaration(text: str) -> tuple[str, str]:
    """Blank the XML declaration out; the text is Unicode by now, and nothing else in it matters."""
    found = _DECLARATION.search(text)
    if found is None:
        return text, ""
    version = re.search(r"""version\s*=\s*["']([^"']*)""", found[0])
    message = ""
    if version is None or version[1] not in ("1.0", "1.1"):
        message = f"the version in the XML declaration is '{version[1] if version else ''}'; read as 1.0"
    elif found.start() > 0:
        message = "the XML declaration does not stand at the start; read as if it did"
    blank = re.sub(r"[^\n]", " ", found[0])
    return _DECLARATION.sub("", text[: found.start()] + blank + text[found.end() :]), message


def _without_controls(text: str) -> tuple[str, str]:
    clean, count = _CONTROL.subn("", text.rstrip("\0 \t\r\n"))
    wrong = sum(not _is_character(found[1]) for found in _REFERENCE.finditer(clean))
    if wrong:
        clean = _REFERENCE.sub(lambda found: found[0] if _is_character(found[1]) else "", clean)
    count += wrong
    message = f"{count} control character{'s' if count > 1 else ''} left out" if count else ""
    if not message and text.endswith("\0"):
        message = "NUL bytes after the end left out"
    return clean, message


def _is_character(number: str) -> bool:
    """Whether the number of a character reference is that of a character that XML allows."""
    value = int(number[1:], 16) if number.startswith("x") else int(number)
    return value in (9, 10, 13) or 32 <= value < 0xD800 or 0xE000 <= value < 0xFFFE or 0x10000 <= value < 0x110000


def _without_rest(text: str) -> tuple[str, str]:
    end = text.rfind(">") + 1
    rest = text[end:].strip()
    if not end or not rest:
        return text, ""
    return text[:end], "text after the last element left out"


def _with_clean_tags(text: str) -> tuple[str, str]:
    """Blanks between attributes that are blanks to XML, escaped ampersands, and comments without ``--``; CDATA stays as it is."""
    pieces = []
    changed: set[str] = set()
    for piece in _PIECES.findall(text):
        clean = piece
        if piece.startswith("<!--"):
            text = piece[4:].removesuffix("-->")
            clean = f"<!--{_comment_text(text)}-->"
            message = "'---' within a comment; read as '==='" if "---" in text else "'--' within a comment; read as '- -'"
            changed |= {message} if clean != piece else set()
        elif not piece.startswith(("<!", "<?")):
            clean, count = _BARE_AMPERSAND.subn("&amp;", piece)
            changed |= {"'&' stands where '&amp;' is needed; read as '&'"} if count else set()
        if piece.startswith("<") and not piece.startswith(("<!", "<?")):
            plain = _OTHER_BLANKS.sub(lambda found: found[1] or " ", clean)
            changed |= {"no-break or other typographic spaces between attributes; read as spaces"} if plain != clean else set()
            clean, count = _NO_BLANK.subn(r"\1 ", plain)
            changed |= {"attributes without a blank between them; read as if there was one"} if count else set()
        pieces.append(clean)
    return "".join(pieces), "; ".join(sorted(changed))


_REPAIRS = (without_declaration, _without_controls, _without_rest, _with_clean_tags)
"""Cheap ones first. Each takes a text and returns it repaired, with a message about the repair; line numbers stay."""
