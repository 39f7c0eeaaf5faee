"""The pipeline: read -> legalize -> write -> read back -> ledger. Values in, values out; the disk is the caller's business."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Protocol

from hymeko_x import codes, formats
from hymeko_x.assets.pack import pack
from hymeko_x.assets.stored import with_stored_meshes
from hymeko_x.collector import uncollected
from hymeko_x.diagnostics import Origin, Refusal, Report, refuse
from hymeko_x.formats.carrier import taken_off
from hymeko_x.formats.usd import POSE
from hymeko_x.ir.diff import Difference, Tolerance, diff
from hymeko_x.ir.leaves import leaves_again, leaves_between
from hymeko_x.ir.legalize import Options, legalize
from hymeko_x.ir.legalize_native import is_native
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.parts import Mesh, Texture
from hymeko_x.ir.residue.align import aligned
from hymeko_x.ir.residue.bridge import other_words
from hymeko_x.ir.residue.delta import residue_behind
from hymeko_x.language.residue import BadResidue, parse_residue, print_residue
from hymeko_x.source import Package, PackageFiles, PlacedFiles, Source

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.formats import Format
    from hymeko_x.ir.leaves import Leaves
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.parts import VertexPart
    from hymeko_x.ir.residue import Bridge
    from hymeko_x.source import Files

LEDGER_TOLERANCE = Tolerance(absolute=1e-12, relative=1e-12)
"""Numbers that differ by less are not a loss: turning degrees into radians and back moves the last digit."""

LONGEST_VALUE = 120
"""How many letters of a value a person is shown; the report has all of them."""


class Reader(Protocol):
    """What every frontend has."""

    def __call__(self, source: Source, report: Report) -> Mechanism:
        """The mechanism that the source describes. Raises: Refusal."""
        ...


class Writer(Protocol):
    """What every backend has."""

    def __call__(self, mechanism: Mechanism, report: Report) -> Package:
        """The files that describe the mechanism, which must be legal for the format."""
        ...


class Carrier(Protocol):
    """What every backend has whose format cannot say everything."""

    def __call__(self, package: Package, text: str) -> Package:
        """The package with a residue where other readers pass over it."""
        ...


@dataclass(frozen=True, slots=True)
class Place:
    """Where the output goes: its ``folder``, and whether files go beside it or are referred to (None = the format's own way)."""

    folder: str = "."
    assets: Literal["copy", "reference"] | None = None


HERE = Place()
"""The working folder."""


class Loss(NamedTuple):
    """One line of the ledger: what is not the same in the result."""

    element: str
    field: str
    before: str | None
    after: str | None
    fate: Literal["carried", "approximated", "dropped"]
    origin: Origin | None = None

    def __str__(self) -> str:
        place = f"{self.origin}: " if self.origin else ""
        what = f"{self.element} {self.field}".rstrip()
        return f"{place}loss: {what} {self.fate}: {self.change}"

    @property
    def change(self) -> str:
        """Before and after in one short line."""
        return f"{_shown(self.before)} -> {_shown(self.after)}"

    def as_json(self) -> dict[str, str | int | None]:
        """The keys of the `--report` contract."""
        return {
            "element": self.element,
            "field": self.field,
            "before": self.before,
            "after": self.after,
            "fate": self.fate,
            "file": self.origin.file if self.origin else None,
            "line": self.origin.line if self.origin else None,
        }


def _shown(value: str | None) -> str:
    """A value in one short line."""
    if value is None:
        return "nothing"
    line = " ".join(value.split())
    return f"{line[:LONGEST_VALUE]}..." if len(line) > LONGEST_VALUE else line or "''"


@dataclass(frozen=True, slots=True)
class Result:
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
    from hymeko_x.ir.residue.merge import restore

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
    bridge, crossed = aligned(image, mechanism)
    moved = with_references_of(packed, mechanism)
    apart = leaves_between(moved, crossed)
    carry = None if options.pure else carrier_of(format)
    losses = ledger(moved, crossed, bridge, format, apart, is_carried=carry is not None)
    if carry is None:
        return Result(mechanism, package, report, losses)
    source = _standing_in(moved, packed) if options.within else mechanism
    residue = residue_behind(source, image, bridge, crossed, leaves_again(source, moved, crossed, apart))
    bare = package.main
    if not residue.is_empty:
        package = carry(package, print_residue(residue))
    return Result(mechanism, package, report, losses, bare)


def within(folder: str, mechanism: Mechanism, format: Format, options: Options, files: Files, place: Place = HERE) -> Package:
    """The package that :func:`convert` makes, with every file beside the main one below this folder, which ends in a slash."""
    return convert(mechanism, format, replace(options, within=folder), files, Report(), place).package


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
    mechanism = _explicit(with_stored_meshes(mechanism, format.name, files, report), format, files, report)
    legal = legalize(mechanism, format.name, options, report)
    packed, new, copies = pack(legal, format.name, files, place.assets, report, out_dir=place.folder)
    package = backend(packed, report)
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
    """What came from MJCF, with what MuJoCo computes from shapes, for formats in which it has to be said."""
    if format in (formats.MJCF, formats.HYMEKO) or not is_native(mechanism):
        return mechanism
    from hymeko_x.frontends.mjcf.weigh import weigh

    def printed() -> tuple[Mechanism, bytes]:
        native = legalize(mechanism, formats.MJCF.name, Options(), Report())
        return native, writer(formats.MJCF)(native, Report()).main

    return weigh(mechanism, printed, files, report)


def read_back(package: Package, format: Format, files: Files) -> Mechanism:
    """What the format's own frontend sees in a package that was just written.

    Raises: Refusal HX901 when it sees nothing.
    """
    result = Source(f"<written {format.name}>", package.main, PackageFiles(package, files))
    try:
        return reader(format)(result, Report())
    except Refusal as error:
        raise refuse(codes.BUG, f"what was written as {format.name} cannot be read back: {error}") from error


def ledger(
    mechanism: Mechanism,
    crossed: Mechanism,
    bridge: Bridge,
    format: Format,
    apart: Mapping[Id, Leaves] | None = None,
    *,
    is_carried: bool = False,
) -> tuple[Loss, ...]:
    """Everything in which what was written and read back differs from the mechanism; what it only says in other words, once.

    ``crossed`` is what was read back, behind the bridge that leads to the mechanism; ``apart`` in what their elements differ, if
    that is known; ``is_carried`` whether the file will carry what got lost.
    """
    found = (*other_words(bridge), *diff(mechanism, crossed, LEDGER_TOLERANCE, apart), *_unsaid_notes(mechanism, crossed))
    return tuple([_loss(difference, mechanism, is_carried) for difference in found if not _is_dress(difference, format)])


def _unsaid_notes(mechanism: Mechanism, image: Mechanism) -> Iterator[Difference]:
    """What only a notation holds, and yet says more than how something was written: where a stage shows its bodies at first."""
    for key, table in mechanism.notations.items():
        if POSE in table and image.notation(key, POSE) != table[POSE]:
            yield Difference(key, "pose on the stage", table[POSE], image.notation(key, POSE))


def _is_dress(difference: Difference, format: Format) -> bool:
    """Whether the format only wears its own clothes: settings of the file that every file of the format has."""
    if difference.element != ROOT:
        return False
    if format == formats.XACRO and difference.field == "urdf @xmlns:xacro":
        return True  # each xacro file declares its own prefix, and no expansion does
    own = "usd" if format.name.startswith("usd") else format.name  # the extras of each kind of USD are USD text
    return difference.before is None and difference.field.startswith(f"{own} ")


def with_references_of(packed: Mechanism, mechanism: Mechanism) -> Mechanism:
    """The mechanism with the packed one's paths of meshes and textures: that a file has moved is no loss."""
    moved: dict[Id, VertexPart] = {}
    for key, part in mechanism.graph.vertices.items():
        other = packed.graph.vertices.get(key)
        if isinstance(part, Mesh | Texture) and isinstance(other, Mesh | Texture) and other.uri and part.uri != other.uri:
            moved[key] = replace(part, uri=other.uri)
    return mechanism.with_graph(mechanism.graph.replace(vertices=moved)) if moved else mechanism


def _standing_in(moved: Mechanism, packed: Mechanism) -> Mechanism:
    """What a file carries that stands in for another one: nothing that leads back to the files which are being replaced."""
    return replace(moved, extras=packed.extras) if is_native(moved) else moved


def _loss(difference: Difference, mechanism: Mechanism, is_carried: bool) -> Loss:
    gone: Literal["approximated", "dropped"] = "dropped" if difference.after is None else "approximated"
    element = "mechanism" if difference.element == ROOT else str(difference.element)
    origin = mechanism.origin(difference.element)
    return Loss(element, difference.field, difference.before, difference.after, "carried" if is_carried else gone, origin)


def reader(format: Format) -> Reader:
    """The format's frontend, loaded now.

    Raises: Refusal HX003 when the format can only be written.
    """
    if format.frontend is None:
        readable = ", ".join(row.name for row in formats.FORMATS if row.frontend)
        raise refuse(codes.UNKNOWN_FORMAT, f"{format.name} cannot be read, only written", hint=f"readable: {readable}")
    found: Reader = import_module(format.frontend).read
    return found


def writer(format: Format) -> Writer:
    """The format's backend, loaded now.

    Raises: Refusal HX003 when the format can only be read.
    """
    if format.backend is None:
        writable = ", ".join(row.name for row in formats.FORMATS if row.backend)
        raise refuse(codes.UNKNOWN_FORMAT, f"{format.name} cannot be written, only read", hint=f"writable: {writable}")
    found: Writer = import_module(format.backend).write
    return found


def carrier_of(format: Format) -> Carrier | None:
    """How the format's files carry a residue; None for a format that says everything itself."""
    found: Carrier | None = _offered(format, "carry_residue")
    return found


def _offered(format: Format, name: str) -> Any:
    """A function that only some backends have; None where the format's has none."""
    return getattr(import_module(format.backend), name, None) if format.backend else None
