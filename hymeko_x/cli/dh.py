"""`hymeko-x dh FILE`: Denavit-Hartenberg tables of every chain, or of the one to a body."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from hymeko_x.assets.resolve import search_path
from hymeko_x.cli import exits
from hymeko_x.cli.dh_tables import FORMATS
from hymeko_x.cli.inputs import engine_input, input_arguments, refuse_own_reading

if TYPE_CHECKING:
    import argparse

_EXACT = 1e-9


def dh_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `dh`."""
    parser.add_argument("input", metavar="FILE", help="a robot in any format")
    conventions = ("standard", "modified", "hayati")
    parser.add_argument("--convention", choices=conventions, default="standard", help="how the numbers are grouped (default standard)")
    parser.add_argument("--tip", metavar="BODY", help="the body at the end of the chain (default: every chain's end)")
    parser.add_argument("--check", action="store_true", help="compare the tables' kinematics with Pinocchio's; exit 4 beyond 1e-9")
    what = "text, a table of Markdown or LaTeX, CSV or JSON with all digits (default text)"
    parser.add_argument("--format", dest="style", choices=tuple(FORMATS), default="text", help=what)
    parser.add_argument("--json", dest="style", action="store_const", const="json", help="the same as --format json")
    input_arguments(parser)


def run_dh(chosen: argparse.Namespace) -> int:
    """Print one table per chain: a row per joint between two constant transformations. Angles in rad, lengths in m."""
    from hymeko_x.verify import dh, model_of

    refuse_own_reading(chosen)
    found = engine_input(chosen.input, chosen)
    arguments = {**found.arguments, **dict(chosen.arg)}
    model = model_of(found.path, packages=dict(chosen.package), search_path=search_path(os.environ), arguments=arguments)
    tips = [chosen.tip] if chosen.tip else [tip for tip in dh.chains(model) if dh.chain(model, tip)[1]]
    tables = [dh.table(model, tip, dh.Convention(chosen.convention), as_data_sheet=True) for tip in tips or [None]]
    errors = [dh.error_against_pinocchio(model, table) if chosen.check else None for table in tables]
    print(FORMATS[chosen.style](list(zip(tables, errors, strict=True))), end="")
    return exits.DIFFERENT if any(error is not None and not error <= _EXACT for error in errors) else exits.DONE
