"""xacro as the library `xacro` expands it, read as URDF.

The library runs in this project's child process, which gives out files and package folders but takes no part in the expansion.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, Refusal, Report, refuse
from hymeko_x.frontends.xacro.expand import expand
from hymeko_x.source import Source
from hymeko_x.verify.readers import urdf

if TYPE_CHECKING:
    from pathlib import Path

    from hymeko_x.verify.model import KinematicModel
    from hymeko_x.verify.readers.lookup import Lookup


def read(path: Path, lookup: Lookup) -> KinematicModel:
    """The robot that urdfdom sees in the expansion. Raises: Refusal HX302 in the words of xacro or urdfdom."""
    source = Source(str(path), path.read_bytes(), lookup.files(path.parent), lookup.arguments)
    try:
        expansion = expand(source, Report())
    except Refusal as refusal:
        raise refuse(codes.ENGINE_REFUSED, f"xacro refuses the file: {refusal.diagnostic.message}", Origin(str(path))) from refusal
    found = urdf.read_text(expansion.text, path, lookup)
    return replace(found, engine=f"xacro, {found.engine}")
