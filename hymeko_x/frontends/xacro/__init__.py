"""The xacro frontend: a file is expanded in a child process and read as URDF, with the origins in the xacro files.

Source: the xacro language as the library `xacro` evaluates it; docs/mapping/xacro.md lists the differences.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.source import Reading, Source


def read(source: Source, report: Report) -> Reading:
    """The mechanism that a xacro file describes, and the residue that it contains.

    Raises: Refusal HX050 to HX058 when it cannot be expanded or is no URDF, and those of URDF.
    """
    from hymeko_x.frontends.xacro import reading  # here: the child process loads this file as well, and has to start quickly

    return reading.read(source, report)
