"""The builder of a mechanism from HyMeKo text: ids, references and arcs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import field

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.hymeko import POSED_EDGES, TARGETS
from hymeko_x.ir.builder import Builder
from hymeko_x.ir.graph import Arc
from hymeko_x.ir.mechanism import KINDS, WORLD, Id, Provenance
from hymeko_x.ir.parts import Weight, World
from hymeko_x.language.syntax import ArcItem, QuotedName, is_list
from hymeko_x.language.templates import standard_templates

if TYPE_CHECKING:
    from hymeko_x.frontends.hymeko.block import Block
    from hymeko_x.frontends.hymeko.values import ValueReader
    from hymeko_x.ir.mechanism import RobotArc
    from hymeko_x.ir.values import Vec3
    from hymeko_x.language.expansion import Element, Scope
    from hymeko_x.language.syntax import Item, Ref

_FEW = 8
_ALL_KINDS = tuple(KINDS.values())
_SIGNS = {"+": 1, "<-": 1, "-": -1, "->": -1, "~": 0, "<>": 0}


class HymekoBuilder(Builder):
    """The elements of a text so far, and which names exist of which kind."""

    reader: ValueReader
    source: Provenance = field(default=Provenance())
    files: str = ""
    kinds: dict[str, list[str]] = field(default_factory=dict)
    directions: dict[str, Vec3] = field(default_factory=dict)
    folded: set[Id] = field(default_factory=set)

    def declare(self, kind: str, element: Element) -> Id:
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
        written = {**({"unnamed": "yes"} if block.unnamed else {}), **block.written}
        if written:
            self.notations[key] = {**self.notations.get(key, {}), **written}

    def target(self, ref: Ref, scope: Scope, kinds: tuple[str, ...], item: Item) -> Id:
        """The element behind a reference: the first of these kinds that has the name.

        Raises: Refusal (HX040) when there is none.
        """
        found = self.find(ref, scope, kinds)
        if found is None:
            raise refuse(
                codes.UNDEFINED_REFERENCE,
                f"'{ref.dotted}' is not defined; expected a {' or '.join(kinds or ('element',))}",
                self.reader.origin(item),
                hint=self._near(ref.path[-1], kinds),
            )
        return found

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
                    self.vertices.setdefault(WORLD, World())
                    return WORLD
        return None

    def _near(self, name: str, kinds: tuple[str, ...]) -> str:
        from difflib import get_close_matches

        candidates = [known for known, of in self.kinds.items() if not kinds or set(of) & set(kinds)]
        near = get_close_matches(name, candidates, n=3)
        if near:
            return f"did you mean {' or '.join(near)}?"
        return f"defined are {', '.join(candidates)}" if 0 < len(candidates) <= _FEW else ""

    def full_uri(self, uri: str) -> str:
        """The uri of a file: behind the mechanism's ``files`` prefix where it begins with ``~/``."""
        return self.files + uri[2:] if self.files and uri.startswith("~/") else uri

    def arc(self, kind: str, item: ArcItem, scope: Scope) -> RobotArc:
        """An arc of an edge of this kind, with its weight read as the kind wants it."""
        target = self.target(item.ref, scope, TARGETS[kind], item)
        return Arc(target, sign_of(item), self._weight(kind, item), item.role)

    def _weight(self, kind: str, item: ArcItem) -> Weight | None:
        """An arc's weight: a pose for the edges that join bodies, numbers for the others."""
        if item.weight is None:
            return None
        if kind in POSED_EDGES:
            return self.reader.pose(item.weight, item)
        flat = tuple(part for part in item.weight if not is_list(part))
        if len(flat) != len(item.weight):
            raise self.reader.refuse(item, f"the weight of the arc to '{item.ref.dotted}' is a list of numbers")
        return self.reader.numbers(item.weight, "", item)


def sign_of(item: ArcItem) -> int:
    """+1 into the edge, -1 out of it, 0 undirected."""
    return _SIGNS[item.ref.direction]
