"""`hymeko-x mcp`: the tools for language models, on standard input and output."""

from __future__ import annotations

import argparse
from pathlib import Path

from hymeko_x.cli import exits


def mcp_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `mcp`."""
    where = "the folder to which the tools are confined (default: the working folder)"
    parser.add_argument("folder", nargs="?", type=_folder, default=Path(), metavar="DIR", help=where)


def run_mcp(chosen: argparse.Namespace) -> int:
    """Serve until the client ends it."""
    from hymeko_x.mcp.tools import make_server

    make_server(chosen.folder).run("stdio")
    return exits.DONE


def _folder(text: str) -> Path:
    if not Path(text).is_dir():
        raise argparse.ArgumentTypeError(f"there is no folder '{text}'")
    return Path(text)
