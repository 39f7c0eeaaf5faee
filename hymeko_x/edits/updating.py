"""`update`: the edits of a converted file in the text of its original."""

from __future__ import annotations

import os
from difflib import unified_diff
from typing import TYPE_CHECKING, NamedTuple

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes, pipeline
from hymeko_x.compare.diff import Difference, diff
from hymeko_x.compare.ledger import TOLERANCE
from hymeko_x.compare.relevance import is_idle
from hymeko_x.diagnostics import Origin, Refusal, Report, refuse
from hymeko_x.edits.conversion import Conversion
from hymeko_x.edits.differences import is_given_again, is_inherited, is_weight
from hymeko_x.edits.paths import with_new_assets
from hymeko_x.edits.text import EditedFiles, Texts, imported, text_with_edits, with_new_files
from hymeko_x.edits.unnamed import unnamed_bodies, unnamed_edges, with_same_assets, with_same_edges, with_same_numbers
from hymeko_x.ir.names import rename
from hymeko_x.ir.parts import Body, Shape
from hymeko_x.memory import remembering
from hymeko_x.residue.pairing import other_names
from hymeko_x.rewrite import Options

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Set

    from hymeko_x.edits.conversion import Left
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge
    from hymeko_x.ir.parts import VertexPart
    from hymeko_x.source import Source

_ASSET_KINDS = ("mesh", "material", "texture")
"""A texture is used by the materials that it is a layer of."""
_MOST_MISSING = 10
"""How many edits that did not arrive are listed."""
_MOST_ROUNDS = 4
"""How often a text with edits is converted and compared again."""


class Updated(Struct, frozen=True):
    """What an update gives: the robot with the edits, these as differences, and the files.

    ``source`` is the text of the original, ``changed`` the new texts of its files by their paths, ``before`` their old ones; ``beside`` are
    new files by their paths beside the original.
    """

    mechanism: Mechanism
    edits: tuple[Difference, ...]
    source: bytes
    changed: Mapping[str, bytes]
    before: Mapping[str, bytes]
    beside: Mapping[str, bytes]
    report: Report

    def files(self, original: str, output: str | None = None) -> dict[str, bytes]:
        """What is to be written, by path: into the original's own files, or to ``output`` and the folder around it."""
        target = output or original
        folder, home = os.path.dirname(target), os.path.dirname(original)
        found = {os.path.join(folder, name): data for name, data in self.beside.items()}
        for path, data in self.changed.items():
            away = os.path.abspath(folder) != os.path.abspath(home)
            found[target if path == original else os.path.join(folder, os.path.relpath(path, home or ".")) if away else path] = data
        if output is not None and original not in self.changed:
            found[output] = self.source
        return found

    @property
    def diff(self) -> str:
        """What changes in the texts, as `diff -u` shows it."""
        return "".join(line for path in self.changed for line in self._lines(path))

    def _lines(self, path: str) -> Iterator[str]:
        old, new = (data.decode("utf-8", "replace").splitlines(keepends=True) for data in (self.before[path], self.changed[path]))
        for line in unified_diff(old, new, path, path):
            yield line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n"


class _Round(NamedTuple):
    """One round of an update: the robot as the text had it, and what changes in the texts; ``lost`` edits have no place in the format.

    ``left`` is in what the text was not yet what EDITED asks for.
    """

    before: Mechanism
    texts: Texts
    beside: Mapping[str, bytes]
    lost: tuple[Difference, ...]
    left: Left


@remembering()
def update(original: Source, format: Format, edited: Source, edited_format: Format, options: Options, report: Report) -> Updated:
    """The edits in ``edited``, which was once converted from ``original``, in the text of that. ``options``: those of the conversion.

    What an edit brings with it, such as a name that follows from another one, shows when the new text is converted in its turn; so this
    is done as long as the text comes closer to what was edited. What is left then has no place in the original.

    Raises: Refusal when a file cannot be read or ``original`` cannot be converted; HX003 where the text of the format cannot be edited.
    """
    if format.outline is None:
        raise refuse(codes.UNKNOWN_FORMAT, f"{format.name} is no text in which edits could be placed", Origin(original.name))
    conversion = Conversion(edited, edited_format, format, options, report)
    first = found = _round(original, format, conversion, edited, report)
    changed, beside = dict[str, bytes](), dict[str, bytes]()
    for _ in range(_MOST_ROUNDS):
        if not found.texts.changed:
            break
        new, new_beside = {**changed, **found.texts.changed}, {**beside, **found.beside, **found.texts.beside}
        edited_files = EditedFiles(original.files, new)
        source = with_new_files(replace(original, data=new.get(original.name, original.data), files=edited_files), new_beside)
        try:
            later = _round(source, format, conversion, edited, Report())
        except Refusal as error:
            raise _broken(original, error) from error
        if changed and later.left.distance >= found.left.distance:
            break
        found.texts.report_printed(original, report)
        changed, beside, found = new, new_beside, later
    _report_left(found, conversion, original, format, report, is_changed=bool(changed))
    if not changed:  # the original is the same already, in the words of its own format
        return Updated(first.before, (), original.data, {}, {}, {}, report)
    report.extend(conversion.notes)
    old = {path: original.data if path == original.name else original.files.read(path) for path in changed}
    robot = with_same_numbers(found.before, first.before, unnamed_bodies(first.before))
    robot = with_same_assets(with_same_edges(robot, first.before, unnamed_edges(first.before)), first.before)
    edits = _edits(first.before, robot)
    return Updated(replace(found.before, origins=first.before.origins), edits, original.data, changed, old, beside, report)


def _round(original: Source, format: Format, conversion: Conversion, edited: Source, report: Report) -> _Round:
    """The edits that a text does not have yet, carried over to it."""
    before = pipeline.read(original, format, Report())
    after, beside = with_new_assets(before, conversion.edited_mechanism(before, original), edited)
    original = with_new_files(original, beside) if beside else original
    after = _without_unused(before, _with_imported_names(before, after, imported(original, format, before)))
    every = diff(before, after, TOLERANCE)
    after = _without_rounding(before, after, {edit.element for edit in every})
    gone = _dropped(every, after, original, format)
    after = _without_inertials(before, after, {element for element, field in gone if field.partition(".")[0] == "inertial"})
    derived = (is_inherited, is_weight, is_given_again)
    dropped = [edit for edit in every if (str(edit.element), edit.field) in gone and not any(test(edit) for test in derived)]
    texts = text_with_edits(original, format, before, after, report) if len(dropped) < len(every) else Texts({}, {})
    lost = tuple(edit for edit in dropped if not (_is_hidden_material(edit, after) or is_idle(edit)))
    return _Round(before, texts, beside, lost, conversion.left())


def _report_left(found: _Round, conversion: Conversion, original: Source, format: Format, report: Report, *, is_changed: bool) -> None:
    """Report the edits that have no place in the original, after the last round."""
    lost = [edit for edit in found.lost if edit.element not in found.left.renamed]
    for edit in lost:
        message = f"the edit has no place in {format.name}: {edit}"
        report.warn(codes.EDIT_DROPPED, message, found.before.origin(edit.element), element=str(edit.element))
    found.texts.report_missing(original, report)
    if found.texts.missing:
        return
    known = {edit.element for edit in lost}
    left = [] if lost else found.left.edits
    unmet = [words for element, words in conversion.unmet(left, of_extras=not is_changed) if element not in known]
    unmet += [] if is_changed else conversion.lost_colours()
    computed = [f"{words}, which follows from masses in the original" for words in conversion.computed.edits]
    missing = [f"the edit did not arrive: {words}" for words in (*found.left.names, *left, *computed)]
    _report_missing([*dict.fromkeys([*missing, *unmet])], original, report)
    for key, words in conversion.computed.old.items():
        message = f"{words} of {key} follow from masses, and are old in the edited file"
        report.note(codes.EDIT_DROPPED, message, found.before.origin(key) or Origin(original.name), hint="convert the original again")
    for name in dict.fromkeys([*found.left.made_names, *(conversion.lost_names() if is_changed else ())]):
        hint = f"{format.name} has no name for it there"
        report.note(codes.EDIT_DROPPED, f"the edit did not arrive: {name}", Origin(original.name), hint=hint)


def _without_rounding(before: Mechanism, after: Mechanism, edited: Set[Id]) -> Mechanism:
    """The edited robot, in which elements without an edit have the numbers that they had before, and not those that rounding left."""
    vertices, edges = before.graph.vertices, before.graph.edges
    return after.replace(
        vertices={
            key: vertices[key] for key, part in after.graph.vertices.items() if key not in edited and vertices.get(key, part) != part
        },
        edges={key: edges[key] for key, edge in after.graph.edges.items() if key not in edited and edges.get(key, edge) != edge},
    )


def _without_inertials(before: Mechanism, after: Mechanism, bodies: Set[str]) -> Mechanism:
    """The edited robot; the inertials of these bodies, which the format would write and its engine pass over, are those of before."""
    inertials: dict[Id, VertexPart] = {}
    for key, body in after.vertices(Body) if bodies else ():
        if str(key) in bodies:
            earlier = before.part(key, Body)
            inertials[key] = replace(body, inertial=None if earlier is None else earlier.inertial)
    return after.replace(vertices=inertials)


def _edits(before: Mechanism, after: Mechanism) -> tuple[Difference, ...]:
    """What was edited; a new name is one edit, whatever refers to the element or is called after it."""
    names = {new: old for new, old in other_names(after, before).items() if old.kind == new.kind}
    renamed: dict[tuple[str, str], Difference] = {}
    for new, old in names.items():
        if old.kind != "shape":  # whose name is a field
            renamed.setdefault((old.name, new.name), Difference(old, "name", repr(old.name), repr(new.name)))
    return (*renamed.values(), *diff(before, rename(after, names), TOLERANCE))


def _with_imported_names(before: Mechanism, after: Mechanism, imported: frozenset[Id]) -> Mechanism:
    """The edited robot with the names that a text cannot change, as other files give them."""
    names = other_names(after, before) if imported else {}
    return rename(after, {new: old for new, old in names.items() if old in imported})


def _report_missing(missing: list[str], original: Source, report: Report) -> None:
    """Warn of edits that have no place in the original, by what the edited file has."""
    for words in missing[:_MOST_MISSING]:
        report.warn(codes.EDIT_DROPPED, words, Origin(original.name))
    if len(missing) > _MOST_MISSING:
        report.warn(codes.EDIT_DROPPED, f"{len(missing) - _MOST_MISSING} more edits did not arrive", Origin(original.name))


def _dropped(edits: tuple[Difference, ...], after: Mechanism, original: Source, format: Format) -> frozenset[tuple[str, str]]:
    """The elements and fields among the edits that the format of the original cannot represent."""
    if not edits or format.is_exact:
        return frozenset()
    elements = {str(edit.element) for edit in edits}
    try:
        losses = pipeline.convert(after, format, Options(lenient=True), original.files, Report()).losses or ()
    except Refusal as error:
        raise _broken(original, error) from error
    return frozenset((loss.element, loss.field) for loss in losses if loss.fate == "dropped" and loss.element in elements)


def _broken(original: Source, error: Refusal) -> Refusal:
    """The refusal of edits with which the original cannot be read, or converted, as the one says that this led to."""
    if error.diagnostic.code == codes.LIBRARY_MISSING:
        return error
    reason = error.__cause__ if isinstance(error.__cause__, Refusal) else error
    return refuse(codes.EDIT_DROPPED, f"with the edits the original cannot be used: {reason}", Origin(original.name))


def _without_unused(before: Mechanism, after: Mechanism) -> Mechanism:
    """The edited robot without meshes and materials that only it lists and that no shape has, as where a body was removed."""
    graph = after.graph
    new = [key for key in graph.vertices if key.kind in _ASSET_KINDS and key not in before.graph.vertices]
    gone: set[Id] = set()
    for key in sorted(new, key=lambda key: _ASSET_KINDS.index(key.kind)):
        edges = {found.edge for found in graph.incidence.get(key, ())}
        if all(edge in gone or (key.kind == "material" and edge.kind == "layer") for edge in edges):
            gone |= {key, *edges}
    extras = {key: found for key, found in after.extras.items() if key not in gone}
    return replace(after.replace(without=gone), extras=extras) if gone else after


def _is_hidden_material(edit: Difference, after: Mechanism) -> bool:
    """Whether an edit is of a material without images that the own colours of its shapes hide, as a note of the writer reports.

    It adds the material itself, or gives it to a shape.
    """
    key, graph = edit.element, after.graph
    if key.kind == "material" and not edit.field:
        return all(_has_own_colour(graph.edges.get(found.edge)) for found in graph.incidence.get(key, ()))
    edge = graph.edges.get(key)
    if edge is None or not _has_own_colour(edge) or not (edit.after or "").startswith("~ material "):
        return False
    materials = [arc.target for arc in edge.arcs if arc.role == "material"]
    return not any(found.edge.kind == "layer" for material in materials for found in graph.incidence.get(material, ()))


def _has_own_colour(edge: RobotEdge | None) -> bool:
    return edge is not None and isinstance(edge.data, Shape) and edge.data.rgba is not None
