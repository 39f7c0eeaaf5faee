"""How a stage is to be laid out, noted where the writer finds it: files of their own for its aspects, bodies inside of one another."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from hymeko_x.ir.mechanism import ROOT

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.legalize import Options
    from hymeko_x.ir.mechanism import Mechanism

LAYOUT = "usd.layout"
"""The notation of the mechanism that says ``layered`` where the stage has a file for each of its aspects."""
NESTED = "usd.nested"
"""The notation of the mechanism that says ``true`` where each body is inside of its parent."""

POINTS = "usd.points"
"""The notation of the mechanism that names the crate file which holds what is too long for a text."""


def choose_layout(mechanism: Mechanism, options: Options, report: Report) -> Mechanism:
    """Note the options about the layout of a stage; without them it stays as it was. Meshes go beside it if they can."""
    del report
    own = dict(mechanism.notations.get(ROOT, {}))
    wanted = dict(own)
    if options.layout is not None:
        wanted[LAYOUT] = options.layout
    if options.nested is not None:
        wanted[NESTED] = "true" if options.nested else "false"
    if options.beside:
        wanted[POINTS] = f"{options.beside}_meshes.usdc"
    return replace(mechanism, notations={**mechanism.notations, ROOT: wanted}) if wanted != own else mechanism
