"""A residue as HyMeKo text: the part of a mechanism that a file of another format cannot represent, for people to read and to review.

Elements that differ in the same way stand together (``of [a b c]``). A field has the source's value, or ``[source X file Y]`` where the
file's own value is another one than the field's default.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from msgspec import NODEFAULT
from msgspec.structs import replace

from hymeko_x.compare.leaves import TURN
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.values import Pose
from hymeko_x.language.printer import TextBlock, print_block, print_field, print_item, print_name
from hymeko_x.language.syntax import ArcItem, Comment, Ref
from hymeko_x.language.values import encoded, encoded_turn, given_fields, name_ref
from hymeko_x.residue import WholeElement

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from hymeko_x.compare.leaves import Path
    from hymeko_x.ir.mechanism import Extra, Id, RobotArc
    from hymeko_x.language.syntax import Value
    from hymeko_x.residue import Change, Fold, Landmark, Residue, Run, Sides

    Items = Iterable[str | TextBlock]

VERSION = 2.0
SOURCE, FILE = name_ref("source"), name_ref("file")
"""The words before the source's value and before the file's own."""
SIGNS = {1: "+", -1: "-", 0: "~"}

_ABOUT = """What the format of this file cannot represent of the robot that it was made from.
Reading the file adds it, wherever the file still has what stands here as its own; an edit of the file wins."""
_TITLES = {
    "names": "names in the file, and in the source",
    "chains": "a joint of the source, the joints of the file that it is, and the bodies between them",
    "twins": "a shape of the source that the file has twice, to be seen and to be touched",
    "frames": "the frame of a body in the source as it is in that of the file: position in m, quaternion",
    "values": "values of the source; where the file has another one than none or zero, that as well",
    "source_only": "what the file lacks",
    "file_only": "what only the file has; it stands for something above",
    "weighs": "shapes as they are in the file, from which the source's masses follow",
    "notations": "how the source's author wrote it",
    "file_notations": "notations that only the file has",
    "stereotypes": "the classes and macros that the source's elements were made from",
    "extras": "what only the source's format understands",
    "file_extras": "what only the file's format understands",
    "order": "elements that stand behind another one in the source, or at the head of all (0)",
    "landmarks": "how renamed elements are found: what they are on or with, and mass (kg) and position (m), axis, or colour",
}
"""The sections in their order, each with a line for the reader."""


def print_residue(residue: Residue) -> str:
    """The text of a residue."""
    sections: dict[str, Items] = {
        "names": _names(residue),
        "chains": map(_chain, residue.alignment.folds),
        "twins": [print_field(join.shape.name, name_ref(join.twin.name)) for join in residue.alignment.joins],
        "frames": [print_field(key.name, (*pose.xyz, *pose.quat)) for key, pose in residue.alignment.frames],
        "values": _grouped((change.element, _change(change)) for change in residue.changes),
        "source_only": map(_element, residue.additions),
        "file_only": map(_element_of_file, residue.removals),
        "weighs": map(_element_of_file, residue.weights),
        **_side_sections(residue.sides),
        "order": _by_kind((run.elements[0].kind, _run(run)) for run in residue.order),
        "landmarks": _by_kind((landmark.element.kind, _landmark(landmark)) for landmark in residue.landmarks),
    }
    source = residue.source
    items: list[str | TextBlock | Comment] = [*map(Comment, _ABOUT.splitlines()), print_field("version", VERSION)]
    if any((source.file, source.format)):
        items.append(print_field("source", (source.file, source.format, *((source.version,) if source.version else ()))))
    if residue.sides.is_plain:
        items += [Comment("the source's elements are made from no classes"), "plain"]
    for name, title in _TITLES.items():
        found = tuple(sections[name])
        if found:
            items += [Comment(title), TextBlock(name, found)]
    if residue.layout is not None:
        items += [Comment("the order of all elements in the source's text")]
        items += [_listed("layout", map(_id_text, residue.layout)), _listed("unplaced", map(_id_text, residue.unplaced))]
    return print_block(TextBlock("kept : residue", tuple(items)))


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
        yield TextBlock(print_name(kind), (_listed("of", map(print_name, names)), *alike))


def _by_kind(entries: Iterable[tuple[str, str]]) -> Iterator[TextBlock]:
    """The items of each kind."""
    kinds: dict[str, list[str]] = defaultdict(list)
    for kind, item in entries:
        kinds[kind].append(item)
    for kind, found in kinds.items():
        yield TextBlock(print_name(kind), tuple(found))


def _listed(name: str, texts: Iterable[str]) -> str:
    """A field with a list."""
    return f"{name} [{' '.join(texts)}]"


def _names_of(ids: Iterable[Id]) -> list[str]:
    return [print_name(key.name) for key in ids]


def _id_text(key: Id) -> str:
    return f"{print_name(key.kind)}.{print_name(key.name)}"


# ---- entries -------------------------------------------------------------------------------------------------------------


def _names(residue: Residue) -> Iterator[TextBlock]:
    return _by_kind((new.kind, print_field(old.name, name_ref(new.name))) for old, new in residue.alignment.names)


def _chain(fold: Fold) -> TextBlock:
    return TextBlock(print_name(fold.joint.name), (_listed("joints", _names_of(fold.chain)), _listed("between", _names_of(fold.between))))


def _change(change: Change) -> str:
    turned = change.path[-1] == TURN
    value: Value = encoded_turn(change.value) if turned else encoded(change.value)  # type: ignore[arg-type]
    if change.there is not NODEFAULT:
        value = (SOURCE, value, FILE, encoded(change.there))
    return print_field(_path_text(change.path), value)


def _path_text(path: Path) -> str:
    """A path as it is printed."""
    return ".".join(map(str, path[1:] if path[0] == "data" else path))


def _element(element: WholeElement) -> TextBlock:
    """An element as a node: its part's fields, and an edge's arcs behind them."""
    key, part = element
    data = part.data if isinstance(part, Edge) else part
    items = [print_field(name, value) for name, value in given_fields(data)]
    if isinstance(part, Edge):
        items += map(_arc_text, part.arcs)
    return TextBlock(f"{print_name(key.name)} : {print_name(key.kind)}", tuple(items))


def _element_of_file(element: WholeElement) -> TextBlock:
    """The same without notations, which are of no use for finding it unchanged."""
    part = element.part
    if isinstance(part, Edge):
        arcs = tuple(replace(arc, weight=replace(arc.weight, written=None)) if isinstance(arc.weight, Pose) else arc for arc in part.arcs)
        element = WholeElement(element.id, replace(part, arcs=arcs))
    return _element(element)


def _arc_text(arc: RobotArc) -> str:
    weight = None if arc.weight is None else encoded(arc.weight)
    assert weight is None or isinstance(weight, tuple)
    return print_item(ArcItem(Ref(arc.target, SIGNS[arc.sign]), arc.role, weight))


def _run(run: Run) -> str:
    names = _names_of(run.elements)
    return _listed("head", ["0", *names]) if run.after is None else _listed(print_name(run.after.name), names)


def _landmark(landmark: Landmark) -> str:
    numbers = [numbers_text(landmark.numbers)] if landmark.numbers else []
    return _listed(print_name(landmark.element.name), [*map(_id_text, landmark.beside), *numbers])


# ---- side tables -------------------------------------------------------------------------------------------------------------


def _side_sections(sides: Sides) -> dict[str, Items]:
    return {
        "notations": _grouped((key, print_field(name, encoded(text))) for key, name, text in sides.notations),
        "file_notations": map(print_name, sides.forgotten),
        "stereotypes": _grouped((key, print_field("classes", encoded(names))) for key, names in sides.stereotypes),
        "extras": _grouped((key, _extra(extra)) for key, extra in sides.extras),
        "file_extras": _grouped((key, _extra(extra)) for key, extra in sides.foreign_extras),
    }


def _extra(extra: Extra) -> str:
    values = (extra.path, extra.text)
    return print_field(extra.format, (*values, float(extra.index)) if extra.index else values)
