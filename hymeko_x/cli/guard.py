"""The outermost line: whatever happens inside a verb ends here, as an exit code and one clear message."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.cli import debugging, exits
from hymeko_x.cli.terminal import show
from hymeko_x.diagnostics import Diagnostic, Refusal, Severity

if TYPE_CHECKING:
    from collections.abc import Callable


class UsageError(Exception):
    """The words on the command line do not fit together."""


def run(verb: str, body: Callable[[], int]) -> int:
    """Run a verb's body; return its exit code, or that of what went wrong."""
    try:
        return body()
    except Refusal as refusal:
        show([refusal.diagnostic])
        return exits.BUG if refusal.diagnostic.code == codes.BUG else exits.FAILED
    except UsageError as error:
        print(f"hymeko-x {verb}: {error}", file=sys.stderr)
        return exits.USAGE
    except BrokenPipeError:
        return _reader_left()
    except KeyboardInterrupt:
        return exits.INTERRUPTED
    except Exception as error:
        if debugging():
            raise
        show([_bug(error)])
        return exits.BUG


def _reader_left() -> int:
    """Whoever read our output has seen enough, which is no failure. Python must not flush into the closed pipe at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return exits.DONE


def _bug(error: Exception) -> Diagnostic:
    import traceback

    frames = traceback.extract_tb(error.__traceback__)
    places = [f"{os.path.relpath(frame.filename, _our_folder())}:{frame.lineno}" for frame in frames if _our_folder() in frame.filename]
    place = places[-1] if places else "an unknown place"
    message = f"{type(error).__name__} at {place}: {error}".rstrip(": ")
    return Diagnostic(codes.BUG, Severity.ERROR, message, hint="HYMEKO_X_DEBUG=1 shows the traceback; please report it with the input")


def _our_folder() -> str:
    return os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
