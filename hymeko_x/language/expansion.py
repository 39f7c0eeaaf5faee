"""A syntax tree expanded: templates, stereotypes and imports resolved to flat elements with plain values.

An element keeps the types that it was made from and the scope in which its references are looked up.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from msgspec import Struct, field

from hymeko_x.language.classes import settled
from hymeko_x.language.constants import with_constants
from hymeko_x.language.expressions import INDEX, fill, fill_text, fill_value
from hymeko_x.language.prototypes import role_of
from hymeko_x.language.syntax import ArcItem, Comment, Document, Field, Import, Item, Node, QuotedName, Using, Value, is_field, is_list
from hymeko_x.language.templates import MAX_DEPTH, Templates, definitions, is_definition, merge, place_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from hymeko_x.language.expressions import Environment
    from hymeko_x.language.prototypes import Prototypes
    from hymeko_x.language.templates import Fetch
MAX_ITEMS = 500_000
"""Items that templates may add to a text: elements, fields, arcs and nested nodes."""
EACH = 20
"""How much more they may add for each element that the text has itself: a robot of 100,000 links may use as many types."""


class Scope(Struct):
    """Where names are looked up: the elements of one assembly instance, or of one block of data, inside those of its parent.

    ``name`` is that of the root, with which a path may begin.
    """

    prefix: str = ""
    parent: Scope | None = None
    name: str = ""
    elements: set[str] = field(default_factory=set)
    scopes: dict[str, Scope] = field(default_factory=dict)

    def full(self, name: str) -> str:
        """The name of an element of this scope in the whole mechanism."""
        return f"{self.prefix}{name}"

    def resolve(self, path: tuple[str, ...]) -> str | None:
        """The full name behind a path, looked up here and then outwards; None when there is none."""
        return next(self.meanings(path), None)

    def meanings(self, path: tuple[str, ...]) -> Iterator[str]:
        """The full names that a path may mean, from here outwards: elements of different kinds may share a name.

        A path that begins with an empty name begins in the root, where another element has the same path from here.
        """
        here: Scope | None = self
        if len(path) > 1 and not path[0]:
            here, path = self._root(), path[1:]
        while here is not None:
            found = here._inside(path)
            if found is not None:
                yield found
            if here.parent is None and len(path) > 1 and here.name == path[0] and (found := here._inside(path[1:])) is not None:
                yield found
            here = here.parent

    def define(self, path: tuple[str, ...]) -> str | None:
        """The full name of an element that is defined now, and its place from here outwards; None where there is no such scope."""
        here: Scope | None = self
        while here is not None:
            inner: Scope | None = here
            for step in path[:-1]:
                inner = inner.scopes.get(step) if inner is not None else None
            if inner is not None:
                inner.elements.add(path[-1])
                return inner.full(path[-1])
            here = here.parent
        return None

    def _root(self) -> Scope:
        here = self
        while here.parent is not None:
            here = here.parent
        return here

    def _inside(self, path: tuple[str, ...]) -> str | None:
        scope = self
        for step in path[:-1]:
            if step not in scope.scopes:
                return None
            scope = scope.scopes[step]
        return scope.full(path[-1]) if path[-1] in scope.elements else None


class ExpandedElement(NamedTuple):
    """A node or edge after expansion: full name, its node with plain values, its types from the nearest to the base."""

    name: str
    node: Node
    types: tuple[str, ...]
    scope: Scope
    has_prototype: bool = False


class Instance(NamedTuple):
    """A robot of another file: where it is imported, its arguments, the node with plain values, and the scope of its elements.

    ``inner.prefix`` is what the names of its elements begin with; ``inner.elements`` are they, as soon as the file is read.
    """

    node: Node
    source: Import
    arguments: tuple[tuple[str, float | str], ...]
    inner: Scope
    scope: Scope


class Amendment(NamedTuple):
    """``group.name { .. }``: fields of an element that another item makes."""

    node: Node
    scope: Scope

    @property
    def path(self) -> tuple[str, ...]:
        """The path of the element."""
        return (*self.node.within, self.node.name)


class Statement(NamedTuple):
    """A field or arc that stands in the root's block itself."""

    item: Field | ArcItem | Comment
    scope: Scope


class Expanded(NamedTuple):
    """A whole text, expanded: the root's name and types, and its elements and statements in order.

    ``inside`` expands the items in the block of an element in the same way, with the scope of their names.
    """

    name: str
    types: tuple[str, ...]
    items: tuple[Expansion, ...]
    root: str
    inside: Callable[[Sequence[Item], Scope], tuple[Expansion, ...]]
    prototypes: Prototypes
    preceding: tuple[Comment, ...] = ()
    following: tuple[Comment, ...] = ()


def expand(document: Document, file: str, fetch: Fetch) -> Expanded:
    """The elements of a text. ``fetch`` gives the bytes of an imported file, or None.

    Raises: Refusal (HX061, HX063, HX064, HX040) at the place in the text.
    """
    preceding, document, following = _without_outer_comments(document)
    document = document._replace(items=with_constants(document.items, file))
    header, roots, loose = _split(document)
    defined = definitions(document.items, roots, file, fetch)
    templates = Templates(file, defined, MAX_ITEMS + EACH * sum(len(node.items) for node in roots))
    expansion = _Expansion(file, templates)
    if len(roots) != 1 or loose:
        found = expansion.inside([*loose, *roots], Scope())
        return Expanded(header, (), found, "", expansion.inside, templates.prototypes, preceding, following)
    root = roots[0]
    if document.header:
        root = root._replace(items=_without_node_words(root.items))
    root = root._replace(stereotypes=tuple(kind for kind in root.stereotypes if templates.is_known(kind.ref)))
    preset = templates.preset(root, {})
    found = expansion.inside(merge(preset.items, root.items), Scope(name=root.name))
    return Expanded(header or root.name, preset.types, found, root.name, expansion.inside, templates.prototypes, preceding, following)


def _without_node_words(items: tuple[Item, ...]) -> tuple[Item, ...]:
    """The items without the word ``node`` before a vertex, which texts with a header in brackets have."""
    found: list[Item] = []
    following: Item | None = None
    for item in reversed(items):
        if not (is_field(item, ("node",)) and item.value is None and isinstance(following, Node)):
            found.append(item)
        if not isinstance(item, Comment):
            following = item
    return tuple(reversed(found))


def _is_type(item: Expansion, applied: set[tuple[str, int, int]]) -> bool:
    if not isinstance(item, ExpandedElement) or not item.node.edge or place_of(item.node) not in applied:
        return False
    return not any(isinstance(inner, ArcItem) and not role_of(inner) for inner in item.node.items)


def _changed(found: Iterator[Expansion]) -> tuple[Expansion, ...]:
    """The items with the changes of elements that this text makes; those of imported robots are left for their reader."""
    items = list(found)
    changes = [item for item in items if isinstance(item, Amendment)]
    if not changes:
        return tuple(items)
    places = {(item.name, bool(item.node.edge)): place for place, item in enumerate(items) if isinstance(item, ExpandedElement)}
    done: set[int] = set()
    for change in changes:
        name = change.scope.resolve(change.path)
        place = places.get((name or "", bool(change.node.edge)))
        element = None if place is None else items[place]
        if place is not None and isinstance(element, ExpandedElement):
            done.add(id(change))
            items[place] = element._replace(node=element.node._replace(items=merge(element.node.items, change.node.items)))
    return tuple(item for item in items if id(item) not in done)


def _without_outer_comments(document: Document) -> tuple[tuple[Comment, ...], Document, tuple[Comment, ...]]:
    """The comments before the last item, the document without comments, and the comments behind it."""
    numbers = [number for number, item in enumerate(document.items) if not isinstance(item, Comment)]
    last = numbers[-1] if numbers else 0
    preceding = tuple(item for item in document.items[:last] if isinstance(item, Comment))
    following = tuple(item for item in document.items[last:] if isinstance(item, Comment))
    return preceding, document._replace(items=tuple(document.items[number] for number in numbers)), following


def _split(document: Document) -> tuple[str, list[Node], list[Item]]:
    """The header name, the root nodes, and the items beside them."""
    header = document.header
    roots: list[Node] = []
    loose: list[Item] = []
    for position, item in enumerate(document.items):
        if position == 0 and isinstance(item, Field) and item.value is None:
            header = item.name
        elif is_definition(item):
            continue
        elif isinstance(item, Node) and not item.edge:
            roots.append(item)
        else:
            loose.append(item)
    settings = [node for node in roots if node.name == "units" and not isinstance(node.name, QuotedName)]
    bodies = [node for node in roots if node not in settings]
    if len(bodies) > 1 and not loose:
        header, bodies = _one_root(header, bodies)
    if len(bodies) == 1 and not loose:
        return header, [bodies[0]._replace(items=(*settings, *bodies[0].items))], []
    return header, roots, loose


def _one_root(header: str, roots: list[Node]) -> tuple[str, list[Node]]:
    """The root among several nodes: the others are a description before it, and roots whose elements are types in it."""
    first, *others = roots
    used = {ref.path[0] for node in others for ref in (*node.uses, *(kind.ref for kind in node.stereotypes))}
    libraries = [node for node in roots if node.name in used]
    rest = [node for node in roots if node not in libraries]
    is_description = len(rest) > 1 and rest[0] is first and _describes(first)
    described = rest[1:] if is_description else rest
    if len(described) != 1 or not any(isinstance(item, Node) for item in described[0].items):
        return header, roots
    root = described[0]
    if is_description and any(isinstance(item, Field | Node) for item in first.items):
        data = first._replace(items=tuple(item for item in first.items if isinstance(item, Field | Node | Comment)))
        root = root._replace(items=(data, *root.items))
    return header, [root]


def _describes(node: Node) -> bool:
    """Whether a block before the root holds fields and imports alone; one with imports or names for paths may hold blocks of fields."""
    has_imports = any(isinstance(item, Import | Using) for item in node.items)
    return all(isinstance(item, _DESCRIBING) or (has_imports and _is_data(item)) for item in node.items)


def _is_data(item: Item) -> bool:
    if not isinstance(item, Node) or item.edge or item.stereotypes or item.uses:
        return False
    return all(isinstance(inner, Field | Comment) for inner in item.items)


_DESCRIBING = (Field, Import, Using, Comment)
Expansion = ExpandedElement | Statement | Instance | Amendment


class _Expansion:
    """The elements of blocks, with those of the assemblies in them."""

    def __init__(self, file: str, templates: Templates) -> None:
        self._file = file
        self._templates = templates

    def inside(self, items: Sequence[Item], scope: Scope) -> tuple[Expansion, ...]:
        """The elements of a block, with the changes that other items of it make; an edge without arcs that is a type is none."""
        found = _changed(self.elements(items, {}, scope))
        applied = self._templates.applied
        return found if not applied else tuple(item for item in found if not _is_type(item, applied))

    def elements(
        self, items: Sequence[Item], environment: Environment, scope: Scope, depth: int = 0, *, made: bool = False
    ) -> Iterator[Expansion]:
        """The elements of a block, with those of the assemblies in it in their place. ``made``: a template put them there."""
        for item in items:
            if is_definition(item):
                continue
            if isinstance(item, Node):
                yield from self._element(item, environment, scope, depth, made=made)
            else:
                if isinstance(item, Field):
                    scope.elements.add(item.name)
                yield Statement(fill(item, environment, self._file), scope)  # type: ignore[arg-type]

    def _element(self, node: Node, environment: Environment, scope: Scope, depth: int, *, made: bool) -> Iterator[Expansion]:
        if made:
            self._templates.count(node, 1)
        if node.size is not None:
            yield from self._array(node, node.size, environment, scope, depth)
            return
        name = fill_text(node.name, environment, node, self._file)
        if node.within:
            yield Amendment(self._plain(node, name, environment), scope)
            return
        robot = self._templates.robot(node)
        if robot is not None:
            source, kind = robot
            arguments = tuple((key, self._templates.scalar(key, value, environment, node)) for key, value in kind.arguments or ())
            inner = scope.scopes.setdefault(name, Scope(f"{scope.full(name)}_", scope))
            scope.elements.add(name)
            yield Instance(self._plain(node, name, environment), source, arguments, inner, scope)
            return
        preset = self._templates.preset(node, environment)
        merged = settled(merge(preset.items, node.items))
        if "assembly" in preset.types:
            yield from self._assembly(node, name, merged, environment, scope, depth, made=made)
            return
        scope.elements.add(name)
        plain = tuple(
            fill(self._templates.refine(item, environment), environment, self._file)
            for item in merged
            if not isinstance(item, Import | Using)
        )
        found = node._replace(name=name, items=plain, stereotypes=())
        yield ExpandedElement(scope.full(name), found, preset.types, scope, preset.has_prototype)

    def _plain(self, node: Node, name: str, environment: Environment) -> Node:
        """The node with plain values."""
        return node._replace(name=name, items=tuple(fill(item, environment, self._file) for item in node.items))

    def _array(self, node: Node, count: tuple[Value, ...], environment: Environment, scope: Scope, depth: int) -> Iterator[Expansion]:
        """The elements of an array: ``${i}`` is the number of each, from 0, and stands behind its name."""
        sizes = fill_value(count, environment, node, self._file)
        size = sizes[0] if is_list(sizes) and len(sizes) == 1 else None
        if not isinstance(size, float) or not size.is_integer() or size < 0:
            hint = f"{node.name} [3] : type {{ }} makes {node.name}_0, {node.name}_1 and {node.name}_2"
            raise self._templates.refuse(node, f"the size of the array '{node.name}' is one whole number in brackets", hint)
        self._templates.count(node, int(min(size, MAX_ITEMS * 2)))
        for number in range(int(size)):
            one = node._replace(size=None, name=type(node.name)(f"{node.name}_{number}"))
            yield from self._element(one, {**environment, INDEX: float(number)}, scope, depth, made=True)

    def _assembly(
        self, node: Node, name: str, items: tuple[Item, ...], environment: Environment, scope: Scope, depth: int, *, made: bool
    ) -> Iterator[Expansion]:
        """The elements of an assembly: its own nodes and comments, and the nodes of its template. One of the same name is continued."""
        if depth > MAX_DEPTH:
            hint = "an assembly that holds an instance of itself never ends"
            raise self._templates.refuse(node, f"'{name}' is nested more than {MAX_DEPTH} levels deep", hint)
        inner = scope.scopes.setdefault(name, Scope(f"{scope.full(name)}_", scope))
        own = set(map(id, node.items))
        for item in items:
            if isinstance(item, Node) or (isinstance(item, Comment) and id(item) in own):
                yield from self.elements([item], environment, inner, depth + 1, made=made or id(item) not in own)
