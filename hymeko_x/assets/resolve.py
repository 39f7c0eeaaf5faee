"""Finding the files that a robot refers to: `package://`, `model://`, `file://`, relative and absolute.

Nothing here looks at the environment: the shell passes in what the user and ROS say about packages.
"""

from __future__ import annotations

import errno
import io
import os
import re
from contextlib import suppress
from fnmatch import fnmatchcase
from functools import cached_property
from itertools import chain, islice
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

from msgspec import Struct, field
from msgspec.structs import replace

from hymeko_x.assets.archives import inside, names_in, read_inside

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

MOST_BYTES = 2**30
MOST_FOLDERS = 20_000
"""How many folders below the search path are looked at for packages."""
MOST_WILDCARDS = 4
"""In how many parts of a path there may be wildcards: each can multiply the folders that are looked into."""

_SCHEME = re.compile(r"([A-Za-z][A-Za-z0-9+.-]+):/*")  # one letter would be a Windows drive
_NAMELESS = re.compile(r"(package|model):///(?!/)", re.IGNORECASE)
_PACKED = re.compile(r"(.+\.usdz)\[([^\[\]]+)\]", re.IGNORECASE | re.DOTALL)
_PACKAGE_NAME = re.compile(rb"<name>\s*([^<\s]+)\s*</name>")


class DiskFiles(Struct, frozen=True, dict=True):
    """The files around a description in ``base``; a :class:`hymeko_x.source.Files`.

    ``packages`` are the user's own NAME=DIR, ``search_path`` the folders in which packages stand (ROS_PACKAGE_PATH,
    AMENT_PREFIX_PATH/share). With ``confine`` no file outside that folder is found or read, wherever links lead.
    """

    base: Path
    packages: Mapping[str, Path] = field(default_factory=dict)
    search_path: tuple[Path, ...] = ()
    confine: Path | None = None

    def find(self, uri: str) -> str | None:
        """The path of the file that ``uri`` names, or None.

        A package is looked for in ``packages``, then in the search path, then upwards from ``base``, nearest first: a folder whose
        `package.xml` bears the name, a folder of that name above or beside, and a folder whose name is a form of it
        (:meth:`guess_package`). One without a name (``package:///a.stl``) is ``base`` or a folder above. A file in a package of USD is
        named as there: ``robot.usdz[textures/a.png]``; another archive is like a folder: ``robot.mjz/meshes/a.stl``.
        """
        if (packed := _PACKED.fullmatch(uri)) is not None:
            package = self.find(packed[1])
            return None if package is None or packed[2] not in names_in(package) else f"{package}[{packed[2]}]"
        for candidate in self._candidates(uri.strip().replace("\\", "/")):
            if self._may_read(candidate):
                return str(_tidy(candidate))
        return None

    def read(self, path: str) -> bytes:
        """The content of a path that :meth:`find` returned.

        Raises: OSError when the file vanished, is no regular file, may not be read, or is larger than 1 GiB.
        """
        if (packed := _PACKED.fullmatch(path)) is not None:
            return read_inside(io.BytesIO(self.read(packed[1])), packed[2])
        if not self._may_read(Path(path)):
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), path)
        if (within := inside(Path(path))) is not None:
            return read_inside(*within)
        if Path(path).stat().st_size > MOST_BYTES:
            raise OSError(errno.EFBIG, os.strerror(errno.EFBIG), path)
        self.opened[path] = None
        return Path(path).read_bytes()

    @cached_property
    def opened(self) -> dict[str, None]:
        """The paths that were read so far, in their order."""
        return {}

    # ---- packages as folders ---------------------------------------------------------------------------------------------

    def find_package(self, name: str, beside: str = "") -> str | None:
        """The folder of a package, or None.

        First the user's own, then the nearest `package.xml` with that name above or beside the description, the search
        path, and the nearest folder of that name; then the same once more from the file ``beside``.
        """
        if name in ("", ".", "..") or "/" in name or "\\" in name:
            return None
        found = (folder for files in self._standpoints(beside) for folder in files._packages_called(name))
        return next((str(folder) for folder in found if self._may_enter(folder)), None)

    def guess_package(self, name: str, beside: str = "") -> str | None:
        """The nearest folder above or beside that bears a shorter or longer form of the name, word by word, or None."""
        near = (folder for files in self._standpoints(beside) for folder in files._forms_of(name))
        return next((str(folder) for folder in near if self._may_enter(folder)), None)

    def match(self, pattern: str) -> list[str]:
        """The files that a path with wildcards (`*`, `?`, `[a-z]`) in at most four of its parts names, sorted."""
        start, *parts = (self.base / pattern).parts or ("",)
        if "\0" in pattern or sum(bool(_WILDCARD.search(part)) for part in parts) > MOST_WILDCARDS:
            return []
        places = [Path(start)]
        for part in parts:
            step = self._matching(places, part) if _WILDCARD.search(part) else [place / part for place in places]
            places = step[:MOST_FOLDERS]
        return [str(_tidy(place)) for place in places if self._may_read(place)]

    def _matching(self, folders: list[Path], pattern: str) -> list[Path]:
        hidden = pattern.startswith(".")
        names = ((folder, name) for folder in folders if self._is_inside(folder) for name in _names_in(folder))
        looked_at = islice(names, MOST_FOLDERS)
        return [folder / name for folder, name in looked_at if fnmatchcase(name, pattern) and name.startswith(".") <= hidden]

    def _standpoints(self, beside: str) -> Iterator[DiskFiles]:
        yield self
        if beside:
            yield replace(self, base=(self.base / beside).parent)

    def _packages_called(self, name: str) -> Iterator[Path]:
        if name in self.packages:
            yield Path(os.path.abspath(self.packages[name]))
        yield from (folder for folder in self._neighbourhood() if self._package_name(folder) == name)
        yield from (Path(os.path.abspath(folder)) / name for folder in self.search_path)
        if name in self._named_on_search_path:
            yield Path(os.path.abspath(self._named_on_search_path[name]))
        for folder in self._upwards:
            yield from (folder,) if folder.name == name else ()
            yield folder / name

    def _neighbourhood(self) -> Iterator[Path]:
        """Every folder above the description, nearest first, each followed by the folders in it."""
        for folder in self._upwards:
            yield from chain((folder,), (folder / name for name in _names_in(folder)))

    def _forms_of(self, name: str) -> list[Path]:
        """The folders near the description, nearest first, that bear a shorter or longer form of a name, word by word."""
        if name not in self._forms:
            words = _words(name)
            self._forms[name] = [folder for folder in self._neighbourhood() if _is_form(_words(folder.name), words)]
        return self._forms[name]

    @cached_property
    def _forms(self) -> dict[str, list[Path]]:
        """The folders that were found so far, by the name."""
        return {}

    def _may_enter(self, folder: Path) -> bool:
        return folder.is_dir() and self._is_inside(folder)

    # ---- candidates for a uri --------------------------------------------------------------------------------------------

    def _candidates(self, uri: str) -> Iterator[Path]:
        scheme = _SCHEME.match(uri)
        if scheme is None:
            yield self.base / uri
        elif scheme[1].lower() == "file":
            yield from self._file_url(uri[len("file:") :])
        elif scheme[1].lower() in ("package", "model"):
            if is_of_nameless_package(uri):
                yield from (folder / uri[scheme.end() :] for folder in self._folders_of_nameless())
            name, _, rest = uri[scheme.end() :].partition("/")
            yield from (folder / rest for folder in self._package_folders(name) if rest)

    def _file_url(self, rest: str) -> Iterator[Path]:
        """`file:///a`, `file://localhost/a` and `file:/a` are absolute; `file://a` is a common slip and taken as relative."""
        path = rest.removeprefix("//localhost").removeprefix("//")
        yield from (self.base / text for text in dict.fromkeys((unquote(path), path)))

    def _folders_of_nameless(self) -> Iterator[Path]:
        """Where the files of a package without a name are: where the user says, with the description, or where packages stand."""
        if "" in self.packages:
            yield self.packages[""]
        yield from self._upwards
        yield from self.search_path

    def _package_folders(self, name: str) -> Iterator[Path]:
        if name in ("", ".", ".."):
            return
        if name in self.packages:
            yield self.packages[name]
        yield from (folder / name for folder in self.search_path)
        if name in self._named_on_search_path:
            yield self._named_on_search_path[name]
        for folder, names in self._named_upwards:
            if name in names:
                yield folder
            yield folder / name
        yield from self._forms_of(name)

    @cached_property
    def _named_upwards(self) -> tuple[tuple[Path, tuple[str, str | None]], ...]:
        """The description's folder and all above it, each with the names that it has as a package."""
        return tuple((folder, (folder.name, self._package_name(folder))) for folder in self._upwards)

    @cached_property
    def _upwards(self) -> tuple[Path, ...]:
        """The description's folder and all above it, nearest first, as far as reading is allowed."""
        start = Path(os.path.abspath(self.base))
        return tuple(folder for folder in (start, *start.parents) if self._is_inside(folder))

    @cached_property
    def _named_on_search_path(self) -> Mapping[str, Path]:
        """The packages below the search path by the name in their `package.xml`; the first one of a name counts."""
        found: dict[str, Path] = {}
        folders = (place for root in self.search_path if self._is_inside(root) for place in os.walk(root))
        for folder, below, files in islice(folders, MOST_FOLDERS):
            below.sort()
            if "package.xml" in files:
                found.setdefault(self._package_name(Path(folder)) or "", Path(folder))
                below.clear()
        return found

    def _package_name(self, folder: Path) -> str | None:
        """The <name> in the folder's `package.xml`, or None."""
        return package_name(folder) if self._may_read(folder / "package.xml") else None

    def _may_read(self, path: Path) -> bool:
        """Whether this is a readable regular file inside the border. Odd names (NUL bytes, too long) are just not there."""
        try:
            if (within := inside(path)) is not None:
                return self._may_read(Path(within.archive)) and within.name in self._names_inside(within.archive)
            return path.is_file() and os.access(path, os.R_OK) and self._is_inside(path)
        except (OSError, ValueError):
            return False

    def _names_inside(self, archive: str) -> frozenset[str]:
        """The files in an archive, which is opened once."""
        if archive not in self._archives:
            self._archives[archive] = names_in(archive)
        return self._archives[archive]

    @cached_property
    def _archives(self) -> dict[str, frozenset[str]]:
        return {}

    def _is_inside(self, path: Path) -> bool:
        return self.confine is None or path.resolve().is_relative_to(self.confine.resolve())


def is_of_nameless_package(uri: str) -> bool:
    """Whether a uri is ``package:///...``, which some exporters write for what lies beside the description."""
    return _NAMELESS.match(uri.strip()) is not None


_WILDCARD = re.compile(r"[*?\[]")


def _names_in(folder: Path) -> list[str]:
    """The names of what is in a folder, sorted; nothing when it cannot be listed."""
    try:
        return sorted(os.listdir(folder))
    except (OSError, ValueError):
        return []


def _words(name: str) -> list[str]:
    return [word for word in re.split(r"[-_.]", name.lower()) if word]


def _is_form(words: list[str], others: list[str]) -> bool:
    """Whether one begins with all of the other."""
    shorter, longer = sorted((words, others), key=len)
    return bool(shorter) and longer[: len(shorter)] == shorter


def _tidy(path: Path) -> Path:
    """The path without `..` where that does not lead through a link to another file."""
    if ".." not in path.parts:
        return path
    short = Path(os.path.normpath(path))
    if inside(path) is not None:
        return short
    return short if short.exists() and short.samefile(path) else path


_GAZEBO = ("GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "SDF_PATH", "GAZEBO_MODEL_PATH")
"""The variables of Gazebo, of its releases before it was renamed, of libsdformat, and of Gazebo Classic."""


def search_path(environ: Mapping[str, str]) -> tuple[Path, ...]:
    """The folders in which packages stand, as ROS and Gazebo tell their tools in these environment variables."""
    ros = [Path(text) for text in _entries(environ, "ROS_PACKAGE_PATH")]
    ament = [Path(text) / "share" for text in _entries(environ, "AMENT_PREFIX_PATH")]
    gazebo = [Path(text) for name in _GAZEBO for text in _entries(environ, name)]
    return tuple(dict.fromkeys((*ros, *ament, *gazebo)))


def _entries(environ: Mapping[str, str], name: str) -> list[str]:
    return [text for text in environ.get(name, "").split(os.pathsep) if text]


def package_name(folder: Path) -> str | None:
    """The <name> in the folder's `package.xml`; None where it has none."""
    with suppress(OSError), (folder / "package.xml").open("rb") as file:
        found = _PACKAGE_NAME.search(file.read(2**16))
        return found[1].decode("utf-8", "replace") if found else None
    return None
