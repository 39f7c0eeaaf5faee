"""The processor time and the peak memory of a whole process. POSIX."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

_STARTER = """\
import os, sys
null = os.open(os.devnull, os.O_WRONLY)
actions = [(os.POSIX_SPAWN_DUP2, null, 1), (os.POSIX_SPAWN_DUP2, null, 2)]
_, status, usage = os.wait4(os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ, file_actions=actions), 0)
assert status == 0, f"{sys.argv} ended with {status}"
print(usage.ru_utime + usage.ru_stime, usage.ru_maxrss)
"""


def run(command: Sequence[str], *, limit: float | None = None) -> tuple[float, float]:
    """The processor time in s and the peak memory in MB of a process, which a small one starts: it would begin with our memory else.

    Raises: subprocess.CalledProcessError when it fails, subprocess.TimeoutExpired when it takes more than ``limit`` seconds.
    """
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    starter = [sys.executable, "-S", "-c", _STARTER, *command]
    with subprocess.Popen(starter, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment, start_new_session=True) as process:
        try:
            printed, complaint = process.communicate(timeout=limit)
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)
            raise
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, command, printed, complaint)
    seconds, memory = map(float, printed.split())
    return seconds, memory / (2**20 if sys.platform == "darwin" else 2**10)
