"""Names that an XML attribute cannot hold, or that a target would read as no name at all."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.ir.rename import names_in_use, rename

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.legalize import Options
    from hymeko_x.ir.mechanism import Id, Mechanism

_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def make_names_usable(mechanism: Mechanism, options: Options, report: Report) -> Mechanism:
    """Empty names become the kind of the element, characters that XML forbids become ``_``."""
    del options
    names = names_in_use(mechanism)
    renamed: dict[Id, Id] = {}
    for key in (*mechanism.graph.vertices, *mechanism.graph.edges):
        if key.name and not _NOT_XML.search(key.name):
            continue
        new = names.take(key.kind, _NOT_XML.sub("_", key.name) or key.kind)
        renamed[key] = new
        found = "is empty" if not key.name else f"{key.name!r} has characters that XML cannot hold"
        report.warn(
            codes.RENAMED, f"the name of a {key.kind} {found}; it is written as '{new.name}'", mechanism.origin(key), element=str(new)
        )
    return rename(mechanism, renamed)
