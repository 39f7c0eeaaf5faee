"""From bytes to an XML tree, leniently: what other readers of real robot files overlook is repaired and reported.

Strict first. Then known mistakes are repaired in the text (line numbers stay as they are) and the result is read
strictly again. Only then libxml2's recovery has a try, which may leave things out. Entities are never expanded.
"""

from __future__ import annotations

import codecs
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from lxml import etree

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.formats.xml import Node, verbatim

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.source import Source

MAX_BYTES = 256 * 1024 * 1024
KNOWN_PREFIXES = {
    "xacro": "http://www.ros.org/wiki/xacro",
    "drake": "http://drake.mit.edu",
    "gz": "http://gazebosim.org/schema",
}
"""What an undeclared prefix stands for; others become ``urn:prefix``."""


@dataclass(frozen=True, slots=True)
class Document:
    """A read file: its root, and the comments and processing instructions around it, verbatim."""

    root: Node
    preceding: tuple[str, ...]
    following: tuple[str, ...]


def parse(source: Source, report: Report) -> Document:
    """The XML of a source.

    Raises: Refusal with HX004 (not XML), HX007 (too large or too deep), HX008 (it defines entities).
    """
    if len(source.data) > MAX_BYTES:
        raise refuse(codes.TOO_LARGE, f"the file has {len(source.data)} bytes, at most {MAX_BYTES} are read", Origin(source.name))
    root = _read(source, report)
    _check_doctype(root, source, report)
    _drop_default_namespace(root)
    before = [verbatim(node) for node in root.itersiblings(preceding=True) if not _is_declaration(node)]
    after = [verbatim(node) for node in root.itersiblings() if not _is_declaration(node)]
    return Document(Node(root, source.name), tuple(reversed(before)), tuple(after))


def _is_declaration(node: Any) -> bool:
    """Whether a recovered tree took a misplaced XML declaration for a processing instruction."""
    return node.tag is etree.PI and node.target.lower() == "xml"


def _read(source: Source, report: Report) -> Any:
    try:
        return etree.fromstring(source.data, _parser())
    except (etree.XMLSyntaxError, ValueError) as error:
        return _read_again(source, report, error)


def _parser(*, recover: bool = False) -> Any:
    return etree.XMLParser(resolve_entities=False, no_network=True, huge_tree=True, strip_cdata=False, recover=recover)


def _read_again(source: Source, report: Report, error: Exception) -> Any:
    """The second try on repaired text, repair by repair; then the third with libxml2's recovery."""
    _refuse_hopeless(source, error)
    text, said = _decoded(source.data)
    repairs = [said] if said else []
    still = error
    for step in _REPAIRS:
        text, said = step(text)
        if not said and step is not _without_declaration:
            continue
        repairs += [said] if said else []
        try:
            root = etree.fromstring(text.encode(), _parser())
        except (etree.XMLSyntaxError, ValueError) as next_error:
            still = next_error
            continue
        _say_repairs(source, repairs, report, error)
        return root
    return _recover(source, text, repairs, report, still)


def _refuse_hopeless(source: Source, error: Exception) -> None:
    if not source.data.strip(b"\0 \t\r\n\xef\xbb\xbf"):
        raise refuse(codes.NOT_XML, "the file is empty", Origin(source.name)) from error
    if "depth" in str(error):
        raise refuse(codes.TOO_LARGE, "the elements are nested more than 2048 deep", _place(source, error)) from error


def _recover(source: Source, text: str, repairs: list[str], report: Report, error: Exception) -> Any:
    parser = _parser(recover=True)
    try:
        root = etree.fromstring(text.encode(), parser)
    except (etree.XMLSyntaxError, ValueError):
        root = None
    if root is None:
        raise refuse(codes.NOT_XML, f"not XML: {_said(error)}", _place(source, error)) from error
    _say_repairs(source, repairs, report, error)
    report.warn(
        codes.REPAIRED_XML,
        f"not well-formed: {_said(error)}; what could be read was read, and what could not is missing",
        _place(source, error),
    )
    _tidy(root)
    return root


def _say_repairs(source: Source, repairs: list[str], report: Report, error: Exception) -> None:
    for said in repairs:
        report.warn(codes.REPAIRED_XML, said, _place(source, error))


def _said(error: Exception) -> str:
    """libxml2's message without the place, which the diagnostic has in a field of its own."""
    return re.sub(r", line \d+, column \d+.*", "", str(error), flags=re.DOTALL).strip()


def _place(source: Source, error: Exception) -> Origin:
    line, column = getattr(error, "position", (None, None))
    return Origin(source.name, line, column)


def _tidy(root: Any) -> None:
    """Make a recovered tree writable again: no ``--`` in comments, names that are names, no attribute twice."""
    for element in [*root.itersiblings(preceding=True), *root.iter(), *root.itersiblings()]:
        if _is_declaration(element) and element.getparent() is not None:
            element.getparent().remove(element)
        elif element.tag is etree.Comment:
            element.text = re.sub("-(?=-)|-$", "- ", element.text or "")
        elif isinstance(element.tag, str):
            if not _NAME.fullmatch(element.tag):
                element.tag = "_" + re.sub(r"[^\w.-]", "_", element.tag)
            _tidy_attributes(element)


def _tidy_attributes(element: Any) -> None:
    items = element.items()
    good = {name: value for name, value in reversed(items) if _NAME.fullmatch(name)}
    if len(good) == len(items):
        return
    for name, _ in items:
        del element.attrib[name]
    for name, value in reversed(good.items()):
        element.set(name, value)


def _check_doctype(root: Any, source: Source, report: Report) -> None:
    doctype = root.getroottree().docinfo
    if not doctype.doctype:
        return
    if any(True for _ in (doctype.internalDTD.iterentities() if doctype.internalDTD is not None else ())):
        raise refuse(codes.ENTITIES, "the file defines XML entities, which are never expanded", Origin(source.name))
    report.warn(codes.REPAIRED_XML, f"'{doctype.doctype}' is left out: robot files have no document type", Origin(source.name))


def _drop_default_namespace(root: Any) -> None:
    """Elements of the root's default namespace (``<robot xmlns="...">``) go by their plain names."""
    uri = root.nsmap.get(None)
    if uri is None:
        return
    start = f"{{{uri}}}"
    for element in root.iter(f"{start}*"):
        element.tag = element.tag.removeprefix(start)


# ---- repairs of the text -----------------------------------------------------------------------------------------------------

_NAME = re.compile(r"(?:\{[^}]*\})?[^\W\d][\w.-]*")
_PIECES = re.compile(r"<!--.*?(?:-->|\Z)|<!\[CDATA\[.*?(?:\]\]>|\Z)|<\?.*?(?:\?>|\Z)|<[^\s<>!?/][^<>]*>?|[^<]+|<", re.DOTALL)
_DECLARATION = re.compile(r"<\?xml\s[^?>]*\?>")
_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")
_BARE_AMPERSAND = re.compile(r"&(?![A-Za-z_][\w.-]*;|#\d+;|#x[0-9a-fA-F]+;)")
_NO_BLANK = re.compile(r"""(=\s*(?:"[^"]*"|'[^']*'))(?=[\w:])""")
_PREFIX = re.compile(r"""(?:<|\s)([A-Za-z_][\w.-]*):[\w.-]+(?=[\s=/>])""")


def _decoded(data: bytes) -> tuple[str, str]:
    for mark, name in ((codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be")):
        if data.startswith(mark):
            return data[len(mark) :].decode(name, "replace"), ""
    declared = re.search(rb"""<\?xml[^?>]*encoding\s*=\s*["']([\w.-]+)""", data[:1000])
    name = declared[1].decode() if declared else "utf-8"
    for candidate in (name, "utf-8"):
        try:
            text = data.decode(candidate)
        except (UnicodeDecodeError, LookupError):
            continue
        return text, "" if candidate == name else f"the text is not {name}, as it says; read as {candidate}"
    return data.decode("latin-1"), f"the text is not {name}; read as latin-1"


def _without_declaration(text: str) -> tuple[str, str]:
    """Blank the XML declaration out; the text is Unicode by now, and nothing else in it matters."""
    found = _DECLARATION.search(text)
    if found is None:
        return text, ""
    version = re.search(r"""version\s*=\s*["']([^"']*)""", found[0])
    said = ""
    if version is None or version[1] not in ("1.0", "1.1"):
        said = f"the XML declaration says version '{version[1] if version else ''}'; read as 1.0"
    elif found.start() > 0:
        said = "the XML declaration does not stand at the start; read as if it did"
    blank = re.sub(r"[^\n]", " ", found[0])
    return _DECLARATION.sub("", text[: found.start()] + blank + text[found.end() :]), said


def _without_controls(text: str) -> tuple[str, str]:
    clean, count = _CONTROL.subn("", text.rstrip("\0 \t\r\n"))
    said = f"{count} control character{'s' if count > 1 else ''} left out" if count else ""
    if not said and text.endswith("\0"):
        said = "NUL bytes after the end left out"
    return clean, said


def _without_rest(text: str) -> tuple[str, str]:
    end = text.rfind(">") + 1
    rest = text[end:].strip()
    if not end or not rest:
        return text, ""
    return text[:end], "text after the last element left out"


def _with_clean_tags(text: str) -> tuple[str, str]:
    """Blanks between attributes and escaped ampersands; comments and CDATA stay as they are."""
    pieces = []
    changed = set()
    for piece in _PIECES.findall(text):
        clean = piece
        if not piece.startswith(("<!", "<?")):
            clean, count = _BARE_AMPERSAND.subn("&amp;", piece)
            changed |= {"'&' stands where '&amp;' is needed; read as '&'"} if count else set()
        if piece.startswith("<") and not piece.startswith(("<!", "<?")):
            clean, count = _NO_BLANK.subn(r"\1 ", clean)
            changed |= {"attributes without a blank between them; read as if there was one"} if count else set()
        pieces.append(clean)
    return "".join(pieces), "; ".join(sorted(changed))


def _with_prefixes(text: str) -> tuple[str, str]:
    """Declare at the root what is declared nowhere."""
    used: dict[str, None] = {}
    root_end = 0
    place = 0
    for piece in _PIECES.findall(text):
        place += len(piece)
        if not piece.startswith("<") or piece.startswith(("<!", "<?")):
            continue
        root_end = root_end or place
        used.update(dict.fromkeys(_PREFIX.findall(re.sub(r"""=\s*(?:"[^"]*"|'[^']*')""", "=", piece))))
    missing = [p for p in used if p not in ("xml", "xmlns") and not re.search(rf"xmlns:{re.escape(p)}\s*=", text)]
    if not missing or not root_end:
        return text, ""
    at = root_end - (2 if text[root_end - 2] == "/" else 1)
    declared = "".join(f' xmlns:{p}="{KNOWN_PREFIXES.get(p, "urn:" + p)}"' for p in missing)
    said = ", ".join(f"'{p}'" for p in missing)
    return text[:at] + declared + text[at:], f"undeclared prefix {said}; read as if the root declared it"


_REPAIRS = (_without_declaration, _without_controls, _without_rest, _with_clean_tags, _with_prefixes)
"""Cheap ones first. Each takes a text and returns it repaired, with what was repaired in words; lines stay where they are."""
