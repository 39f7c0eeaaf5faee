"""The comparison: every file of a robot with its first one, by the verifier, and each difference with its place in both files."""

from __future__ import annotations

from fnmatch import fnmatchcase
from math import inf, isinf
from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x.agree.files import ElementLines, path_of

if TYPE_CHECKING:
    from collections.abc import Iterator
    from datetime import date
    from pathlib import Path

    from hymeko_x.agree.config import Allowed, RobotFiles
    from hymeko_x.diagnostics import Origin
    from hymeko_x.verify.verdict import Check, Verdict

_CONSEQUENCES = (
    "DH parameters, lengths",
    "DH parameters, angles",
    "loop closure, position",
    "loop closure, rotation",
    "mass matrix",
    "gravity torque",
)
"""Quantities that follow from others: a difference in them is one of its own only where there is no other."""


class Disagreement(Struct, frozen=True):
    """One difference between the first file of a robot and another one, or why these cannot be compared.

    ``places`` are where its element stands in both files; ``allowed`` is the known difference that it is.
    """

    robot: str
    files: tuple[str, str]
    quantity: str
    message: str
    element: str = ""
    places: tuple[Origin, ...] = ()
    allowed: Allowed | None = None
    difference: float = inf
    """Its size, in the unit of the quantity."""
    count: int = 1
    """So many differences of the quantity it stands for, the largest of them."""

    @property
    def key(self) -> tuple[str, ...]:
        """What makes it the same difference in another run."""
        return self.robot, *self.files, self.quantity, self.element


class Compared(Struct, frozen=True):
    """What became of one robot."""

    robot: RobotFiles
    found: tuple[Disagreement, ...] = ()
    notes: tuple[str, ...] = ()
    """What a reader of the result should know: allowances that ended or that nothing needs, and what a format cannot represent."""

    @property
    def wrong(self) -> tuple[Disagreement, ...]:
        """The differences that are not allowed."""
        return tuple(found for found in self.found if found.allowed is None)

    @property
    def summary(self) -> Compared:
        """The same with one difference of each quantity between two files: the largest."""
        alike: dict[tuple[object, ...], list[Disagreement]] = {}
        for found in self.found:
            alike.setdefault((found.files, found.quantity, found.allowed), []).append(found)
        largest = (replace(max(group, key=lambda found: found.difference), count=len(group)) for group in alike.values())
        return replace(self, found=tuple(largest))


def compare(robot: RobotFiles, folder: Path, today: date, search_path: tuple[Path, ...] = ()) -> Compared:
    """Compare the files of a robot, whose paths are relative to ``folder``.

    Raises: Refusal when a file is not there or an engine is not installed.
    """
    found: list[Disagreement] = []
    notes: list[str] = []
    lines = ElementLines(robot, folder, search_path)
    for path in robot.files[1:]:
        verdict = _verdict(robot, folder, path, search_path)
        found += _disagreements(robot, path, verdict, lines, today)
        notes += [f"{path}: {gap.format} cannot say {gap}" for gap in verdict.gaps]
    used = {found.allowed for found in found}
    for allowed in robot.allow:
        if allowed.until < today:
            notes.append(f"the allowance of '{allowed.what}' ended on {allowed.until}: {allowed.reason}")
        elif allowed not in used:
            notes.append(f"the allowance of '{allowed.what}' is not needed any more: {allowed.reason}")
    return Compared(robot, tuple(found), tuple(dict.fromkeys(notes)))


def _verdict(robot: RobotFiles, folder: Path, path: str, search_path: tuple[Path, ...]) -> Verdict:
    from hymeko_x.verify import verify

    return verify(
        path_of(folder, robot.files[0]),
        path_of(folder, path),
        samples=robot.samples,
        seed=robot.seed,
        structure=robot.match == "structure",
        joints=robot.match == "joints",
        rename=robot.rename,
        meshes=robot.meshes,
        packages={name: folder / place for name, place in robot.packages.items()},
        search_path=search_path,
        arguments=dict(robot.arguments),
    )


def _disagreements(robot: RobotFiles, path: str, verdict: Verdict, lines: ElementLines, today: date) -> Iterator[Disagreement]:
    files = robot.files[0], path
    if verdict.reason:
        places = tuple(lines.mentioned(file, verdict.reason) for file in files)
        yield Disagreement(robot.name, files, "not comparable", verdict.reason, places=places)
        return
    failed = [check for check in verdict.failed if not any(fnmatchcase(check.quantity, ignored) for ignored in robot.ignore)]
    causes = [check for check in failed if check.quantity not in _CONSEQUENCES]
    for check in failed if robot.consequences or not causes else causes:
        for element, difference, values in _each(check):
            if difference <= robot.tolerances.get(check.quantity, 0.0):
                continue
            allowances = (known for known in robot.allow if known.until >= today and known.covers(path, check.quantity, element))
            message = _message(check, element, difference, values)
            places = lines.places(files, element, of_joints=check.quantity.startswith("forward kinematics"))
            yield Disagreement(robot.name, files, check.quantity, message, element, places, next(allowances, None), difference)


def _each(check: Check) -> Iterator[tuple[str, float, tuple[str, str] | None]]:
    """The differences of a check that failed: their elements, sizes and values."""
    for finding in check.findings:
        yield finding.at, finding.difference, finding.values
    if not check.findings:
        yield check.at, check.worst, check.values


def _message(check: Check, element: str, difference: float, values: tuple[str, str] | None) -> str:
    if not check.unit:
        return f"{check.quantity}: {element}"
    size = f"{difference:.3g} {check.unit} off"
    if not values:
        return f"{check.quantity} of {element}: {size}"
    both = f"{check.quantity} of {element}: {values[0]} and {values[1]} {check.unit}"
    return both if isinf(difference) else f"{both} ({size})"
