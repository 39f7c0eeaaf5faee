"""The text of a mechanism under construction: nodes, names, references and arcs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct, field

from hymeko_x.backends.hymeko.extras import with_extras
from hymeko_x.backends.hymeko.nesting import BlockNesting, name_of
from hymeko_x.backends.hymeko.values import pose_value, value_of
from hymeko_x.formats import native_format
from hymeko_x.formats.hymeko import CHILD_CLASS, NAMED_AFTER_ID, PARTS, SHORT_TYPES, TARGETS, attached_key
from hymeko_x.formats.hymeko.files import short_uri
from hymeko_x.ir.fields import layout_of
from hymeko_x.ir.ids import KINDS
from hymeko_x.ir.mechanism import WORLD, Id
from hymeko_x.ir.values import Pose
from hymeko_x.language.classes import IMPLIED, SAME
from hymeko_x.language.markup import value_of_text
from hymeko_x.language.syntax import ArcItem, Field, Item, Node, Ref, Stereotype, Value, is_field

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.backends.hymeko.values import Angles
    from hymeko_x.ir.mechanism import Mechanism, RobotArc

_ALL_KINDS = tuple(KINDS.values())
_DIRECTIONS = {1: "+", 0: "~", -1: "-"}


class HymekoSheet(Struct, frozen=True):
    """The text under construction: the mechanism, and where the text of each element stands.

    ``files``: the folder and the ending that files have in common; ``inline``: meshes and colours that are defined where a shape uses
    them, with the first shape that does; ``given_names``: those among them that have an id there; ``mimics``: couplings in the block
    of the joint that follows; ``shared``: joints that stand in the edge of the one that they follow, by that one; ``implied``: the
    drives that name actuators without a text, by those; ``attached``: arcs of mounts, drives and the like in the block of the vertex
    that they attach; ``angles``: the unit of plain angles; ``homes``: the assemblies of elements, by the elements' names, and
    ``inside``: the one that is being printed;
    ``nesting``: what stands in the blocks of data, and ``within``: the element whose block is being printed;
    ``around``: the class in force at joints, shapes and frames, where classes are stereotypes of this text;
    ``is_flat``: every shape stands by itself;
    ``clashes`` collects the assemblies in which a reference would mean another element.
    """

    mechanism: Mechanism
    files: str
    inline: Mapping[Id, Id]
    given_names: frozenset[Id]
    mimics: Mapping[Id, tuple[RobotArc, ...]]
    attached: Mapping[Id, tuple[RobotArc, ...]]
    angles: Angles
    homes: Mapping[str, str] = field(default_factory=dict)
    inside: str = ""
    nesting: BlockNesting = BlockNesting()
    within: Id | None = None
    around: Mapping[Id, str] | None = None
    shared: Mapping[Id, tuple[Id, ...]] = field(default_factory=dict)
    implied: dict[Id, Id] = field(default_factory=dict)
    is_flat: bool = False
    clashes: set[str] = field(default_factory=set)
    names: dict[str, list[str]] = field(default_factory=dict)

    attached_edges: set[Id] = field(default_factory=set)
    followers: set[Id] = field(default_factory=set)

    def __post_init__(self) -> None:
        if self.names:
            return  # a copy for another assembly
        graph = self.mechanism.graph
        self.followers.update(*self.shared.values())
        self.attached_edges.update(key for vertex in self.attached if (key := attached_key(vertex)) is not None)
        for key in (*graph.vertices, *graph.edges):
            self.names.setdefault(key.name, []).append(key.kind)

    def is_marked(self, key: Id) -> bool:
        """Whether an element has extras or notations."""
        return bool(self.mechanism.extras.get(key)) or bool(self.mechanism.notations.get(key))

    def node(self, key: Id, items: list[Item], kind: str, *, edge: bool = False) -> Node:
        """An element's node with its notations and extras at the end of its block."""
        notations = self.mechanism.notations.get(key)
        items.extend(self.class_items(key))
        if notations:
            items.extend(written_items(notations, flags=key.kind not in NAMED_AFTER_ID))
        items = with_extras(items, self.mechanism.extras.get(key, ()))
        stereotypes: tuple[Stereotype, ...] = ()
        if kind:
            path, items = _typed(kind, items)
            stereotypes = (Stereotype(Ref(path)),)
        own = self.nesting.name(key)
        name = own if key == WORLD else name_of(own.removeprefix(f"{self.inside}_" if self.inside else ""))
        return Node(name, tuple(items), stereotypes, edge="@" if edge else "")

    def class_items(self, key: Id) -> list[Item]:
        """``class "a"``: the default classes of an element of MJCF, of a joint one for each of its dofs.

        Where classes are stereotypes, an element without one has a field of the type ``IMPLIED`` with the class in force there, and a
        field that must be written, because that is the class in force there, has the type ``SAME``.
        """
        classes = self.mechanism.stereotypes.get(key)
        row = native_format(self.mechanism)
        if not classes or row is None:
            return [] if self.around is None or row is None else [Field("class", self.around.get(key, row.main_class), IMPLIED)]
        is_same = self.around is not None and classes == (self.around.get(key, row.main_class),)
        return [Field("class", value_of(classes[0]) if len(classes) == 1 else classes, SAME if is_same else "")]

    def ref(self, target: Id, kinds: tuple[str, ...], direction: str = "") -> Ref:
        """A reference: by name alone where the name means the target, else with its kind before it."""
        if target == WORLD:
            self._note_clash("world", kinds)
            alone = self.names.get("world") == ["world"]
            return Ref(("world",) if alone else ("world", "world"), direction)
        if target in self.nesting.outer or self.within is not None:
            return Ref(self.nesting.path(target, kinds, self.within, self.names), direction)
        first = next((kind for kind in kinds or _ALL_KINDS if kind in self.names.get(target.name, ())), None)
        path = self._path(target.name, kinds)
        return Ref(path if first == target.kind else (target.kind, *path), direction)

    def _path(self, name: str, kinds: tuple[str, ...]) -> tuple[str, ...]:
        """The path to a name from the assembly that is being printed: ``foot`` in the assembly ``left``, ``left.foot`` elsewhere."""
        home = self.homes.get(name)
        if home is None:
            self._note_clash(name, kinds)
            return (name_of(name),)
        short = name_of(name.removeprefix(f"{home}_"))
        return (short,) if home == self.inside else (name_of(home), short)

    def _note_clash(self, name: str, kinds: tuple[str, ...]) -> None:
        """Note when a name from outside means another element in the assembly that is being printed."""
        full = f"{self.inside}_{name}"
        if self.inside and self.homes.get(full) == self.inside and not {*(kinds or _ALL_KINDS)}.isdisjoint(self.names[full]):
            self.clashes.add(self.inside)

    def short_uri(self, uri: str) -> str:
        """A file's uri behind the common prefix, where it has it."""
        return short_uri(uri, self.files)

    def arc(self, kind: str, arc: RobotArc, kinds: tuple[str, ...] | None = None) -> ArcItem:
        """An arc of an edge of this kind. ``kinds``: what it may lead to, the likeliest first."""
        weight: tuple[Value, ...] | None = None
        if isinstance(arc.weight, Pose):
            weight = pose_value(arc.weight, self.angles)
        elif arc.weight is not None:
            weight = tuple([part if isinstance(part, str) else value_of(part) for part in arc.weight])
        return ArcItem(self.ref(arc.target, TARGETS[kind] if kinds is None else kinds, _DIRECTIONS[arc.sign]), arc.role, weight)


def defaults_of(part: type) -> dict[str, object]:
    """The default of every field of a part that has one."""
    layout = layout_of(part)
    assert layout is not None
    return {item.name: item.default for item in layout.attributes}


def _typed(kind: str, items: list[Item]) -> tuple[tuple[str, ...], list[Item]]:
    """The type that stands for an element's kind and its ``type``, and the fields without that: ``sensor.imu``, ``weld``."""
    found = next((item for item in items if is_field(item, ("type",))), None)
    part = PARTS[kind].part if kind in PARTS else None
    value = found.value if found is not None else defaults_of(part).get("kind") if part is not None else None
    word = value.path[0] if isinstance(value, Ref) else value
    if isinstance(word, str) and (kind, word) in SHORT_TYPES:
        return (SHORT_TYPES[kind, word],), [item for item in items if item is not found]
    if found is not None and isinstance(value, Ref):
        return (kind, value.path[0]), [item for item in items if item is not found]
    return (kind,), items


def written_items(notations: Mapping[str, str], *, flags: bool = True) -> list[Item]:
    """``written { key text .. }``, and the flag ``unnamed`` for an element without a name."""
    unnamed = flags and notations.get("unnamed") == "yes"
    done = {"unnamed"} if unnamed else set()
    items: list[Item] = [Field("unnamed")] if unnamed else []
    if flags and CHILD_CLASS in notations:
        items.append(Field(CHILD_CLASS, value_of(notations[CHILD_CLASS])))
        done.add(CHILD_CLASS)
    fields = [Field(key, value_of_text(text)) for key, text in notations.items() if key not in done]
    return [*items, *([Node("written", tuple(fields))] if fields else [])]
