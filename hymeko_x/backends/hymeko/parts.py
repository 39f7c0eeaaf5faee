"""What every element's text is made of: names, references, poses, fields, extras and notations."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, cast

from msgspec import NODEFAULT, Struct, field

from hymeko_x.backends.hymeko.foreign import foreign_items
from hymeko_x.formats.hymeko import (
    ATTACHED,
    CHILD_CLASS,
    FOREIGN,
    LIMIT_WORDS,
    NAMED_AFTER_ID,
    PARTS,
    POSED_EDGES,
    RESERVED,
    SHORT_TYPES,
    TARGETS,
    Word,
)
from hymeko_x.formats.hymeko.attached import TEXTURE, attached_key
from hymeko_x.ir import parts
from hymeko_x.ir.fields import layout_of
from hymeko_x.ir.mechanism import KINDS, WORLD, Id
from hymeko_x.ir.values import NO_ROTATION, Pose
from hymeko_x.language.markup import value_of_text
from hymeko_x.language.syntax import ArcItem, Field, Item, Node, QuotedName, Ref, Stereotype, Value
from hymeko_x.rewrite.native import is_native

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.backends.hymeko.angles import Angles
    from hymeko_x.ir.mechanism import Mechanism, RobotArc

_WORD = re.compile(r"[^\W\d]\w*")
_NO_WORDS = frozenset({"inf", "nan", "rel", "seq", "concurrent", "use", "import", "as"})
_ALL_KINDS = tuple(KINDS.values())
_DIRECTIONS = {1: "+", 0: "~", -1: "-"}
_FLAGS = frozenset({"unnamed", "kind", "moves", "scope"})
_SETTINGS = FOREIGN | _FLAGS | {"extra", "class", CHILD_CLASS, "written"}
_SPANS = frozenset({"limit", "limits", "range"}) | {word.word for word in LIMIT_WORDS}


class Context(Struct, frozen=True):
    """What the printers need to know: the mechanism, the files' common prefix, and what is said in place.

    ``inline``: meshes and colours that are defined where a shape uses them, with the shape that uses them first;
    ``given_names``: those among them that say their id; ``mimics``: couplings that are said in the joint that follows;
    ``attached``: the arcs of mounts, drives and the like that are said in the block of the vertex that they put to use;
    ``angles``: the unit of plain angles; ``homes``: the assemblies in which elements stand, by the elements' names, and
    ``inside``: the one that is being printed; ``clashes`` collects those in which a reference would mean another element.
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
    clashes: set[str] = field(default_factory=set)
    names: dict[str, list[str]] = field(default_factory=dict)

    attached_edges: set[Id] = field(default_factory=set)

    def __post_init__(self) -> None:
        if self.names:
            return  # a copy, which shares what is known of the mechanism
        graph = self.mechanism.graph
        self.attached_edges.update(key for vertex in self.attached if (key := attached_key(vertex)) is not None)
        for key in (*graph.vertices, *graph.edges):
            self.names.setdefault(key.name, []).append(key.kind)

    def is_marked(self, key: Id) -> bool:
        """Whether something is said beside the element: extras or notations."""
        return bool(self.mechanism.extras.get(key)) or bool(self.mechanism.notations.get(key))

    def node(self, key: Id, items: list[Item], kind: str, *, edge: bool = False) -> Node:
        """An element's node with its notations and extras at the end of its block."""
        notations = self.mechanism.notations.get(key)
        items.extend(self.class_items(key))
        if notations:
            items.extend(written_items(notations, flags=key.kind not in NAMED_AFTER_ID))
        items.extend(foreign_items(self.mechanism.extras.get(key, ())))
        path, items = typed(kind, items)
        stereotypes = (Stereotype(Ref(path)),) if kind else ()
        name = key.name if key == WORLD else name_of(key.name.removeprefix(f"{self.inside}_" if self.inside else ""))
        return Node(name, tuple(items), stereotypes, edge="@" if edge else "")

    def class_items(self, key: Id) -> list[Item]:
        """``class "a"``: the default classes that MJCF's author gave an element, of a joint one for each of its dofs."""
        classes = self.mechanism.stereotypes.get(key)
        if not classes or not is_native(self.mechanism):
            return []
        return [Field("class", value_of(classes[0]) if len(classes) == 1 else classes)]

    def ref(self, target: Id, kinds: tuple[str, ...], direction: str = "") -> Ref:
        """A reference: by name alone where the name means the target, else with its kind before it."""
        if target == WORLD:
            self._look_out("world", kinds)
            alone = self.names.get("world") == ["world"]
            return Ref(("world",) if alone else ("world", "world"), direction)
        first = next((kind for kind in kinds or _ALL_KINDS if kind in self.names.get(target.name, ())), None)
        path = self._path(target.name, kinds)
        return Ref(path if first == target.kind else (target.kind, *path), direction)

    def _path(self, name: str, kinds: tuple[str, ...]) -> tuple[str, ...]:
        """A name as it is called where the printer is: ``foot`` in the assembly ``left``, ``left.foot`` elsewhere."""
        home = self.homes.get(name)
        if home is None:
            self._look_out(name, kinds)
            return (name_of(name),)
        short = name_of(name.removeprefix(f"{home}_"))
        return (short,) if home == self.inside else (name_of(home), short)

    def _look_out(self, name: str, kinds: tuple[str, ...]) -> None:
        """Note if a name from outside means something else in the assembly that is being printed."""
        full = f"{self.inside}_{name}"
        if self.inside and self.homes.get(full) == self.inside and not {*(kinds or _ALL_KINDS)}.isdisjoint(self.names[full]):
            self.clashes.add(self.inside)

    def arc(self, kind: str, arc: RobotArc) -> ArcItem:
        """An arc of an edge of this kind."""
        weight = None
        if isinstance(arc.weight, Pose):
            weight = pose_value(arc.weight, self.angles)
        elif arc.weight is not None:
            weight = cast("tuple[Value, ...]", arc.weight)
        elif kind in POSED_EDGES:
            weight = None
        return ArcItem(self.ref(arc.target, TARGETS[kind], _DIRECTIONS[arc.sign]), arc.role, weight)


def name_of(name: str) -> str:
    """The name of an element, quoted where it would mean something else."""
    return QuotedName(name) if name in RESERVED else name


def pose_value(pose: Pose, angles: Angles) -> tuple[Value, ...]:
    """``[x y z]`` for a translation, else ``[[x y z] rotation]``, roll-pitch-yaw if written so, else a quaternion.

    Other notations say their kind: ``[[x y z] "zaxis" [0 1 0]]``, and ``["fromto" [two points]]``.
    """
    if pose.written is not None:
        rotation = angles.rotation(pose.written)
        if pose.written.kind in ("rpy", "quat"):
            return (pose.xyz, rotation)
        if pose.written.kind == "fromto":
            return ("fromto", rotation)
        return (pose.xyz, pose.written.kind, rotation)
    if pose.quat == NO_ROTATION:
        return pose.xyz
    return (pose.xyz, pose.quat)


def word_fields(part: object, words: Iterable[Word], angles: Angles, motion: str = "") -> list[Item]:
    """A field for every attribute that differs from its default; ``motion`` is what the dimension of that name stands for."""
    defaults = _defaults(type(part))
    found: list[Item] = []
    for word in words:
        value = getattr(part, word.attribute)
        if value == defaults.get(word.attribute, NODEFAULT):
            continue
        dimension = motion if word.dimension == "motion" else word.dimension
        if word.form == "rgba" and value[3] == 1.0:
            value = value[:3]
        if word.form == "numbers" and len(value) == 1:
            value = value[0]
        found.append(Field(word.word, angles.value(value) if dimension == "angle" else value_of(value)))
    return found


def limit_items(limits: parts.Limits, angles: Angles, motion: str) -> list[Item]:
    """``limit [lower upper]`` where there are both, and a field for every other bound."""
    if limits.lower is None or limits.upper is None:
        return word_fields(limits, LIMIT_WORDS, angles, motion)
    span = (limits.lower, limits.upper)
    said = angles.values(span) if motion == "angle" else span
    return [Field("limit", said), *word_fields(limits, LIMIT_WORDS[2:], angles, motion)]


def _defaults(part: type) -> dict[str, object]:
    layout = layout_of(part)
    assert layout is not None
    return {item.name: item.default for item in layout.attributes}


def value_of(value: object) -> Value:
    """A part's value as a value of the language."""
    if isinstance(value, bool):
        return Ref(("true" if value else "false",))
    if isinstance(value, int):
        return float(value)
    if isinstance(value, tuple):
        return tuple(value if isinstance(value, str) else value_of(value) for value in value)
    if isinstance(value, str) and _WORD.fullmatch(value) and value not in _NO_WORDS:
        return Ref((value,))
    assert isinstance(value, float | str), value
    return value


def typed(kind: str, items: list[Item]) -> tuple[tuple[str, ...], list[Item]]:
    """The type that says an element's kind and its ``type``, and the fields without that: ``sensor.imu``, ``weld``."""
    found = next(
        (item for item in items if isinstance(item, Field) and item.name == "type" and not isinstance(item.name, QuotedName)), None
    )
    part = PARTS[kind].part if kind in PARTS else None
    value = found.value if found is not None else _defaults(part).get("kind") if part is not None else None
    word = value.path[0] if isinstance(value, Ref) else value
    if isinstance(word, str) and (kind, word) in SHORT_TYPES:
        return (SHORT_TYPES[kind, word],), [item for item in items if item is not found]
    if found is not None and isinstance(value, Ref):
        return (kind, value.path[0]), [item for item in items if item is not found]
    return (kind,), items


def part_items(context: Context, key: Id, part: parts.VertexPart | parts.EdgePart, arcs: tuple[RobotArc, ...]) -> list[Item]:
    """The block of an element that its words describe completely."""
    words = PARTS[key.kind]
    items: list[Item] = [context.arc(key.kind, arc) for arc in arcs] or _attached_items(context, key)
    said = word_fields(part, words.words, context.angles)
    if key.kind in NAMED_AFTER_ID:
        said = _named(said, key)
    items.extend(_uri_fields(context, said, key.kind))
    if isinstance(part, parts.Tendon):
        items.extend(limit_items(part.limits, context.angles, "length"))
    if words.open:
        taken = {word.word for word in words.words} | _SETTINGS | _SPANS
        items.extend(
            Field(QuotedName(name) if name in taken else name, value_of(value))
            for name, value in part.parameters  # type: ignore[union-attr]
        )
    return items


def _attached_items(context: Context, key: Id) -> list[Item]:
    """The arcs of the edge that puts a vertex to use, and the texture of a material."""
    arcs = context.attached.get(key, ())
    if key.kind == "material":
        return [Field(TEXTURE, context.ref(arc.target, ("texture",))) for arc in arcs]
    return [context.arc(ATTACHED[key.kind], arc) for arc in arcs]


def _named(items: list[Item], key: Id) -> list[Item]:
    """The fields with ``unnamed`` where there is no name, and without the name that the id tells."""
    names = [item for item in items if isinstance(item, Field) and item.name == "name"]
    if not names:
        return [Field("unnamed"), *items]
    return [item for item in items if item is not names[0] or names[0].value != value_of(key.name)]


def _uri_fields(context: Context, items: list[Item], kind: str) -> list[Item]:
    if kind not in ("mesh", "texture"):
        return items
    return [
        item._replace(value=short_uri(context, _text_of(item.value))) if isinstance(item, Field) and item.name == "file" else item
        for item in items
    ]


def _text_of(value: Value | None) -> str:
    return value.path[0] if isinstance(value, Ref) else str(value)


def short_uri(context: Context, uri: str) -> str:
    """A file's uri behind the common prefix, where it has it."""
    return f"~/{uri.removeprefix(context.files)}" if context.files and uri.startswith(context.files) else uri


def written_items(notations: Mapping[str, str], *, flags: bool = True) -> list[Item]:
    """``written { key text .. }``, and the flag ``unnamed`` for what its author gave no name."""
    unnamed = flags and notations.get("unnamed") == "yes"
    apart = {"unnamed"} if unnamed else set()
    items: list[Item] = [Field("unnamed")] if unnamed else []
    if flags and CHILD_CLASS in notations:
        items.append(Field(CHILD_CLASS, value_of(notations[CHILD_CLASS])))
        apart.add(CHILD_CLASS)
    said = [Field(key, value_of_text(text)) for key, text in notations.items() if key not in apart]
    return [*items, *([Node("written", tuple(said))] if said else [])]
