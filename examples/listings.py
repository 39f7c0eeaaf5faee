"""Runs the listings of a page in a folder: those with a name become files, Python is run; prints what it prints.

python examples/listings.py docs/robot.md FOLDER
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
from pathlib import Path

LISTING = re.compile(r"```(\w+)(?: (\S+))?\n(.*?)```\n", re.DOTALL)


def run(page: Path) -> list[str]:
    """What each Python listing prints; files go into the current folder, and all listings share their names."""
    names: dict[str, object] = {}
    printed = []
    for language, name, content in LISTING.findall(page.read_text("utf-8")):
        if name:
            Path(name).write_text(content)
        elif language == "python":
            with contextlib.redirect_stdout(io.StringIO()) as out:
                exec(compile(content, str(page), "exec"), names)
            printed.append(out.getvalue())
    return printed


if __name__ == "__main__":
    page = Path(sys.argv[1]).resolve()
    os.chdir(sys.argv[2])
    print("".join(run(page)), end="")
