"""`hymeko-x lsp`: the language server, on standard input and output."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.cli import exits

if TYPE_CHECKING:
    import argparse


def lsp_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `lsp`."""
    parser.add_argument("--stdio", action="store_true", help="speak on standard input and output, as it always does")


def run_lsp(chosen: argparse.Namespace) -> int:
    """Serve until the editor ends it."""
    from hymeko_x.server.lsp import make_server

    make_server().start_io()
    return exits.DONE
