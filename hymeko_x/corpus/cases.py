"""What a batch run reads: the robots of the catalogue, those written for this project, and the files of any folder."""

from __future__ import annotations

from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x import codes, formats
from hymeko_x.corpus import cache, catalog
from hymeko_x.diagnostics import Refusal, refuse

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from hymeko_x.formats import Format

OWN = "hymeko_x"
_HEAD = 65536


class Case(Struct, frozen=True):
    """One robot file. ``folder`` holds it and everything that it may read; a path or an fsspec URL. ``path`` is relative to it."""

    package: str
    folder: str
    path: str
    format: str
    arguments: tuple[tuple[str, str], ...] = ()

    @property
    def key(self) -> str:
        """What names the file in the results, on every machine: package and path."""
        return f"{self.package}/{self.path}"


def readable() -> tuple[str, ...]:
    """The formats that a run can start from."""
    return tuple(format.name for format in formats.FORMATS if format.frontend)


def from_catalogue(packages: Sequence[catalog.WheelPackage], root: Path) -> tuple[Case, ...]:
    """Every robot of these packages, which must be fetched.

    Raises: Refusal HX210 when one is not.
    """
    missing = [package.name for package in packages if not cache.is_fetched(package, root)]
    if missing:
        words = (
            f"{len(missing)} packages are not here: {', '.join(missing)}" if len(missing) > 1 else f"the package {missing[0]} is not here"
        )
        raise refuse(codes.PACKAGE_UNAVAILABLE, words, hint=f"hymeko-x corpus fetch {' '.join(missing)}")
    known = readable()
    return tuple(
        Case(package.name, str(cache.package_path(package, root)), path, format, tuple(sorted(package.arguments.get(path, {}).items())))
        for package in packages
        for format, path in package.listed()
        if format in known
    )


def own_robots() -> tuple[Case, ...]:
    """The HyMeKo robots of this project, in a checkout; none in an installation without them."""
    folder = Path(__file__).parents[2] / "corpus"
    paths = sorted(path for name in ("robots", "listings") for path in (folder / name).glob("*.hymeko"))
    return tuple(Case(OWN, str(folder), path.relative_to(folder).as_posix(), formats.OWN.name) for path in paths)


def from_folder(place: str) -> tuple[Case, ...]:
    """Every file of a known format in a folder, or below an fsspec URL, in the order of their paths.

    A folder below a URL is a package of its own, which is all that a worker fetches.

    Raises: Refusal HX001 when there is no such folder.
    """
    if "://" in place:
        return _below_url(place)
    folder = Path(place)
    if not folder.is_dir():
        raise refuse(codes.CANNOT_READ, f"there is no folder '{place}'")
    root = folder.resolve()
    paths = (path for path in sorted(root.rglob("*")) if path.is_file() and path.suffix.lower() in _suffixes())
    found = ((path, _format_of(path.name, _head(path))) for path in paths)
    return tuple(Case(root.name, str(root), path.relative_to(root).as_posix(), format.name) for path, format in found if format)


def _below_url(place: str) -> tuple[Case, ...]:
    from fsspec.core import url_to_fs

    files, root = url_to_fs(place)
    try:
        names = sorted(files.find(root))
    except OSError as error:
        raise refuse(codes.CANNOT_READ, f"'{place}' cannot be listed: {error}") from error
    return tuple(_remote_cases(place.rstrip("/"), root, names, lambda name: bytes(files.cat_file(name, 0, _HEAD))))


def _remote_cases(place: str, root: str, names: Sequence[str], head: Callable[[str], bytes]) -> Iterator[Case]:
    for name in names:
        path = PurePosixPath(name).relative_to(root)
        if path.suffix.lower() not in _suffixes():
            continue
        format = _format_of(path.name, head(name))
        top, *rest = path.parts
        inside = "/".join(rest) if rest else top
        folder = f"{place}/{top}" if rest else place
        if format:
            yield Case(top if rest else PurePosixPath(root).name, folder, inside, format.name)


def _head(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(_HEAD)


def _suffixes() -> tuple[str, ...]:
    return tuple(suffix for format in formats.FORMATS if format.frontend for suffix in format.suffixes)


def _format_of(name: str, head: bytes) -> Format | None:
    """The format of a file that can be recognised; HyMeKo only by its suffix."""
    try:
        format = formats.of_input(name, head)
    except Refusal:
        return None
    return None if format is formats.OWN and not name.lower().endswith(formats.OWN.suffixes) else format
