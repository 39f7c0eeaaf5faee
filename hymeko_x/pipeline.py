"""The pipeline: read, rewrite, place the files, print, read back, compare. Values in, values out; `delivery` puts them on the disk."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, NamedTuple, Protocol

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes, formats, targets
from hymeko_x.assets.pack import GAZEBO_MODEL, ROS_PACKAGE, pack, unloaded, with_prefix, with_stand_ins
from hymeko_x.assets.shelf import Shelf, safe_name
from hymeko_x.collector import uncollected
from hymeko_x.compare.geometry import with_points_of_files
from hymeko_x.diagnostics import Refusal, Report, Stopped, refuse
from hymeko_x.reporting.mark import without_mark
from hymeko_x.residue.kept import restored
from hymeko_x.residue.measuring import compared
from hymeko_x.residue.originals import fetch_from, files_of, originals_of, with_originals
from hymeko_x.rewrite import Options, actuate, choose, legalize
from hymeko_x.rewrite.decimals import shorten_computed
from hymeko_x.rewrite.networks import robot_of_network
from hymeko_x.source import NO_FILES, Kept, PackageFiles, Source

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from hymeko_x.compare.ledger import Loss
    from hymeko_x.formats import Assets, Format
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.source import Files, Package, Reading


class Reader(Protocol):
    """The function ``read`` of every frontend."""

    def __call__(self, source: Source, report: Report) -> Reading:
        """The mechanism that the source describes, and the residue that is kept inside of it. Raises: Refusal."""
        ...


class Writer(Protocol):
    """The function ``write`` of every backend."""

    def __call__(self, mechanism: Mechanism, options: Options, report: Report) -> Package:
        """The files that describe the mechanism, which must be legal for the format."""
        ...


class OutputPlace(Struct, frozen=True):
    """Where the output goes: its ``folder``, and whether files go beside it or with it into an archive, or are referred to (None = the
    format's own way).

    ``name`` is the folder's own name, and ``package`` its uri as a part of a package (``package://NAME``), where these are known;
    ``around`` finds files from the folder.

    ``in_the_way(package, other_folder)`` names a file of another output that one of the package's would overwrite; then all of them go
    below the other folder, which ends in a slash.
    """

    folder: str = "."
    assets: Assets | None = None
    name: str = ""
    package: str = ""
    around: Files = NO_FILES
    in_the_way: Callable[[Package, str], str | None] | None = None


HERE = OutputPlace()
"""The working folder."""


class Result(Struct, frozen=True):
    """The result of a conversion: the mechanism as the options ask for it, and what was written.

    ``losses`` is None when nothing was measured: the target cannot be read back.
    """

    mechanism: Mechanism
    package: Package
    report: Report
    losses: tuple[Loss, ...] | None


class _Printed(NamedTuple):
    """A package, and the mechanism as it was printed: legal, with the paths of its files.

    ``is_moved`` says that its files are below a folder of their own, so that its residue must not lead back to those in the way.
    """

    package: Package
    mechanism: Mechanism
    is_moved: bool


# ---- the stages ------------------------------------------------------------------------------------------------------------------


def read(source: Source, format: Format, report: Report, *, lenient: bool = False) -> Mechanism:
    """The mechanism in a source of this format, with what is kept for it.

    Raises: Refusal when the input cannot be read at all; Stopped when it has errors, unless ``lenient``.
    """
    since = len(report)
    mechanism = read_anyway(source, format, report)
    stop_on_errors(report, since, lenient=lenient)
    return mechanism


@uncollected()
def read_anyway(source: Source, format: Format, report: Report) -> Mechanism:
    """As :func:`read`, whatever errors there are: for those who look at the errors. Raises: Refusal when nothing can be read."""
    image, kept = _native(source, format, report)
    if kept is not None and kept.text:
        image = with_points_of_files(restored(image, kept, report), fetch_from(source.files))
    return image if kept is None else with_originals(image, kept.originals, source.files, report)


@uncollected()
def read_for(target: Format, source: Source, format: Format, report: Report, *, lenient: bool = False) -> tuple[Mechanism, Kept | None]:
    """The mechanism to convert into a target; and within one format, what is kept for the source, which fits the output as it is.

    All that a conversion within one format needs stands in the file itself.

    Raises: as :func:`read`.
    """
    if format.family != target.family:
        return read(source, format, report, lenient=lenient), None
    since = len(report)
    image, kept = _native(source, format, report)
    stop_on_errors(report, since, lenient=lenient)
    return image, kept or Kept("", "")


def read_file(source: Source, format: Format, report: Report) -> Reading:
    """The mechanism as the file and those that it imports describe it, and what is kept inside of it. Raises: Refusal."""
    if format.imports is not None and source.parts is None:
        source = formats.loaded(format.imports)(source, report)
    return reader(format)(source, report)


def _native(source: Source, format: Format, report: Report) -> tuple[Mechanism, Kept | None]:
    """The mechanism as the file itself describes it, and what is kept for it: inside of it, else beside it."""
    image, inside = read_file(source, format, report)
    kept = Kept(inside, source.name) if inside else source.kept
    if source.ignores_kept or (kept is None and not source.originals):
        return image, None
    return image, (kept or Kept("", source.name))._replace(originals=source.originals)


def stop_on_errors(report: Report, since: int, *, lenient: bool) -> None:
    """End a stage whose diagnostics are those from this number on. Raises: Stopped when one is an error, unless ``lenient``."""
    errors = report.errors(since)
    if not errors:
        return
    if not lenient:
        raise Stopped(report, since)
    those = "one error was" if len(errors) == 1 else f"{len(errors)} errors were"
    report.warn(codes.PASSED_OVER, f"{those} passed over, as asked: the result is not what the input means")


@uncollected()
def write(mechanism: Mechanism, format: Format, options: Options, files: Files, report: Report, place: OutputPlace = HERE) -> Package:
    """The mechanism in a format, without a residue: rewritten until the format can represent it, its files placed, then printed.

    Raises: Refusal when the format cannot be written; Stopped when that made errors, unless the options are lenient.
    """
    chosen, options = _chosen(mechanism, format, options, files, report)
    return _printed(chosen, mechanism, format, options, files, report, place).package


@uncollected()
def convert(
    mechanism: Mechanism,
    format: Format,
    options: Options,
    files: Files,
    report: Report,
    place: OutputPlace = HERE,
    *,
    measured: bool = True,
    passed: Kept | None = None,
) -> Result:
    """Write a mechanism, read the result back if the format has a reader, measure the losses, and keep them if the options ask for it.

    ``passed`` is what was kept for the source and is passed on instead (None: what there is to keep is measured). Without ``measured`` the
    mechanism is only written.

    Raises: as :func:`write`, and HX901 when our own reader refuses the output.
    """
    given = mechanism
    mechanism, options = _chosen(given, format, options, files, report)
    package, printed, is_moved = _printed(mechanism, given, format, options, files, report, place)
    if format.frontend is None or not measured:
        return Result(mechanism, package, report, None)
    image = read_back(package, format, files)
    contents = None if place.assets == "reference" else PackageFiles(package, files_of(mechanism, files))
    is_kept = options.keep is not None and passed is None and not format.is_exact
    losses, residue, aligned = compared(mechanism, printed, image, format, contents, is_moved=is_moved, is_kept=is_kept)
    if is_kept and _is_network_as_robot(given, mechanism, format):  # the way home leads to the network
        _, residue, aligned = compared(given, printed, image, format, contents, is_moved=is_moved, is_kept=True)
    kept = Kept(residue, "") if passed is None else passed
    if passed is None and options.keep is not None:
        named, is_inside = printed if format.is_exact else mechanism, options.keep == "inside" and not format.is_exact
        originals, digests = originals_of(mechanism, named, aligned, package, files_of(mechanism, files), missing_only=is_inside)
        kept = kept._replace(originals=originals, digests="" if is_inside else digests)
    return Result(mechanism, with_kept(package, kept, options, report), report, losses)


def _is_network_as_robot(given: Mechanism, mechanism: Mechanism, format: Format) -> bool:
    """Whether the mechanism is a lumped network as the robot that it becomes in a format, and no option has changed that robot."""
    robot = robot_of_network(given, format, Report())
    return robot is not given and robot == mechanism


def _chosen(mechanism: Mechanism, format: Format, options: Options, files: Files, report: Report) -> tuple[Mechanism, Options]:
    """The robot as the options and the target among them ask for it, and the options with that target's defaults."""
    options, target = targets.chosen(options, format)
    since = len(report)
    mechanism = robot_of_network(mechanism, format, report)
    stop_on_errors(report, since, lenient=options.lenient)
    mechanism = actuate(choose(mechanism, options, report, files=files_of(mechanism, files)), format.name, options, report)
    files = files_of(mechanism, files)
    mechanism = mechanism if target is None else completed(mechanism, format, files, report)

    def printed(robot: Mechanism) -> Package:
        return _printed(robot, robot, format, replace(options, beside="", lenient=True), files, Report(), HERE).package

    return targets.aimed(mechanism, target, files, report, printed), options


def with_kept(package: Package, kept: Kept, options: Options, report: Report) -> Package:
    """The package with this text of a residue where the options want it, and with the originals."""
    if not kept.text and not kept.originals:
        return package
    if options.keep is None:
        report.note(codes.KEPT_LEFT, "what is kept for the input stays there", hint="--keep takes it along")
        return package
    package = replace(package, originals=kept.originals, digests=kept.digests)
    if not kept.text:
        return package
    if options.keep == "beside" or package.with_residue is None:
        return replace(package, kept=kept.text)
    return replace(package, main=package.with_residue(kept.text))


def _printed(
    mechanism: Mechanism, given: Mechanism, format: Format, options: Options, files: Files, report: Report, place: OutputPlace
) -> _Printed:
    """Rewritten, with numbers that ``given`` has not as short as a person would write them, with its files placed, and printed."""
    since = len(report)
    files = files_of(mechanism, files)
    complete = completed(with_stand_ins(mechanism, format, files, report), format, files, report)
    legal = shorten_computed(legalize(complete, format.name, report), given)
    printed = _placed_and_printed(legal, format, options, files, report, place)
    stop_on_errors(report, since, lenient=options.lenient)
    folder = f"{safe_name(options.beside)}/"
    other = None if place.in_the_way is None else place.in_the_way(printed.package, folder)
    if other is None:
        return printed
    report.note(codes.ASSETS_APART, f"'{other}' beside the output has another content and stays; files of this output go to '{folder}'")
    return _placed_and_printed(legal, format, replace(options, within=folder), files, Report(), place)


def _placed_and_printed(legal: Mechanism, format: Format, options: Options, files: Files, report: Report, place: OutputPlace) -> _Printed:
    """A legal mechanism with its files placed, and printed."""
    options = replace(options, mesh_prefix=_prefix(options, format, place))
    prefix = options.mesh_prefix or ""
    shelf = Shelf(place.assets or format.assets, place.folder, options.within, place.around, legal.source.file)
    layout = GAZEBO_MODEL if options.package_layout else ROS_PACKAGE
    placed, new, copies = pack(legal, format, files, shelf, report, layout=layout if prefix else None)
    placed = with_prefix(placed, prefix, {*new, *copies}) if prefix else placed
    package = replace(writer(format)(placed, options, report), prefix=prefix)
    placed = unloaded(placed)
    if package.enclose is not None and (new or copies):
        return _Printed(package.enclose({**new, **dict(_contents(copies, files))}), placed, bool(options.within))
    package = replace(package, files={**package.files, **new}, copies={**package.copies, **copies})
    beside = targets.files_beside(placed, package, files, options) if options.beside else {}
    package = replace(package, files={**package.files, **beside}) if beside else package
    return _Printed(package, placed, bool(options.within))


def _prefix(options: Options, format: Format, place: OutputPlace) -> str | None:
    """What stands before the paths of files beside the output; None where they are relative, or no files are put there."""
    if options.package_layout:
        return f"model://{place.name}" if place.name and place.assets != "reference" else None
    prefix = options.mesh_prefix if "mesh_prefix" in format.layout_options and (place.assets or format.assets) != "reference" else None
    return (place.package or None) if prefix == "package://" else prefix and prefix.rstrip("/")


def read_back(package: Package, format: Format, files: Files) -> Mechanism:
    """The mechanism that the format's own frontend reads from a package that was just written.

    Raises: Refusal HX901 when it refuses it.
    """
    companion = next((name for name in package.files if name.endswith(format.companions)), "") if format.companions else ""
    result = Source(companion or f"<written {format.name}>", package.main, PackageFiles(package, files))
    try:
        return reader(format)(result, Report()).mechanism
    except Refusal as error:
        if error.diagnostic.code == codes.LIBRARY_MISSING:
            raise
        raise refuse(codes.BUG, f"what was written as {format.name} cannot be read back: {error}") from error


# ---- steps of the stages ---------------------------------------------------------------------------------------------------------


def completed(mechanism: Mechanism, format: Format, files: Files, report: Report) -> Mechanism:
    """The mechanism with what only the engine of the format that it came from computes, where it goes to another format."""
    native = formats.native_format(mechanism)
    return mechanism if native is format or format.is_exact else fully_completed(mechanism, files, report)


def fully_completed(mechanism: Mechanism, files: Files, report: Report) -> Mechanism:
    """The mechanism with what only the engine of the format that it came from computes, wherever it goes."""
    native = formats.native_format(mechanism)
    if native is None or native.completes is None:
        return mechanism

    def printed() -> tuple[Mechanism, bytes]:
        legal = legalize(mechanism, native.name, Report())
        return legal, writer(native)(legal, Options(), Report()).main

    found: Mechanism = formats.loaded(native.completes)(mechanism, printed, files, report)
    return found


def flattened(mechanism: Mechanism) -> Mechanism:
    """The mechanism whose elements have all that they inherit from classes of the format that it came from, and no classes."""
    native = formats.native_format(mechanism)
    if native is None or native.flattens is None:
        return mechanism
    found: Mechanism = formats.loaded(native.flattens)(mechanism, lambda named: writer(native)(named, Options(), Report()).main)
    return found


def inlined(mechanism: Mechanism, files: Files) -> Mechanism:
    """The mechanism without files that name its elements, which are in its own text then: for elements that get other names."""
    for row in formats.FORMATS:
        if row.inlines is not None:
            mechanism = formats.loaded(row.inlines)(mechanism, files)
    return mechanism


def _contents(copies: Mapping[str, str], files: Files) -> Iterator[tuple[str, bytes]]:
    """The files to copy that are still there."""
    for name, path in copies.items():
        with suppress(OSError):
            yield name, files.read(path)


def reader(format: Format) -> Reader:
    """The format's frontend, loaded now; the comment that an earlier conversion wrote is not part of the robot.

    Raises: Refusal HX003 when the format can only be written.
    """
    if format.frontend is None:
        readable = ", ".join(row.name for row in formats.FORMATS if row.frontend)
        raise refuse(codes.UNKNOWN_FORMAT, f"{format.name} cannot be read", hint=f"readable: {readable}")
    native: Reader = formats.loaded(format.frontend).read

    def read_without_mark(source: Source, report: Report) -> Reading:
        found = native(source, report)
        return found._replace(mechanism=without_mark(found.mechanism))

    return read_without_mark


def writer(format: Format) -> Writer:
    """The format's backend, loaded now.

    Raises: Refusal HX003 when the format can only be read.
    """
    if format.backend is None:
        writable = ", ".join(row.name for row in formats.FORMATS if row.backend)
        raise refuse(codes.UNKNOWN_FORMAT, f"{format.name} cannot be written", hint=f"writable: {writable}")
    found: Writer = formats.loaded(format.backend).write
    return found
