"""The builder of a mechanism from HyMeKo text: ids, references and arcs."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from msgspec import field
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import refuse, with_article
from hymeko_x.formats.hymeko import POSED_EDGES, TARGETS
from hymeko_x.formats.hymeko.classes import classes_in_force
from hymeko_x.formats.hymeko.files import full_uri
from hymeko_x.formats.hymeko.nesting import OUTER
from hymeko_x.ir.builder import Builder
from hymeko_x.ir.graph import Arc
from hymeko_x.ir.ids import KINDS
from hymeko_x.ir.mechanism import WORLD, Id, Provenance
from hymeko_x.ir.parts import Datum, Texture, Weight, World
from hymeko_x.ir.values import compose
from hymeko_x.language.classes import native
from hymeko_x.language.syntax import ArcItem, Field, Node, QuotedName, is_list
from hymeko_x.language.templates import standard_templates

if TYPE_CHECKING:
    from hymeko_x.frontends.hymeko.block import Block
    from hymeko_x.frontends.hymeko.values import ValueReader
    from hymeko_x.ir.mechanism import Mechanism, RobotArc
    from hymeko_x.ir.provenance import StoredMesh
    from hymeko_x.ir.values import Pose, Vec3
    from hymeko_x.language.expansion import ExpandedElement, Scope
    from hymeko_x.language.prototypes import Prototypes
    from hymeko_x.language.syntax import Item, Ref

_FEW = 8
_ALL_KINDS = tuple(KINDS.values())
_SIGNS = {"+": 1, "<-": 1, "-": -1, "->": -1, "~": 0, "<>": 0}


class ImportedRoot(NamedTuple):
    """What the name of an imported robot means where a body is expected: its root, and the frame of the robot's world in that."""

    roots: tuple[Id, ...]
    frame: Pose


class HymekoBuilder(Builder):
    """The elements of a text so far, and which names exist of which kind."""

    reader: ValueReader
    source: Provenance = field(default=Provenance())
    files: str = ""
    kinds: dict[str, list[str]] = field(default_factory=dict)
    directions: dict[str, Vec3] = field(default_factory=dict)
    folded: set[Id] = field(default_factory=set)
    imported: dict[str, ImportedRoot] = field(default_factory=dict)
    prototypes: Prototypes | None = None
    root: str = ""
    implied: set[Id] = field(default_factory=set)
    places: dict[str, str] = field(default_factory=dict)
    stored: dict[Id, StoredMesh | Texture] = field(default_factory=dict)

    def declare(self, kind: str, element: ExpandedElement) -> Id:
        """Reserve the id of an element, so that references find it.

        Raises: Refusal (HX023) when the name is taken by an element of the same kind.
        """
        key = self.reserve(kind, element.name, element.node)
        self.layout.append(key)
        own = tuple(name for name in element.types if name not in standard_templates())
        if own and not self.source.version:  # a mechanism with a version has its default classes in `class` fields
            self.stereotypes[key] = own
        return key

    def reserve(self, kind: str, name: str, item: Item) -> Id:
        """Reserve the id of a part of an element."""
        taken = self.kinds.setdefault(name, [])
        key = Id(kind, name)
        if kind in taken:
            first = self.origins[key].line
            message = f"{key} is defined twice; the first definition is in line {first}"
            raise refuse(codes.DUPLICATE_NAME, message, self.reader.origin(item), hint="give one of them another name")
        taken.append(kind)
        self.names.reserve(kind, name)
        self.origins[key] = self.reader.origin(item)
        return key

    def name_after_place(self, kind: str, name: str, item: Item) -> Id:
        """The id of an element without a name: after its place, with a number when that is taken."""
        key = self.fresh(kind, name, self.reader.origin(item))
        self.kinds.setdefault(key.name, []).append(kind)
        return key

    def keep(self, key: Id, block: Block) -> None:
        """Keep the block's extras and notations beside its element."""
        self.add_extras(key, *block.extras)
        if block.classes:
            self.stereotypes[key] = block.classes
            self.implied.update({key} if block.is_implied else ())
        written = {**({"unnamed": "yes"} if block.unnamed else {}), **block.written}
        if written:
            self.notations[key] = {**self.notations.get(key, {}), **written}

    def target(self, ref: Ref, scope: Scope, kinds: tuple[str, ...], item: Item) -> Id:
        """The element behind a reference: the first of these kinds that has the name.

        Raises: Refusal (HX040) when there is none.
        """
        found = self.find(ref, scope, kinds)
        if found is None and not kinds:
            found = self._imported(ref, item)
        if found is None:
            self._check_roots(ref, scope, kinds, item)
            other = self.find(ref, scope, ())
            problem = "is not defined" if other is None else f"is {_listed((other.kind,))}"
            message = f"'{ref.dotted}' {problem}; expected {_listed(kinds or ('element',))}"
            raise refuse(codes.UNDEFINED_REFERENCE, message, self.reader.origin(item), hint=self.near(ref.path[-1], kinds))
        return found

    def _imported(self, ref: Ref, item: Item) -> Id | None:
        """The vertex of data for an element of an imported text, or of a root that holds types: its name is the path there."""
        prototype = None if self.prototypes is None else self.prototypes.find(ref.path)
        if prototype is None or self.root in ("", prototype.path[0]):
            return None
        key = Id("datum", ".".join(prototype.path))
        if key not in self.vertices:
            self.reserve(key.kind, key.name, item)
            fields = self.prototypes.fields_of(prototype.item) if isinstance(prototype.item, Node) else (prototype.item,)  # type: ignore[union-attr]
            values = [(field.name, self.reader.datum(field)) for field in fields if isinstance(field, Field) and field.value is not None]
            self.vertices[key] = Datum(tuple(values))
            self.layout.append(key)
        return key

    def _check_roots(self, ref: Ref, scope: Scope, kinds: tuple[str, ...], item: Item) -> None:
        """Raises: Refusal (HX045) for the name of an imported robot with no root or several."""
        found = next((self.imported[name] for name in scope.meanings(ref.path) if name in self.imported), None)
        if found is None or "body" not in kinds:
            return
        names = ", ".join(root.name for root in found.roots[:_FEW]) or "none"
        message = f"the robot '{ref.dotted}' has {len(found.roots)} roots, and one was expected: {names}"
        raise refuse(codes.MISSING_PART, message, self.reader.origin(item), hint=f"name a body of it: {ref.dotted}.body")

    def find(self, ref: Ref, scope: Scope, kinds: tuple[str, ...]) -> Id | None:
        """The element behind a reference, or None."""
        path = ref.path
        if len(path) > 1 and path[0] in _ALL_KINDS and (not kinds or path[0] in kinds):
            kinds, path = (path[0],), path[1:]
        for name in (*scope.meanings(path), ".".join(path)):
            for kind in kinds or _ALL_KINDS:
                if kind in self.kinds.get(name, ()):
                    return Id(kind, name)
                if kind == "world" and name == "world" and not isinstance(path[-1], QuotedName):
                    return self.world()
            if name in self.imported and (root := self._root(name, kinds)) is not None:
                return root
        return None

    def _root(self, name: str, kinds: tuple[str, ...]) -> Id | None:
        """The root of an imported robot of this name, where a body is expected and there is one root."""
        found = self.imported.get(name)
        return found.roots[0] if found is not None and len(found.roots) == 1 and "body" in kinds else None

    def in_root(self, ref: Ref, scope: Scope, pose: Pose) -> Pose:
        """A pose in the world of an imported robot that the reference names as one in its root; of another body the pose itself."""
        name = next((name for name in scope.meanings(ref.path) if name in self.imported and "body" not in self.kinds.get(name, ())), None)
        return pose if name is None else compose(self.imported[name].frame, pose)

    def world(self) -> Id:
        """The world, which is there from now on."""
        self.vertices.setdefault(WORLD, World())
        return WORLD

    def near(self, name: str, kinds: tuple[str, ...]) -> str:
        """A hint with names that look alike, of elements of these kinds (none: of all)."""
        from difflib import get_close_matches

        candidates = [known for known, of in self.kinds.items() if not kinds or set(of) & set(kinds)]
        near = get_close_matches(name, candidates, n=3)
        if near:
            return f"did you mean {' or '.join(near)}?"
        return f"defined are {', '.join(candidates)}" if 0 < len(candidates) <= _FEW else ""

    def full_uri(self, uri: str) -> str:
        """The uri of a file: behind the mechanism's ``files`` prefix where it begins with ``~/``."""
        return full_uri(uri, self.files)

    def arc(self, kind: str, item: ArcItem, scope: Scope, kinds: tuple[str, ...] | None = None) -> RobotArc:
        """An arc of an edge of this kind, with its weight. ``kinds``: what it may lead to, the likeliest first."""
        sign = sign_of(item)
        expected = TARGETS[kind] if kinds is None else kinds
        if kind == "drive" and sign < 0:
            expected = tuple(other for other in expected if other != "actuator")
        if kind == "sense" and sign < 0:
            expected = ("sensor",)
        return Arc(self.target(item.ref, scope, expected, item), sign, self._weight(kind, item), str(item.role))

    def _weight(self, kind: str, item: ArcItem) -> Weight | None:
        """An arc's weight: a pose for the edges that join bodies, numbers for the others."""
        if item.weight is None:
            return None
        if kind in POSED_EDGES:
            return self.reader.pose(item.weight, item)
        if kind in OUTER:
            return tuple([self.reader.data(part, item) for part in item.weight])
        flat = tuple(part for part in item.weight if not is_list(part))
        if len(flat) != len(item.weight):
            raise self.reader.refuse(item, f"the weight of the arc to '{item.ref.dotted}' is a list of numbers")
        return self.reader.numbers(item.weight, "", item)


def _listed(kinds: tuple[str, ...]) -> str:
    """The kinds with their article: ``an actuator or sensor``."""
    return with_article(" or ".join(kinds))


def without_implied(mechanism: Mechanism, implied: set[Id]) -> Mechanism:
    """The mechanism without classes that elements have as their stereotypes and that are in force there anyway."""
    if not implied:
        return mechanism
    around = classes_in_force(mechanism)
    main = (native().main_class,)
    left = {
        key: classes
        for key, classes in mechanism.stereotypes.items()
        if key not in implied or classes != ((around[key],) if key in around else main)
    }
    return replace(mechanism, stereotypes=left)


def sign_of(item: ArcItem) -> int:
    """+1 into the edge, -1 out of it, 0 undirected."""
    return _SIGNS[item.ref.direction]
