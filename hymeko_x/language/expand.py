"""Templates, stereotypes and imports resolved: from a syntax tree to flat elements with plain values.

An element keeps the chain of types that it was made from and the scope in which its references are looked up.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import NamedTuple

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, Refusal, refuse
from hymeko_x.language.expressions import ExpressionError, evaluate
from hymeko_x.language.parser import parse
from hymeko_x.language.syntax import (
    ArcItem,
    Comment,
    Document,
    Expression,
    Field,
    Import,
    Item,
    Node,
    Quantity,
    QuotedName,
    Ref,
    Stereotype,
    Value,
)

MAX_ITEMS = 500_000
"""What templates may add to a text: elements, fields, arcs and nested nodes."""
EACH = 20
"""How much more they may add for each element that the text has itself: a robot of 100,000 links may use as many types."""
MAX_TEXT = 100_000
"""Characters of a text with `${ }` in it."""
MAX_DEPTH = 64
MAX_IMPORTS = 200
_INTERPOLATION = re.compile(r"\$\{([^{}]*)\}")

Fetch = Callable[[str], bytes | None]
Environment = Mapping[str, float | str]
_Imported = dict[str, dict[str, Node] | None]  # what each file defines; None while it is being read


@dataclass(slots=True)
class Scope:
    """Where names are looked up: the elements of one assembly instance, inside those of its parent."""

    prefix: str = ""
    parent: Scope | None = None
    elements: set[str] = field(default_factory=set)
    scopes: dict[str, Scope] = field(default_factory=dict)

    def full(self, name: str) -> str:
        """The name of an element of this scope as the whole mechanism knows it."""
        return f"{self.prefix}{name}"

    def resolve(self, path: tuple[str, ...]) -> str | None:
        """The full name behind a path, looked up here and then outwards; None when there is none."""
        return next(self.meanings(path), None)

    def meanings(self, path: tuple[str, ...]) -> Iterator[str]:
        """The full names that a path may mean, from here outwards: elements of different kinds may share a name."""
        here: Scope | None = self
        while here is not None:
            found = here._inside(path)
            if found is not None:
                yield found
            here = here.parent

    def _inside(self, path: tuple[str, ...]) -> str | None:
        scope = self
        for step in path[:-1]:
            if step not in scope.scopes:
                return None
            scope = scope.scopes[step]
        return scope.full(path[-1]) if path[-1] in scope.elements else None


class Element(NamedTuple):
    """A node or edge after expansion: full name, its node with plain values, its types from the nearest to the base."""

    name: str
    node: Node
    types: tuple[str, ...]
    scope: Scope


class Statement(NamedTuple):
    """A field or arc that stands in the root's block itself."""

    item: Field | ArcItem | Comment
    scope: Scope


class Expanded(NamedTuple):
    """A whole text, expanded: the root's name and types, and what it holds in order."""

    name: str
    types: tuple[str, ...]
    items: tuple[Element | Statement, ...]
    scope: Scope
    root: str
    preceding: tuple[Comment, ...] = ()
    following: tuple[Comment, ...] = ()


class _Type(NamedTuple):
    """A type's chain of names and the items that it presets."""

    names: tuple[str, ...]
    items: tuple[Item, ...]


NO_TYPE = _Type((), ())


def expand(document: Document, file: str, fetch: Fetch) -> Expanded:
    """The elements of a text. ``fetch`` gives the bytes of an imported file, or None.

    Raises: Refusal (HX061, HX063, HX064, HX040) at the place in the text.
    """
    preceding, document, following = _without_outer_comments(document)
    header, roots, loose = _split(document)
    templates = dict(standard_templates())
    _import(document.items, file, fetch, templates, {})
    for node in roots:
        _define(node.items, templates)
    _define(document.items, templates)
    root = roots[0] if len(roots) == 1 and not loose else None
    work = _Expansion(file, templates, MAX_ITEMS + EACH * sum(len(node.items) for node in roots))
    scope = Scope()
    if root is None:
        items = [*loose, *roots]
        return Expanded(header, (), tuple(work.elements(items, {}, scope)), scope, "", preceding, following)
    kind = work.type_of(root, {})
    merged = _merge(kind.items, root.items)
    name = header or root.name
    return Expanded(name, kind.names, tuple(work.elements(list(merged), {}, scope)), scope, root.name, preceding, following)


@cache
def standard_templates() -> Mapping[str, Node]:
    """The types of the standard vocabulary by name."""
    text = files("hymeko_x.language").joinpath("std/kinematics.hymeko").read_text(encoding="utf-8")
    return {item.name: item for item in parse(text, "std/kinematics.hymeko").items if isinstance(item, Node)}


def _without_outer_comments(document: Document) -> tuple[tuple[Comment, ...], Document, tuple[Comment, ...]]:
    """The comments before the last item, the document without comments, and the comments behind it."""
    numbers = [number for number, item in enumerate(document.items) if not isinstance(item, Comment)]
    last = numbers[-1] if numbers else 0
    preceding = tuple(item for item in document.items[:last] if isinstance(item, Comment))
    following = tuple(item for item in document.items[last:] if isinstance(item, Comment))
    return preceding, document._replace(items=tuple(document.items[number] for number in numbers)), following


def _split(document: Document) -> tuple[str, list[Node], list[Item]]:
    """The header name, the root nodes, and what stands beside them."""
    header = document.header
    roots: list[Node] = []
    loose: list[Item] = []
    for position, item in enumerate(document.items):
        if position == 0 and isinstance(item, Field) and item.value is None:
            header = item.name
        elif isinstance(item, Import) or (isinstance(item, Node) and item.parameters is not None):
            continue
        elif isinstance(item, Node) and not item.edge:
            roots.append(item)
        else:
            loose.append(item)
    settings = [node for node in roots if node.name == "units" and not isinstance(node.name, QuotedName)]
    bodies = [node for node in roots if node not in settings]
    if len(bodies) == 1 and not loose:
        return header, [bodies[0]._replace(items=(*settings, *bodies[0].items))], []
    return header, roots, loose


def _define(items: tuple[Item, ...], templates: dict[str, Node]) -> None:
    for item in items:
        if isinstance(item, Node) and item.parameters is not None:
            templates[item.name] = item


def _import(items: tuple[Item, ...], file: str, fetch: Fetch, templates: dict[str, Node], seen: _Imported) -> None:
    """Define what imported files define: by name, and by alias and name."""
    for item in items:
        if not isinstance(item, Import) or item.path.startswith("std/") or item.path == "std":
            continue
        origin = Origin(file, item.line or None, item.column or None)
        if item.path not in seen:
            seen[item.path] = None
            seen[item.path] = _definitions(item.path, fetch, templates, seen, origin)
        found = seen[item.path]
        if found is None:
            raise refuse(codes.BAD_TEMPLATE, f"the import of '{item.path}' leads back to itself", origin)
        templates.update(found)
        if item.alias:
            templates.update({f"{item.alias}.{name}": node for name, node in found.items()})


def _definitions(path: str, fetch: Fetch, templates: dict[str, Node], seen: _Imported, origin: Origin) -> dict[str, Node]:
    """What one imported file defines, after those that it imports itself."""
    if len(seen) > MAX_IMPORTS:
        raise refuse(codes.TOO_LARGE, f"more than {MAX_IMPORTS} files are imported", origin)
    data = fetch(path)
    if data is None:
        raise refuse(codes.UNDEFINED_REFERENCE, f"the imported file '{path}' was not found", origin)
    imported = parse(_decode(data, path), path)
    _import(imported.items, path, fetch, templates, seen)
    found: dict[str, Node] = {}
    _define(imported.items, found)
    return found


def _decode(data: bytes, name: str) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise refuse(codes.SYNTAX, f"byte {error.start} is not UTF-8", Origin(name)) from error


class _Expansion:
    """One run: the templates, and how many elements were made."""

    def __init__(self, file: str, templates: Mapping[str, Node], most: int) -> None:
        self._file = file
        self._templates = templates
        self._most = most
        self._made = 0

    # ---- elements ----------------------------------------------------------------------------------------------------------

    def elements(
        self, items: list[Item], environment: Environment, scope: Scope, depth: int = 0, *, made: bool = False
    ) -> list[Element | Statement]:
        """The elements of a block, with those of the assemblies in it in their place. ``made``: a template put them there."""
        found: list[Element | Statement] = []
        for item in items:
            if isinstance(item, Import) or (isinstance(item, Node) and item.parameters is not None):
                continue
            if isinstance(item, Node):
                found.extend(self._element(item, environment, scope, depth, made=made))
            else:
                found.append(Statement(self._plain(item, environment), scope))
        return found

    def _element(self, node: Node, environment: Environment, scope: Scope, depth: int, *, made: bool) -> list[Element | Statement]:
        if made:
            self._count(node, 1)
        name = self._text(node.name, environment, node)
        kind = self.type_of(node, environment)
        merged = _merge(kind.items, node.items)
        if "assembly" in kind.names:
            return self._assembly(node, name, merged, environment, scope, depth, made=made)
        scope.elements.add(name)
        plain = tuple(self._plain(self._refined(item, environment), environment) for item in merged if not isinstance(item, Import))
        return [Element(scope.full(name), node._replace(name=name, items=plain, stereotypes=()), kind.names, scope)]

    def _assembly(
        self, node: Node, name: str, items: tuple[Item, ...], environment: Environment, scope: Scope, depth: int, *, made: bool
    ) -> list[Element | Statement]:
        """What an assembly holds: its own nodes and comments, and the nodes of its template. One of the same name is continued."""
        if depth > MAX_DEPTH:
            hint = "an assembly that holds an instance of itself never ends"
            raise self._refuse(node, f"'{name}' is nested more than {MAX_DEPTH} levels deep", hint)
        inner = scope.scopes.setdefault(name, Scope(f"{scope.full(name)}_", scope))
        own = set(map(id, node.items))
        found: list[Element | Statement] = []
        for item in items:
            if isinstance(item, Node) or (isinstance(item, Comment) and id(item) in own):
                found.extend(self.elements([item], environment, inner, depth + 1, made=made or id(item) not in own))
        return found

    def _count(self, node: Node, items: int) -> None:
        self._made += items
        if self._made > self._most:
            raise refuse(codes.TOO_LARGE, f"the templates make more than {self._most} items", self._origin(node))

    # ---- types -------------------------------------------------------------------------------------------------------------

    def type_of(self, node: Node, environment: Environment) -> _Type:
        """All types of a node merged, the first one strongest, with their parameters filled in."""
        result = NO_TYPE
        for stereotype in node.stereotypes:
            kind = self._stereotype(stereotype, environment, node, ())
            result = _combined(result, kind)
        return result

    def _stereotype(self, stereotype: Stereotype, environment: Environment, node: Node, chain: tuple[str, ...]) -> _Type:
        name, preset = self._find(stereotype.ref, node)
        if name in chain or len(chain) > MAX_DEPTH:
            raise self._refuse(node, f"the template '{name}' applies itself: {' -> '.join([*chain, name])}")
        template = self._templates[name]
        if template is not standard_templates().get(name):
            self._count(node, 1 + len(template.items))
        inner = self._bind(template, stereotype, environment, node)
        base = NO_TYPE
        for parent in template.stereotypes:
            kind = self._stereotype(parent, inner, node, (*chain, name))
            base = _combined(base, kind)
        own = tuple(self._item(_named_class(item, name), inner) for item in template.items)
        return _Type((name, *base.names), (*_merge(base.items, own), *preset))

    def _find(self, ref: Ref, node: Node) -> tuple[str, tuple[Item, ...]]:
        """The template's name behind a type, and the ``type`` preset of a dotted one (``sensor.imu``)."""
        dotted = ref.dotted
        if dotted in self._templates:
            return dotted, ()
        path = ref.path[1:] if len(ref.path) > 1 and ref.path[0] not in self._templates else ref.path
        if ".".join(path) in self._templates:
            return ".".join(path), ()
        if len(path) == 2 and path[0] in self._templates:
            return path[0], (Field("type", path[1]),)
        raise self._unknown(dotted, node)

    def _unknown(self, name: str, node: Node) -> Refusal:
        from difflib import get_close_matches

        near = get_close_matches(name, self._templates, n=3)
        hint = f"did you mean {' or '.join(near)}?" if near else "the vocabulary is listed in the language reference"
        return refuse(codes.UNKNOWN_TYPE, f"'{node.name}' has the type '{name}', which is not known", self._origin(node), hint=hint)

    def _bind(self, template: Node, stereotype: Stereotype, environment: Environment, node: Node) -> Environment:
        """The parameters of a template with the values of one application."""
        given = dict(stereotype.arguments or ())
        bound: dict[str, float | str] = {}
        for parameter in template.parameters or ():
            value = given.pop(parameter.name, parameter.default)
            if value is None:
                hint = f"it has the parameters {', '.join(parameter.name for parameter in template.parameters or ())}"
                raise self._refuse(node, f"'{node.name}' applies '{template.name}' without its parameter '{parameter.name}'", hint)
            scope = environment if parameter.name in dict(stereotype.arguments or ()) else bound
            bound[parameter.name] = self._scalar(parameter.name, value, scope, node)
        if given:
            known = ", ".join(parameter.name for parameter in template.parameters or ()) or "no parameters"
            unknown = ", ".join(f"'{name}'" for name in given)
            raise self._refuse(node, f"'{node.name}' gives '{template.name}' the unknown parameter {unknown}; it has {known}")
        return bound

    def _scalar(self, name: str, value: Value, environment: Environment, node: Node) -> float | str:
        plain = self._value(value, environment, node)
        if isinstance(plain, float | str):
            return plain
        if isinstance(plain, Ref) and len(plain.path) == 1:
            return plain.path[0]
        hint = "pass a plain number in the unit of the field that uses it" if isinstance(plain, Quantity) else ""
        raise self._refuse(node, f"the parameter '{name}' takes a number or a text", hint)

    # ---- plain values ------------------------------------------------------------------------------------------------------

    def _plain(self, item: Item, environment: Environment) -> Field | ArcItem | Comment:
        return self._item(item, environment)  # type: ignore[return-value]

    def _item(self, item: Item, environment: Environment) -> Item:
        """The item with every expression replaced by its value."""
        if not environment and not _calculates(item):
            return item
        match item:
            case Field(value=None) | Import() | Comment():
                return item
            case Field():
                assert item.value is not None
                return item._replace(value=self._value(item.value, environment, item))
            case ArcItem():
                return self._arc(item, environment)
            case Node():
                items = tuple(self._item(inner, environment) for inner in item.items)
                types = tuple(self._arguments(stereotype, environment, item) for stereotype in item.stereotypes)
                return item._replace(name=self._text(item.name, environment, item), items=items, stereotypes=types)

    def _refined(self, item: Item, environment: Environment) -> Item:
        """A node inside an element, such as a shape, with what types of the text's own say of it."""
        standard = standard_templates()
        if not isinstance(item, Node) or all(
            kind.ref.dotted in standard or kind.ref.dotted not in self._templates for kind in item.stereotypes
        ):
            return item
        return item._replace(items=_merge(self.type_of(item, environment).items, item.items), stereotypes=())

    def _arguments(self, stereotype: Stereotype, environment: Environment, node: Node) -> Stereotype:
        if not stereotype.arguments:
            return stereotype
        return stereotype._replace(arguments=tuple((name, self._value(value, environment, node)) for name, value in stereotype.arguments))

    def _arc(self, arc: ArcItem, environment: Environment) -> ArcItem:
        weight = arc.weight
        if weight is not None:
            weight = tuple(self._value(value, environment, arc) for value in weight)
        path = tuple(self._text(step, environment, arc) for step in arc.ref.path)
        items = tuple(self._item(inner, environment) for inner in arc.items)
        return arc._replace(ref=arc.ref._replace(path=path), weight=weight, items=items)

    def _value(self, value: Value, environment: Environment, place: Item) -> Value:
        if type(value) is float:
            return value
        if type(value) is str:
            return self._text(value, environment, place)
        if isinstance(value, Expression):
            return self._evaluate(value.text, environment, place)
        if type(value) is tuple:
            return tuple(self._value(part, environment, place) for part in value)
        return value

    def _text(self, text: str, environment: Environment, place: Item) -> str:
        """A name or string with its ``${ }`` filled in, inside a template."""
        if not environment or "${" not in text:
            return text

        def fill(match: re.Match[str]) -> str:
            value = self._evaluate(match[1], environment, place)
            if isinstance(value, str):
                return value
            return str(int(value)) if value.is_integer() else repr(value)

        filled = _INTERPOLATION.sub(fill, text)
        if len(filled) > MAX_TEXT:
            raise refuse(codes.TOO_LARGE, f"a text grows to more than {MAX_TEXT} characters", self._origin(place))
        return type(text)(filled)

    def _evaluate(self, text: str, environment: Environment, place: Item) -> float | str:
        try:
            return evaluate(text.strip(), environment)
        except ExpressionError as error:
            raise refuse(codes.BAD_EXPRESSION, f"${{{text}}}: {error}", self._origin(place)) from error

    def _refuse(self, node: Node, message: str, hint: str = "") -> Refusal:
        return refuse(codes.BAD_TEMPLATE, message, self._origin(node), hint=hint)

    def _origin(self, item: Item) -> Origin:
        return Origin(self._file, item.line or None, item.column or None)


def _named_class(item: Item, name: str) -> Item:
    """The field ``class`` without a value means the template's own name."""
    return item._replace(value=name) if isinstance(item, Field) and item.name == "class" and item.value is None else item


def _calculates(item: Item | Value | None) -> bool:
    """Whether there is an expression in it."""
    match item:
        case float() | str() | None:
            return False
        case Expression():
            return True
        case Field():
            return _calculates(item.value)
        case ArcItem():
            return _calculates(item.weight) or any(map(_calculates, item.items))
        case Node():
            return any(map(_calculates, item.items)) or any(kind.arguments for kind in item.stereotypes)
        case Import() | Comment() | Ref():
            return False
    return any(map(_calculates, item))


def _combined(strong: _Type, weak: _Type) -> _Type:
    """Two types of one element: what the first one says counts."""
    return _Type(tuple(dict.fromkeys((*strong.names, *weak.names))), _merge(weak.items, strong.items))


def _merge(base: tuple[Item, ...], own: tuple[Item, ...]) -> tuple[Item, ...]:
    """The items of a type with those of its instance: a field given again takes the place of the preset, all else is added."""
    if not base:
        return own
    said = {slot: item for item in own if (slot := _slot(item)) is not None}
    replaced = [(_slot(item), item) for item in base]
    used = {slot for slot, _ in replaced} & set(said)
    merged = [said[slot] if slot is not None and slot in said else item for slot, item in replaced]
    return (*merged, *(item for item in own if _slot(item) not in used))


def _slot(item: Item) -> str | None:
    """What a field or role fills; None for items of which there may be many."""
    match item:
        case Field(name=name, value=value) if value is not None:
            return f"`{name}" if isinstance(name, QuotedName) else name
        case ArcItem(role=role) if role:
            return role
        case _:
            return None
