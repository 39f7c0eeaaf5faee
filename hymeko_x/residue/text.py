"""A residue as HyMeKo text, and back: the part of a mechanism that a file of another format carries but cannot represent.

Elements that differ in the same way stand together (``of [a b c]``). ``field <mark> value`` means that the file's own text has
a value with this digest; without a mark the file has no value there.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any, TypeVar, get_args

from hymeko_x.compare.leaves import TURN
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import KINDS, WORLD, Extra, Id
from hymeko_x.ir.parts import EdgePart, Weight
from hymeko_x.ir.types import fits, is_sound
from hymeko_x.ir.values import Pose
from hymeko_x.language.printer import TextBlock, print_block, print_field, print_item, print_name
from hymeko_x.language.syntax import ArcItem, Field, Node, Ref
from hymeko_x.language.values import decoded, decoded_turn, encoded, encoded_turn, given_fields, name_ref
from hymeko_x.residue import Addition, Alignment, Change, Fold, Join, Removal, Residue, Run, Sides

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from hymeko_x.compare.leaves import Path
    from hymeko_x.ir.mechanism import RobotArc, RobotEdge
    from hymeko_x.language.syntax import Document, Item, Value

VERSION = 1.0
_EDGES = frozenset(kind for part, kind in KINDS.items() if part in get_args(EdgePart))
_SIGNS = {1: "+", -1: "-", 0: "~"}
_SIGN_OF = {text: sign for sign, text in _SIGNS.items()}
_CLASSES = {kind: part for part, kind in KINDS.items()}

_NO_GROUP = "alone"

T = TypeVar("T")


class BadResidue(Exception):
    """A text that is no residue, or one of a newer version."""


def print_residue(residue: Residue) -> str:
    """The text of a residue."""
    sections: tuple[tuple[str, Iterable[str | TextBlock]], ...] = (
        ("names", _by_kind((new.kind, old.name, new.name) for old, new in residue.alignment.names)),
        ("folds", map(_fold, residue.alignment.folds)),
        ("joins", [print_field(join.shape.name, name_ref(join.twin.name)) for join in residue.alignment.joins]),
        ("frames", [print_field(key.name, (*pose.xyz, *pose.quat)) for key, pose in residue.alignment.frames]),
        ("changes", _grouped((change.element, _change(change)) for change in residue.changes)),
        ("additions", map(_addition, residue.additions)),
        ("removals", _by_kind((*key, guard, group or _NO_GROUP) for key, guard, group in residue.removals)),
        *_side_sections(residue.sides),
        ("order", map(_moved, residue.order)),
        ("known", _by_kind((*key, mark) for key, mark in residue.known)),
    )
    items: list[str | TextBlock] = [print_field("version", VERSION)]
    items += ["plain"] if residue.sides.is_plain else []
    items += [TextBlock(name, found) for name, content in sections if (found := tuple(content))]
    if residue.layout is not None:
        items += [_id_list("layout", residue.layout), _id_list("unplaced", residue.unplaced)]
    return print_block(TextBlock("carried : residue", tuple(items)))


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
        read.alignment(),
        tuple(Change(key, _path(key, item.name), _changed(item), item.type) for key, item in read.grouped("changes")),
        tuple(_added(item) for item in read.nodes("additions")),
        tuple(Removal(Id(kind, key), mark, "" if group == _NO_GROUP else group) for kind, key, mark, group in read.rows("removals", 3)),
        read.sides("plain" in fields),
        tuple(_run(item) for item in read.fields("order")),
        tuple(decoded(fields["layout"])) if "layout" in fields else None,
        tuple(decoded(fields.get("unplaced", ()))),
        tuple((Id(kind, key), mark) for kind, key, mark in read.rows("known", 2)),
    )
    _check(residue)
    return residue


def _check(residue: Residue) -> None:
    """Raise TypeError for side tables with values of other types; parts are checked as they are read."""
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

    def fields(self, name: str) -> list[Field]:
        return _only(Field, self._sections.get(name, ()))

    def nodes(self, name: str) -> list[Node]:
        return _only(Node, self._sections.get(name, ()))

    def grouped(self, name: str) -> Iterator[tuple[Id, Field]]:
        """Each field of each element of each group."""
        for node in self.nodes(name):
            names, *rest = _only(Field, node.items)
            yield from ((Id(str(node.name), element), item) for element in _refs(names.value) for item in rest)

    def rows(self, name: str, width: int) -> Iterator[tuple[str, ...]]:
        """The kind and the names of each row of :func:`_by_kind`, with so many names."""
        for item in self.fields(name):
            names = iter(_refs(item.value))
            yield from ((str(item.name), *row) for row in zip(*[names] * width, strict=True))

    def alignment(self) -> Alignment:
        names = [_renamed(*row) for row in self.rows("names", 2)]
        frames = [(Id("body", item.name), _pose(decoded(item.value))) for item in self.fields("frames")]
        joins = [Join(Id("shape", item.name), Id("shape", _refs((item.value,))[0])) for item in self.fields("joins")]
        return Alignment(tuple(names), tuple(map(_folded, self.nodes("folds"))), tuple(joins), tuple(frames))

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


def _grouped(entries: Iterable[tuple[Id, str]]) -> Iterator[TextBlock]:
    """The fields of each element; elements of one kind with the same fields share them."""
    fields: dict[Id, list[str]] = defaultdict(list)
    for key, item in entries:
        fields[key].append(item)
    groups: dict[tuple[str, ...], list[str]] = defaultdict(list)
    for key, found in fields.items():
        groups[key.kind, *found].append(key.name)
    for (kind, *alike), names in groups.items():
        yield TextBlock(print_name(kind), (_list("of", names), *alike))


def _by_kind(rows: Iterable[tuple[str, ...]]) -> list[str]:
    """A field with names for each kind, from rows of a kind and names."""
    kinds: dict[str, list[str]] = defaultdict(list)
    for kind, *names in rows:
        kinds[kind] += names
    return [_list(kind, names) for kind, names in kinds.items()]


def _only(kind: type[T], items: Iterable[object]) -> list[T]:
    found = [item for item in items if isinstance(item, kind)]
    if len(found) != len(tuple(items)):
        raise TypeError(f"a section holds something else than {kind.__name__}s")
    return found


def _refs(value: object) -> list[str]:
    if not isinstance(value, tuple):
        raise ValueError(f"{value!r} is no list of names")
    names: list[str] = []
    for item in value:
        if not isinstance(item, Ref) or len(item.path) != 1:
            raise ValueError(f"{item!r} is no name")
        names.append(str(item.path[0]))
    return names


# ---- the alignment ----------------------------------------------------------------------------------------------------------


def _renamed(kind: str, old: str, new: str) -> tuple[Id, Id]:
    """The old and the new id: of the same kind, but for a body that stands for the world."""
    if kind == WORLD.kind and new != WORLD.name:
        raise ValueError(f"there is no other world '{new}'")
    return Id("body" if kind == WORLD.kind else kind, old), Id(kind, new)


def _fold(fold: Fold) -> TextBlock:
    chain, between = ([key.name for key in keys] for keys in (fold.chain, fold.between))
    return TextBlock(print_name(fold.joint.name), (_list("chain", chain), _list("between", between)))


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


def _list(name: str, names: Iterable[str]) -> str:
    """A field with a list of names."""
    return f"{print_name(name)} [{' '.join(map(print_name, names))}]"


def _id_list(name: str, ids: Iterable[Id]) -> str:
    """A field with a list of elements, by kind and name."""
    return f"{name} [{' '.join([f'{print_name(kind)}.{print_name(own)}' for kind, own in ids])}]"


def _change(change: Change) -> str:
    turned = change.path[-1] == TURN
    value = encoded_turn(change.value) if turned else encoded(change.value)  # type: ignore[arg-type]
    return print_field(_path_text(change.path), value, change.guard)


def _path_text(path: Path) -> str:
    """A path as it is printed."""
    return ".".join(map(str, path[1:] if path[0] == "data" else path))


def _changed(item: Field) -> object:
    return decoded_turn(item.value) if item.name.endswith(f".{TURN}") else decoded(item.value)


def _path(key: Id, text: str) -> Path:
    path: Path = tuple(int(step) if step.isdecimal() else step for step in text.split("."))
    return path if key.kind not in _EDGES or path[0] == "arcs" else ("data", *path)


# ---- elements --------------------------------------------------------------------------------------------------------------


def _addition(addition: Addition) -> TextBlock:
    """An element as a node: its part's fields, and an edge's arcs behind them."""
    key, part = addition
    data = part.data if isinstance(part, Edge) else part
    items = [print_field(name, value) for name, value in given_fields(data)]
    if isinstance(part, Edge):
        items += map(_arc_text, part.arcs)
    return TextBlock(f"{print_name(key.name)} : {print_name(key.kind)}", tuple(items))


def _arc_text(arc: RobotArc) -> str:
    weight = None if arc.weight is None else encoded(arc.weight)
    assert weight is None or isinstance(weight, tuple)
    return print_item(ArcItem(Ref(arc.target, _SIGNS[arc.sign]), arc.role, weight))


def _added(node: Node) -> Addition:
    key = Id(str(node.stereotypes[0].ref.path[0]), str(node.name))
    words: list[Value] = [name_ref(_CLASSES[key.kind].__name__)]
    for item in node.items:
        if isinstance(item, Field):
            assert item.value is not None
            words += [name_ref(item.name), item.value]
    data: Any = decoded(tuple(words))
    if key.kind not in _EDGES:
        return Addition(key, data)
    arcs = tuple(_arc(item) for item in node.items if isinstance(item, ArcItem))
    edge: RobotEdge = Edge(data, arcs)
    if not is_sound(edge):
        raise ValueError(f"no {key.kind}: {node.name}")
    return Addition(key, edge)


def _arc(item: ArcItem) -> RobotArc:
    kind, name = map(str, item.ref.path)
    sign = _SIGN_OF.get(item.ref.direction)
    if sign is None:
        raise ValueError(f"no direction of an arc: {item.ref.direction}")
    weight: Weight | None = None if item.weight is None else decoded(item.weight)
    return Arc(Id(kind, name), sign, weight, str(item.role))


def _moved(run: Run) -> str:
    after = "0" if run.after is None else print_name(run.after.name)
    return f"{print_name(run.elements[0].kind)} [{after} {' '.join([print_name(key.name) for key in run.elements])}]"


def _run(item: Field) -> Run:
    assert isinstance(item.value, tuple)
    after, *names = item.value
    if not names:
        raise ValueError(f"an order of no {item.name}")
    first = None if isinstance(after, float) else Id(item.name, _refs((after,))[0])
    return Run(first, tuple(Id(item.name, name) for name in _refs(tuple(names))))


# ---- side tables -------------------------------------------------------------------------------------------------------------


def _side_sections(sides: Sides) -> tuple[tuple[str, Iterable[str | TextBlock]], ...]:
    return (
        ("notations", _grouped((key, print_field(name, encoded(text))) for key, name, text in sides.notations)),
        ("forgotten", map(print_name, sides.forgotten)),
        ("stereotypes", _grouped((key, print_field("classes", encoded(names))) for key, names in sides.stereotypes)),
        ("extras", _grouped((key, _extra(extra)) for key, extra in sides.extras)),
        ("strangers", _grouped((key, _list("gone", (mark,))) for key, mark in sides.foreign_extras)),
    )


def _extra(extra: Extra) -> str:
    values = (extra.path, extra.text)
    return print_field(extra.format, (*values, float(extra.index)) if extra.index else values)


def _read_extra(item: Field) -> Extra:
    path, text, *index = decoded(item.value)
    return Extra(str(item.name), path, text, int(index[0]) if index else 0)
