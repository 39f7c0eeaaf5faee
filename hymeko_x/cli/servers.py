"""`hymeko-x lsp`, `mcp`: servers for editors and for language models, on standard input and output."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from hymeko_x.cli import exits
from hymeko_x.cli.inputs import folder

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


def mcp_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `mcp`."""
    where = "the folder to which the tools are confined (default: the working folder)"
    parser.add_argument("folder", nargs="?", type=folder, default=Path(), metavar="DIR", help=where)


def run_mcp(chosen: argparse.Namespace) -> int:
    """Serve until the client ends it."""
    from hymeko_x.mcp.tools import make_server

    make_server(chosen.folder).run("stdio")
    return exits.DONE
