"""Expanding a xacro file: a child process evaluates it, and this side provides the files that it asks for.

The child (`frontends/xacro/child`) has limits on time and memory, no environment, and opens no file itself, so that what it may
read is decided here, by the `Files` of the source. Python in ${} is the reason: xacro's own fence around it has gaps.
"""

from __future__ import annotations

import json
import re
import subprocess
import threading
from bisect import bisect_right
from contextlib import suppress
from functools import cached_property
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Protocol, cast, runtime_checkable

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.child_process import environment_with, python
from hymeko_x.diagnostics import Diagnostic, Origin, refuse
from hymeko_x.frontends.xacro import messages
from hymeko_x.frontends.xacro.child.limits import ExpansionLimits

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.frontends.xacro.messages import Message
    from hymeko_x.source import Source

CHILD = "hymeko_x.frontends.xacro.child"
MOST_HEADER = 2**28
MOST_BYTES = 2**30
MOST_SOURCE = 2**28
LIMITS = ExpansionLimits()


@runtime_checkable
class Packages(Protocol):
    """Files that know packages as ROS does."""

    def find_package(self, name: str, beside: str) -> str | None:
        """The folder of a package, for the file ``beside``."""
        ...

    def guess_package(self, name: str, beside: str) -> str | None:
        """A folder near by that may be the package under another name."""
        ...

    def match(self, pattern: str) -> list[str]:
        """The files that a pattern with wildcards names."""
        ...


class Expansion(Struct, frozen=True, dict=True):
    """The URDF that a xacro file expands to, and the origins of its elements.

    ``name`` is what the text is called while it is read. On ``lines`` (rising) of the text elements start, which stand
    in the source at ``places``: file, line, and the macro around them. ``root`` and ``children`` are the names of the
    root element and of what is directly in it.
    """

    source: str
    name: str
    text: bytes
    lines: tuple[int, ...]
    places: tuple[tuple[str, int, str | None], ...]
    root: str
    children: frozenset[str]

    def origin(self, line: int | None) -> Origin:
        """The place in the source of what stands on a line of the text."""
        number = bisect_right(self.lines, line or 0) - 1
        return Origin(*self.places[number][:2]) if number >= 0 else Origin(self.source)

    def macro(self, line: int | None) -> str | None:
        """The macro in which the element on this line of the text is written, or None."""
        number = bisect_right(self.lines, line or 0) - 1
        return self.places[number][2] if number >= 0 else None

    def traced(self, diagnostic: Diagnostic) -> Diagnostic:
        """A diagnostic about the text as one about the source."""
        origin = diagnostic.origin and (self.origin(diagnostic.origin.line) if diagnostic.origin.file == self.name else diagnostic.origin)
        return replace(diagnostic, origin=origin, message=self._traced_text(diagnostic.message), hint=self._traced_text(diagnostic.hint))

    def _traced_text(self, text: str) -> str:
        return self._mentions.sub(lambda found: str(self.origin(int(found[1]))), text)

    @property
    def root_origin(self) -> Origin:
        """Where the root element stands."""
        return Origin(*self.places[0][:2])

    @cached_property
    def _mentions(self) -> re.Pattern[str]:
        return re.compile(rf"(?<![\w./-]){re.escape(self.name)}:(\d+)(?::\d+)?")


def expand(source: Source, report: Report, limits: ExpansionLimits = LIMITS) -> Expansion:
    """Expand a xacro file as the library `xacro` does, with our own answers to $(find ...).

    Raises: Refusal HX050 to HX058, HX004 when a file is not XML, HX008 when it defines entities.
    """
    if len(source.data) > MOST_SOURCE:
        raise refuse(codes.TOO_LARGE, f"the file has {len(source.data)} bytes, at most {MOST_SOURCE} are read", Origin(source.name))
    message, text = Conversation(source, limits).result()
    if "failed" in message:
        raise messages.refusal(cast("Message", message["failed"]), source.name, limits)
    report.extend(messages.notice(facts, source.name) for facts in cast("list[Message]", message["notices"]))
    starts = cast("list[tuple[int, str, int, str | None]]", message["places"])
    return Expansion(
        source=source.name,
        name=source.name[: -len(".xacro")] if source.name.lower().endswith(".xacro") else source.name,
        text=text,
        lines=tuple(start[0] for start in starts),
        places=tuple((file, line, macro) for _, file, line, macro in starts),
        root=str(message["root"]),
        children=frozenset(cast("list[str]", message["children"])),
    )


class Conversation:
    """The messages to and from one child, from the job to its result."""

    def __init__(self, source: Source, limits: ExpansionLimits) -> None:
        self._source = source
        self._limits = limits
        self._out_of_time = False

    def result(self) -> tuple[Message, bytes]:
        """The child's result or failure.

        Raises: Refusal HX054 when a limit ended the child before it could report that.
        """
        process = self._started()
        clock = threading.Timer(self._limits.wall_seconds, self._stop, [process])
        clock.start()
        with process:
            try:
                return self._converse(process)
            except (EOFError, BrokenPipeError) as error:
                process.wait()
                raise messages.ended(process.returncode, self._source.name, self._limits, slow=self._out_of_time) from error
            finally:
                clock.cancel()
                process.kill()
                _close(process)

    def _started(self) -> subprocess.Popen[bytes]:
        pipe, nowhere = subprocess.PIPE, subprocess.DEVNULL
        environment = environment_with("hymeko_x", "xacro", "yaml")
        try:
            return subprocess.Popen(python("-m", CHILD), env=environment, stdin=pipe, stdout=pipe, stderr=nowhere)
        except OSError as error:
            message = f"no process can be started for the expansion: {error}"
            raise refuse(codes.EXPANSION_FAILED, message, Origin(self._source.name)) from error

    def _stop(self, process: subprocess.Popen[bytes]) -> None:
        self._out_of_time = True
        process.kill()

    def _converse(self, process: subprocess.Popen[bytes]) -> tuple[Message, bytes]:
        self._send(process, self._job(), self._source.data)
        while True:
            message, data = _receive(process)
            if "ask" not in message:
                return message, data
            self._send(process, *self._answer(message))

    def _job(self) -> Message:
        return {
            "name": PurePosixPath(self._source.name.replace("\\", "/")).name,
            "shown": self._source.name,
            "arguments": dict(self._source.arguments),
            "environment": dict(self._source.environment),
            "cpu_seconds": self._limits.cpu_seconds,
            "memory_bytes": self._limits.memory_bytes,
        }

    def _send(self, process: subprocess.Popen[bytes], message: Message, data: bytes) -> None:
        assert process.stdin is not None
        process.stdin.write(json.dumps({**message, "bytes": len(data)}).encode() + b"\n")
        process.stdin.write(data)
        process.stdin.flush()

    # ---- answers ---------------------------------------------------------------------------------------------------------

    def _answer(self, message: Message) -> tuple[Message, bytes]:
        match message["ask"]:
            case "read":
                return self._read(str(message["path"]))
            case "match":
                files = self._source.files
                found = files.match(str(message["pattern"])) if isinstance(files, Packages) else []
                return {"paths": found}, b""
            case "find":
                return self._find(str(message["package"]), str(message["beside"])), b""
            case unknown:
                raise EOFError(f"the child asks for '{unknown}'")

    def _read(self, path: str) -> tuple[Message, bytes]:
        found = self._source.files.find(path)
        if found is None:
            return {"error": "no such file, or none that may be read"}, b""
        try:
            return {"path": found}, self._source.files.read(found)
        except OSError as error:
            return {"error": error.strerror or str(error)}, b""

    def _find(self, package: str, beside: str) -> Message:
        """The folder of a package; where the files know no packages, that of its `package.xml`."""
        files = self._source.files
        if not isinstance(files, Packages):
            description = files.find(f"package://{package}/package.xml")
            return {"folder": description and str(PurePosixPath(description).parent), "guessed": False}
        folder = files.find_package(package, beside)
        return {"folder": folder or files.guess_package(package, beside), "guessed": folder is None}


def _close(process: subprocess.Popen[bytes]) -> None:
    """Close the pipe to the child, which may have ended with half a message unread."""
    assert process.stdin is not None
    with suppress(OSError):
        process.stdin.close()


def _receive(process: subprocess.Popen[bytes]) -> tuple[Message, bytes]:
    """The child's next message. Raises: EOFError when it ended, or sends anything else because an expression broke out of xacro."""
    assert process.stdout is not None
    line = process.stdout.readline(MOST_HEADER)
    if not line.endswith(b"\n"):
        raise EOFError
    try:
        message = json.loads(line)
        size = int(message["bytes"])
    except (ValueError, KeyError, TypeError) as error:
        raise EOFError from error
    if not 0 <= size <= MOST_BYTES:
        raise EOFError
    return message, process.stdout.read(size)
