"""What the user chose about the files of xacro, noted for its writer."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from hymeko_x.ir.mechanism import ROOT

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite import Options

SPLIT = "xacro.split"
"""The notation of a mechanism whose macros are to stand in a file of their own."""


def choose_files(mechanism: Mechanism, options: Options, report: Report) -> Mechanism:
    """Note whether the macros go into a file of their own."""
    del report
    if not options.split:
        return mechanism
    own = {**mechanism.notations.get(ROOT, {}), SPLIT: "true"}
    return replace(mechanism, notations={**mechanism.notations, ROOT: own})
