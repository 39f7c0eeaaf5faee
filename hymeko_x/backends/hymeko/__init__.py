"""Mechanism to canonical HyMeKo text: defaults are not written, and parts that are used once stand where they are used.

Elements stand in the order in which their author wrote them (``Mechanism.layout``), all others behind, by kind.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.backends.hymeko.assemblies import PieceInstance, assemblies, pieces_of, templates
from hymeko_x.backends.hymeko.bodies import body_items, files_prefix, given_names, inline_assets
from hymeko_x.backends.hymeko.extras import foreign_items, is_standing, standing_items, without_namespaces
from hymeko_x.backends.hymeko.implied import fits_in, implied_actuators
from hymeko_x.backends.hymeko.joints import dof_node, joint_items, mimic_arcs
from hymeko_x.backends.hymeko.nesting import name_of, nesting_of
from hymeko_x.backends.hymeko.parts import attached_arcs, part_items
from hymeko_x.backends.hymeko.sharing import shared_joints
from hymeko_x.backends.hymeko.sheet import HymekoSheet, written_items
from hymeko_x.backends.hymeko.stereotypes import with_stereotypes
from hymeko_x.backends.hymeko.values import ExplicitAngles, shortest_angles
from hymeko_x.formats import native_format
from hymeko_x.formats.hymeko import AXES, RESERVED, ROOT_NAME
from hymeko_x.formats.hymeko.classes import classes_in_force
from hymeko_x.formats.hymeko.nesting import BLOCK_SETTINGS
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import ROOT, WORLD, Id
from hymeko_x.ir.provenance import kept_notations
from hymeko_x.language.classes import PLAIN_UNITS, given_fields, is_class, is_section
from hymeko_x.language.markup import sound_comment
from hymeko_x.language.printer import print_document
from hymeko_x.language.syntax import Comment, Document, Field, Item, Node, QuotedName, Ref, Stereotype
from hymeko_x.language.templates import standard_templates
from hymeko_x.source import Package

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from hymeko_x.backends.hymeko.assemblies import Piece, Row
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Extra, Mechanism
    from hymeko_x.language.classes import Given
    from hymeko_x.rewrite.context import Options

_MOST_TRIES = 4
"""How often assemblies are chosen anew because names in them would hide others, before there are none."""
_INLINE_EDGES = frozenset({"shape"})
_PLAIN = frozenset({"datum", "relation", "nest"})
_ORDER = ("world", "material", "texture", "layer", "mesh", "body", "joint", "frame", "camera", "light", "sensor", "mount")


def write(mechanism: Mechanism, options: Options, report: Report) -> Package:
    """The text as the only file of a package; other files stay where they are and are referred to."""
    return Package(print_document(document(mechanism)).encode("utf-8"))


def write_flat(mechanism: Mechanism, options: Options, report: Report) -> Package:
    """The text in which every element stands by itself and every angle has its unit: what two mechanisms share looks the same in both."""
    return Package(print_document(document(mechanism, flat=True)).encode("utf-8"))


def document(mechanism: Mechanism, *, flat: bool = False) -> Document:
    """The syntax tree of a mechanism; ``flat`` as :func:`write_flat`."""
    mechanism = without_namespaces(mechanism)
    plain = _is_plain(mechanism)
    inline = inline_assets(mechanism)
    root = mechanism.notation(ROOT, ROOT_NAME)
    name = root if root is not None else mechanism.name
    around = None if flat or plain else _classes(mechanism)
    mimics = mimic_arcs(mechanism)
    sheet = HymekoSheet(
        mechanism,
        "" if flat else files_prefix(mechanism),
        inline,
        given_names(mechanism, inline),
        mimics,
        attached_arcs(mechanism),
        ExplicitAngles() if flat else shortest_angles(mechanism, may_round=around is None),
        nesting=nesting_of(mechanism, name),
        around=around,
        is_flat=flat,
    )
    if not flat:
        sheet = replace(sheet, names={}, shared=shared_joints(mechanism, mimics, _behind_comments(sheet)))
        sheet.implied.update(implied_actuators(mechanism, sheet.names))
    items = _settings(sheet, plain)
    items += [item for row in _rows(sheet) for item in _texts({"": sheet}, row, {})] if plain or flat else _grouped(sheet)
    header = mechanism.name if root is not None else ""
    kind = Stereotype(Ref(("graph" if plain else "robot",)))
    node = Node(name_of(name), tuple(items), (kind,))
    preceding, following = _outer_comments(mechanism)
    return Document((*preceding, node, *following), header)


def _classes(mechanism: Mechanism) -> Mapping[Id, str] | None:
    """The default classes in force at its elements, where it has one section of them; see :attr:`HymekoSheet.around`."""
    sections = sum(map(is_section, mechanism.extras.get(ROOT, ())))
    return classes_in_force(mechanism) if sections == 1 and native_format(mechanism) is not None else None


def _outer_comments(mechanism: Mechanism) -> tuple[list[Item], list[Item]]:
    """The comments before and behind the root."""
    outer = [extra for extra in mechanism.extras.get(ROOT, ()) if _is_outer(extra)]
    outer.sort(key=lambda extra: extra.index)
    before: list[Item] = [Comment(extra.text) for extra in outer if extra.path == "preceding"]
    after: list[Item] = [Comment(extra.text) for extra in outer if extra.path == "following"]
    return before, after


def _is_outer(extra: Extra) -> bool:
    return extra.format == "comment" and extra.path in ("preceding", "following") and sound_comment(extra.text)


def _is_plain(mechanism: Mechanism) -> bool:
    """Whether the graph has no robot in it: data and relations only."""
    keys = [*mechanism.graph.vertices, *mechanism.graph.edges]
    return bool(keys) and all(key.kind in _PLAIN for key in keys)


def _settings(sheet: HymekoSheet, plain: bool) -> list[Item]:
    """The head of the root: units, the prefix of files, notations and extras of the whole."""
    items: list[Item] = []
    if not plain and not sheet.angles.degrees:
        items.append(Node("units", (Field("angle"), Field("rad"))))
    if not plain and sheet.angles.digits:
        items.append(Node("units", (Field("digits", float(sheet.angles.digits)),)))
    if sheet.files:
        items.append(Field("files", sheet.files))
    notations = {
        key: text
        for key, text in kept_notations(sheet.mechanism.notations, sheet.mechanism.source).get(ROOT, {}).items()
        if key != ROOT_NAME.name
    }
    if notations:
        items.extend(written_items(notations, flags=False))
    items.extend(foreign_items(_in_place(sheet.mechanism)[1]))
    return items


def _grouped(sheet: HymekoSheet) -> list[Item]:
    """The elements with their stereotypes, those of one prefix in assemblies."""
    refused: frozenset[str] = frozenset()
    for tries in range(_MOST_TRIES + 1):
        rows = _rows(sheet)
        homes = assemblies(rows, sheet, refused) if tries < _MOST_TRIES else {}
        if not _with_implied(homes, sheet):
            continue
        names = {key.name: home for key, home in homes.items()}
        within = {home: replace(sheet, homes=names, inside=home) for home in ("", *names.values())}
        texts = [_texts(within, row, homes) for row in rows]
        if not sheet.clashes:
            break
        refused |= sheet.clashes
        sheet.clashes.clear()
    return _assembled(pieces_of(rows, texts, homes), _given(sheet))


def _with_implied(homes: dict[Id, str], sheet: HymekoSheet) -> bool:
    """Put implied actuators where their drives stand; False where some cannot be named there, which are implied no longer."""
    unfit = [actuator for actuator, drive in sheet.implied.items() if not fits_in(homes.get(drive, ""), actuator, sheet.names)]
    homes.update({actuator: homes[drive] for actuator, drive in sheet.implied.items() if drive in homes})
    for actuator in unfit:
        del sheet.implied[actuator]
    return not unfit


def _given(sheet: HymekoSheet) -> Given:
    """What the default classes give to their elements, where they are stereotypes."""
    if sheet.around is None:
        return {}
    texts = [extra.text for extra in sheet.mechanism.extras.get(ROOT, ())]
    reserved = {*standard_templates(), *RESERVED}
    given = given_fields(texts, PLAIN_UNITS if sheet.angles.degrees else {**PLAIN_UNITS, "angle": "rad"})
    return {name: kinds for name, kinds in given.items() if name not in reserved}


def _assembled(pieces: Sequence[Piece], given: Given) -> list[Item]:
    """The stereotypes and templates, then the pieces: as they are, in assemblies, or as instances."""
    taken = {*standard_templates(), *RESERVED, *given}  # a template must not stand before a type
    defined, placed = templates(pieces, taken)
    blocks = [*(node.items for node in defined), *(() if isinstance(piece, PieceInstance) else piece.items for piece in placed)]
    homes = ["" if isinstance(piece, Node | PieceInstance) else piece.home for piece in placed]
    owners = [home for block, home in zip(blocks, [*("" for _ in defined), *homes], strict=True) for _ in block]
    items = with_stereotypes([item for block in blocks for item in block], taken, given, owners)
    first = len(items) - sum(map(len, blocks))
    found = items[:first]
    for block, piece in zip(blocks, (*defined, *placed), strict=True):
        inner = tuple(items[first : first + len(block)])
        first += len(block)
        if isinstance(piece, PieceInstance):
            found.append(piece.node)
        elif isinstance(piece, Node):
            found.append(piece._replace(items=inner))
        else:
            found.extend([Node(piece.home, inner, (Stereotype(Ref(("assembly",))),))] if piece.home else inner)
    return _behind_classes(found)


def _behind_classes(items: list[Item]) -> list[Item]:
    """The items with the stereotypes and templates behind the default classes that they may refine."""
    last = max((place for place, item in enumerate(items) if is_class(item)), default=-1)

    def is_moved(item: Item) -> bool:
        return isinstance(item, Node) and item.parameters is not None and not is_class(item)

    return [*sorted(items[: last + 1], key=is_moved), *items[last + 1 :]]


def _rows(sheet: HymekoSheet) -> list[Row]:
    """The elements in layout order, with the extras of the whole in their places among them."""
    standing, _ = _in_place(sheet.mechanism)
    rows: list[Row] = []
    place = 0
    queue = list(reversed(standing))
    for key in _order(sheet):
        here = []
        while queue and queue[-1].index <= place:
            here.append(queue.pop())
            place += not here[-1].path
        rows.extend([here] if here else [])
        rows.append(key)
        place += 2 if key in sheet.attached else 1 + len(sheet.shared.get(key, ()))
    return [*rows, queue[::-1]] if queue else rows


def _behind_comments(sheet: HymekoSheet) -> frozenset[Id]:
    """The elements with a comment before them."""
    rows = _rows(sheet) if any(extra.format == "comment" for extra in sheet.mechanism.extras.get(ROOT, ())) else []
    pairs = ((before, row) for before, row in pairwise(rows) if isinstance(before, list) and isinstance(row, Id))
    return frozenset(row for before, row in pairs if any(extra.format == "comment" for extra in before))


def _texts(within: Mapping[str, HymekoSheet], row: Row, homes: Mapping[Id, str]) -> list[Item]:
    """The items of a row, as they stand in its assembly."""
    return (
        standing_items(row, classes=within[""].around is not None) if isinstance(row, list) else [_element(within[homes.get(row, "")], row)]
    )


def _in_place(mechanism: Mechanism) -> tuple[list[Extra], list[Extra]]:
    """The extras of the whole: those that stand among the elements, by place, and the others as they come."""
    extras = [extra for extra in mechanism.extras.get(ROOT, ()) if not _is_outer(extra)]
    places: dict[str, list[int]] = {}
    for extra in extras:
        places.setdefault(extra.path, []).append(extra.index)
    backwards = {path for path, found in places.items() if found != sorted(found)}
    standing = [extra for extra in extras if not extra.path or (is_standing(extra) and extra.path not in backwards)]
    about = [extra for extra in extras if extra.path and not (is_standing(extra) and extra.path not in backwards)]
    return sorted(standing, key=lambda extra: extra.index), about


def _order(sheet: HymekoSheet) -> list[Id]:
    """Every element that stands at top level: as its author ordered them, then the rest by kind in graph order."""
    graph = sheet.mechanism.graph
    shown = [key for key in (*graph.vertices, *graph.edges) if _stands_alone(sheet, key)]
    known = set(shown)
    first = [key for key in dict.fromkeys(sheet.mechanism.layout) if key in known]
    placed = set(first)
    rank = {kind: number for number, kind in enumerate(_ORDER)}
    rest = sorted((key for key in shown if key not in placed), key=lambda key: rank.get(key.kind, len(_ORDER)))
    return [*first, *rest]


def _stands_alone(sheet: HymekoSheet, key: Id) -> bool:
    elsewhere = (sheet.implied, sheet.inline, sheet.mimics, sheet.attached_edges, sheet.followers)
    if key.kind in _INLINE_EDGES or any(key in place for place in elsewhere):
        return False
    if key in sheet.nesting.outer or key in sheet.nesting.edges:
        return False
    if key != WORLD:
        return True
    mechanism = sheet.mechanism
    marked = WORLD in mechanism.extras or WORLD in mechanism.notations or WORLD in mechanism.layout
    return marked or bool(mechanism.shapes.get(WORLD)) or not mechanism.graph.incidence.get(WORLD)


def _element(sheet: HymekoSheet, key: Id) -> Item:
    graph = sheet.mechanism.graph
    if key in graph.vertices:
        return _vertex(sheet, key, graph.vertices[key])
    edge = graph.edges[key]
    if isinstance(edge.data, parts.Joint):
        kind, items = joint_items(sheet, key)
        return sheet.node(key, items, kind, edge=True)
    items = part_items(sheet, key, edge.data, edge.arcs) + _inner(sheet, key)
    if isinstance(edge.data, parts.Loop):
        items.extend(dof_node(dof, sheet.angles) for dof in edge.data.dofs)
    return sheet.node(key, items, _kind(sheet, key), edge=True)


def _vertex(sheet: HymekoSheet, key: Id, part: parts.VertexPart) -> Item:
    if isinstance(part, parts.Body | parts.World):
        node = sheet.node(key, body_items(sheet, key, part), "")
        return node if node.items or key.name not in AXES else sheet.node(key, [], "link")
    items = part_items(sheet, key, part, ()) + _inner(sheet, key)
    in_edge = sheet.within is not None and sheet.within.kind == "relation"  # where a name alone is a flag
    if isinstance(part, parts.Datum) and not items and not in_edge and not sheet.is_marked(key):
        return Field(_bare_name(sheet.nesting.name(key)))
    return sheet.node(key, items, _kind(sheet, key))


def _inner(sheet: HymekoSheet, key: Id) -> list[Item]:
    """The elements that stand in the block of an element. As deep as the blocks, which have a limit."""
    inner = sheet.nesting.inner.get(key, ())
    return [_element(replace(sheet, within=key), found) for found in inner]


def _kind(sheet: HymekoSheet, key: Id) -> str:
    """The type of a vertex or an edge; inside of data, what has none is data as well."""
    return "" if key in sheet.nesting.outer else key.kind


def _bare_name(name: str) -> str:
    """A name that stands alone, quoted where it would be a field."""
    return QuotedName(name) if name in BLOCK_SETTINGS else name_of(name)
