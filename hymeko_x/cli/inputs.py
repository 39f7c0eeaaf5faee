"""The words on the command line that say what to read, and the reading."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from msgspec.structs import replace

from hymeko_x import codes, formats
from hymeko_x.assets.resolve import DiskFiles, search_path
from hymeko_x.cli.exits import UsageError
from hymeko_x.corpus.names import Located, located
from hymeko_x.diagnostics import Report, refuse
from hymeko_x.source import Source

if TYPE_CHECKING:
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.source import Kept


class Input(NamedTuple):
    """One input as it was read; ``passed`` is what is kept for it and is passed on, as in :func:`hymeko_x.pipeline.convert`."""

    mechanism: Mechanism
    format: Format
    source: Source
    passed: Kept | None = None


def input_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of every verb that reads a robot."""
    parser.add_argument("-v", "--verbose", action="store_true", help="report everything, each with its place; verify: the table of checks")
    parser.add_argument("-q", "--quiet", action="store_true", help="report nothing but errors; verify: the answer alone")
    parser.add_argument("--from", dest="from_format", metavar="FORMAT", help="the input's format, where suffix and content do not tell")
    where = "where package://NAME and model://NAME are (repeatable)"
    parser.add_argument("--package", action="append", default=[], type=_package, metavar="NAME=DIR", help=where)
    parser.add_argument("--confine", type=folder, metavar="DIR", help="read no file outside this folder")
    argument = "an argument of a xacro file; NAME:=VALUE as in ROS works too (repeatable)"
    parser.add_argument("--arg", action="append", default=[], type=_argument, metavar="NAME=VALUE", help=argument)
    picked = "which variant of a USD file's variant set to read, wherever it has that set (repeatable)"
    parser.add_argument("--variant", action="append", default=[], type=_variant, metavar="SET=NAME", help=picked)
    passed = "an environment variable that a xacro file may see (repeatable)"
    parser.add_argument("--env", action="append", default=[], type=_variable, metavar="NAME[=VALUE]", help=passed)
    parser.add_argument("--ignore-kept", action="store_true", help="leave out what is kept for the file, beside it or inside of it")


def refuse_own_reading(chosen: argparse.Namespace) -> None:
    """Refuse options of this program's own readers for a verb whose files the formats' engines read. Raises: UsageError."""
    for given, option in (
        (chosen.from_format, "--from"),
        (chosen.env, "--env"),
        (chosen.ignore_kept, "--ignore-kept"),
    ):
        if given:
            reason = "which choose by the suffix, open files themselves and know nothing of what is kept"
            raise UsageError(f"{option} changes nothing here: the files are read by the formats' own engines, {reason}")


def engine_input(path: str, chosen: argparse.Namespace) -> Located:
    """A file that an engine is going to open, with every file that it refers to.

    Raises: Refusal HX001 where reading is confined and the robot refers to a file outside; Stopped when it cannot be read within.
    """
    found = located(path)
    if chosen.confine is None:
        return found
    from hymeko_x import disk, pipeline
    from hymeko_x.residue.originals import files_named

    report = Report()
    source = disk.open_source(found.path, packages=dict(chosen.package), search_path=search_path(os.environ), confine=chosen.confine)
    source = replace(source, arguments={**found.arguments, **dict(chosen.arg)}, variants=dict(chosen.variant), ignores_kept=True)
    robot = pipeline.read(source, formats.of_input(source.name, source.data), report)
    everywhere = DiskFiles(Path(found.path).parent, dict(chosen.package), search_path(os.environ))
    for key, uri in files_named(robot):
        if source.files.find(uri) is None and everywhere.find(uri) is not None:
            message = f"{key} refers to '{uri}', outside '{chosen.confine}', to which reading is confined"
            raise refuse(codes.CANNOT_READ, message, robot.origin(key))
    return found


def lenient_argument(parser: argparse.ArgumentParser) -> None:
    """The option of every verb that an error ends."""
    parser.add_argument("--lenient", action="store_true", help="go on where the input has errors, with what each error says")


def shape_arguments(parser: argparse.ArgumentParser) -> None:
    """Options for bodies without inertia, and for meshes that collide."""
    inertia_arguments(parser)
    convex = "replace concave meshes that collide by their convex hulls, or by convex parts (CoACD)"
    parser.add_argument("--collision", choices=("hull", "decompose"), help=convex)


def inertia_arguments(parser: argparse.ArgumentParser) -> None:
    """Options for bodies without inertia."""
    given = "give bodies without inertia that of their shapes (default 1000 where --inertia-from is given)"
    parser.add_argument("--density", type=_density, metavar="KG_PER_M3", help=given)
    parser.add_argument("--inertia-from", choices=("collision", "visual", "hull"), help="of which shapes (default collision)")


def _density(text: str) -> float:
    try:
        density = float(text)
    except ValueError:
        density = 0.0
    if not 0.0 < density < float("inf"):
        raise argparse.ArgumentTypeError(f"expected a positive number of kg/m^3, found '{text}'")
    return density


def read_input(path: str, chosen: argparse.Namespace, report: Report, target: Format | None = None, *, anyway: bool = False) -> Input:
    """Read a file, or standard input for `-`; for a conversion, into the target. ``anyway``: whatever errors it has.

    Raises: Refusal when it cannot be read; Stopped when it has errors, without `--lenient`.
    """
    from hymeko_x import pipeline

    source = _standard_input(chosen) if path == "-" else source_of(path, chosen)
    format = formats.by_name(chosen.from_format) if chosen.from_format else formats.of_input(source.name, source.data)
    if (chosen.arg or chosen.env) and not format.has_arguments:
        option = "--arg" if chosen.arg else "--env"
        raise UsageError(f"{option} is for formats that take arguments, and {source.name} is {format.name}")
    if chosen.variant and not format.has_variants:
        raise UsageError(f"--variant is for formats that have variants, and {source.name} is {format.name}")
    values = {"variants": dict(chosen.variant), "arguments": {**source.arguments, **dict(chosen.arg)}, "environment": dict(chosen.env)}
    source = replace(source, **values, ignores_kept=chosen.ignore_kept)
    if anyway:
        return Input(pipeline.read_anyway(source, format, report), format, source)
    if target is None:
        return Input(pipeline.read(source, format, report, lenient=chosen.lenient), format, source)
    mechanism, passed = pipeline.read_for(target, source, format, report, lenient=chosen.lenient)
    return Input(mechanism, format, source, passed)


def source_of(path: str, chosen: argparse.Namespace) -> Source:
    """A file, or the robot of this name, with the files around it. Raises: Refusal when it cannot be read."""
    from hymeko_x import disk

    found = located(path)
    source = disk.open_source(found.path, packages=dict(chosen.package), search_path=search_path(os.environ), confine=chosen.confine)
    return replace(source, arguments=found.arguments) if found.arguments else source


def _standard_input(chosen: argparse.Namespace) -> Source:
    from hymeko_x import disk

    files = DiskFiles(Path(), dict(chosen.package), search_path(os.environ), chosen.confine)
    return Source("<stdin>", sys.stdin.buffer.read(disk.MOST_BYTES), files)


def _package(text: str) -> tuple[str, Path]:
    name, equals, place = text.partition("=")
    if not (equals and place):
        raise argparse.ArgumentTypeError(f"expected NAME=DIR, found '{text}'")
    return name, folder(place)


def folder(text: str) -> Path:
    """An argument that is a folder. Raises: ArgumentTypeError when there is none of this name."""
    if not Path(text).is_dir():
        raise argparse.ArgumentTypeError(f"there is no folder '{text}'")
    return Path(text)


def _argument(text: str) -> tuple[str, str]:
    name, sign, value = text.partition("=")
    name = name.removesuffix(":")
    if not (name and sign):
        raise argparse.ArgumentTypeError(f"expected NAME=VALUE, found '{text}'")
    return name, value


def _variant(text: str) -> tuple[str, str]:
    name, equals, variant = text.partition("=")
    if not (name and equals):
        raise argparse.ArgumentTypeError(f"expected SET=NAME, found '{text}'")
    return name, variant


def _variable(text: str) -> tuple[str, str]:
    name, sign, value = text.partition("=")
    if sign:
        return name, value
    if name not in os.environ:
        raise argparse.ArgumentTypeError(f"the environment has no variable '{text}'")
    return name, os.environ[name]
