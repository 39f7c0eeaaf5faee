"""`hymeko-x view`: one robot or two in the browser, with sliders, and with what the verifier finds."""

from __future__ import annotations

import asyncio
import ipaddress
import secrets
import threading
from contextlib import redirect_stdout
from functools import partial
from io import StringIO
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.cli import exits
from hymeko_x.cli.comparison import read_side
from hymeko_x.cli.exits import UsageError
from hymeko_x.cli.inputs import input_arguments, lenient_argument
from hymeko_x.cli.verdicts import engine_arguments, verdict_of
from hymeko_x.diagnostics import refuse

if TYPE_CHECKING:
    import argparse


def view_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `view`."""
    parser.add_argument("inputs", nargs="+", metavar="FILE", help="a robot, or two to compare, of any formats")
    parser.add_argument("--host", default="127.0.0.1", metavar="ADDRESS", help="where the page is served (default: this machine alone)")
    parser.add_argument("--port", type=int, default=8080, metavar="N", help="the port (default 8080, or the next that is free)")
    engine_arguments(parser)
    input_arguments(parser)
    lenient_argument(parser)


def run_view(chosen: argparse.Namespace) -> int:
    """Serve the page until the user ends it."""
    if len(chosen.inputs) > 2 or "-" in chosen.inputs:
        raise UsageError("view shows one file or two")
    import viser

    from hymeko_x.draw.view.session import Session

    is_local = _is_loopback(chosen.host)
    with redirect_stdout(StringIO()):  # viser prints where it listens, whatever it is asked for
        server = viser.ViserServer("127.0.0.1", chosen.port if is_local else _INSIDE, label="hymeko-x", verbose=False)
    try:
        with TemporaryDirectory(prefix="hymeko-x-") as folder:
            verify = partial(verdict_of, chosen=chosen)
            session = Session(server, chosen.inputs, partial(read_side, chosen=chosen), verify, folder)
            inside = server.get_port()
            print(f"http://127.0.0.1:{inside}" if is_local else _guarded(chosen.host, chosen.port, inside), flush=True)
            session.watch()
    finally:
        with redirect_stdout(StringIO()):
            server.stop()
    return exits.DONE


_INSIDE = 18080
"""Where the server behind the gate begins to look for a free port."""


def _is_loopback(host: str) -> bool:
    """Whether an address is of this machine alone. Raises: UsageError when it is none."""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError as error:
        raise UsageError(f"--host wants an address such as 0.0.0.0, found '{host}'") from error


def _guarded(host: str, port: int, behind: int) -> str:
    """Serve beyond this machine whoever has the token; the address with it. Raises: Refusal when the port cannot be had."""
    from hymeko_x.draw.view.gate import Gate

    loop = asyncio.new_event_loop()
    threading.Thread(target=loop.run_forever, daemon=True).start()
    token = secrets.token_urlsafe(24)
    gate = Gate(host, port, behind, token)
    try:
        asyncio.run_coroutine_threadsafe(gate.open(), loop).result()
    except OSError as error:
        raise refuse(codes.CANNOT_WRITE, f"{host}:{port} cannot be served: {error.strerror}") from error
    return f"http://{host}:{gate.port}/?token={token}"
