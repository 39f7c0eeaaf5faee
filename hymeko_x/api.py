"""The public functions, on files and on bytes: load, loads, dump, dumps, convert."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from msgspec.structs import replace

from hymeko_x import disk, formats, pipeline
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.delivery import Delivery
from hymeko_x.diagnostics import Origin, Report
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Source

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.source import Files

    Place = str | os.PathLike[str]
    Base = Literal["fixed", "free"] | None
    Assets = Literal["copy", "reference"] | None
    Actuators = Literal["none", "motor", "position", "velocity"] | None
    Layout = Literal["single", "layered"] | None


def load(
    path: Place,
    format: str | None = None,
    *,
    packages: Mapping[str, Place] | None = None,
    arguments: Mapping[str, str] | None = None,
    environment: Mapping[str, str] | None = None,
    variants: Mapping[str, str] | None = None,
    report: Report | None = None,
) -> Mechanism:
    """The robot in a file. The format is taken from suffix and content unless it is given.

    ``packages`` says where `package://NAME` is, ``arguments`` and ``environment`` what $(arg NAME) and $(env NAME) are in
    a xacro file, ``variants`` which variant of a variant set of USD to read. What there is to say goes into ``report``.

    Raises: Refusal when the file cannot be read.
    """
    source = disk.open_source(os.fspath(path), packages=_folders(packages))
    source = replace(source, arguments=dict(arguments or {}), environment=dict(environment or {}), variants=dict(variants or {}))
    robot = pipeline.read(source, _input_format(source, format), Report() if report is None else report)
    return replace(robot, origins={ROOT: Origin(source.name), **robot.origins})  # files are looked for beside the first of them


def loads(data: bytes | str, format: str | None = None, *, files: Files | None = None, report: Report | None = None) -> Mechanism:
    """The robot in a text or in bytes. ``files`` are those that it may refer to (none by default).

    Raises: Refusal when it cannot be read.
    """
    source = Source("<text>", data.encode() if isinstance(data, str) else data, NoFiles() if files is None else files)
    return pipeline.read(source, _input_format(source, format), Report() if report is None else report)


def dump(
    robot: Mechanism,
    path: Place,
    format: str | None = None,
    *,
    packages: Mapping[str, Place] | None = None,
    base: Base = None,
    actuators: Actuators = None,
    layout: Layout = None,
    nested: bool | None = None,
    assets: Assets = None,
    pure: bool = False,
) -> Report:
    """Write a robot with its meshes to a file; return what there is to say. The format is taken from the suffix unless given.

    Relative meshes are looked for beside the file that the robot was read from. ``assets``: copy meshes beside the
    output, or refer to them where they are (None = what is usual for the format). ``layout`` and ``nested`` say how a stage of
    USD is laid out. ``pure`` leaves out what the format cannot say itself, which it carries otherwise.

    Raises: Refusal when it cannot be written; then nothing was changed.
    """
    report = Report()
    target = formats.by_name(format) if format else formats.of_output(os.fspath(path))
    files = _files_of(robot, packages)
    options = Options(base, actuators, layout, nested, pure=pure, beside=Path(path).stem)
    delivery = Delivery(robot, target, options, files, _place(path, assets), os.fspath(path))
    delivery.put(delivery.convert(report))
    return report


def dumps(
    robot: Mechanism,
    format: str,
    *,
    base: Base = None,
    actuators: Actuators = None,
    nested: bool | None = None,
    pure: bool = False,
    report: Report | None = None,
) -> str:
    """A robot as text; meshes are referred to from the working folder, and nothing is written.

    Raises: Refusal when the format cannot be written.
    """
    said = Report() if report is None else report
    options = Options(base, actuators, nested=nested, pure=pure)
    place = pipeline.Place(assets="reference")
    result = pipeline.convert(robot, formats.by_name(format), options, _files_of(robot, None), said, place)
    return result.package.main.decode()


def convert(
    source: Place,
    target: Place,
    *,
    from_format: str | None = None,
    to_format: str | None = None,
    packages: Mapping[str, Place] | None = None,
    arguments: Mapping[str, str] | None = None,
    environment: Mapping[str, str] | None = None,
    variants: Mapping[str, str] | None = None,
    base: Base = None,
    actuators: Actuators = None,
    layout: Layout = None,
    nested: bool | None = None,
    assets: Assets = None,
    pure: bool = False,
) -> pipeline.Result:
    """Convert a file with its meshes; return the mechanism, what was written, what there is to say and what got lost.

    The output carries what its format cannot say itself, unless it is to be ``pure``.

    Raises: Refusal when the input cannot be read or the output not written; then nothing was changed.
    """
    report = Report()
    given = disk.open_source(os.fspath(source), packages=_folders(packages))
    given = replace(given, arguments=dict(arguments or {}), environment=dict(environment or {}), variants=dict(variants or {}))
    robot = pipeline.read(given, _input_format(given, from_format), report)
    form = formats.of_output(os.fspath(target), to_format)
    options = Options(base, actuators, layout, nested, pure=pure, beside=Path(target).stem)
    delivery = Delivery(robot, form, options, given.files, _place(target, assets), os.fspath(target))
    result = delivery.convert(report)
    delivery.put(result)
    return result


def _input_format(source: Source, format: str | None) -> formats.Format:
    return formats.by_name(format) if format else formats.of_input(source.name, source.data)


def _place(path: Place, assets: Assets) -> pipeline.Place:
    return pipeline.Place(os.path.dirname(os.fspath(path)) or ".", assets)


def _folders(packages: Mapping[str, Place] | None) -> dict[str, Path]:
    return {name: Path(folder) for name, folder in (packages or {}).items()}


def _files_of(robot: Mechanism, packages: Mapping[str, Place] | None) -> Files:
    """The files beside the one that the robot was read from; those of the working folder if it was made by a program."""
    return DiskFiles(Path(robot.source.file).parent, _folders(packages))
