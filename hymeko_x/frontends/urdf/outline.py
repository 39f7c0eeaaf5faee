"""The outline of a URDF file, which stands in one piece."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.xml.outline import outline_of
from hymeko_x.xml.parse import parse

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.outline import Outline
    from hymeko_x.source import Source


def outline(source: Source, report: Report) -> Outline:
    """Where everything stands in a URDF file. Raises: Refusal when it is no XML."""
    return outline_of(parse(source, report), source.name)
