"""The files of a robot: where its elements stand in them, which files they need, and what has changed since a revision."""

from __future__ import annotations

import re
import subprocess
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes, disk, formats, pipeline
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.corpus.names import located
from hymeko_x.diagnostics import Origin, Refusal, Report, refuse
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.parts import Joint
from hymeko_x.verify.renaming import renamed

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.agree.config import Config, RobotFiles
    from hymeko_x.ir.mechanism import Mechanism

_NAMED = re.compile(r"(\w+) '([^']*)'")
_MENTIONED = re.compile(r"[\['\"]([^\[\]'\"]+)[\]'\"]")
_NEW_NAME = re.compile(r"(\w+) '[^']*' is called '([^']*)'")


def path_of(folder: Path, file: str) -> Path:
    """Where a file of a robot is: relative to ``folder``, or by the name of the robot, as every verb takes it.

    Raises: Refusal HX001 for a name whose robot is not there.
    """
    path = folder / file
    return path if path.exists() else folder / located(file).path


def read(robot: RobotFiles, folder: Path, path: str, search_path: tuple[Path, ...] = ()) -> tuple[Mechanism | None, set[Path]]:
    """A file of a robot by this program's own reader, None where it cannot be read; and all files that it needs, with links resolved."""
    place = path_of(folder, path)
    needed = {place.resolve()}
    packages = {name: folder / place for name, place in robot.packages.items()}
    try:
        source = disk.open_source(str(place), packages=packages, search_path=search_path)
        format = formats.of_input(source.name, source.data)
        arguments = dict(robot.arguments) if format.has_arguments else {}
        mechanism = pipeline.read_anyway(replace(source, arguments=arguments), format, Report())
    except Refusal:
        return None, needed
    uris = (getattr(part, "uri", None) for part in mechanism.graph.vertices.values())
    assets = {source.files.find(uri) for uri in uris if isinstance(uri, str)}
    read_in = {origin.file for origin in mechanism.origins.values()}
    included = source.files.opened if isinstance(source.files, DiskFiles) else ()
    return mechanism, needed | {Path(place).resolve() for place in {*assets, *read_in, *included} if place}


class ElementLines:
    """Where elements stand in the files of a robot, which are read when the first is asked for."""

    def __init__(self, robot: RobotFiles, folder: Path, search_path: tuple[Path, ...]) -> None:
        self._read = cache(lambda path: read(robot, folder, path, search_path)[0])
        self._written = cache(lambda path: self._names(path, robot.rename))

    def places(self, files: tuple[str, str], words: str, *, of_joints: bool) -> tuple[Origin, ...]:
        """The lines of the element that these words name, in both files; line 1 where that is not known.

        ``of_joints``: a body stands for the joint above it.
        """
        named = _NAMED.findall(words)
        others = _NEW_NAME.findall(words)
        return self._place(files[0], named, of_joints), self._place(files[1], [*others, *named], of_joints)

    def mentioned(self, file: str, message: str) -> Origin:
        """The line of the first element whose name an engine's message has in brackets or quotes; line 1 without one."""
        return self._place(file, [("joint", name) for name in _MENTIONED.findall(message)], False)

    def _place(self, file: str, named: list[tuple[str, str]], of_joints: bool) -> Origin:
        mechanism = self._read(file)
        if mechanism is None:
            return Origin(file, 1)
        for kind, name in [(kind, self._written(file).get(name, name)) for kind, name in named]:
            above = mechanism.parent_joint.get(Id("body", name)) if of_joints else None
            keys = [*([above.id] if above else []), *(Id(known, name) for known in (kind, "joint", "body"))]
            for origin in filter(None, map(mechanism.origin, keys)):
                if origin.line:
                    return Origin(_shown(origin.file, mechanism.source.file, file), origin.line)
        return Origin(file, 1)

    def _names(self, path: str, rename: Mapping[str, str]) -> dict[str, str]:
        """Of each joint that is compared by another name the one that its file has."""
        mechanism = self._read(path) if rename else None
        joints = [] if mechanism is None else [key.name for key, _, _ in mechanism.edges(Joint)]
        return {renamed(name, rename): name for name in reversed(joints)}


def _shown(place: str, main: str, file: str) -> str:
    """The file of an origin as the configuration names the main one: an included file stands relative to it."""
    if place == main:
        return file
    beside = Path(main).parent
    return str(Path(file).parent / Path(place).relative_to(beside)) if Path(place).is_relative_to(beside) else place


# ---- what has changed ------------------------------------------------------------------------------------------------------


def changed_robots(config: Config, path: str, revision: str, search_path: tuple[Path, ...] = ()) -> tuple[RobotFiles, ...]:
    """The robots of which a file, or one that it includes or shows, has changed since a revision of git; all where ``path`` itself has.

    Raises: Refusal HX304 when git is not there or does not know the revision.
    """
    folder = Path(path).parent
    changed = changed_files(folder, revision)
    if Path(path).resolve() in changed:
        return config.robot
    return tuple(robot for robot in config.robot if any(read(robot, folder, file, search_path)[1] & changed for file in robot.files))


def changed_files(folder: Path, revision: str) -> set[Path]:
    """Files of the repository around a folder that differ from a revision, and those that git does not know yet."""
    root = Path(_git(folder, "rev-parse", "--show-toplevel").strip())
    names = _git(root, "diff", "--name-only", "-z", revision, "--") + _git(root, "ls-files", "--others", "--exclude-standard", "-z")
    return {(root / name).resolve() for name in names.split("\0") if name}


def _git(folder: Path, *words: str) -> str:
    if words[-1:] == ("--",) and words[-2].startswith("-"):
        raise refuse(codes.CONFIG, f"'{words[-2]}' is no revision")
    try:
        done = subprocess.run(["git", "-C", str(folder), *words], capture_output=True, text=True, check=False)
    except FileNotFoundError as error:
        raise refuse(codes.CONFIG, "git is not installed, and --changed-since asks it") from error
    if done.returncode:
        raise refuse(codes.CONFIG, f"git says: {done.stderr.strip().splitlines()[0] if done.stderr.strip() else 'no reason'}")
    return done.stdout
