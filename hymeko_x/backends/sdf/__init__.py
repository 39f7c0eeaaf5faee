"""The SDF backend: prints a legal mechanism as SDF, poses relative to the joint before, or as the author of an SDF file wrote them.

Deterministic; numbers as the shortest decimals that read back to the same doubles; extras from an SDF file are written where they were.
docs/mapping/sdf.md has the mapping.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.assets.written import contents_of
from hymeko_x.backends.sdf.models import document
from hymeko_x.backends.sdf.sheet import SdfSheet
from hymeko_x.formats import sdf as words
from hymeko_x.source import Package
from hymeko_x.xml.printing import Tag, render
from hymeko_x.xml.text import escaped_lines, parts_of_text

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Options


def write(mechanism: Mechanism, options: Options, report: Report) -> Package:
    """The SDF file of a mechanism. Meshes are referred to by their uris as they are.

    Raises: Refusal with HX104 for a joint or a shape that SDF cannot represent; rewriting replaces those beforehand.
    """
    del report  # printing takes no decisions, so there is nothing to report
    sheet = SdfSheet(mechanism, options.within)
    root = document(sheet)
    before, after = sheet.around()

    def printed(residue: str) -> bytes:
        whole = Tag(root.name, root.attributes, [*root.children, *_residue_elements(residue)])
        return "\n".join(['<?xml version="1.0"?>', *before, *render(whole), *after, ""]).encode()

    return Package(printed(""), contents_of(mechanism, sheet.mesh_files, sheet.images), carry=printed)


def _residue_elements(text: str) -> list[str]:
    """The elements that carry a residue; a prefix makes them custom elements, which readers of SDF leave alone."""
    texts = [f"<![CDATA[\n{part}]]>" if "]]>" not in part else escaped_lines(part) for part in parts_of_text(text)]
    return [f'<{words.RESIDUE} xmlns:hymeko="{words.RESIDUE_NAMESPACE}">{part}</{words.RESIDUE}>' for part in texts]
