"""Every MJCF of a folder through our reader and writer: is the recompiled mjModel the original's, bit for bit?

python -m benchmarks.mjcf_exact [FOLDER ...] [--table docs/mapping/mjcf_exact.md] [--match TEXT]

Without a folder all packages of the corpus cache that have MJCF are taken. Each file has a process and a time limit of its own.
"""

from __future__ import annotations

import argparse
import contextlib
import multiprocessing
import os
import re
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import mujoco
from msgspec import Struct

from hymeko_x.corpus.cache import cache_root
from hymeko_x.diagnostics import Refusal
from tests.mjcf import mjmodels

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from multiprocessing.connection import Connection

T = TypeVar("T")

SECONDS = 300.0
"""How long one file may take."""

EQUAL = "equal"
MISSING = "a file is missing"
STATES = (EQUAL, "different", "refused by us alone", "failed", "refused by MuJoCo alone", MISSING, "refused by both")

_ROOT = re.compile(rb"<mujoco[\s>]")
_KINDS = ("*.xml", "*.mjcf")
_CHECKSUM = re.compile("-[0-9a-f]{8}$")
_EXPLAINED = (EQUAL, MISSING, "refused by both")


class Finding(Struct, frozen=True):
    """What became of one file: the state of its direct way and of that through HyMeKo text, and why."""

    path: str
    direct: str
    text: str
    why: str = ""
    seconds: float = 0.0


def main() -> int:
    """Print a line per file that is not equal, and the table of all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="*", type=Path, help="folders of unpacked packages, one table row each")
    parser.add_argument("--table", type=Path, help="write the table to this file")
    parser.add_argument("--match", default="", help="only files whose path has this in it")
    parser.add_argument("--verbose", action="store_true", help="print a line for every file")
    options = parser.parse_args()
    folders = options.folders or sorted((cache_root(os.environ) / "corpus").iterdir())
    rows = []
    for folder in folders:
        findings = [examined(path) for path in models(folder) if options.match in str(path)]
        rows += [(_CHECKSUM.sub("", folder.name), findings)] if findings else []
        for found in findings:
            if options.verbose or (found.direct, found.text) != (EQUAL, EQUAL):
                print(f"{found.path}\t{found.direct}\t{found.text}\t{found.seconds:.1f} s\t{found.why}", flush=True)
    print(table(rows))
    if options.table:
        options.table.write_text(page(rows))
    bad = ("different", "refused by us alone", "failed")
    return 1 if any(_worst(found) in bad for _, findings in rows for found in findings) else 0


def models(folder: Path) -> Iterator[Path]:
    """All files below a folder whose root element is <mujoco>."""
    for path in sorted(path for kind in _KINDS for path in folder.rglob(kind)):
        if _ROOT.search(re.sub(rb"<!--.*?-->", b"", path.read_bytes(), flags=re.DOTALL)):
            yield path


def examined(path: Path) -> Finding:
    """One file in its own process."""
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_send, args=(path, theirs))
    start = time.monotonic()
    process.start()
    theirs.close()
    try:
        found: Finding = ours.recv() if ours.poll(SECONDS) else Finding(str(path), "failed", "failed", f"no answer in {SECONDS:g} s")
    except EOFError:
        found = Finding(str(path), "failed", "failed", "the process died")
    process.kill()
    process.join()
    return Finding(found.path, found.direct, found.text, found.why, time.monotonic() - start)


def _send(path: Path, answer: Connection) -> None:
    with contextlib.redirect_stderr(None), contextlib.redirect_stdout(None):
        answer.send(_examine(path))


def _examine(path: Path) -> Finding:
    original = _or_words(lambda: mujoco.MjModel.from_xml_path(str(path)))
    mechanism = _or_words(lambda: mjmodels.read(path))
    if isinstance(original, str) or isinstance(mechanism, str):
        state = _state(original, mechanism)
        return Finding(str(path), state, state, " | ".join(why for why in (original, mechanism) if isinstance(why, str)))
    direct, why = _judged(original, lambda: mjmodels.compiled(mjmodels.write(mechanism), path.parent))
    text, why_text = _judged(original, lambda: mjmodels.compiled(mjmodels.write(mjmodels.through_hymeko(mechanism)), path.parent))
    return Finding(str(path), direct, text, why or why_text)


def _state(original: object, mechanism: object) -> str:
    """What it is called that somebody refuses the file; the words of MuJoCo and ours are texts."""
    if isinstance(original, str) and "Error opening file" in original:
        return MISSING
    if isinstance(original, str):
        return "refused by both" if isinstance(mechanism, str) else "refused by MuJoCo alone"
    return "refused by us alone"


def _or_words(make: Callable[[], T]) -> T | str:
    """What is made, or the words with which it is refused."""
    try:
        return make()
    except (ValueError, Refusal, mujoco.FatalError) as error:
        return " ".join(str(error).split())


def _judged(original: mujoco.MjModel, make: Callable[[], mujoco.MjModel]) -> tuple[str, str]:
    made = _or_words(make)
    if isinstance(made, str):
        return "different", f"what we wrote is refused: {made}"
    found = mjmodels.differences(original, made)
    if not found:
        return EQUAL, ""
    return "different", ", ".join(found)


def table(rows: list[tuple[str, list[Finding]]]) -> str:
    """A row of counts for each package, and one for all."""
    lines = ["| package | files | " + " | ".join(STATES) + " |", "|---" * (len(STATES) + 2) + "|"]
    everything = [found for _, findings in rows for found in findings]
    for name, findings in [*rows, ("all", everything)]:
        counts = [sum(_worst(found) == state for found in findings) for state in STATES]
        lines.append(f"| {name} | {len(findings)} | " + " | ".join(str(count or "") for count in counts) + " |")
    return "\n".join(lines)


def page(rows: list[tuple[str, list[Finding]]]) -> str:
    """The table as a page, with a line for each file that is neither equal, nor refused by both, nor without its files."""
    lines = [
        "# How exactly MJCF is kept",
        "",
        f"Written by `python -m benchmarks.mjcf_exact --table docs/mapping/mjcf_exact.md` with MuJoCo {mujoco.__version__}.",
        "What the columns mean stands in [mjcf.md](mjcf.md#how-exact-it-is).",
        "",
        table(rows),
        "",
    ]
    for name, findings in rows:
        rest = [found for found in findings if _worst(found) not in _EXPLAINED]
        lines += [f"* {name}, `{Path(found.path).name}`: {_worst(found)}: {found.why}" for found in rest]
    return "\n".join(lines) + "\n"


def _worst(found: Finding) -> str:
    return found.direct if STATES.index(found.direct) >= STATES.index(found.text) else found.text


if __name__ == "__main__":
    sys.exit(main())
