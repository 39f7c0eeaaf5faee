"""A reader for the tests: its engine crashes on files that ask for it, and has bugs."""

from __future__ import annotations

import os
import signal
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.verify.model import KinematicModel, world_body

if TYPE_CHECKING:
    from pathlib import Path

    from hymeko_x.verify.readers.lookup import Lookup


def read(path: Path, lookup: Lookup) -> KinematicModel:
    """A robot without bodies, called as the file's text and the number of its packages."""
    match path.read_text("utf-8"):
        case "crash":
            os.kill(os.getpid(), signal.SIGSEGV)
        case "bug":
            raise ZeroDivisionError("a bug")
        case "refused":
            raise refuse(codes.ENGINE_REFUSED, "not a robot", Origin(str(path)))
    os.write(1, b"native libraries print what they like\n")
    return KinematicModel(f"{os.environ.get('ROBOT', 'robot')}{len(lookup.packages)}", "sdf", "none", (world_body(),))
