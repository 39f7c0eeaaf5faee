"""The text of a residue read again, and checked: it may be damaged, or made up."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar, get_args

from msgspec import NODEFAULT

from hymeko_x.compare.leaves import TURN
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.ids import KINDS
from hymeko_x.ir.mechanism import WORLD, WORLD_LINK, Extra, Id
from hymeko_x.ir.parts import EdgePart
from hymeko_x.ir.provenance import Provenance
from hymeko_x.ir.types import fits, is_sound
from hymeko_x.ir.values import Pose
from hymeko_x.language.syntax import ArcItem, Field, Node
from hymeko_x.language.values import decoded, decoded_turn, name_of, name_ref
from hymeko_x.residue import Alignment, Change, Fold, Join, Landmark, Residue, Run, Sides, WholeElement
from hymeko_x.residue.prefix import with_prefix
from hymeko_x.residue.text import FILE, SIGNS, SOURCE, VERSION

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from hymeko_x.compare.leaves import Path
    from hymeko_x.ir.mechanism import RobotArc, RobotEdge
    from hymeko_x.ir.parts import Weight
    from hymeko_x.language.syntax import Item, Value

_EDGES = frozenset(kind for part, kind in KINDS.items() if part in get_args(EdgePart))
_SIGN_OF = {text: sign for sign, text in SIGNS.items()}
_CLASSES = {kind: part for part, kind in KINDS.items()}

T = TypeVar("T")


class BadResidue(Exception):
    """A text that is no residue, or one of another version."""


def parse_residues(text: str) -> list[Residue]:
    """The residues in a text: one, or several where robots were joined.

    Raises: BadResidue; Refusal when the text is not even HyMeKo.
    """
    from hymeko_x.language.parser import parse

    document = parse(text, "<residue>")
    try:
        return [_residue(root) for root in _only(Node, document.items)]
    except (ValueError, LookupError, TypeError, AttributeError, AssertionError, ArithmeticError) as error:
        raise BadResidue(f"{type(error).__name__}: {error}") from error


def _residue(root: Node) -> Residue:
    fields = {item.name: item.value for item in root.items if isinstance(item, Field)}
    if fields["version"] != VERSION:
        raise BadResidue(f"version {fields['version']}, and this program reads version {VERSION:g}")
    read = _Sections({item.name: item.items for item in root.items if isinstance(item, Node)})
    source = fields.get("source", ())
    residue = Residue(
        Provenance() if not source else _provenance(*decoded(source)),
        read.alignment(),
        tuple(_change(key, item) for key, item in read.grouped("values")),
        tuple(map(_element, read.nodes("source_only"))),
        tuple(map(_element, read.nodes("file_only"))),
        tuple(map(_element, read.nodes("weighs"))),
        read.sides("plain" in fields),
        tuple(_run(kind, item) for kind, item in read.of_kinds("order")),
        tuple(decoded(fields["layout"])) if "layout" in fields else None,
        tuple(decoded(fields.get("unplaced", ()))),
        tuple(_landmark(kind, item) for kind, item in read.of_kinds("landmarks")),
    )
    _check(residue)
    prefix = fields.get("prefix", "")
    return residue if not isinstance(prefix, str) or not prefix else with_prefix(residue, prefix)


def _check(residue: Residue) -> None:
    """Raise TypeError for side tables with values of other types; parts are checked as they are read."""
    sides = residue.sides
    for name, value, hint in (
        ("notations", sides.notations, tuple[tuple[Id, str, str | None], ...]),
        ("stereotypes", sides.stereotypes, tuple[tuple[Id, tuple[str, ...]], ...]),
        ("extras", (*sides.extras, *sides.foreign_extras), tuple[tuple[Id, Extra], ...]),
        ("layout", (*(residue.layout or ()), *residue.unplaced), tuple[Id, ...]),
        ("landmarks", tuple((mark.element, mark.beside, mark.numbers) for mark in residue.landmarks), _LANDMARKS),
    ):
        if not fits(value, hint):
            raise TypeError(f"{name} holds something else")


_LANDMARKS = tuple[tuple[Id, tuple[Id, ...], tuple[float, ...]], ...]


class _Sections:
    """The parts of a residue's text, each by its name."""

    def __init__(self, sections: Mapping[str, tuple[Item, ...]]) -> None:
        self._sections = sections

    def fields(self, name: str) -> list[Field]:
        return _only(Field, self._sections.get(name, ()))

    def nodes(self, name: str) -> list[Node]:
        return _only(Node, self._sections.get(name, ()))

    def grouped(self, name: str) -> Iterator[tuple[Id, Field]]:
        """Each field of each element of each group."""
        for node in self.nodes(name):
            names, *rest = _only(Field, node.items)
            yield from ((Id(str(node.name), element), item) for element in _names(names.value) for item in rest)

    def of_kinds(self, name: str) -> Iterator[tuple[str, Field]]:
        """Each field of each kind."""
        for node in self.nodes(name):
            yield from ((str(node.name), item) for item in _only(Field, node.items))

    def alignment(self) -> Alignment:
        names = [_renamed(kind, str(item.name), name_of(item.value)) for kind, item in self.of_kinds("names")]
        frames = [(Id("body", item.name), _pose(decoded(item.value))) for item in self.fields("frames")]
        joins = [Join(Id("shape", item.name), Id("shape", name_of(item.value))) for item in self.fields("twins")]
        return Alignment(tuple(names), tuple(map(_folded, self.nodes("chains"))), tuple(joins), tuple(frames))

    def sides(self, is_plain: bool) -> Sides:
        return Sides(
            tuple((key, item.name, decoded(item.value)) for key, item in self.grouped("notations")),
            tuple(item.name for item in self.fields("file_notations")),
            tuple((key, decoded(item.value)) for key, item in self.grouped("stereotypes")),
            is_plain,
            tuple((key, _extra(item)) for key, item in self.grouped("extras")),
            tuple((key, _extra(item)) for key, item in self.grouped("file_extras")),
        )


def _only(kind: type[T], items: Iterable[object]) -> list[T]:
    found = [item for item in items if isinstance(item, kind)]
    if len(found) != len(tuple(items)):
        raise TypeError(f"a section holds something else than {kind.__name__}s")
    return found


def _names(value: object) -> list[str]:
    if not isinstance(value, tuple):
        raise ValueError(f"{value!r} is no list of names")
    return [name_of(item) for item in value]


# ---- entries -------------------------------------------------------------------------------------------------------------


def _provenance(file: object, format: object, version: object = "") -> Provenance:
    if not (isinstance(file, str) and isinstance(format, str) and isinstance(version, str)):
        raise ValueError("the source is a file, its format and that format's version")
    return Provenance(format, version, file)


def _renamed(kind: str, old: str, new: str) -> tuple[Id, Id]:
    """The old and the new id: of the same kind, but for the world and a body that represents it."""
    if kind == WORLD.kind and new != WORLD.name:
        raise ValueError(f"there is no other world '{new}'")
    if Id(kind, old) == Id(kind, new) == WORLD_LINK:
        return WORLD, WORLD_LINK
    return Id("body" if kind == WORLD.kind else kind, old), Id(kind, new)


def _folded(node: Node) -> Fold:
    found = {item.name: _names(item.value) for item in node.items if isinstance(item, Field)}
    chain, between = (tuple(Id(kind, name) for name in found[part]) for kind, part in (("joint", "joints"), ("body", "between")))
    return Fold(Id("joint", node.name), chain, between)


def _pose(numbers: tuple[float, ...]) -> Pose:
    x, y, z, *quat = numbers
    a, b, c, d = quat
    found = Pose((x, y, z), (a, b, c, d))
    if not is_sound(found):
        raise ValueError(f"{numbers!r} is no pose")
    return found


def _change(key: Id, item: Field) -> Change:
    value, there = _two_values(item.value)
    turned = item.name.endswith(f".{TURN}")
    found = decoded_turn(value) if turned else decoded(value)
    return Change(key, _path(key, item.name), found, NODEFAULT if there is None else decoded(there))


def _two_values(value: Value | None) -> tuple[Value | None, Value | None]:
    """The source's value, and the file's own where it stands there."""
    if isinstance(value, tuple) and len(value) == 4 and value[0] == SOURCE and value[2] == FILE:
        return value[1], value[3]
    return value, None


def _path(key: Id, text: str) -> Path:
    path: Path = tuple(int(step) if step.isdecimal() else step for step in text.split("."))
    return path if key.kind not in _EDGES or path[0] == "arcs" else ("data", *path)


def _element(node: Node) -> WholeElement:
    key = Id(str(node.stereotypes[0].ref.path[0]), str(node.name))
    words: list[Value] = [name_ref(_CLASSES[key.kind].__name__)]
    for item in node.items:
        if isinstance(item, Field):
            assert item.value is not None
            words += [name_ref(item.name), item.value]
    data: Any = decoded(tuple(words))
    if key.kind not in _EDGES:
        return WholeElement(key, data)
    arcs = tuple(_arc(item) for item in node.items if isinstance(item, ArcItem))
    edge: RobotEdge = Edge(data, arcs)
    if not is_sound(edge):
        raise ValueError(f"no {key.kind}: {node.name}")
    return WholeElement(key, edge)


def _arc(item: ArcItem) -> RobotArc:
    kind, name = map(str, item.ref.path)
    sign = _SIGN_OF.get(item.ref.direction)
    if sign is None:
        raise ValueError(f"no direction of an arc: {item.ref.direction}")
    weight: Weight | None = None if item.weight is None else decoded(item.weight)
    return Arc(Id(kind, name), sign, weight, str(item.role))


def _run(kind: str, item: Field) -> Run:
    is_head = isinstance(item.value, tuple) and item.value[:1] == (0.0,)
    names = _names(item.value[1:] if is_head and isinstance(item.value, tuple) else item.value)
    if not names:
        raise ValueError(f"an order of no {kind}")
    return Run(None if is_head else Id(kind, item.name), tuple(Id(kind, name) for name in names))


def _landmark(kind: str, item: Field) -> Landmark:
    found = decoded(item.value)
    beside = tuple(value for value in found if isinstance(value, Id))
    return Landmark(Id(kind, item.name), beside, tuple(value for value in found if not isinstance(value, Id)))


def _extra(item: Field) -> Extra:
    path, text, *index = decoded(item.value)
    return Extra(str(item.name), path, text, int(index[0]) if index else 0)
