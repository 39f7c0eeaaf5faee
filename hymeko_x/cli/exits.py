"""The exit codes, on which scripts rely, and the guard: whatever happens inside a verb ends here, as one code and one message."""

from __future__ import annotations

import errno
import os
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.diagnostics import Diagnostic

DONE = 0
FAILED = 1
USAGE = 2
FAIL_ON = 3
DIFFERENT = 4
BUG = 70
INTERRUPTED = 130

TABLE = (
    "exit: 0 done; 1 the input has errors or cannot be read, or the output cannot be written; 2 usage; 3 --fail-on reached;\n"
    "      4 a difference was found; 70 a bug of ours"
)


class UsageError(Exception):
    """Options and arguments on the command line do not fit together."""


def output_suffix(output: str, allowed: tuple[str, ...]) -> str:
    """The suffix of an output in small letters. Raises: UsageError when it is none of those that are allowed."""
    suffix = os.path.splitext(output)[1].lower()
    if suffix not in allowed:
        raise UsageError(f"the suffix of the output is one of {', '.join(allowed)}, not '{suffix}'")
    return suffix


def guarded(verb: str, body: Callable[[], int]) -> int:
    """Run a verb's body; return its exit code, or that of what went wrong. HYMEKO_X_DEBUG shows the traceback of a bug."""
    from hymeko_x import codes
    from hymeko_x.cli.terminal import show
    from hymeko_x.diagnostics import Refusal, Stopped

    try:
        return body()
    except Stopped as stopped:
        show(stopped.diagnostics)
        print(f"hymeko-x {verb}: stopped by errors, nothing was written; --lenient goes on with what they say", file=sys.stderr)
        return FAILED
    except Refusal as refusal:
        show(refusal.diagnostics)
        return BUG if refusal.diagnostic.code == codes.BUG else FAILED
    except UsageError as error:
        print(f"hymeko-x {verb}: {error}", file=sys.stderr)
        return USAGE
    except BrokenPipeError:
        return _reader_left()
    except KeyboardInterrupt:
        return INTERRUPTED
    except Exception as error:
        if isinstance(error, OSError) and error.errno in _FULL:
            return _output_full(error)
        missing = _missing_library(error)
        if missing is None and os.environ.get("HYMEKO_X_DEBUG"):
            raise
        show([missing or _bug(error)])
        return BUG if missing is None else FAILED


_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""What the system says when standard output takes no more; files report it themselves."""


def _output_full(error: OSError) -> int:
    """Standard output took not all of the result. Python must not flush the rest into it at exit."""
    from hymeko_x import codes
    from hymeko_x.cli.terminal import show
    from hymeko_x.diagnostics import Diagnostic, Severity

    show([Diagnostic(codes.CANNOT_WRITE, Severity.ERROR, f"standard output cannot be written: {error.strerror}")])
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return FAILED


def _reader_left() -> int:
    """The program that read our output has closed the pipe, which is no failure. Python must not flush into it at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return DONE


def _missing_library(error: Exception) -> Diagnostic | None:
    """The advice to install an optional library; None for every other error."""
    if not isinstance(error, ModuleNotFoundError):
        return None
    from hymeko_x.extras import missing_library

    refusal = missing_library(error)
    return None if refusal is None else refusal.diagnostic


def _bug(error: Exception) -> Diagnostic:
    import traceback

    from hymeko_x import codes
    from hymeko_x.diagnostics import Diagnostic, Severity

    frames = traceback.extract_tb(error.__traceback__)
    places = [f"{os.path.relpath(frame.filename, _our_folder())}:{frame.lineno}" for frame in frames if _our_folder() in frame.filename]
    place = places[-1] if places else "an unknown place"
    message = f"{type(error).__name__} at {place}: {error}".rstrip(": ")
    return Diagnostic(codes.BUG, Severity.ERROR, message, hint="HYMEKO_X_DEBUG=1 shows the traceback; please report it with the input")


def _our_folder() -> str:
    return os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
