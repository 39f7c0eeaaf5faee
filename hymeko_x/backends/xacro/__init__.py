"""The xacro backend: the URDF of a mechanism in which macros, properties and arithmetic stand for everything that repeats.

Expanding it gives the elements and attributes that the URDF backend writes, to the letter. docs/mapping/xacro.md
has the mapping.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from hymeko_x.backends.urdf.document import document, residue_elements
from hymeko_x.backends.xacro.elements import DIALECT, top_level
from hymeko_x.backends.xacro.printing import print_file, print_macros
from hymeko_x.backends.xacro.remarks import placed
from hymeko_x.factor.rounds import factor
from hymeko_x.formats.xacro import macros_file
from hymeko_x.source import Package

if TYPE_CHECKING:
    from hymeko_x.backends.urdf.document import UrdfDocument
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Options


def write(mechanism: Mechanism, options: Options, report: Report) -> Package:
    """The xacro file of a mechanism that is legal for URDF.

    Raises: Refusal with HX104 for a joint or a shape that URDF cannot represent.
    """
    del report  # printing takes no decisions, so there is nothing to report
    plain = document(mechanism, options.within)
    forms, remarks = top_level(plain.elements, mechanism)
    factored = factor(forms, DIALECT)
    if not factored.macros or not options.split:
        lines = print_file(plain, factored, placed(factored, remarks))
        return Package(_file(lines, plain), plain.meshes, with_residue=lambda residue: _file(lines, plain, residue))
    beside = f"{options.within}{macros_file(mechanism.name)}"
    lines = print_file(plain, factored, placed(factored, remarks), beside)
    files = {**plain.meshes, beside: print_macros(plain, factored, placed(factored, remarks)).encode()}
    return Package(_file(lines, plain), files, with_residue=lambda residue: _file(lines, plain, residue))


def _file(lines: list[str], plain: UrdfDocument, residue: str = "") -> bytes:
    """The file with the end of its root, and before that a residue in which there is nothing for xacro to evaluate."""
    text = re.sub(r"\$+(?=[{(])", r"\g<0>$", residue)
    kept = [f"  {element}" for element in residue_elements(text, readable=False)]
    return "\n".join([*lines, *kept, "</robot>", *plain.after, ""]).encode()
