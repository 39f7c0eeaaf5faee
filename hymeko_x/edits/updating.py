"""`update`: the edits of a converted file in the text of its original."""

from __future__ import annotations

import os
import posixpath
from contextlib import suppress
from difflib import unified_diff
from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x import codes, formats, pipeline
from hymeko_x.compare.diff import diff
from hymeko_x.compare.ledger import TOLERANCE
from hymeko_x.diagnostics import Origin, Report, refuse
from hymeko_x.edits.conversion import Conversion, new_assets
from hymeko_x.edits.text import EditedFiles, Texts, imported, text_with_edits
from hymeko_x.ir.names import rename
from hymeko_x.ir.parts import Mesh, Texture
from hymeko_x.residue.pairing import other_names
from hymeko_x.rewrite import Options

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.compare.diff import Difference
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.parts import VertexPart
    from hymeko_x.source import Source

_ASSETS = "meshes"
_ASSET_KINDS = frozenset({"mesh", "material", "texture"})
_MOST_MISSING = 10
"""How many edits that did not arrive are listed."""


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


def update(original: Source, format: Format, edited: Source, edited_format: Format, options: Options, report: Report) -> Updated:
    """The edits in ``edited``, which was once converted from ``original``, in the text of that. ``options``: those of the conversion.

    Raises: Refusal when a file cannot be read or ``original`` cannot be converted; HX003 where the text of the format cannot be edited.
    """
    if format.outline is None:
        raise refuse(codes.UNKNOWN_FORMAT, f"{format.name} is no text in which edits could be placed", Origin(original.name))
    before = pipeline.read(original, format, Report())
    notes = Report()
    conversion = Conversion(before, original, edited, edited_format, format, report, notes)
    after, beside = _with_new_assets(before, conversion.edited_mechanism(options), edited)
    after = _with_imported_names(before, after, imported(original, format, before))
    every = diff(before, after, TOLERANCE)
    dropped = _dropped(every, after, original, format)
    lost = [edit for edit in dropped if not _is_unused(edit, after)]
    for edit in lost:
        message = f"the edit has no place in {format.name}: {edit}"
        report.warn(codes.EDIT_DROPPED, message, before.origin(edit.element), element=str(edit.element))
    edits = tuple([edit for edit in every if edit not in dropped])
    texts = text_with_edits(original, format, before, after, report) if edits else Texts({}, {})
    edits = tuple([edit for edit in edits if edit.element not in texts.missing])
    if not lost and not texts.missing:
        files = EditedFiles(original.files, {**texts.changed, **beside, **texts.beside})
        text = texts.changed.get(original.name, original.data)
        _report_missing(conversion.missing(replace(original, data=text, files=files)), original, report)
    if not texts.changed:  # the original is the same already, in the words of its own format
        return Updated(before, (), original.data, {}, {}, {}, report)
    report.extend(notes)
    old = {path: original.data if path == original.name else original.files.read(path) for path in texts.changed}
    return Updated(replace(after, origins=before.origins), edits, original.data, texts.changed, old, {**beside, **texts.beside}, report)


def _with_imported_names(before: Mechanism, after: Mechanism, imported: frozenset[Id]) -> Mechanism:
    """The edited robot with the names that a text cannot change, as other files give them."""
    names = other_names(after, before) if imported else {}
    return rename(after, {new: old for new, old in names.items() if old in imported})


def _report_missing(missing: list[str], original: Source, report: Report) -> None:
    """Warn of edits that have no place in the original, by what the edited file has."""
    for words in missing[:_MOST_MISSING]:
        report.warn(codes.EDIT_DROPPED, f"the edit did not arrive: {words}", Origin(original.name))
    if len(missing) > _MOST_MISSING:
        report.warn(codes.EDIT_DROPPED, f"{len(missing) - _MOST_MISSING} more edits did not arrive", Origin(original.name))


def _dropped(edits: tuple[Difference, ...], after: Mechanism, original: Source, format: Format) -> list[Difference]:
    """The edits that the format of the original cannot represent. The mass of a shape is part of its body's inertial."""
    if not edits or format.is_exact:
        return []
    losses = pipeline.convert(after, format, Options(lenient=True), original.files, Report()).losses or ()
    gone = {(loss.element, loss.field) for loss in losses if loss.fate == "dropped"}
    return [edit for edit in edits if (str(edit.element), edit.field) in gone and not _is_inherited(edit) and not _is_weight(edit)]


def _is_unused(edit: Difference, after: Mechanism) -> bool:
    """Whether an edit only leaves a mesh or a material that no shape has any more, as where a body was removed."""
    return edit.element.kind in _ASSET_KINDS and edit.before is None and not after.graph.incidence.get(edit.element)


def _is_weight(edit: Difference) -> bool:
    return edit.element.kind == "shape" and edit.field in ("mass", "density")


def _is_inherited(edit: Difference) -> bool:
    """Whether an edit is one of classes alone, which the elements have in fields of their own."""
    rows = [formats.loaded(row.inherited) for row in formats.FORMATS if row.inherited is not None and edit.field.startswith(f"{row.name} ")]
    return any(function(text or "") == function("") for function in rows for text in (edit.after or edit.before,))


def _with_new_assets(before: Mechanism, after: Mechanism, edited: Source) -> tuple[Mechanism, dict[str, bytes]]:
    """The mechanism with the paths that files get beside the original which only the edited robot has, and their contents."""
    folder = next((posixpath.dirname(part.uri) for _, part in before.vertices(Mesh) if part.uri and _is_below(part.uri)), _ASSETS)
    names: dict[str, str] = {}
    contents: dict[str, bytes] = {}
    for uri in new_assets(before, after):
        path = edited.files.find(uri) if _is_below(uri) else None
        with suppress(OSError):
            if path is not None:
                names[uri] = posixpath.join(folder, posixpath.basename(uri))
                contents[names[uri]] = edited.files.read(path)
    changed: dict[Id, VertexPart] = {}
    for key, part in after.assets():
        if isinstance(part, Mesh | Texture) and part.uri in names:
            changed[key] = replace(part, uri=names[part.uri])
    return (after.replace(vertices=changed)), contents


def _is_below(uri: str) -> bool:
    """Whether a uri is a relative path that stays below its folder."""
    return "://" not in uri and not os.path.isabs(uri) and ".." not in uri.split("/")
