"""The public functions, on files and on bytes: load, loads, dump, dumps, convert, update.

Every option of the command line is an argument here.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypedDict, Unpack

from msgspec.structs import replace

from hymeko_x import disk, formats, pipeline
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.delivery import Delivery, place_of, reason_against, report_unwritten, unchanged
from hymeko_x.diagnostics import Report
from hymeko_x.ir.holder import mechanism_of
from hymeko_x.rewrite import Options
from hymeko_x.source import KEPT_SUFFIX, Kept, ManyFiles, NoFiles, Source

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.edits.updating import Updated
    from hymeko_x.ir.holder import Holder
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.robot import Robot
    from hymeko_x.source import Files

Place = str | os.PathLike[str]


class FindingOptions(TypedDict, total=False):
    """How files are found to which a robot refers."""

    packages: Mapping[str, Place] | None
    """Where ``package://NAME`` and ``model://NAME`` are."""
    search_path: Iterable[Place]
    """The folders in which packages stand; the command line takes them from ROS_PACKAGE_PATH and the like."""
    confine: Place | None
    """The folder outside of which no file is read."""


class ReadingOptions(FindingOptions, total=False):
    """How a file is read."""

    arguments: Mapping[str, str] | None
    """The values of ``$(arg NAME)`` in a xacro file."""
    environment: Mapping[str, str] | None
    """The values of ``$(env NAME)`` in a xacro file."""
    variants: Mapping[str, str] | None
    """Which variant of a variant set of USD to read, by set."""
    ignore_kept: bool
    """Whether what is kept for the file, beside it or inside of it, is left out."""


class WritingOptions(TypedDict, total=False):
    """How a robot is written."""

    base: Literal["fixed", "free"] | None
    """What becomes of a base that the source leaves open (None = usual for the format). It belongs to the robot from then on."""
    actuators: Literal["none", "motor", "position", "velocity"] | None
    """The actuators to give it (None = those that it has). They belong to the robot from then on."""
    layout: Literal["single", "layered", "rep158"] | None
    """USD: one file, or an interface with files for geometry, materials and physics behind it."""
    nested: bool | None
    """USD: whether each body stands inside of its parent."""
    split: bool
    """xacro: whether the macros go into a file of their own."""
    density: float | None
    """The density in kg/m^3 with which bodies without inertia get that of their shapes (None = 1000 where ``inertia_from`` is given)."""
    inertia_from: Literal["collision", "visual", "hull"] | None
    """The shapes that count for it (None = those that collide)."""
    collision: Literal["hull", "decompose"] | None
    """What replaces concave meshes that collide: their convex hulls, or convex parts (CoACD). It belongs to the robot from then on."""
    target: str | None
    """The program that the output is for, a row of `hymeko_x.targets`. What it expects belongs to the robot from then on."""
    sites: bool | None
    """URDF: whether each frame on a body is a link with a fixed joint."""
    package_layout: bool
    """SDF: whether the output's folder becomes a model of Gazebo, with `model.config`, which ``model://FOLDER`` finds."""
    mesh_prefix: str | None
    """URDF: what stands before the paths of meshes; ``package://`` is the package in which the output lies."""
    keep: Literal["beside", "inside"] | None
    """Where to keep what the format cannot represent, so that it comes back: in a file beside the output, or inside of it."""
    lenient: bool
    """Whether to go on where writing makes errors; else they raise Stopped, and nothing is written."""


Assets = Literal["copy", "reference", "pack"] | None
"""Copy meshes beside the output, refer to them where they are, or pack all into one archive; None = usual for the format and suffix."""


def load(
    path: Place, format: str | None = None, *, report: Report | None = None, lenient: bool = False, **reading: Unpack[ReadingOptions]
) -> Robot:
    """The robot in a file; :class:`ReadingOptions` lists the options. The format is taken from suffix and content unless it is given.

    Diagnostics go into ``report``. ``lenient`` goes on where the input has errors, with what each error says.

    Raises: Refusal when the file cannot be read; Stopped, a Refusal, when it has errors and ``lenient`` is not set.
    """
    return _robot(_source(path, **reading), format, report, lenient=lenient)


def loads(
    data: bytes | str,
    format: str | None = None,
    *,
    files: Files | None = None,
    report: Report | None = None,
    lenient: bool = False,
    kept: str | None = None,
    ignore_kept: bool = False,
) -> Robot:
    """The robot in a text or in bytes. ``files`` are those that it may refer to (none by default), ``kept`` is the text of its kept file.

    Raises: as :func:`load`.
    """
    data = data.encode() if isinstance(data, str) else data
    beside = Kept(kept, f"<text>{KEPT_SUFFIX}") if kept else None
    source = Source("<text>", data, NoFiles() if files is None else files, kept=beside, ignores_kept=ignore_kept)
    return _robot(source, format, report, lenient=lenient)


def _robot(source: Source, format: str | None, report: Report | None, *, lenient: bool) -> Robot:
    from hymeko_x.robot import Robot

    mechanism = pipeline.read(source, _input_format(source, format), Report() if report is None else report, lenient=lenient)
    return Robot(mechanism, source.files)


def dump(
    robot: Mechanism | Holder,
    path: Place,
    format: str | None = None,
    *,
    assets: Assets = None,
    packages: Mapping[str, Place] | None = None,
    search_path: Iterable[Place] = (),
    confine: Place | None = None,
    **writing: Unpack[WritingOptions],
) -> Report:
    """Write a robot with its meshes to a file; return the diagnostics. The format is taken from the suffix unless given.

    Relative meshes are looked for beside the file that the robot was read from, and otherwise as :class:`FindingOptions` says;
    :class:`WritingOptions` lists the other options.

    Raises: Refusal when it cannot be written; then nothing was changed. ValueError for ``assets`` that do not fit to the path.
    """
    report = Report()
    target = formats.by_name(format) if format else formats.of_output(os.fspath(path))
    files, place = _files_of(robot, packages, search_path, confine), _place(path, assets, target)
    delivery = Delivery(mechanism_of(robot), target, Options(**writing, beside=Path(path).stem), files, place, os.fspath(path))
    delivery.put(delivery.convert(report))
    return report


def dumps(
    robot: Mechanism | Holder,
    format: str,
    *,
    report: Report | None = None,
    packages: Mapping[str, Place] | None = None,
    search_path: Iterable[Place] = (),
    confine: Place | None = None,
    **writing: Unpack[WritingOptions],
) -> str:
    """A robot as text; meshes are referred to from the working folder, and nothing is written. Options as for :func:`dump`.

    Files that would stand beside the text (layers of USD, macros of xacro) are named in a warning.

    Raises: Refusal when the format cannot be written; ValueError for ``keep="beside"``, where there is no file to be beside of.
    """
    if writing.get("keep") == "beside":
        raise ValueError('a text has nothing beside it: keep="inside" keeps within the text, and dump() writes files')
    report = Report() if report is None else report
    files = _files_of(robot, packages, search_path, confine)
    mechanism = mechanism_of(robot)
    result = pipeline.convert(
        mechanism, formats.by_name(format), Options(**writing), files, report, pipeline.OutputPlace(assets="reference")
    )
    report_unwritten(result.package, "a text", report)
    return result.package.main.decode()


def convert(
    source: Place,
    output: Place,
    *,
    from_format: str | None = None,
    to_format: str | None = None,
    assets: Assets = None,
    base: Literal["fixed", "free"] | None = None,
    actuators: Literal["none", "motor", "position", "velocity"] | None = None,
    layout: Literal["single", "layered", "rep158"] | None = None,
    nested: bool | None = None,
    split: bool = False,
    sites: bool | None = None,
    mesh_prefix: str | None = None,
    package_layout: bool = False,
    keep: Literal["beside", "inside"] | None = None,
    target: str | None = None,
    density: float | None = None,
    inertia_from: Literal["collision", "visual", "hull"] | None = None,
    collision: Literal["hull", "decompose"] | None = None,
    lenient: bool = False,
    **reading: Unpack[ReadingOptions],
) -> pipeline.Result:
    """Convert a file with its meshes; return the mechanism, the package, the diagnostics and the losses.

    :class:`ReadingOptions` and :class:`WritingOptions` list the options.

    Raises: Refusal when input or output has errors; then nothing was changed. ValueError for ``assets`` that do not fit to the path.
    """
    report, given = Report(), _source(source, **reading)
    read_as = _input_format(given, from_format)
    format = formats.of_output(os.fspath(output), to_format)
    robot, passed = pipeline.read_for(format, given, read_as, report, lenient=lenient)
    options = Options(base, actuators, layout, nested, split, keep, lenient, Path(output).stem, "", target, density, inertia_from, sites)
    options = replace(options, mesh_prefix=mesh_prefix, package_layout=package_layout, collision=collision)
    place, own = _place(output, assets, format), unchanged(given, read_as, format)
    delivery = Delivery(robot, format, options, given.files, place, os.fspath(output), own, passed)
    result = delivery.convert(report)
    delivery.put(result)
    return result


def update(
    original: Place,
    edited: Place,
    output: Place | None = None,
    *,
    dry_run: bool = False,
    from_format: str | None = None,
    edited_format: str | None = None,
    base: Literal["fixed", "free"] | None = None,
    actuators: Literal["none", "motor", "position", "velocity"] | None = None,
    target: str | None = None,
    density: float | None = None,
    inertia_from: Literal["collision", "visual", "hull"] | None = None,
    collision: Literal["hull", "decompose"] | None = None,
    **reading: Unpack[ReadingOptions],
) -> Updated:
    """Bring the edits in ``edited``, which was once converted from ``original``, into the text of that, or into ``output``.

    ``base``, ``actuators`` and ``target`` are those of the conversion, found out where they are not given, and so are ``density``,
    ``inertia_from`` and ``collision``, which are not found out. With ``dry_run`` nothing is written.
    The result has the edits, the differences of the texts, and the diagnostics.

    Raises: Refusal when a file cannot be read or written; then nothing was changed.
    """
    from hymeko_x.edits import updating

    given, changed = _source(original, **reading), _source(edited, **reading)
    report = Report()
    options = Options(base, actuators, beside=Path(edited).stem, target=target, density=density, inertia_from=inertia_from)
    options = replace(options, collision=collision)
    found = updating.update(given, _input_format(given, from_format), changed, _input_format(changed, edited_format), options, report)
    if not dry_run:
        disk.write_files(found.files(given.name, None if output is None else os.fspath(output)))
    return found


def _source(
    path: Place,
    packages: Mapping[str, Place] | None = None,
    search_path: Iterable[Place] = (),
    confine: Place | None = None,
    arguments: Mapping[str, str] | None = None,
    environment: Mapping[str, str] | None = None,
    variants: Mapping[str, str] | None = None,
    ignore_kept: bool = False,
) -> Source:
    given = disk.open_source(
        os.fspath(path),
        packages=_folders(packages),
        search_path=tuple(map(Path, search_path)),
        confine=None if confine is None else Path(confine),
    )
    chosen = {"arguments": dict(arguments or {}), "environment": dict(environment or {}), "variants": dict(variants or {})}
    return replace(given, **chosen, ignores_kept=ignore_kept)


def _place(path: Place, assets: Assets, format: formats.Format) -> pipeline.OutputPlace:
    """Where the output and its files go. Raises: ValueError where they cannot go there."""
    reason = reason_against(os.fspath(path), assets, format)
    if reason:
        raise ValueError(reason)
    return place_of(os.fspath(path), assets)


def _input_format(source: Source, format: str | None) -> formats.Format:
    return formats.by_name(format) if format else formats.of_input(source.name, source.data)


def _folders(packages: Mapping[str, Place] | None) -> dict[str, Path]:
    return {name: Path(folder) for name, folder in (packages or {}).items()}


def _files_of(
    robot: Mechanism | Holder, packages: Mapping[str, Place] | None, search_path: Iterable[Place], confine: Place | None
) -> Files:
    """The files beside the one that the robot was read from; those of the working folder if it was made by a program.

    An object that knows its files itself is asked after the packages that the user names.
    """
    folder = Path(mechanism_of(robot).source.file).parent
    named = DiskFiles(folder, _folders(packages), tuple(map(Path, search_path)), None if confine is None else Path(confine))
    own: Files | None = getattr(robot, "files", None)
    return named if own is None or confine is not None else ManyFiles((named, own))
