"""Looks for silent losses: what can be changed in a source without anybody noticing, in the output or in the ledger.

`python -m tests.residue.silence [--to FORMAT,...] [--most N] FILE...` changes every attribute and leaves out every element of each
file, one at a time, and converts each of these to every format; ``--most`` looks at a sample of so many changes per file.
"""

from __future__ import annotations

import argparse
import os
import random
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import chdir
from pathlib import Path

import mujoco
import numpy as np
from pxr import Sdf, Usd

from hymeko_x import formats, pipeline
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.compare.diff import Tolerance, diff
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.rewrite import Options
from hymeko_x.source import Files, NoFiles, Source
from tests.residue.changes import Change, changes
from tests.residue.exactness import unequal

Outcome = tuple[object, ...]
TARGETS = ("urdf", "xacro", "mjcf", "usd", "hymeko")


def silent_changes(
    data: bytes, own: str, targets: Sequence[str], files: Files | None = None, *, most: int | None = None
) -> Iterator[tuple[str, list[str]]]:
    """For each change of a text that was tried, what it was and the formats that leave output, ledger and diagnostics as they are."""
    files = NoFiles() if files is None else files
    nothing, *tried = changes(data, own)
    if most is not None and len(tried) > most:
        tried = random.Random(len(tried)).sample(tried, most)
    before = Conversions(nothing, own, files)
    for change in tried:
        after = Conversions(change, own, files)
        silent = [target for target in targets if after.shows_the_same_as(before, target)]
        if silent and (after.only_words_it_otherwise_than(before) or (own == "mjcf" and is_same_to_mujoco(change, nothing, files))):
            silent = []  # the rotation of a ball's inertia; the axis of a free joint, a direction of another length
        if silent and own == "usd" and (is_same_stage(change, nothing) or (is_computed(change) and after.is_the_same_as(before))):
            silent = []  # what is inherited; moments that follow from the shapes
        yield change.what, silent


_ROUNDING = Tolerance(absolute=1e-14)


class Conversions:
    """All that a user sees of the pure conversions of a text; places in the source do not count."""

    def __init__(self, text: Change, own: str, files: Files) -> None:
        self._files = files
        self._report = Report()
        try:
            source = Source("robot", text.data, files)
            self._robot: Mechanism | Outcome = pipeline.read(source, formats.by_name(own), self._report)
        except Refusal as refusal:
            self._robot = _refused(refusal)
        self._written: dict[str, Outcome] = {}
        self._lost: dict[str, Outcome] = {}

    def shows_the_same_as(self, other: Conversions, target: str) -> bool:
        """Whether files, diagnostics and ledger are the same; the ledger, which takes longest, is only measured where the files are."""
        return self.written(target) == other.written(target) and self.lost(target) == other.lost(target)

    def is_the_same_as(self, other: Conversions) -> bool:
        """Whether the reader took the same robot from both."""
        return self._robot == other._robot

    def only_words_it_otherwise_than(self, other: Conversions) -> bool:
        """Whether the reader saw the change, and kept it as a notation of a robot whose values are all the same, to rounding."""
        if isinstance(self._robot, tuple) or isinstance(other._robot, tuple):
            return False
        return diff(self._robot, other._robot, _ROUNDING) == () and bool(unequal(self._robot, other._robot))

    def written(self, target: str) -> Outcome:
        """The files of a format and the diagnostics."""
        if target not in self._written:
            self._written[target] = self._outcome(target, _files_of)
        return self._written[target]

    def lost(self, target: str) -> Outcome:
        """The ledger, and the diagnostics of measuring it."""
        if target not in self._lost:
            self._lost[target] = self._outcome(target, _ledger_of)
        return self._lost[target]

    def _outcome(self, target: str, of: Callable[[Mechanism, str, Files, Report], Outcome]) -> Outcome:
        if isinstance(self._robot, tuple):
            return self._robot
        report = Report()
        report.extend(self._report)
        try:
            found = of(self._robot, target, self._files, report)
        except Refusal as refusal:
            return _refused(refusal)
        return (*found, *((item.code.id, item.message) for item in report))


def _refused(refusal: Refusal) -> Outcome:
    return ("refused", refusal.diagnostic.message)


def _files_of(robot: Mechanism, target: str, files: Files, report: Report) -> Outcome:
    package = pipeline.write(robot, formats.by_name(target), Options(), files, report)
    return package.main, tuple(package.files.items())


def _ledger_of(robot: Mechanism, target: str, files: Files, report: Report) -> Outcome:
    result = pipeline.convert(robot, formats.by_name(target), Options(), files, report)
    return tuple((loss.element, loss.field, loss.before, loss.after) for loss in result.losses or ())


def is_same_stage(a: Change, b: Change) -> bool:
    """Whether two USD texts compose to the same stage, each without the files to which it refers."""
    return _composed(a.data) == _composed(b.data)


def _composed(data: bytes) -> str:
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.ImportFromString(data.decode())
    return str(Usd.Stage.Open(layer).Flatten().ExportToString())


def is_computed(change: Change) -> bool:
    """Whether the moments of a body are gone."""
    return change.what.startswith("without /") and change.what.endswith(".physics:diagonalInertia")


def is_same_to_mujoco(a: Change, b: Change, files: Files) -> bool:
    """Whether MuJoCo makes the same model of two MJCF texts: what it does not see means nothing."""
    folder = files.base if isinstance(files, DiskFiles) else Path()
    try:
        with chdir(folder):
            return _compiled(a.data) == _compiled(b.data)
    except ValueError:
        return False


def _compiled(data: bytes) -> bytes:
    model = mujoco.MjModel.from_xml_string(data.decode())
    buffer = np.zeros(mujoco.mj_sizeModel(model), dtype=np.uint8)
    mujoco.mj_saveModel(model, None, buffer)
    return buffer.tobytes()


def _of_file(path: Path, targets: Sequence[str], most: int | None) -> tuple[int, list[str]]:
    """How many changes of a file were tried, and the silent ones."""
    data = path.read_bytes()
    own = formats.of_input(path.name, data).name
    found = list(silent_changes(data, own, [target for target in targets if target != own], DiskFiles(path.parent), most=most))
    return len(found), [f"{path.name}: {what}: silent in {', '.join(silent)}" for what, silent in found if silent]


def main(arguments: Sequence[str]) -> int:
    """Print a line for every file and for every silent change."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--to", default=",".join(TARGETS))
    parser.add_argument("--most", type=int)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("files", nargs="+", type=Path)
    chosen = parser.parse_args(arguments)
    targets = chosen.to.split(",")
    is_silent = False
    with ProcessPoolExecutor(chosen.jobs) as pool:
        running = {pool.submit(_of_file, path, targets, chosen.most): path for path in chosen.files}
        for done in as_completed(running):
            tried, silent = done.result()
            is_silent = is_silent or bool(silent)
            lines = [f"{running[done]}: {tried} changes, {len(silent)} silent", *silent]
            sys.stdout.write("".join(f"{line}\n" for line in lines))
            sys.stdout.flush()
    return int(is_silent)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
