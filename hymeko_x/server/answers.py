"""What the server answers about a HyMeKo text: names, types, units, places and layouts."""

from __future__ import annotations

import re
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lsprotocol import types

from hymeko_x.diagnostics import Refusal
from hymeko_x.ir.digits import number_text, numbers_text
from hymeko_x.ir.ids import KINDS
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.parts import Body, Joint
from hymeko_x.ir.values import rpy_from_quat
from hymeko_x.language.formatting import format_text
from hymeko_x.language.templates import standard_templates
from hymeko_x.robot.kinematics import all_poses
from hymeko_x.server.text import NodeDefinition, PathWord, heads, unquoted, word_at, words

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from hymeko_x.server.analysis import Analysis

    Texts = Callable[[Path], Analysis | None]
    """The HyMeKo text at a path; None where there is none."""

_HEAD = re.compile(r"(@?)\s*(`[^`]*`|[^\W\d]\w*)?[^:]*(?::\s*([\w.`]+))?")
_QUANTITY = re.compile(r"(?<![\w.])[+-]?(\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?(?![eE][+-]?\d)([A-Za-z%°µ][\w/^*%·-]*)")
_FIELD_AT_END = re.compile(r"(=|:|->|<-|[+~-])\s*[\w.`]*$")
_KINDS = tuple(KINDS.values())


# ---- names ---------------------------------------------------------------------------------------------------------------------


def definition_of(document: Analysis, word: PathWord) -> NodeDefinition | None:
    """Where a name is defined: the definition that ends with its path, the one with fewest names around it where there are several."""
    path = word.path[1:] if len(word.path) > 1 and word.path[0] in _KINDS else word.path
    is_type = document.text[max(word.start - 9, 0) : word.start].rstrip()[-1:] == ":"
    same = (found for found in document.by_name.get(path[-1], ()) if found.path[-len(path) :] == path)
    own = [found for found in same if not is_type or _is_template(document, found)]
    here = next((found for found in own if found.start <= word.start <= found.end), None)
    return here or min(own, key=lambda found: len(found.path), default=None)


def _is_template(document: Analysis, found: NodeDefinition) -> bool:
    return document.text[found.end : found.end + 1] == "("


def definition(document: Analysis, position: types.Position, texts: Texts) -> types.Location | None:
    """The place where the name at a position is defined: in this text, or in a file that it imports."""
    offset = document.places.offset(position)
    imported = _import_at(document, offset)
    if imported is not None:
        return types.Location(Path(imported).resolve().as_uri(), types.Range(types.Position(0, 0), types.Position(0, 0)))
    word = word_at(document.text, offset)
    if word is None:
        return None
    found = definition_of(document, word)
    if found is not None and len(found.path) >= len(word.path):
        return types.Location(Path(document.path).resolve().as_uri(), document.places.range(found.start, found.end))
    return _in_another_file(document, word) or _template_in_another_file(document, word, texts)


def _import_at(document: Analysis, offset: int) -> str | None:
    """The imported file whose path, or whose alias, stands at an offset."""
    for match in re.finditer(r'\bimport\s+"([^"\n]+)"', document.text):
        if match.start(1) <= offset <= match.end(1):
            return str(Path(document.path).parent / match[1])
    word = word_at(document.text, offset)
    known = document.imports()
    if word is not None and len(word.path) == 1 and word.path[0] in known and definition_of(document, word) is None:
        return str(Path(document.path).parent / known[word.path[0]])
    return None


def _in_another_file(document: Analysis, word: PathWord) -> types.Location | None:
    """The place of an element of an imported robot."""
    key = _element(document, word)
    origin = document.robot.origins.get(key) if document.robot is not None and key is not None else None
    if origin is None or not Path(origin.file).is_file():
        return None
    place = types.Position((origin.line or 1) - 1, max((origin.column or 1) - 1, 0))
    return types.Location(Path(origin.file).resolve().as_uri(), types.Range(place, place))


def _template_in_another_file(document: Analysis, word: PathWord, texts: Texts) -> types.Location | None:
    """The place of a template of an imported text, with the import's alias before its name or without."""
    known = document.imports()
    path = word.path[1:] if word.path[0] in known else word.path
    for given in dict.fromkeys(known.values()):
        other = texts(Path(document.path).parent / given)
        found = None if other is None else next((one for one in other.by_name.get(path[-1], ()) if one.path == path), None)
        if other is not None and found is not None:
            return types.Location(Path(other.path).resolve().as_uri(), other.places.range(found.start, found.end))
    return None


def _element(document: Analysis, word: PathWord) -> Id | None:
    """The element of the robot that a name means."""
    if document.robot is None:
        return None
    path = word.path[1:] if len(word.path) > 1 and word.path[0] in _KINDS else word.path
    names = {"_".join(path[start:]) for start in range(len(path))}
    graph = document.robot.graph
    found = definition_of(document, word)
    full = "_".join(found.path[1:]) if found is not None else "_".join(path)
    for name in (full, "_".join(path), *sorted(names, key=len, reverse=True)):
        for kind in _KINDS:
            if Id(kind, name) in graph:
                return Id(kind, name)
    return None


def references(document: Analysis, position: types.Position) -> list[types.Range]:
    """Every place of the name at a position, its definition among them."""
    word = word_at(document.text, document.places.offset(position))
    target = None if word is None else definition_of(document, word)
    if word is None or target is None:
        return []
    last = target.path[-1]
    same = (other for other in words(document.text) if other.path[-1] == last)
    return [document.places.range(other.start, other.end) for other in same if definition_of(document, other) == target]


# ---- hover ---------------------------------------------------------------------------------------------------------------------


def hover(document: Analysis, position: types.Position) -> types.Hover | None:
    """What is known of the name at a position: an element with its world pose, a type, or a field with its form and dimension."""
    offset = document.places.offset(position)
    word = word_at(document.text, offset)
    if word is None:
        return None
    lines = list(_lines_about(document, word, offset))
    if not lines:
        return None
    value = types.MarkupContent(types.MarkupKind.Markdown, "\n\n".join(lines))
    return types.Hover(value, document.places.range(word.start, word.end))


def _lines_about(document: Analysis, word: PathWord, offset: int) -> Iterator[str]:
    name = word.path[-1]
    fields = _fields(document, _kind_around(document, offset))
    if len(word.path) == 1 and name in fields:
        yield f"`{name}`: {fields[name]}"
        return
    key = _element(document, word)
    if key is not None:
        yield from _of_element(document, key)
    elif name in standard_templates():
        yield f"type `{name}`" + (f" of a {kind}" if (kind := _kind_of(document, name)) else "")
    elif name in document.imports():
        yield f"the robot in `{document.imports()[name]}`"
    elif definition_of(document, word) is not None:
        yield f"template `{name}`"


def _of_element(document: Analysis, key: Id) -> Iterator[str]:
    robot = document.robot
    assert robot is not None
    yield f"**{key.kind}** `{key.name}`"
    part = robot.graph.vertices.get(key) or robot.graph.edges[key].data
    if isinstance(part, Body):
        if part.inertial is not None and part.inertial.mass is not None:
            yield f"mass {number_text(part.inertial.mass)} kg, centre [{numbers_text(part.inertial.com)}] m"
        pose = all_poses(robot, {}).get(key)
        if pose is not None:
            xyz, rpy = (tuple(round(value, 6) + 0.0 for value in numbers) for numbers in (pose.xyz, rpy_from_quat(pose.quat)))
            yield f"in the world: [{numbers_text(xyz)}] m, rpy [{numbers_text(rpy)}] rad"
    elif isinstance(part, Joint):
        view = robot.joints.get(key)
        ends = "" if view is None else f", from `{view.parent.name}` to `{view.child.name}`"
        yield f"{' + '.join(dof.kind.value for dof in part.dofs) or 'fixed'}{ends}"
        for dof in part.dofs:
            if dof.limits.lower is not None or dof.limits.upper is not None:
                yield f"from {dof.limits.lower} to {dof.limits.upper} {'m' if dof.kind.value == 'slide' else 'rad'}"


# ---- completion ----------------------------------------------------------------------------------------------------------------


def completion(document: Analysis, position: types.Position) -> list[types.CompletionItem]:
    """What may stand at a position: types behind a colon, elements behind a direction, units behind a number, else fields."""
    offset = document.places.offset(position)
    vocabulary = _vocabulary(document)
    before = document.text[document.text.rfind("\n", 0, offset) + 1 : offset]
    if re.search(r"(?<![\w.])[+-]?\d[\d.]*[A-Za-z°µ%]*$", before):
        return [_item(unit, types.CompletionItemKind.Unit) for unit in (() if vocabulary is None else vocabulary.units())]
    behind = _FIELD_AT_END.search(before)
    if behind is not None and behind[1] == ":":
        return _types(document)
    if behind is not None:
        return _elements(document, before)
    fields = _fields(document, _kind_around(document, offset))
    return [_item(name, types.CompletionItemKind.Field, text) for name, text in fields.items()] + _elements(document, before)


def _types(document: Analysis) -> list[types.CompletionItem]:
    own = [found.path[-1] for found in document.definitions if _is_template(document, found)]
    aliases = [name for name in document.imports() if re.fullmatch(r"\w+", name)]
    return [_item(name, types.CompletionItemKind.Class) for name in dict.fromkeys((*own, *aliases, *standard_templates()))]


def _elements(document: Analysis, before: str) -> list[types.CompletionItem]:
    """The elements of the text, or those within a group whose name and dot stand before."""
    group = re.search(r"([\w.]+)\.\w*$", before)
    if group is not None:
        prefix = group[1].replace(".", "_") + "_"
        graph = None if document.robot is None else document.robot.graph
        found = [] if graph is None else [key for table in (graph.vertices, graph.edges) for key in table if key.name.startswith(prefix)]
        return [_item(name, types.CompletionItemKind.Variable) for name in dict.fromkeys(key.name.removeprefix(prefix) for key in found)]
    names = dict.fromkeys(found.path[-1] for found in document.definitions[1:])
    return [_item(name, types.CompletionItemKind.Variable) for name in names]


def _item(label: str, kind: types.CompletionItemKind, detail: str | None = None) -> types.CompletionItem:
    return types.CompletionItem(label, kind=kind, detail=detail)


def _fields(document: Analysis, kind: str) -> Mapping[str, str]:
    vocabulary = _vocabulary(document)
    found: Mapping[str, str] = {} if vocabulary is None else vocabulary.fields_of(kind)
    return found


def _vocabulary(document: Analysis) -> Any:
    """The module with the fields and units of the language."""
    row = document.format
    return None if row is None or row.vocabulary is None else import_module(row.vocabulary)


def _kind_around(document: Analysis, offset: int) -> str:
    """The kind of the element in whose block an offset is."""
    around = heads(document.text, offset)
    head = _HEAD.match(around[-1]) if around else None
    if head is None:
        return ""
    if head[3]:
        return _kind_of(document, unquoted(head[3].partition(".")[0]))
    if head[1]:
        return "joint"
    if unquoted(head[2] or "") in ("visual", "collision", "shape", "geometry"):
        return "shape"
    return "body" if len(around) > 1 else ""


def _kind_of(document: Analysis, name: str) -> str:
    """The kind of elements of a type."""
    templates = standard_templates()
    for _ in range(20):
        template = templates.get(name)
        if template is None:
            own = next((found for found in document.definitions if found.path[-1] == name), None)
            following = None if own is None else re.match(r"(\w+)", own.types)
            if following is None:
                return ""
            name = following[1]
            continue
        kind = next((getattr(item, "value", None) for item in template.items if getattr(item, "name", "") == "kind"), None)
        if isinstance(kind, str):
            return kind
        if not template.stereotypes:
            return ""
        name = template.stereotypes[0].ref.dotted
    return ""


# ---- the whole text ------------------------------------------------------------------------------------------------------------


def symbols(document: Analysis) -> list[types.DocumentSymbol]:
    """The nodes of the text as a tree."""
    top: list[types.DocumentSymbol] = []
    stack: list[tuple[int, list[types.DocumentSymbol]]] = [(len(document.text) + 1, top)]
    for found in document.definitions:
        children: list[types.DocumentSymbol] = []
        symbol = types.DocumentSymbol(
            name=found.path[-1] or "``",
            kind=types.SymbolKind.Event if found.is_edge else types.SymbolKind.Object,
            range=document.places.range(found.first, found.last),
            selection_range=document.places.range(found.start, found.end),
            detail=found.types or None,
            children=children,
        )
        while stack[-1][0] <= found.first:
            stack.pop()
        stack[-1][1].append(symbol)
        stack.append((found.last, children))
    return top


def folding(document: Analysis) -> list[types.FoldingRange]:
    """The blocks of several lines."""
    ranges = [document.places.range(found.first, found.last) for found in document.definitions]
    return [types.FoldingRange(found.start.line, found.end.line - 1) for found in ranges if found.end.line > found.start.line + 1]


def formatting(document: Analysis) -> list[types.TextEdit]:
    """The edit that gives the text its usual layout; none where it cannot be parsed."""
    try:
        new = format_text(document.text, document.path)
    except Refusal:
        return []
    return [] if new == document.text else [types.TextEdit(document.places.range(0, len(document.text)), new)]


def inlays(document: Analysis, range: types.Range) -> list[types.InlayHint]:
    """Behind each number with a unit its value in SI."""
    first, last = document.places.offset(range.start), document.places.offset(range.end)
    found: list[types.InlayHint] = []
    vocabulary = _vocabulary(document)
    if vocabulary is None:
        return found
    for match in _QUANTITY.finditer(document.text, first, last):
        unit = vocabulary.si_of(match[2])
        if unit is None or unit[0] == 1.0:
            continue
        value = float(match[0].removesuffix(match[2])) * unit[0]
        label = f"= {number_text(float(f'{value:.6g}'))} {unit[1]}".rstrip()
        found.append(types.InlayHint(document.places.position(match.end()), label, padding_left=True))
    return found
