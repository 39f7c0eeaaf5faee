"""The pipeline: read -> legalize -> write -> read back -> ledger. Values in, values out; the disk is the caller's business."""

from __future__ import annotations

from contextlib import suppress
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal, Protocol

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes, formats
from hymeko_x.assets.pack import pack
from hymeko_x.assets.stored import with_stored_meshes
from hymeko_x.collector import uncollected
from hymeko_x.compare.leaves import leaves_again, leaves_between
from hymeko_x.compare.ledger import losses_between
from hymeko_x.diagnostics import Origin, Refusal, Report, refuse
from hymeko_x.formats.carrier import taken_off
from hymeko_x.ir.parts import Mesh, Texture
from hymeko_x.residue.align import align
from hymeko_x.residue.delta import residue_between
from hymeko_x.residue.realign import alignment_differences
from hymeko_x.residue.text import BadResidue, parse_residue, print_residue
from hymeko_x.rewrite import Options, legalize
from hymeko_x.source import Package, PackageFiles, PlacedFiles, Source

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.compare.ledger import Loss
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.parts import VertexPart
    from hymeko_x.source import Files


class Reader(Protocol):
    """What every frontend has."""

    def __call__(self, source: Source, report: Report) -> Mechanism:
        """The mechanism that the source describes. Raises: Refusal."""
        ...


class Writer(Protocol):
    """What every backend has."""

    def __call__(self, mechanism: Mechanism, options: Options, report: Report) -> Package:
        """The files that describe the mechanism, which must be legal for the format."""
        ...


class Carrier(Protocol):
    """What every backend has whose format cannot say everything."""

    def __call__(self, package: Package, text: str) -> Package:
        """The package with a residue where other readers pass over it."""
        ...


class Place(Struct, frozen=True):
    """Where the output goes: its ``folder``, and whether files go beside it or are referred to (None = the format's own way)."""

    folder: str = "."
    assets: Literal["copy", "reference"] | None = None


HERE = Place()
"""The working folder."""


class Result(Struct, frozen=True):
    """What a conversion made. ``losses`` is None when the target cannot be read back, so that nothing was measured.

    ``bare`` is the main file before anything was put in for it to carry; None when it carries nothing.
    """

    mechanism: Mechanism
    package: Package
    report: Report
    losses: tuple[Loss, ...] | None
    bare: bytes | None = None


@uncollected()
def read(source: Source, format: Format, report: Report) -> Mechanism:
    """The mechanism in a source of this format.

    Raises: Refusal when the input cannot be read at all.
    """
    return restored(reader(format)(source, report), Origin(source.name), report)


def restored(image: Mechanism, origin: Origin, report: Report) -> Mechanism:
    """The mechanism that a file describes together with what it carries of the one that it was made from."""
    image, text = taken_off(image)
    if not text:
        return image
    from hymeko_x.residue.merge import restore

    try:
        residue = parse_residue(text)
    except (BadResidue, Refusal) as error:
        report.warn(codes.RESIDUE_UNREADABLE, f"what the file carries cannot be read, and is left out: {error}", origin)
        return image
    return restore(image, residue, report)


@uncollected()
def write(mechanism: Mechanism, format: Format, options: Options, files: Files, report: Report, place: Place = HERE) -> Package:
    """The mechanism in a format: rewritten into what the format can say, its meshes and textures gathered, then printed.

    Raises: Refusal when the format cannot be written.
    """
    return _written(mechanism, format, options, files, report, place)[0]


@uncollected()
def convert(mechanism: Mechanism, format: Format, options: Options, files: Files, report: Report, place: Place = HERE) -> Result:
    """Write a mechanism, read the result back if the format has a reader, measure what got lost, and let the file carry that.

    With the option ``pure`` it carries nothing.

    Raises: Refusal when the format cannot be written; HX901 when our own reader refuses what we wrote.
    """
    package, packed = _written(mechanism, format, options, files, report, place)
    if format.frontend is None:
        return Result(mechanism, package, report, None)
    image = read_back(package, format, files)
    alignment, aligned = align(image, mechanism)
    moved = with_references_of(packed, mechanism)
    leaves = leaves_between(moved, aligned)
    carry = None if options.pure else carrier_of(format)
    losses = losses_between(moved, aligned, alignment_differences(alignment), format, leaves, is_carried=carry is not None)
    if carry is None:
        return Result(mechanism, package, report, losses)
    source = _standing_in(moved, packed) if options.within else mechanism
    residue = residue_between(source, image, alignment, aligned, leaves_again(source, moved, aligned, leaves))
    bare = package.main
    if not residue.is_empty:
        package = carry(package, print_residue(residue))
    return Result(mechanism, package, report, losses, bare)


def write_unmeasured(mechanism: Mechanism, format: Format, options: Options, files: Files, report: Report, place: Place = HERE) -> Result:
    """The same without reading back: for a format that holds every mechanism exactly, where time counts.

    Raises: Refusal when the format cannot be written.
    """
    return Result(mechanism, write(mechanism, format, options, files, report, place), report, None)


def _written(
    mechanism: Mechanism, format: Format, options: Options, files: Files, report: Report, place: Place
) -> tuple[Package, Mechanism]:
    """The package, and the mechanism as it was printed."""
    backend = writer(format)
    files = PlacedFiles(mechanism.places, files) if mechanism.places else files
    mechanism = _explicit(with_stored_meshes(mechanism, format, files, report), format, files, report)
    legal = legalize(mechanism, format.name, options, report)
    packed, new, copies = pack(legal, format, files, place.assets, report, out_dir=place.folder, within=options.within)
    package = backend(packed, options, report)
    enclose = _offered(format, "enclose")
    if enclose is not None and (new or copies):
        return enclose(package, {**new, **dict(_contents(copies, files))}), packed
    return replace(package, files={**package.files, **new}, copies={**package.copies, **copies}), packed


def _contents(copies: Mapping[str, str], files: Files) -> Iterator[tuple[str, bytes]]:
    """The files to copy that are still there."""
    for name, path in copies.items():
        with suppress(OSError):
            yield name, files.read(path)


def _explicit(mechanism: Mechanism, format: Format, files: Files, report: Report) -> Mechanism:
    """The mechanism with what only the engine of the format that it came from computes, where that goes to another format."""
    native = formats.native_format(mechanism)
    if native is None or native.completes is None or native is format or format.is_exact:
        return mechanism

    def printed() -> tuple[Mechanism, bytes]:
        legal = legalize(mechanism, native.name, Options(), Report())
        return legal, writer(native)(legal, Options(), Report()).main

    completed: Mechanism = formats.loaded(native.completes)(mechanism, printed, files, report)
    return completed


def read_back(package: Package, format: Format, files: Files) -> Mechanism:
    """What the format's own frontend sees in a package that was just written.

    Raises: Refusal HX901 when it sees nothing.
    """
    result = Source(f"<written {format.name}>", package.main, PackageFiles(package, files))
    try:
        return reader(format)(result, Report())
    except Refusal as error:
        raise refuse(codes.BUG, f"what was written as {format.name} cannot be read back: {error}") from error


def with_references_of(packed: Mechanism, mechanism: Mechanism) -> Mechanism:
    """The mechanism with the packed one's paths of meshes and textures: that a file has moved is no loss."""
    moved: dict[Id, VertexPart] = {}
    for key, part in mechanism.assets():
        other = packed.graph.vertices.get(key)
        if isinstance(other, Mesh | Texture) and other.uri and part.uri != other.uri:
            moved[key] = replace(part, uri=other.uri)
    return mechanism.with_graph(mechanism.graph.replace(vertices=moved)) if moved else mechanism


def _standing_in(moved: Mechanism, packed: Mechanism) -> Mechanism:
    """What a file carries that stands in for another one: nothing that leads back to the files which are being replaced."""
    return replace(moved, extras=packed.extras) if formats.native_format(moved) else moved


def reader(format: Format) -> Reader:
    """The format's frontend, loaded now.

    Raises: Refusal HX003 when the format can only be written.
    """
    if format.frontend is None:
        readable = ", ".join(row.name for row in formats.FORMATS if row.frontend)
        raise refuse(codes.UNKNOWN_FORMAT, f"{format.name} cannot be read", hint=f"readable: {readable}")
    found: Reader = import_module(format.frontend).read
    return found


def writer(format: Format) -> Writer:
    """The format's backend, loaded now.

    Raises: Refusal HX003 when the format can only be read.
    """
    if format.backend is None:
        writable = ", ".join(row.name for row in formats.FORMATS if row.backend)
        raise refuse(codes.UNKNOWN_FORMAT, f"{format.name} cannot be written", hint=f"writable: {writable}")
    found: Writer = import_module(format.backend).write
    return found


def carrier_of(format: Format) -> Carrier | None:
    """How the format's files carry a residue; None for a format that says everything itself."""
    found: Carrier | None = _offered(format, "carry_residue")
    return found


def _offered(format: Format, name: str) -> Any:
    """A function that only some backends have; None where the format's has none."""
    return getattr(import_module(format.backend), name, None) if format.backend else None
