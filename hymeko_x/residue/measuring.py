"""What a conversion lost: its result as its own format reads it, against the mechanism that it was made from."""

from __future__ import annotations

import posixpath
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import formats
from hymeko_x.compare.contents import Contents, content_differences, with_same_files
from hymeko_x.compare.geometry import meshes_as_files, without_points
from hymeko_x.compare.leaves import leaves_again, leaves_between
from hymeko_x.compare.ledger import losses_between
from hymeko_x.ir.parts import Mesh, Texture
from hymeko_x.residue.align import align
from hymeko_x.residue.delta import residue_between
from hymeko_x.residue.originals import fetch_from
from hymeko_x.residue.realign import alignment_differences
from hymeko_x.residue.text import print_residue

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from hymeko_x.compare.diff import Difference
    from hymeko_x.compare.ledger import Loss
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Extra, Id, Mechanism
    from hymeko_x.ir.parts import VertexPart
    from hymeko_x.source import PackageFiles


def compared(
    mechanism: Mechanism,
    printed: Mechanism,
    image: Mechanism,
    format: Format,
    contents: PackageFiles | None,
    *,
    is_moved: bool,
    is_kept: bool,
) -> tuple[tuple[Loss, ...], str, Mechanism]:
    """The losses, the text of the residue if it is to be kept (empty where the image is the mechanism), and the aligned image.

    ``contents`` are the files of the output (None where the main file goes alone): points that the mechanism holds and that are in one of
    them are no difference. Where files are moved, the residue has nothing that leads back to those in the way.
    """
    alignment, aligned = align(image, mechanism)
    as_files = mechanism if contents is None else meshes_as_files(mechanism, aligned, fetch_from(contents))
    moved = with_references_of(printed, as_files)
    leaves = leaves_between(moved, aligned)
    changed = (*alignment_differences(alignment), *_content_changes(mechanism, aligned, contents))
    losses = losses_between(moved, aligned, changed, format, leaves, is_kept=is_kept)
    if not is_kept:
        return losses, "", aligned
    source = without_points(mechanism, as_files)
    if is_moved:
        source = moved if formats.native_format(moved) is None else replace(moved, extras=printed.extras)
    residue = residue_between(source, image, alignment, aligned, leaves_again(source, moved, aligned, leaves))
    return losses, "" if residue.is_empty else print_residue(residue), aligned


def losses_between_files(source: Contents, image: Contents, format: Format) -> tuple[Loss, ...]:
    """What one robot does not have as another one has it, whichever program wrote the files; ``format`` is that of the second.

    Places and names of meshes and images do not count, their contents do.
    """
    alignment, aligned = align(image.mechanism, source.mechanism)
    theirs = Contents(aligned, image.fetch)
    changed = (*alignment_differences(alignment), *content_differences(source, theirs))
    return losses_between(source.mechanism, with_same_files(source, theirs), changed, format)


def _content_changes(mechanism: Mechanism, aligned: Mechanism, contents: PackageFiles | None) -> Iterator[Difference]:
    """In what meshes and images that were converted show something else than those of the source."""
    new = contents.package.files if contents is not None else ()
    converted = {key for key, part in aligned.assets() if part.uri is not None and posixpath.normpath(part.uri) in new}
    if contents is not None and converted:
        ours, theirs = Contents(mechanism, fetch_from(contents.behind)), Contents(aligned, fetch_from(contents))
        yield from content_differences(ours, theirs, converted.__contains__)


def with_references_of(printed: Mechanism, mechanism: Mechanism) -> Mechanism:
    """The mechanism with the printed one's paths of files, in extras as well: that a file has moved is no loss."""
    moved: dict[Id, VertexPart] = {}
    for key, part in mechanism.assets():
        other = printed.graph.vertices.get(key)
        if isinstance(other, Mesh | Texture) and other.uri and part.uri != other.uri:
            moved[key] = replace(part, uri=other.uri)
    row = formats.of_source(mechanism)
    if row is not None and row.tells_places is not None and printed.extras is not mechanism.extras:
        mechanism = replace(mechanism, extras=_with_places_of(printed, mechanism, formats.loaded(row.tells_places)))
    return mechanism.replace(vertices=moved)


def _with_places_of(printed: Mechanism, mechanism: Mechanism, tells_places: Callable[[Extra], bool]) -> dict[Id, tuple[Extra, ...]]:
    """The extras, those that tell of places being the printed one's."""
    extras = dict(mechanism.extras)
    for key, found in mechanism.extras.items():
        new = printed.extras.get(key, ())
        if len(new) == len(found) and any(map(tells_places, found)):
            extras[key] = tuple([b if tells_places(a) and a.path == b.path else a for a, b in zip(found, new, strict=True)])
    return extras
