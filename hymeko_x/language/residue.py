"""A residue as HyMeKo text, and back: what a file of another format carries of the robot that it cannot say itself.

Elements that differ in the same way stand together (``of [a b c]``). ``field <mark> value`` says that the file's own text means
a value with this digest; without a mark the file says nothing there.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar, get_args

from hymeko_x.ir.fields import identical
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import KINDS, WORLD, Extra, Id
from hymeko_x.ir.parts import EdgePart, Weight
from hymeko_x.ir.residue import Addition, Bridge, Change, Fold, Join, Removal, Residue, Run, Sides
from hymeko_x.ir.residue.paths import TURN
from hymeko_x.ir.residue.types import fits, is_sound
from hymeko_x.ir.values import Pose
from hymeko_x.language.printer import print_document
from hymeko_x.language.syntax import ArcItem, Document, Field, Node, Ref, Stereotype
from hymeko_x.language.values import decoded, decoded_turn, encoded, encoded_turn, id_ref, name_ref, said

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from hymeko_x.ir.mechanism import RobotArc, RobotEdge
    from hymeko_x.ir.parts import VertexPart
    from hymeko_x.ir.residue import Path
    from hymeko_x.language.syntax import Item, Value

VERSION = 1.0
_EDGES = frozenset(kind for part, kind in KINDS.items() if part in get_args(EdgePart))
_SIGNS = {1: "+", -1: "-", 0: "~"}
_SIGN_OF = {text: sign for sign, text in _SIGNS.items()}
_CLASSES = {kind: part for part, kind in KINDS.items()}

_NO_GROUP = "alone"

T = TypeVar("T")


class _Group(NamedTuple):
    """Elements of a kind that have the same fields."""

    kind: str
    fields: tuple[Field, ...]
    names: list[Value]


class BadResidue(Exception):
    """A text that is no residue, or one of a newer version."""


def print_residue(residue: Residue) -> str:
    """The text of a residue."""
    sections: tuple[tuple[str, Sequence[Item]], ...] = (
        ("names", _names(residue.bridge.names)),
        ("folds", [_fold(fold) for fold in residue.bridge.folds]),
        ("joins", [Field(join.shape.name, name_ref(join.twin.name)) for join in residue.bridge.joins]),
        ("frames", [Field(key.name, (*pose.xyz, *pose.quat)) for key, pose in residue.bridge.frames]),
        ("changes", _grouped((change.element, _change(change)) for change in residue.changes)),
        ("additions", [_addition(addition) for addition in residue.additions]),
        ("removals", _removals(residue.removals)),
        *_side_sections(residue.sides),
        ("order", [Field(run.elements[0].kind, (_after(run), *(name_ref(key.name) for key in run.elements))) for run in residue.order]),
        ("known", _marks(residue.known)),
    )
    items: list[Item] = [Field("version", VERSION)]
    items += [Field("plain")] if residue.sides.is_plain else []
    items += [Node(name, tuple(content)) for name, content in sections if content]
    if residue.layout is not None:
        items += [Field("layout", tuple(map(id_ref, residue.layout))), Field("unplaced", tuple(map(id_ref, residue.unplaced)))]
    return print_document(Document((Node("carried", tuple(items), (Stereotype(Ref(("residue",))),)),)))


def parse_residue(text: str) -> Residue:
    """The residue in a text.

    Raises: BadResidue; Refusal when the text is not even HyMeKo.
    """
    from hymeko_x.language.parser import parse

    document = parse(text, "<residue>")
    try:
        return _residue(document)
    except (ValueError, LookupError, TypeError, AttributeError, AssertionError, ArithmeticError) as error:
        raise BadResidue(f"{type(error).__name__}: {error}") from error


def _residue(document: Document) -> Residue:
    (root,) = (item for item in document.items if isinstance(item, Node))
    fields = {item.name: item.value for item in root.items if isinstance(item, Field)}
    sections: dict[str, tuple[Item, ...]] = {item.name: item.items for item in root.items if isinstance(item, Node)}
    if fields["version"] != VERSION:
        raise BadResidue(f"version {fields['version']}, and this program reads version {VERSION:g}")
    read = _Sections(sections)
    residue = Residue(
        read.bridge(),
        tuple(Change(key, _path(key, item.name), _changed(item), item.type) for key, item in read.grouped("changes")),
        tuple(_added(item) for item in read.nodes("additions")),
        tuple(read.removals()),
        read.sides("plain" in fields),
        tuple(_run(item) for item in read.fields("order")),
        tuple(decoded(fields["layout"])) if "layout" in fields else None,
        tuple(decoded(fields.get("unplaced", ()))),
        tuple(read.marks("known")),
    )
    _check(residue)
    return residue


def _check(residue: Residue) -> None:
    """Whether the side tables hold what they may hold; parts are checked as they are read.

    Raises: TypeError.
    """
    sides = residue.sides
    for name, value, hint in (
        ("notations", sides.notations, tuple[tuple[Id, str, str | None], ...]),
        ("stereotypes", sides.stereotypes, tuple[tuple[Id, tuple[str, ...]], ...]),
        ("extras", sides.extras, tuple[tuple[Id, Extra], ...]),
        ("layout", (*(residue.layout or ()), *residue.unplaced), tuple[Id, ...]),
    ):
        if not fits(value, hint):
            raise TypeError(f"{name} holds something else")


class _Sections:
    """The parts of a residue's text, each by its name."""

    def __init__(self, sections: Mapping[str, tuple[Item, ...]]) -> None:
        self._sections = sections

    def fields(self, name: str) -> Iterator[Field]:
        for item in self._sections.get(name, ()):
            if not isinstance(item, Field):
                raise TypeError(f"{name} holds something else")
            yield item

    def nodes(self, name: str) -> Iterator[Node]:
        for item in self._sections.get(name, ()):
            if not isinstance(item, Node):
                raise TypeError(f"{name} holds something else")
            yield item

    def grouped(self, name: str) -> Iterator[tuple[Id, Field]]:
        """Each field of each element of each group."""
        for node in self.nodes(name):
            names, *rest = node.items
            assert isinstance(names, Field)
            for element in _refs(names.value):
                for item in rest:
                    if not isinstance(item, Field):
                        raise TypeError(f"{name} holds something else")
                    yield Id(str(node.name), element), item

    def marks(self, name: str) -> Iterator[tuple[Id, str]]:
        for item in self.fields(name):
            names = _refs(item.value)
            yield from ((Id(str(item.name), key), mark) for key, mark in zip(names[::2], names[1::2], strict=True))

    def removals(self) -> Iterator[Removal]:
        for item in self.fields("removals"):
            names = _refs(item.value)
            for key, mark, group in zip(names[::3], names[1::3], names[2::3], strict=True):
                yield Removal(Id(str(item.name), key), mark, "" if group == _NO_GROUP else group)

    def bridge(self) -> Bridge:
        names = [_renamed(item.name, old, new) for item in self.fields("names") for old, new in _pairs(_refs(item.value))]
        frames = [(Id("body", item.name), _pose(decoded(item.value))) for item in self.fields("frames")]
        joins = [Join(Id("shape", item.name), Id("shape", _refs((item.value,))[0])) for item in self.fields("joins")]
        return Bridge(tuple(names), tuple(map(_folded, self.nodes("folds"))), tuple(joins), tuple(frames))

    def sides(self, is_plain: bool) -> Sides:
        return Sides(
            tuple((key, item.name, decoded(item.value)) for key, item in self.grouped("notations")),
            tuple(item.name for item in self.fields("forgotten")),
            tuple((key, decoded(item.value)) for key, item in self.grouped("stereotypes")),
            is_plain,
            tuple((key, _read_extra(item)) for key, item in self.grouped("extras")),
            tuple((key, mark) for key, item in self.grouped("strangers") for mark in _refs(item.value)),
        )


# ---- groups --------------------------------------------------------------------------------------------------------------


def _grouped(entries: Iterable[tuple[Id, Field]]) -> list[Item]:
    """The fields of each element; elements of one kind with the same fields share them."""
    fields: dict[Id, list[Field]] = defaultdict(list)
    for key, item in entries:
        fields[key].append(item)
    groups: dict[tuple[str, tuple[Field, ...]], list[_Group]] = defaultdict(list)
    ordered: list[_Group] = []
    for key, found in fields.items():
        said = tuple(found)
        alike = groups[key.kind, said]
        group = next((group for group in alike if identical(group.fields, said)), None)  # numbers of either sign of zero are equal
        if group is None:
            group = _Group(key.kind, said, [])
            alike.append(group)
            ordered.append(group)
        group.names.append(name_ref(key.name))
    return [Node(group.kind, (Field("of", tuple(group.names)), *group.fields)) for group in ordered]


def _marks(entries: Iterable[tuple[Id, str]]) -> list[Item]:
    kinds: dict[str, list[Value]] = defaultdict(list)
    for key, mark in entries:
        kinds[key.kind] += [name_ref(key.name), name_ref(mark)]
    return [Field(kind, tuple(names)) for kind, names in kinds.items()]


def _removals(removals: Iterable[Removal]) -> list[Item]:
    kinds: dict[str, list[Value]] = defaultdict(list)
    for key, guard, group in removals:
        kinds[key.kind] += [name_ref(key.name), name_ref(guard), name_ref(group or _NO_GROUP)]
    return [Field(kind, tuple(names)) for kind, names in kinds.items()]


def _refs(value: object) -> list[str]:
    if not isinstance(value, tuple):
        raise ValueError(f"{value!r} is no list of names")
    names: list[str] = []
    for item in value:
        if not isinstance(item, Ref) or len(item.path) != 1:
            raise ValueError(f"{item!r} is no name")
        names.append(str(item.path[0]))
    return names


def _pairs(items: list[T]) -> Iterator[tuple[T, T]]:
    return zip(items[::2], items[1::2], strict=True)


# ---- the bridge ------------------------------------------------------------------------------------------------------------


def _names(names: Iterable[tuple[Id, Id]]) -> list[Item]:
    kinds: dict[str, list[Value]] = defaultdict(list)
    for old, new in names:
        kinds[new.kind] += [name_ref(old.name), name_ref(new.name)]
    return [Field(kind, tuple(pairs)) for kind, pairs in kinds.items()]


def _renamed(kind: str, old: str, new: str) -> tuple[Id, Id]:
    """What was renamed is of the same kind, but for a body that stands for the world."""
    if kind == WORLD.kind and new != WORLD.name:
        raise ValueError(f"there is no other world '{new}'")
    return Id("body" if kind == WORLD.kind else kind, old), Id(kind, new)


def _fold(fold: Fold) -> Node:
    chain, between = (tuple(name_ref(key.name) for key in keys) for keys in (fold.chain, fold.between))
    return Node(fold.joint.name, (Field("chain", chain), Field("between", between)))


def _folded(node: Node) -> Fold:
    found = {item.name: _refs(item.value) for item in node.items if isinstance(item, Field)}
    return Fold(
        Id("joint", node.name), tuple(Id("joint", name) for name in found["chain"]), tuple(Id("body", name) for name in found["between"])
    )


def _pose(numbers: tuple[float, ...]) -> Pose:
    x, y, z, *quat = numbers
    a, b, c, d = quat
    found = Pose((x, y, z), (a, b, c, d))
    if not is_sound(found):
        raise ValueError(f"{numbers!r} is no pose")
    return found


# ---- fields --------------------------------------------------------------------------------------------------------------


def _change(change: Change) -> Field:
    path = change.path[1:] if change.path[0] == "data" else change.path
    turned = change.path[-1] == TURN
    value = encoded_turn(change.value) if turned else encoded(change.value)  # type: ignore[arg-type]
    return Field(".".join(map(str, path)), value, change.guard)


def _changed(item: Field) -> object:
    return decoded_turn(item.value) if item.name.endswith(f".{TURN}") else decoded(item.value)


def _path(key: Id, text: str) -> Path:
    path: Path = tuple(int(step) if step.isdecimal() else step for step in text.split("."))
    return path if key.kind not in _EDGES or path[0] == "arcs" else ("data", *path)


# ---- elements --------------------------------------------------------------------------------------------------------------


def _addition(addition: Addition) -> Node:
    """An element as a node: its part's fields, and an edge's arcs behind them."""
    key, part = addition
    data = part.data if isinstance(part, Edge) else part
    items: list[Item] = [Field(name, value) for name, value in said(data)]
    if isinstance(part, Edge):
        items += [ArcItem(Ref((arc.target.kind, arc.target.name), _SIGNS[arc.sign]), arc.role, _weight(arc)) for arc in part.arcs]
    return Node(key.name, tuple(items), (Stereotype(Ref((key.kind,))),))


def _weight(arc: RobotArc) -> tuple[Value, ...] | None:
    if arc.weight is None:
        return None
    weight = encoded(arc.weight)
    assert isinstance(weight, tuple)
    return weight


def _added(node: Node) -> Addition:
    key = Id(str(node.stereotypes[0].ref.path[0]), str(node.name))
    words: list[Value] = [name_ref(_CLASSES[key.kind].__name__)]
    for item in node.items:
        if isinstance(item, Field):
            assert item.value is not None
            words += [name_ref(item.name), item.value]
    data: Any = decoded(tuple(words))
    if key.kind not in _EDGES:
        return Addition(key, _vertex(data))
    arcs = tuple(_arc(item) for item in node.items if isinstance(item, ArcItem))
    edge: RobotEdge = Edge(_edge_part(data), arcs)
    if not is_sound(edge):
        raise ValueError(f"no {key.kind}: {node.name}")
    return Addition(key, edge)


def _vertex(data: VertexPart) -> VertexPart:
    return data


def _edge_part(data: EdgePart) -> EdgePart:
    return data


def _arc(item: ArcItem) -> RobotArc:
    kind, name = map(str, item.ref.path)
    sign = _SIGN_OF.get(item.ref.direction)
    if sign is None:
        raise ValueError(f"no direction of an arc: {item.ref.direction}")
    weight: Weight | None = None if item.weight is None else decoded(item.weight)
    return Arc(Id(kind, name), sign, weight, str(item.role))


def _after(run: Run) -> Value:
    return 0.0 if run.after is None else name_ref(run.after.name)


def _run(item: Field) -> Run:
    assert isinstance(item.value, tuple)
    after, *names = item.value
    if not names:
        raise ValueError(f"an order of no {item.name}")
    first = None if isinstance(after, float) else Id(item.name, _refs((after,))[0])
    return Run(first, tuple(Id(item.name, name) for name in _refs(tuple(names))))


# ---- side tables -------------------------------------------------------------------------------------------------------------


def _side_sections(sides: Sides) -> tuple[tuple[str, list[Item]], ...]:
    return (
        ("notations", _grouped((key, Field(name, encoded(text))) for key, name, text in sides.notations)),
        ("forgotten", [Field(name) for name in sides.forgotten]),
        ("stereotypes", _grouped((key, Field("classes", encoded(names))) for key, names in sides.stereotypes)),
        ("extras", _grouped((key, _extra(extra)) for key, extra in sides.extras)),
        ("strangers", _grouped((key, Field("gone", (name_ref(mark),))) for key, mark in sides.strangers)),
    )


def _extra(extra: Extra) -> Field:
    said = (extra.path, extra.text)
    return Field(extra.format, (*said, float(extra.index)) if extra.index else said)


def _read_extra(item: Field) -> Extra:
    path, text, *index = decoded(item.value)
    return Extra(str(item.name), path, text, int(index[0]) if index else 0)
