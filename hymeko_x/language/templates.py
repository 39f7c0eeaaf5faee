"""Templates and stereotypes: the definitions of a text and of its imports, and the items that the types of a node preset."""

from __future__ import annotations

import posixpath
from collections.abc import Callable, Mapping
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x import codes, formats
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.language.classes import IMPLIED, is_class, kind_of, settled
from hymeko_x.language.comments import without_comments
from hymeko_x.language.expressions import fill, fill_value
from hymeko_x.language.parser import parse
from hymeko_x.language.prototypes import Prototypes, meaning_of, role_of
from hymeko_x.language.syntax import ArcItem, Field, Import, Item, Node, Quantity, QuotedName, Ref, Stereotype, Using, Value, origin_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.diagnostics import Refusal
    from hymeko_x.language.expressions import Environment
    from hymeko_x.language.prototypes import Prototype

MAX_DEPTH = 64
"""Templates in templates, and assemblies in assemblies."""
MAX_IMPORTS = 200
COPY = "<<copy>>"
"""What stands before a type whose whole block an element has, and not the fields alone."""

Fetch = Callable[[str], bytes | None]
_Imported = dict[str, dict[str, Node] | None]  # the definitions of each file; None while it is being read


@cache
def standard_templates() -> Mapping[str, Node]:
    """The types of the standard vocabulary by name."""
    text = files("hymeko_x.language").joinpath("std/kinematics.hymeko").read_text(encoding="utf-8")
    return {item.name: item for item in parse(text, "std/kinematics.hymeko").items if isinstance(item, Node)}


def is_definition(item: Item) -> bool:
    """Whether an item defines a template, or imports some, and is no element itself."""
    return isinstance(item, Import | Using) or (isinstance(item, Node) and item.parameters is not None)


class Definitions(NamedTuple):
    """What the types of a text may name: templates, the imports of files whose robots are types, by alias, and prototypes.

    ``texts`` are the items of the text, named "", and of those that it imports; ``short`` are the names that stand for paths.
    """

    templates: dict[str, Node]
    robots: dict[str, Import]
    texts: list[tuple[str, tuple[Item, ...]]]
    short: dict[str, tuple[str, ...]]


def definitions(items: tuple[Item, ...], roots: list[Node], file: str, fetch: Fetch) -> Definitions:
    """The standard types, those of imported files (also by alias and name), of the roots, and of the text itself.

    Raises: Refusal (HX060, HX063, HX040, HX007) at the import.
    """
    found = Definitions(dict(standard_templates()), {}, [("", items)], {})
    for block in (items, *(node.items for node in items if isinstance(node, Node))):
        found.short.update({item.alias: item.ref.path for item in block if isinstance(item, Using)})
    _import(items, file, fetch, found, {})
    headers = [item for item in items if isinstance(item, Node) and item not in roots]
    for node in (*headers, *roots):
        _import(node.items, file, fetch, found, {})
        found.templates.update(_definitions(node.items))
    found.templates.update(_definitions(items))
    return found


def _definitions(items: tuple[Item, ...]) -> dict[str, Node]:
    return {item.name: item for item in items if isinstance(item, Node) and item.parameters is not None}


def _import(items: tuple[Item, ...], file: str, fetch: Fetch, found: Definitions, seen: _Imported) -> None:
    """Add the definitions of imported files, by name, and by alias and name; an alias alone is the robot in the file."""
    for item in items:
        if not isinstance(item, Import) or item.path.startswith("std/") or item.path == "std":
            continue
        origin = origin_of(item, file)
        if item.alias:
            found.robots[item.alias] = item
        if not _is_text(item.path):
            if not item.alias:
                hint = f'import "{item.path}" as robot'
                raise refuse(codes.BAD_TEMPLATE, f"the robot in '{item.path}' is imported without a name for it", origin, hint=hint)
            continue
        if item.path not in seen:
            seen[item.path] = None
            seen[item.path] = _imported(item.path, fetch, found, seen, origin)
        defined = seen[item.path]
        if defined is None:
            raise refuse(codes.BAD_TEMPLATE, f"the import of '{item.path}' leads back to itself", origin)
        found.templates.update(defined)
        if item.alias:
            found.templates.update({f"{item.alias}.{name}": node for name, node in defined.items()})


def _is_text(path: str) -> bool:
    """Whether the suffix of an imported file leaves open that it is text of this language."""
    row = formats.of_file(path)
    return row is None or row is formats.OWN


def _imported(path: str, fetch: Fetch, found: Definitions, seen: _Imported, origin: Origin) -> dict[str, Node]:
    """The definitions of one imported file, after those of its own imports."""
    if len(seen) > MAX_IMPORTS:
        raise refuse(codes.TOO_LARGE, f"more than {MAX_IMPORTS} files are imported", origin)
    data = next((data for above in ("", "../", "../../") if (data := fetch(above + path)) is not None), None)
    if data is None:
        hint = "it is looked for beside the text, and in the two folders above"
        raise refuse(codes.UNDEFINED_REFERENCE, f"the imported file '{path}' was not found", origin, hint=hint)
    items = parse(decode(data, path), path).items
    _import(items, path, fetch, found, seen)
    found.texts.append((posixpath.splitext(posixpath.basename(path))[0], items))
    return _definitions(items)


def decode(data: bytes, name: str) -> str:
    """The text of a file.

    Raises: Refusal (HX060) for bytes that are not UTF-8.
    """
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise refuse(codes.SYNTAX, f"byte {error.start} is not UTF-8", Origin(name)) from error


class Preset(NamedTuple):
    """The types of a node, from the nearest to the base, the items that they preset, and whether one of them is a vertex or an edge."""

    types: tuple[str, ...] = ()
    items: tuple[Item, ...] = ()
    has_prototype: bool = False


def place_of(node: Node) -> tuple[str, int, int]:
    """The name of a node, and where it stands."""
    return str(node.name), node.line, node.column


class Templates:
    """The templates of one text, and how many items they have made."""

    def __init__(self, file: str, defined: Definitions, most: int) -> None:
        self._file = file
        self._templates = defined.templates
        self._robots = defined.robots
        self.prototypes = Prototypes(defined.texts, defined.short)
        self.applied: set[tuple[str, int, int]] = set()
        self._most = most
        self._made = 0

    def count(self, node: Node, items: int) -> None:
        """Count items that a template makes.

        Raises: Refusal (HX007) when there are too many.
        """
        self._made += items
        if self._made > self._most:
            raise refuse(codes.TOO_LARGE, f"the templates make more than {self._most} items", origin_of(node, self._file))

    def robot(self, node: Node) -> tuple[Import, Stereotype] | None:
        """The import whose robot a node is an instance of, and the type with its arguments.

        Raises: Refusal (HX063) when it has other types as well.
        """
        for stereotype in node.stereotypes:
            found = self._robots.get(stereotype.ref.dotted)
            if found is None or stereotype.ref.dotted in self._templates:
                continue
            if len(node.stereotypes) > 1:
                raise self.refuse(node, f"'{node.name}' is the robot '{stereotype.ref.dotted}' and cannot have other types")
            return found, stereotype
        return None

    def preset(self, node: Node, environment: Environment) -> Preset:
        """All types of a node merged, the first one strongest, with their parameters filled in.

        Raises: Refusal (HX061, HX063, HX064) at the node.
        """
        result = Preset()
        for stereotype in node.stereotypes:
            result = _combined(result, self._applied(stereotype, environment, node, ()))
        return result

    def refine(self, item: Item, environment: Environment) -> Item:
        """A node inside an element, such as a shape, with the items of those of its types that the text defines."""
        standard = standard_templates()
        if not isinstance(item, Node) or all(
            kind.ref.dotted in standard or kind.ref.dotted not in self._templates for kind in item.stereotypes
        ):
            return item
        return item._replace(items=settled(merge(self.preset(item, environment).items, item.items)), stereotypes=())

    def _applied(self, stereotype: Stereotype, environment: Environment, node: Node, chain: tuple[str, ...]) -> Preset:
        prototype = self._prototype(stereotype.ref, node)
        if prototype is not None:
            return self._of_prototype(prototype, node, chain, copies=stereotype.ref.modifier == COPY)
        name, preset = self._find(stereotype.ref, node)
        if name in chain or len(chain) > MAX_DEPTH:
            raise self.refuse(node, f"the template '{name}' applies itself: {' -> '.join([*chain, name])}")
        template = self._templates[name]
        if is_class(template):
            return Preset((name,), (*self._of_class(template, node), *preset))
        if template is not standard_templates().get(name):
            self.count(node, 1 + len(template.items))
        inner = self._bind(template, stereotype, environment, node)
        base = Preset()
        for parent in template.stereotypes:
            base = _combined(base, self._applied(parent, inner, node, (*chain, name)))
        own = tuple(fill(_named_class(item, name), inner, self._file) for item in template.items)
        return Preset((name, *base.types), (*merge(base.items, own), *preset))

    def _of_class(self, template: Node, node: Node) -> tuple[Item, ...]:
        """What a default class gives to an element: the fields for its kind, and the class itself."""
        kind = kind_of(node, self._bases(node))
        blocks = {item.name: item.items for item in template.items if isinstance(item, Node)}
        self.count(node, 1 + len(blocks.get(kind, ())))
        return (*blocks.get(kind, ()), *(item for item in template.items if isinstance(item, Field)))

    def _bases(self, node: Node) -> Iterator[str]:
        """The standard types of a node, through the templates of the text."""
        stack = [*node.stereotypes]
        seen: set[str] = set()
        while stack:
            path = stack.pop(0).ref.path
            name = ".".join(path) if ".".join(path) in self._templates else path[0]
            template = self._templates.get(name)
            if template is None or name in seen or is_class(template):
                continue
            seen.add(name)
            if name in standard_templates():
                yield ".".join(path)
                yield name
            stack.extend(template.stereotypes)

    def is_known(self, ref: Ref) -> bool:
        """Whether a type is a template; one that is none may be a place where types are."""
        return ref.dotted in self._templates or self.prototypes.find(ref.path) is None

    def _prototype(self, ref: Ref, node: Node) -> Prototype | None:
        """The vertex or edge that is a type, where no template has the name.

        In a robot called ``sensor`` the type ``sensor.gyro`` is that of all gyroscopes, and not an element ``gyro`` of the robot.
        """
        if ref.dotted in self._templates:
            return None
        found = self.prototypes.find(ref.path)
        if found is None or not isinstance(found.item, Node) or (found.path == ref.path and ref.path[0] in standard_templates()):
            return None
        return None if place_of(found.item) == place_of(node) else found

    def _of_prototype(self, prototype: Prototype, node: Node, chain: tuple[str, ...], *, copies: bool) -> Preset:
        """The fields of a prototype and of its own types, and what its name means for a robot; of one that it ``copies`` the whole block.

        Raises: Refusal (HX063) for one that is a type of itself.
        """
        name = ".".join(prototype.path)
        if name in chain or len(chain) > MAX_DEPTH:
            message = f"the type '{name}' leads back to itself: {' -> '.join([*chain, name])}"
            raise self.refuse(node, message, "one of them stands without a type")
        assert isinstance(prototype.item, Node)
        self.count(node, 1 + len(prototype.item.items))
        given = without_comments(prototype.item).items if copies else self.prototypes.fields_of(prototype.item)
        self.applied.add(place_of(prototype.item))
        result = Preset((name,), given, has_prototype=True)
        for parent in prototype.item.stereotypes:
            result = _combined(result, self._applied(parent, {}, prototype.item, (*chain, name)))
        meaning = meaning_of(prototype.item.name)
        return result if meaning is None else _combined(result, self._applied(Stereotype(Ref((meaning,))), {}, node, ()))

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
        from difflib import get_close_matches

        near = get_close_matches(dotted, [*self._templates, *self._robots], n=3)
        hint = f"did you mean {' or '.join(near)}?" if near else "the vocabulary is listed in the language reference"
        message = f"'{node.name}' has the type '{dotted}', which is not known"
        raise refuse(codes.UNKNOWN_TYPE, message, origin_of(node, self._file), hint=hint)

    def _bind(self, template: Node, stereotype: Stereotype, environment: Environment, node: Node) -> Environment:
        """The parameters of a template with the values of one application."""
        given = dict(stereotype.arguments or ())
        names = ", ".join(parameter.name for parameter in template.parameters or ())
        bound: dict[str, float | str] = {}
        for parameter in template.parameters or ():
            scope = environment if parameter.name in given else bound
            value = given.pop(parameter.name, parameter.default)
            if value is None:
                message = f"'{node.name}' applies '{template.name}' without its parameter '{parameter.name}'"
                raise self.refuse(node, message, f"it has the parameters {names}")
            bound[parameter.name] = self.scalar(parameter.name, value, scope, node)
        if given:
            unknown = ", ".join(f"'{name}'" for name in given)
            message = f"'{node.name}' gives '{template.name}' the unknown parameter {unknown}; it has {names or 'no parameters'}"
            raise self.refuse(node, message)
        return bound

    def scalar(self, name: str, value: Value, environment: Environment, node: Node) -> float | str:
        """The value of a parameter of a template or of a robot. Raises: Refusal (HX063, HX064) at the node."""
        plain = fill_value(value, environment, node, self._file)
        if isinstance(plain, float | str):
            return plain
        if isinstance(plain, Ref) and len(plain.path) == 1:
            return plain.path[0]
        hint = "pass a plain number in the unit of the field that uses it" if isinstance(plain, Quantity) else ""
        raise self.refuse(node, f"the parameter '{name}' takes a number or a text", hint)

    def refuse(self, node: Node, message: str, hint: str = "") -> Refusal:
        """A refusal (HX063) at a node."""
        return refuse(codes.BAD_TEMPLATE, message, origin_of(node, self._file), hint=hint)


def _named_class(item: Item, name: str) -> Item:
    """The field ``class`` without a value means the template's own name."""
    return item._replace(value=name) if isinstance(item, Field) and item.name == "class" and item.value is None else item


def _combined(strong: Preset, weak: Preset) -> Preset:
    """The presets of two types of one element: the first one wins."""
    types = tuple(dict.fromkeys((*strong.types, *weak.types)))
    return Preset(types, merge(weak.items, strong.items), strong.has_prototype or weak.has_prototype)


def merge(base: tuple[Item, ...], own: tuple[Item, ...]) -> tuple[Item, ...]:
    """The items of a type with those of its instance: a field given again takes the place of the preset, all else is added."""
    if not base:
        return own
    given = {slot: item for item in own if (slot := _slot(item)) is not None}
    replaced = [(slot, item) for item in base if (slot := _slot(item)) not in given or not _is_of_class(item)]
    used = {slot for slot, _ in replaced} & set(given)
    merged = [given[slot] if slot is not None and slot in given else item for slot, item in replaced]
    return (*merged, *(item for item in own if _slot(item) not in used))


def _is_of_class(item: Item) -> bool:
    """Whether it is a field that a default class gives; one that is given again stands in its own place."""
    return isinstance(item, Field) and item.type == IMPLIED


def _slot(item: Item) -> str | None:
    """The name of a field or the role of an arc; None for items of which there may be many."""
    match item:
        case Field(name=name, value=value) if value is not None:
            return f"`{name}" if isinstance(name, QuotedName) else name
        case ArcItem():
            return role_of(item) or None
        case _:
            return None
