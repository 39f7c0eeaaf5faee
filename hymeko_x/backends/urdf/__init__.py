"""The URDF backend: prints a legal mechanism as URDF 1.0: one root, joints with at most one dof (or planar, or free).

Deterministic; numbers as the shortest decimals that read back to the same doubles; extras from a URDF file are written
where they were. docs/mapping/urdf.md has the mapping.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.urdf.document import document, residue_elements
from hymeko_x.source import Package
from hymeko_x.xml.printing import Tag, ready, render

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Options


def write(mechanism: Mechanism, options: Options, report: Report) -> Package:
    """The URDF file of a mechanism. Meshes are referred to by their uris as they are.

    Raises: Refusal with HX104 for a joint or a shape that URDF cannot represent; rewriting replaces those beforehand.
    """
    del report  # printing takes no decisions, so there is nothing to report
    made = document(mechanism, options.within, options.mesh_prefix or "")
    made.root.children += [element if isinstance(element, str) else ready(element, 1) for element in made.elements]

    def printed(residue: str) -> bytes:
        root = Tag(made.root.name, made.root.attributes, [*made.root.children, *residue_elements(residue)])
        return "\n".join(['<?xml version="1.0"?>', *made.before, *render(root), *made.after, ""]).encode()

    return Package(printed(""), made.meshes, with_residue=printed)
