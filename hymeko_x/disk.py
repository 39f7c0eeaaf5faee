"""The disk: reading one input with the files around it, and writing one output so that it is there whole or not at all."""

from __future__ import annotations

import errno
import filecmp
import os
import stat
from collections.abc import Callable
from contextlib import contextmanager, suppress
from pathlib import Path, PurePosixPath
from shutil import rmtree
from typing import TYPE_CHECKING

from msgspec import Struct, field

from hymeko_x import codes
from hymeko_x.assets import archives
from hymeko_x.assets.resolve import DiskFiles, package_name
from hymeko_x.assets.shelf import safe_name
from hymeko_x.diagnostics import Origin, Refusal, refuse
from hymeko_x.source import DIGESTS, KEPT_FOLDER, KEPT_SUFFIX, Kept, Package, PackageFiles, Source

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from hymeko_x.source import Files

MOST_BYTES = 2**30

Within = Callable[[str], Package]
"""The same output with every file beside the main one below a folder, which ends in a slash."""


def open_source(
    path: str, *, packages: Mapping[str, Path] | None = None, search_path: tuple[Path, ...] = (), confine: Path | None = None
) -> Source:
    """The input at ``path`` with the files that it may refer to, and with its kept file if there is one.

    Raises: Refusal HX001 when it cannot be read or is outside ``confine``, HX007 when it is larger than 1 GiB.
    """
    if archives.is_archive(path) and Path(path).is_file():
        _check(path, confine)
        path = archives.main_file(path)
    files = DiskFiles(Path(path).parent, packages or {}, search_path, confine)
    beside = f"{path}{KEPT_SUFFIX}"
    kept = Kept(_read(beside, confine).decode("utf-8", "replace"), beside) if _is_file(beside) else None
    return Source(path, _read(path, confine), files, kept=kept, originals=_originals(f"{path}{KEPT_FOLDER}"))


def _is_file(path: str) -> bool:
    """Whether there is such a file, on the disk or in an archive."""
    within = archives.inside(path)
    return os.path.isfile(path) if within is None else within.name in archives.names_in(within.archive)


def _originals(folder: str) -> dict[str, str]:
    """The files in a folder of originals, by their paths below it."""
    within = archives.inside(folder)
    if within is not None:
        start, names = f"{within.name}/", sorted(archives.names_in(within.archive))
        return {name.removeprefix(start): f"{within.archive}/{name}" for name in names if name.startswith(start) and not name.endswith("/")}
    found = (Path(place, name) for place, _, names in os.walk(folder) for name in names)
    return {path.relative_to(folder).as_posix(): str(path) for path in sorted(found)}


def _read(path: str, confine: Path | None) -> bytes:
    """The content of a file, on the disk or in an archive. Raises: Refusal."""
    _check(path, confine)
    within, origin = archives.inside(path), Origin(path)
    try:
        return _content(Path(path), origin) if within is None else archives.read_inside(*within)
    except (OSError, ValueError) as error:
        raise refuse(codes.CANNOT_READ, f"cannot be read: {_reason(error)}", origin) from error


def _check(path: str, confine: Path | None) -> None:
    """Raises: Refusal where a file, or the archive that has it, is none that may be read."""
    within, origin = archives.inside(path), Origin(path)
    place = path if within is None else within.archive
    try:
        if confine is not None and not Path(place).resolve().is_relative_to(confine.resolve()):
            raise refuse(codes.CANNOT_READ, f"the file is outside '{confine}', to which reading is confined", origin)
        found = os.stat(place)
        if stat.S_ISDIR(found.st_mode):
            raise refuse(codes.CANNOT_READ, "this is a folder, and a file was expected", origin)
        if not stat.S_ISREG(found.st_mode) and (confine is not None or not stat.S_ISFIFO(found.st_mode)):
            raise refuse(codes.CANNOT_READ, "this is a device or a pipe, and a file was expected", origin)
        if found.st_size > MOST_BYTES:
            raise refuse(codes.TOO_LARGE, f"the file has {found.st_size} bytes; at most {MOST_BYTES} are read", origin)
    except (OSError, ValueError) as error:
        raise refuse(codes.CANNOT_READ, f"cannot be read: {_reason(error)}", origin) from error


def _content(place: Path, origin: Origin) -> bytes:
    """The content of a file or of a pipe, whose size is not known beforehand."""
    with place.open("rb") as file:
        data = file.read(MOST_BYTES + 1) if place.is_fifo() else file.read()
    if len(data) > MOST_BYTES:
        raise refuse(codes.TOO_LARGE, f"more than {MOST_BYTES} bytes came out of the pipe", origin)
    return data


def check_outputs(*paths: str | Path | None, makes_folders: bool = False) -> None:
    """Refuse outputs that could not be written, before any work is done for them; None and ``-`` are none.

    ``makes_folders``: folders that are missing will be made. Raises: Refusal HX002.
    """
    for path in paths:
        try:
            if path is not None and str(path) != "-":
                _check_output(Path(path), makes_folders=makes_folders)
        except (OSError, ValueError) as error:
            raise refuse(codes.CANNOT_WRITE, f"cannot be written: {_reason(error)}", Origin(str(path))) from error


def _check_output(target: Path, *, makes_folders: bool = False) -> None:
    """Raises: OSError, ValueError where a file cannot be written."""
    folder = next(place for place in target.parents if place.exists()) if makes_folders else target.parent
    if not folder.is_dir():
        raise FileNotFoundError(errno.ENOENT, f"there is no folder '{folder}'")
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, f"'{target}' is a folder")
    if not os.access(target if _is_stream(target) else folder, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))


def write_package(package: Package, path: str, files: Files, within: Within | None = None, *, makes_folder: bool = False) -> None:
    """Write the main file to ``path`` and its assets beside it. A run that is killed leaves the old output or the new one, whole.

    All is written as temporary siblings and then renamed, the main file last. ``within`` gives the same output with its assets below
    a folder: such a main file stands in while assets are replaced that the old one refers to. What an earlier run has kept beside
    the file is removed first, and what this one keeps comes last. ``makes_folder``: a missing folder of the main file is made.

    Raises: Refusal HX002; then no file of an earlier run has been touched, unless the very renaming failed.
    """
    target, contents = Path(path), PackageFiles(package, files)
    beside = target.with_name(f"{target.name}{KEPT_SUFFIX}")
    assets, main, kept = Staging(), Staging(), Staging()
    try:
        if makes_folder:
            main.make_folders(target.parent)
        _check_output(target)
        assets.add_all((place, contents.read(name)) for name, place in _assets(package, target))
        if is_stream := _is_stream(target):
            _write_stream(package, target)
        else:
            main.add(target, package.main)
        kept.add_all(_kept_files(package, target, files))
        with _alone_in(target.parent):
            if within is not None and target.is_file() and assets.replace_others():
                _put_stand_in(target, files, within)
            assets.put()
            if not is_stream:
                beside.unlink(missing_ok=True)
                _remove_others(target.with_name(f"{target.name}{KEPT_FOLDER}"), package.originals)
            main.put()
            kept.put()
            for stand_in in _stand_ins(target):  # ours, and that of a run that was killed
                rmtree(stand_in, ignore_errors=True)
    except (OSError, ValueError) as error:
        raise refuse(codes.CANNOT_WRITE, f"cannot be written: {_reason(error)}", Origin(path)) from error
    finally:
        for staging in (kept, main, assets):
            staging.clean()


def _kept_files(package: Package, target: Path, files: Files) -> Iterator[tuple[Path, bytes]]:
    """What is kept beside the file for the way home: the originals of what was converted, and the text. Raises: OSError, ValueError."""
    for name, source in package.originals.items():
        yield _beside(target, f"{target.name}{KEPT_FOLDER}/{name}"), files.read(source)
    if package.digests:
        yield _beside(target, f"{target.name}{KEPT_FOLDER}/{DIGESTS}"), package.digests.encode("utf-8", "surrogatepass")
    if package.kept:
        yield target.with_name(f"{target.name}{KEPT_SUFFIX}"), package.kept.encode("utf-8", "surrogatepass")


def _write_stream(package: Package, target: Path) -> None:
    """Write the main file to a pipe or a device. Raises: ValueError when something is kept, which has no place beside it."""
    if package.kept or package.originals:
        raise ValueError("this is a pipe or a device, which has no file beside it; --keep=inside keeps within the output")
    target.write_bytes(package.main)


def _remove_others(folder: Path, originals: Mapping[str, str]) -> None:
    """Remove what an earlier run has kept in the folder of originals, and this one does not. Raises: OSError."""
    for name, path in _originals(str(folder)).items():
        if name not in originals and not name.endswith(".part"):
            Path(path).unlink()
    for place, _, _ in sorted(os.walk(folder), reverse=True):
        with suppress(OSError):  # a folder that is not empty stays
            os.rmdir(place)


def write_archive(package: Package, path: str, main: str, files: Files) -> None:
    """Write an archive with the main file under this name, its assets and what is kept; whole or not at all. Raises: Refusal HX002."""
    contents, home = PackageFiles(package, files), Path(path).parent
    try:
        assets = [(name, contents.read(name)) for name in sorted({*package.files, *package.copies})]
        kept = [(place.relative_to(home).as_posix(), data) for place, data in _kept_files(package, home / main, files)]
        data = archives.packed([(main, package.main), *assets, *kept])
    except (OSError, ValueError) as error:
        raise refuse(codes.CANNOT_WRITE, f"cannot be written: {_reason(error)}", Origin(path)) from error
    write_package(Package(data), path, files)


def write_files(contents: Mapping[str, bytes]) -> None:
    """Write some files, all or none. Raises: Refusal HX002."""
    staging = Staging()
    path = ""
    try:
        for path, data in contents.items():
            staging.make_folders(Path(path).parent)
            staging.add(Path(path), data)
        staging.put()
    except (OSError, ValueError) as error:
        raise refuse(codes.CANNOT_WRITE, f"cannot be written: {_reason(error)}", Origin(path)) from error
    finally:
        staging.clean()


def package_uri(folder: str) -> str:
    """The uri of a folder as a part of its package: the one whose ``package.xml`` is there or above, else the folder is the package."""
    home = Path(folder or ".").resolve()
    for above in (home, *home.parents):
        name = package_name(above)
        if name is not None:
            return "/".join([f"package://{name}", *home.relative_to(above).parts])
    return f"package://{home.name or 'robot'}"


def in_the_way(package: Package, path: str, folder: str, files: Files) -> str | None:
    """An asset that would overwrite what another output beside this one refers to; None when there is none.

    A file with another content is another output's when this main file is new, or has its own below ``folder``.

    Raises: Refusal HX002.
    """
    target, contents = Path(path), PackageFiles(package, files)
    try:
        if _is_stream(target):
            return None
        is_new = not target.exists()
        for name, place in _assets(package, target):
            if place.is_file() and (is_new or _beside(target, folder + name).exists()) and not _holds(place, contents.read(name)):
                return name
    except (OSError, ValueError) as error:
        raise refuse(codes.CANNOT_WRITE, f"cannot be written: {_reason(error)}", Origin(path)) from error
    return None


# ---- while assets are replaced -----------------------------------------------------------------------------------------------


def _put_stand_in(target: Path, files: Files, within: Within) -> None:
    """Replace the main file by one whose assets are in a folder of their own, so that those beside it are free."""
    folder = target.parent / f".{safe_name(target.name)}-{os.urandom(6).hex()}.part"
    main = Staging()
    try:
        package = within(f"{folder.name}/")
        contents = PackageFiles(package, files)
        for name, place in _assets(package, target):
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(contents.read(name))
        main.add(target, package.main)
        main.put()
    except (OSError, ValueError, Refusal):
        rmtree(folder, ignore_errors=True)
        main.clean()
        raise


def _stand_ins(target: Path) -> list[Path]:
    """The folders with the assets of main files that stood in for this one."""
    return [place for place in target.parent.glob(f".{safe_name(target.name)}-{'[0-9a-f]' * 12}.part") if place.is_dir()]


@contextmanager
def _alone_in(folder: Path) -> Iterator[None]:
    """While files are renamed into place no other run does so in the same folder, so that their outputs do not mix."""
    try:
        import fcntl
    except ImportError:  # Windows
        yield
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):  # file systems without locks
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


# ---- assets and their places -------------------------------------------------------------------------------------------------


def _assets(package: Package, target: Path) -> Iterator[tuple[str, Path]]:
    """Every asset with its place, except those that already are the very file that they would be copied from."""
    for name in package.files:
        yield name, _beside(target, name)
    for name, source in package.copies.items():
        place = _beside(target, name)
        if not _is_same(place, source):
            yield name, place


def _is_stream(target: Path) -> bool:
    """Whether the output is a pipe or a device (`/dev/stdout`), which must be written into and never replaced."""
    return target.exists() and not target.is_file() and not target.is_dir()


def _beside(target: Path, name: str) -> Path:
    """Where an asset of this relative name goes.

    Raises: ValueError when the name would lead elsewhere, which a backend must never let happen.
    """
    relative = PurePosixPath(name)
    if relative.is_absolute() or ".." in relative.parts or "\\" in name:
        raise ValueError(f"the asset name '{name}' leads out of the output folder")
    return target.parent / relative


def _is_same(final: Path, source: str) -> bool:
    """Whether the asset already is the very file that it would be copied from."""
    with suppress(OSError):
        return final.samefile(source)
    return False


def _holds(place: Path, data: bytes) -> bool:
    return place.stat().st_size == len(data) and place.read_bytes() == data


def _reason(error: OSError | ValueError) -> str:
    return error.strerror if isinstance(error, OSError) and error.strerror else str(error)


# ---- files on their way to the disk, all there under temporary names before any of them replaces another one ----------


Move = tuple["Path", "Path"]
"""A temporary file, and the place for which it is meant."""


class Staging(Struct):
    """Temporary siblings of some files, and the folders that were made for them."""

    moves: list[Move] = field(default_factory=list)
    folders: list[Path] = field(default_factory=list)

    def make_folders(self, folder: Path) -> None:
        """Make the folders in which a file will be; those that are new are noted. Raises: OSError."""
        missing = [place for place in (folder, *folder.parents) if not place.exists()]
        folder.mkdir(parents=True, exist_ok=True)
        self.folders += missing

    def add(self, final: Path, data: bytes) -> None:
        """Put the data beside its place, with the permissions of the file that it will replace, or of a new file. Raises: OSError."""
        self.moves.append(_stage(final, data))

    def add_all(self, places: Iterable[tuple[Path, bytes]]) -> None:
        """Put data beside its places, in folders that are made where they do not exist. Raises: OSError."""
        for final, data in places:
            self.make_folders(final.parent)
            self.add(final, data)

    def replace_others(self) -> bool:
        """Whether a file with another content is in the place of one of these. Raises: OSError."""
        return any(final.exists() and not filecmp.cmp(temporary, final, shallow=False) for temporary, final in self.moves)

    def put(self) -> None:
        """Rename all into place, in their order. Raises: OSError."""
        for temporary, final in self.moves:
            temporary.replace(final)

    def clean(self) -> None:
        """Remove what a failed run left: temporary files, and folders of its own that stayed empty."""
        for temporary, _ in self.moves:
            with suppress(OSError):
                temporary.unlink(missing_ok=True)
        for folder in self.folders:
            with suppress(OSError):
                folder.rmdir()


def _stage(final: Path, data: bytes) -> Move:
    real = final.resolve() if final.is_symlink() else final
    if real.is_dir():
        raise IsADirectoryError(errno.EISDIR, f"'{final}' is a folder")
    temporary = real.with_name(f".{real.name[:100]}.{os.urandom(6).hex()}.part")
    try:
        with temporary.open("xb") as file:
            file.write(data)
        if real.exists():
            temporary.chmod(stat.S_IMODE(real.stat().st_mode))
    except OSError:
        temporary.unlink(missing_ok=True)
        raise
    return temporary, real
