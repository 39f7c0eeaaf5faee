"""xacro out: the URDF of a mechanism with everything said once that repeats, as macros, properties and arithmetic.

Expanding it gives the elements and attributes that the URDF backend writes, to the letter. docs/mapping/xacro.md says
what is written how.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from hymeko_x.backends import urdf
from hymeko_x.backends.xacro.dialect import DIALECT
from hymeko_x.backends.xacro.elements import top_level
from hymeko_x.backends.xacro.printing import print_file, print_macros
from hymeko_x.backends.xacro.remarks import placed
from hymeko_x.factor import factor
from hymeko_x.formats.xacro import macros_file
from hymeko_x.source import Package

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Options


def write(mechanism: Mechanism, options: Options, report: Report) -> Package:
    """The xacro file of a mechanism that is legal for URDF.

    Raises: Refusal with HX104 for what URDF cannot say.
    """
    del report  # printing takes no decisions, so there is nothing to say
    draft = urdf.draft(mechanism, options.within)
    forms, remarks = top_level(draft.elements, mechanism)
    factored = factor(forms, DIALECT)
    if not factored.macros or not options.split:
        lines = print_file(draft, factored, placed(factored, remarks))
        return Package(_file(lines, draft), draft.meshes, carry=lambda residue: _file(lines, draft, residue))
    beside = f"{options.within}{macros_file(mechanism.name)}"
    lines = print_file(draft, factored, placed(factored, remarks), beside)
    files = {**draft.meshes, beside: print_macros(draft, factored, placed(factored, remarks)).encode()}
    return Package(_file(lines, draft), files, carry=lambda residue: _file(lines, draft, residue))


def _file(lines: list[str], draft: urdf.Draft, residue: str = "") -> bytes:
    """The file with the end of its root, and before that a residue in which nothing is left for xacro to evaluate."""
    plain = re.sub(r"\$+(?=[{(])", r"\g<0>$", residue)
    carried = [f"  {element}" for element in urdf.residue_elements(plain, readable=False)]
    return "\n".join([*lines, *carried, "</robot>", *draft.after, ""]).encode()
