"""<include>: the content of other files in its place, before anything is read."""

from __future__ import annotations

import posixpath
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf.tree import Element, parse

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.source import Source


def expand_includes(root: Element, source: Source, report: Report) -> Element:
    """The tree with every <include> replaced by what the file's root contains; nested ones as well.

    Raises: Refusal for a file that is missing, or included twice.
    """
    seen: dict[str, Element] = {}
    stack = [root]
    while stack:
        parent = stack.pop()
        for child in parent.children:
            if child.tag == "include":
                parent.children = _expanded(parent.children, source, report, seen)
                break
        stack += [child for child in parent.children if child.children]
    return root


def _expanded(children: list[Element], source: Source, report: Report, seen: dict[str, Element]) -> list[Element]:
    found: list[Element] = []
    queue = list(reversed(children))
    while queue:
        child = queue.pop()
        if child.tag != "include":
            found.append(child)
            continue
        queue.extend(reversed(_included(child, source, report, seen).children))
    return found


def _included(include: Element, source: Source, report: Report, seen: dict[str, Element]) -> Element:
    uri = include.attributes.get("file")
    if not uri:
        raise refuse(codes.MISSING_ATTRIBUTE, "<include> needs a file", include.origin)
    if include.children:
        raise refuse(codes.UNKNOWN_WORD, "<include> has no children", include.origin)
    uri = uri.replace("\\", "/")
    path = source.files.find(uri) or source.files.find(posixpath.join(posixpath.dirname(include.file), uri))
    if path is None:
        raise refuse(codes.CANNOT_READ, f"the included file '{uri}' was not found", include.origin)
    if path in seen:
        first = seen[path].origin
        raise refuse(codes.REPEATED, f"the file '{uri}' is included twice; the first time in {first}", include.origin)
    seen[path] = include
    try:
        data = source.files.read(path)
    except OSError as error:
        raise refuse(codes.CANNOT_READ, f"the included file '{uri}' cannot be read: {error.strerror}", include.origin) from error
    return parse(replace(source, name=uri, data=data), report)
