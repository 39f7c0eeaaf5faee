"""From bytes to a tree of nodes, leniently: what other readers of real robot files overlook is repaired and reported.

Strict first, with expat. Then known mistakes are repaired in the text (line numbers stay as they are) and the result is
read strictly again. Only then libxml2's recovery has a try, which may leave things out. Entities are never expanded,
nothing recurses, and nothing is ever fetched.
"""

from __future__ import annotations

import codecs
import re
from typing import TYPE_CHECKING
from xml.parsers import expat

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, Report, refuse
from hymeko_x.xml.tree import MAX_DEPTH, TreeBuilder

if TYPE_CHECKING:
    from hymeko_x.source import Source
    from hymeko_x.xml.tree import XmlDocument, XmlNode

MAX_BYTES = 256 * 1024 * 1024
_ENCODING = re.compile(rb"""\s*<\?xml[^?>]*encoding\s*=\s*["']([\w.-]+)""")


def parse(source: Source, report: Report, *, comments: bool = False, deepest: int | None = MAX_DEPTH) -> XmlDocument:
    """The XML of a source; ``comments`` and ``deepest`` as :class:`TreeBuilder` takes them.

    Raises: Refusal with HX004 (not XML), HX007 (too large or too deep), HX008 (it defines entities).
    """
    if len(source.data) > MAX_BYTES:
        raise refuse(codes.TOO_LARGE, f"the file has {len(source.data)} bytes, at most {MAX_BYTES} are read", Origin(source.name))
    diagnostics = Report()
    try:
        document = TreeBuilder(source.name, _utf8(source, diagnostics), diagnostics, comments=comments, deepest=deepest).document()
    except expat.ExpatError as error:
        from hymeko_x.xml.repair import read_again  # with lxml, which well-formed files do not need

        diagnostics = Report()
        document = read_again(source, diagnostics, error, comments=comments, deepest=deepest)
    report.extend(diagnostics)
    return document


def parse_text(text: str, *, namespaces: bool = False) -> XmlNode:
    """The element that a piece of text is, with its comments. Raises: ExpatError when it is none.

    ``namespaces``: a prefix that is not declared is an error as well.
    """
    if namespaces and ":" in text:
        expat.ParserCreate(namespace_separator=" ").Parse(text.encode(), True)
    return TreeBuilder("", text.encode(), Report(), comments=True, deepest=None).document().root


def _utf8(source: Source, report: Report) -> bytes:
    """The same text in UTF-8 where it is in the other encoding that its mark or its declaration names."""
    declared = _ENCODING.match(source.data[:200])
    marked = source.data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    if not marked and (declared is None or declared[1].lower() in (b"utf-8", b"utf8", b"us-ascii", b"ascii")):
        return source.data.removeprefix(codecs.BOM_UTF8)
    from hymeko_x.xml.repair import decoded, without_declaration

    text, wrong = decoded(source.data)
    text, repaired = without_declaration(text)
    for message in filter(None, (wrong, repaired)):
        report.warn(codes.REPAIRED_XML, message, Origin(source.name, 1))
    return text.encode()
