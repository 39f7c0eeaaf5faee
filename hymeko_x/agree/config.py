"""`hymeko.toml`: which files are one robot, how far they may differ, and which differences are known."""

from __future__ import annotations

import tomllib
from datetime import date  # noqa: TC003 (msgspec looks it up)
from difflib import get_close_matches
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, Literal

import msgspec
from msgspec import Struct, field

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.verify.renaming import is_renaming

NAME = "hymeko.toml"


class Allowed(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A difference that is known, why, and until when. ``what`` and ``at`` are patterns with * of the quantity and of the place."""

    what: str
    reason: str
    until: date
    at: str = "*"
    files: tuple[str, ...] = ()
    """The files for which it holds; all but the first one where none is named."""

    def covers(self, path: str, quantity: str, at: str) -> bool:
        """Whether a difference between the robot's first file and this one is the known one. ``at`` is matched as a part."""
        return (not self.files or path in self.files) and fnmatchcase(quantity, self.what) and fnmatchcase(at, f"*{self.at}*")


class RobotFiles(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """One robot: its files, of which the others are compared with the first one."""

    name: str
    files: tuple[str, ...]
    tolerances: dict[str, float] = field(default_factory=dict)
    """By quantity of the verifier, in its unit: differences up to this size count as none."""
    allow: tuple[Allowed, ...] = ()
    match: Literal["name", "structure", "joints"] = "name"
    rename: dict[str, str] = field(default_factory=dict)
    """Other names for joints, by patterns with at most one ``*``; with ``match = "joints"``."""
    ignore: tuple[str, ...] = ()
    """Patterns of the quantities that are not compared."""
    consequences: bool = False
    """Whether quantities that follow from others, such as the gravity torque, are listed beside these."""
    samples: int = 20
    seed: int = 0
    meshes: bool = False
    packages: dict[str, str] = field(default_factory=dict)
    arguments: dict[str, str] = field(default_factory=dict)


class Config(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The whole file: robots, and what holds for all of them."""

    robot: tuple[RobotFiles, ...]
    tolerances: dict[str, float] = field(default_factory=dict)
    packages: dict[str, str] = field(default_factory=dict)
    ignore: tuple[str, ...] = ()
    consequences: bool = False


def load(path: str) -> Config:
    """The configuration in a file; robots have what holds for all of them, too. Raises: Refusal HX001, HX304."""
    try:
        text = Path(path).read_text("utf-8")
    except OSError as error:
        hint = "docs/agree.md shows how to write one"
        raise refuse(codes.CANNOT_READ, f"cannot be read: {error.strerror}", Origin(path), hint=hint) from error
    try:
        config = msgspec.convert(tomllib.loads(text), Config)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, msgspec.ValidationError) as error:
        raise refuse(codes.CONFIG, str(error), Origin(path)) from error
    robots = tuple(_with_common(robot, config) for robot in config.robot)
    for robot in robots:
        _check(robot, path)
    return msgspec.structs.replace(config, robot=robots)


def _with_common(robot: RobotFiles, config: Config) -> RobotFiles:
    merged: dict[str, Any] = {
        "tolerances": {**config.tolerances, **robot.tolerances},
        "packages": {**config.packages, **robot.packages},
        "ignore": (*config.ignore, *robot.ignore),
        "consequences": config.consequences or robot.consequences,
    }
    return msgspec.structs.replace(robot, **merged)


def _check(robot: RobotFiles, path: str) -> None:
    """Raises: Refusal HX304 where a robot has nothing to compare, a quantity does not exist, or an allowance names no file of the robot."""
    from hymeko_x.verify.checks import QUANTITIES

    if len(robot.files) < 2:
        raise refuse(codes.CONFIG, f"robot '{robot.name}' has {len(robot.files)} file; two or more can be compared", Origin(path))
    if unknown := next((quantity for quantity in robot.tolerances if quantity not in QUANTITIES), None):
        near = get_close_matches(unknown, QUANTITIES, 1)
        hint = f"did you mean '{near[0]}'?" if near else f"quantities: {', '.join(QUANTITIES)}"
        raise refuse(codes.CONFIG, f"robot '{robot.name}': there is no quantity '{unknown}'", Origin(path), hint=hint)
    for pattern in robot.ignore:
        _check_pattern(robot, pattern, path)
    if stray := next((old for old, new in robot.rename.items() if not is_renaming(old, new)), None):
        raise refuse(codes.CONFIG, f"robot '{robot.name}': '{stray}' and its new name may have one * each", Origin(path))
    if robot.rename and robot.match != "joints":
        raise refuse(codes.CONFIG, f"robot '{robot.name}': joints are renamed with match = \"joints\" only", Origin(path))
    for allowed in robot.allow:
        _check_pattern(robot, allowed.what, path)
        if stray := next((file for file in allowed.files if file not in robot.files), None):
            raise refuse(codes.CONFIG, f"robot '{robot.name}' allows a difference in '{stray}', which is none of its files", Origin(path))


def _check_pattern(robot: RobotFiles, pattern: str, path: str) -> None:
    from hymeko_x.verify.checks import QUANTITIES

    if not any(fnmatchcase(quantity, pattern) for quantity in QUANTITIES):
        message = f"robot '{robot.name}': no quantity is called '{pattern}'"
        raise refuse(codes.CONFIG, message, Origin(path), hint=f"quantities: {', '.join(QUANTITIES)}")
