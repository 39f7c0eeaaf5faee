"""The outline of a xacro file and of the files that it includes, as they are written: elements of macros have no names of the robot."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.diagnostics import Refusal
from hymeko_x.outline import Outline
from hymeko_x.xml.outline import STYLE, block_of, text_file
from hymeko_x.xml.parse import parse

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.source import Source


def outline(source: Source, report: Report) -> Outline:
    """Where everything stands in a xacro file that was read, and in the files that were read with it.

    Raises: Refusal when it is no XML.
    """
    document = parse(source, report, deepest=None)
    root = block_of(document.root, document.data)
    files = {source.name: text_file(source, document)}
    for path in source.files.opened if isinstance(source.files, DiskFiles) else ():
        try:
            other = replace(source, name=path, data=source.files.read(path))
            included = parse(other, report, deepest=None)
        except (Refusal, OSError):  # a list of values, or a picture
            continue
        files[path] = text_file(other, included)
        for child in block_of(included.root, included.data).children:
            root.add(child)
    return Outline(root, files, source.name, STYLE)
