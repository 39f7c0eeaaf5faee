"""Running a verb of the command line for a model: in a process of its own, with limits on time and on what comes back.

A damaged file may end the process of a native library; it does not end the server.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from typing import IO, TYPE_CHECKING

import anyio
from msgspec import Struct

if TYPE_CHECKING:
    from pathlib import Path

MOST_SECONDS = 120.0
MOST_CHARACTERS = 30_000
"""Of each of output and messages: a model has to read them."""

MEANINGS = {0: "done", 1: "it has errors, or cannot be read or written", 2: "wrong use", 3: "the check failed", 4: "a difference was found"}
_FAILED = (1, 2)


class Answer(Struct, frozen=True):
    """What a verb printed, and its exit code (None: it took too long)."""

    code: int | None
    output: str
    messages: str

    @property
    def is_failure(self) -> bool:
        """Whether the question has no answer."""
        return self.code not in MEANINGS or self.code in _FAILED

    @property
    def text(self) -> str:
        """For the model: how it ended, what was printed, and the messages."""
        ended = f"stopped after {MOST_SECONDS:g} s" if self.code is None else MEANINGS.get(self.code, "a bug, or a library broke off")
        return "\n".join(filter(None, (f"exit {self.code}: {ended}", self.output.rstrip(), self.messages.rstrip())))


async def run(words: list[str], folder: Path) -> Answer:
    """Run `hymeko-x WORDS` in the folder."""
    command = [sys.executable, "-P", "-m", "hymeko_x", *words]  # -P: no module of the folder is imported
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as messages:
        process = await anyio.open_process(
            command, stdin=subprocess.DEVNULL, stdout=output, stderr=messages, cwd=folder, env=_environment(), start_new_session=True
        )
        try:
            with anyio.move_on_after(MOST_SECONDS) as clock:
                await process.wait()
        finally:
            if process.returncode is None:
                process.kill()
                with anyio.CancelScope(shield=True):
                    await process.wait()
        code = None if clock.cancelled_caught else process.returncode
        return Answer(code, _text(output), _text(messages))


def _environment() -> dict[str, str]:
    """The environment without what leads a robot to packages elsewhere."""
    outside = ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH", "HYMEKO_X_DEBUG")
    kept = {name: value for name, value in os.environ.items() if name not in outside}
    return {**kept, "NO_COLOR": "1", "PYTHONIOENCODING": "utf-8"}


def _text(file: IO[bytes]) -> str:
    """The beginning of what was printed."""
    length = file.seek(0, os.SEEK_END)
    file.seek(0)
    text = file.read(4 * MOST_CHARACTERS).decode("utf-8", "replace")
    if len(text) <= MOST_CHARACTERS and length <= 4 * MOST_CHARACTERS:
        return text
    return f"{text[:MOST_CHARACTERS]}\n... cut off: {length} bytes were printed; ask for less"
