"""The bar of SDF: what is read is what Drake reads, and what is written is the same robot, there and back.

    python -m benchmarks.sdf_bar reading [FILE | FOLDER ...]    # own reader against Drake's, SDF -> IR -> SDF a fixed point
    python -m benchmarks.sdf_bar leaving [FILE | FOLDER ...]    # SDF into every other format; MJCF steps; what is kept comes back
    python -m benchmarks.sdf_bar arriving [FILE ...]            # robots in other formats into SDF, read by Drake and libsdformat, and back

Without files: the SDF files of the catalogue, and for ``arriving`` the development files of URDF, MJCF and USD. Each file has a process
and a time limit of its own, and a line that says in which ways it went. The exit code is 1 when one is different.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import msgspec

from hymeko_x import api, formats
from hymeko_x.assets.resolve import search_path
from hymeko_x.corpus import cache, catalog
from hymeko_x.diagnostics import Refusal, Report, Severity
from hymeko_x.verify import verify
from tests.sdf.canonical import canonical
from tests.sdf.names import is_accepted, library

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from hymeko_x.robot import Robot
    from hymeko_x.verify.verdict import Verdict

SAMPLES = 100
"""The random configurations at which two robots are compared."""
STEPS = 100
"""The steps that MuJoCo takes with a robot from SDF."""
SECONDS = 300.0
"""How long one file may take."""
INERTIA = 1e-10
"""By how much masses (kg) and tensors (kg m^2) may differ, of the value where that is larger than one."""
_RELEASE_OF_1_0 = 3
"""libsdformat 12 reads SDF up to 1.9, 13 up to 1.10, and so on."""
SAME, EQUAL, NOTHING, DIFFERENT = "same", "equal", "nothing to compare", "DIFFERENT"
OTHERS = (formats.MJCF, formats.URDF, formats.USD, formats.XACRO, formats.HYMEKO)
KEEP: tuple[Literal["beside", "inside"], ...] = ("beside", "inside")
MODEL_SUFFIXES = (".sdf", ".world")

Ways = dict[str, str]
"""What became of a file in each way: one of the words above, or who refused it and why."""


def reading(path: Path) -> Ways:
    """The own reader against Drake's, and whether what we write of the file is written so again."""
    report = Report()
    try:
        robot = _read(path, report=report)
    except Refusal as refusal:
        return {"reading": _refused(refusal)}
    found = {"reading": _against_drake(verify(str(path), robot, samples=SAMPLES, search_path=places(path)), report)}
    with tempfile.TemporaryDirectory() as folder:
        once, twice = Path(folder, "a", "m.sdf"), Path(folder, "b", "m.sdf")
        for file in (once, twice):
            file.parent.mkdir()
        try:
            api.dump(robot, once, assets="reference", lenient=True)
            api.dump(_read(once, path), twice, assets="reference", lenient=True)
        except Refusal as refusal:
            return found | {"fixed point": _refused(refusal)}
        first, author = canonical(once.read_bytes()), canonical(path.read_bytes())
        found["fixed point"] = EQUAL if canonical(twice.read_bytes()) == first else DIFFERENT
        found["author's text"] = EQUAL if first == author else "other letters"
    return found


def leaving(path: Path) -> Ways:
    """SDF into every other format, and back with what is kept beside it and inside of it."""
    try:
        robot = _read(path)
    except Refusal as refusal:
        return {"reading": _refused(refusal)}
    reference: str | Robot = str(path)
    if "refuses" in verify(str(path), robot, samples=1).reason:
        reference = robot
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for target in OTHERS:
            file = Path(folder, target.name, f"m{target.suffixes[0]}")
            found[target.name] = _tried(lambda file=file: _there(reference, robot, file))
            for keep in KEEP:
                file = Path(folder, f"{target.name}-{keep}", f"m{target.suffixes[0]}")
                found[f"{target.name} kept {keep}"] = _tried(lambda file=file, keep=keep: _kept(path, robot, file, keep))
    return found


def arriving(path: Path) -> Ways:
    """A robot in another format into SDF, as Drake reads it, and back: as SDF has it, and as it was, with what was kept beside it."""
    row = formats.of_input(str(path), path.read_bytes())
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for keep, origin in ((None, "there"), ("beside", "kept")):
            there, back = Path(folder, origin, "m.sdf"), Path(folder, f"{origin} back", f"m{row.suffixes[0]}")
            found[origin] = _tried(lambda there=there, keep=keep: _there(str(path), _read(path), there, keep))
            original = str(path if keep else there)
            found[f"{origin} and back"] = _tried(lambda original=original, there=there, back=back: _there(original, _read(there), back))
        if library() and Path(folder, "there", "m.sdf").exists():
            found["libsdformat"] = _checked(Path(folder, "there", "m.sdf"))
    return found


def _checked(file: Path) -> str:
    """Whether libsdformat accepts a file, where it knows the version."""
    version = re.search(r'<sdf version="1\.(\d+)"', file.read_text("utf-8"))
    release = re.search(r"sdformat(\d+)", library() or "")
    if version is None or release is None or int(version[1]) > int(release[1]) - _RELEASE_OF_1_0:
        return "has a later version than libsdformat"
    return "accepted" if is_accepted(str(file)) else f"{DIFFERENT}: refused"


WAYS: dict[str, Callable[[Path], Ways]] = {"reading": reading, "leaving": leaving, "arriving": arriving}


def _there(reference: str | Robot, robot: Robot, file: Path, keep: Literal["beside"] | None = None) -> str:
    """A robot written into a file, against what it was written from. MJCF is stepped as well."""
    file.parent.mkdir()
    api.dump(robot, file, assets=None if formats.of_output(str(file)).holds_files else "copy", lenient=True, keep=keep)
    state = _state(verify(reference, str(file), samples=SAMPLES))
    return _stepped(file) or state if file.suffix == ".xml" else state


def _kept(path: Path, robot: Robot, file: Path, keep: Literal["beside", "inside"]) -> str:
    """A file through another format and back, with what that cannot say: is it written as without that way?"""
    direct, back = file.parent / "direct.sdf", file.parent / "back.sdf"
    file.parent.mkdir()
    api.dump(robot, direct, assets="copy", lenient=True)
    api.dump(robot, file, assets="copy", keep=keep, lenient=True)
    api.dump(_read(file, path), back, assets="copy", lenient=True)
    lines = _without_folders(direct), _without_folders(back)
    if lines[0] == lines[1]:
        return EQUAL
    first = next((pair for pair in zip(*lines, strict=False) if pair[0] != pair[1]), (f"{len(lines[0])} lines", f"{len(lines[1])} lines"))
    return f"{DIFFERENT}: {first[0].strip()[:80]} | {first[1].strip()[:80]}"


def _without_folders(file: Path) -> list[str]:
    """The canonical text of a file; of paths only the name, since a stage holds the meshes and gives them back as other files."""
    return [re.sub(r"( uri +)(?:.*/)?([^/]*)\.\w+$", r"\1\2", line) for line in canonical(file.read_bytes())]


def _read(file: Path, origin: Path | None = None, report: Report | None = None) -> Robot:
    """The robot in a file. Packages and models are looked for around the file that it was made from."""
    return api.load(file, lenient=True, report=report, search_path=places(origin or file))


def _stepped(file: Path) -> str:
    """What is wrong with a robot in MuJoCo: that it refuses the file, as where images are missing, or that the state is not finite."""
    import mujoco
    import numpy as np

    try:
        model = mujoco.MjModel.from_xml_path(str(file))
    except ValueError as error:
        return f"refused by MuJoCo: {error}"
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, STEPS)
    return "" if np.isfinite(data.qpos).all() and np.isfinite(data.qvel).all() else f"{DIFFERENT}: MuJoCo's state is not finite"


def _state(verdict: Verdict) -> str:
    """The verdict in a word: ``same`` also as far as a format can say."""
    if verdict.reason:
        return f"refused: {verdict.reason[-120:]}"
    return SAME if verdict.is_same else f"{DIFFERENT}: {[(check.quantity, check.worst, check.at) for check in verdict.failed][:3]}"


def _against_drake(verdict: Verdict, report: Report) -> str:
    """What Drake and the own reader make of a file. Masses and tensors must agree more closely than a verdict demands."""
    if "nothing to compare" in verdict.reason:
        return NOTHING
    if verdict.reason:
        codes = " ".join(sorted({diagnostic.code.id for diagnostic in report if diagnostic.severity is not Severity.NOTE}))
        return f"refused by Drake, {'reported' if codes else 'read'} by us: {codes} {verdict.reason[-120:]}"
    for check in verdict.checks:
        if check.quantity in ("mass", "inertia tensor") and check.worst > max(INERTIA, check.allowed / 10.0):
            return f"{DIFFERENT}: {check.quantity} by {check.worst:.1e} at {check.at}"
    return _state(verdict)


def _tried(way: Callable[[], str]) -> str:
    try:
        return way()
    except Refusal as refusal:
        return _refused(refusal)


def _refused(refusal: Refusal) -> str:
    return f"refused with {refusal.diagnostic.code.id}: {refusal.diagnostic.message[:120]}"


def places(path: Path) -> tuple[Path, ...]:
    """The folders in which models and packages stand that a file names: those of the environment variables, and those above the file."""
    return (*search_path(os.environ), *path.resolve().parents[:4])


def listed(way: str, given: list[Path]) -> Iterator[Path]:
    """The files: those given, those in folders that were given, or those of the catalogue."""
    for one in given:
        yield from sorted(file for file in one.rglob("*") if file.suffix in MODEL_SUFFIXES) if one.is_dir() else [one]
    root = cache.cache_root(os.environ)
    if not given and way == "arriving":
        wanted = [file for row in (formats.URDF, formats.MJCF, formats.USD) for file in catalog.development_files(row.name)]
        yield from (cache.fetch(file.package, root) / file.path for file in wanted)
    elif not given:
        for package in catalog.load():
            yield from (cache.fetch(package, root) / path for name, path in package.listed() if name == formats.SDF.name)


def apart(way: str, path: Path, seconds: float) -> Ways:
    """One file in a process of its own, which may crash."""
    words = [sys.executable, "-m", "benchmarks.sdf_bar", way, "--one", str(path)]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=seconds, check=False)
    except subprocess.TimeoutExpired:
        return {way: f"{DIFFERENT}: more than {seconds:.0f} s"}
    if done.returncode:
        return {way: f"{DIFFERENT}: exit {done.returncode}: {done.stderr.strip()[-200:]}"}
    return msgspec.json.decode(done.stdout.splitlines()[-1], type=Ways)


def main() -> int:
    """A line for each file, and the sums."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("way", choices=WAYS)
    parser.add_argument("files", nargs="*", type=Path, help="files, or folders with .sdf and .world files")
    parser.add_argument("--seconds", type=float, default=SECONDS, metavar="S", help=f"the time of a file (default {SECONDS:.0f})")
    parser.add_argument("--one", type=Path, help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.one:
        print(msgspec.json.encode(WAYS[chosen.way](chosen.one)).decode())
        return 0
    sums: Counter[tuple[str, str]] = Counter()
    for path in listed(chosen.way, chosen.files):
        found = apart(chosen.way, path, chosen.seconds)
        sums.update((way, state.split(":")[0]) for way, state in found.items())
        print(f"{path}: {', '.join(f'{way} {state}' for way, state in found.items())}", flush=True)
    for (way, state), count in sorted(sums.items()):
        print(f"{way}: {count} {state}")
    return 1 if any(state.startswith(DIFFERENT) for _, state in sums) else 0


if __name__ == "__main__":
    sys.exit(main())
