"""The files to which the converted file refers: no edit where they are the same by another path, and brought along where they are new."""

from __future__ import annotations

import os
import posixpath
from collections import defaultdict
from contextlib import suppress
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.ir.parts import Mesh, Texture

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.compare.contents import Contents
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.parts import VertexPart
    from hymeko_x.source import Source

_FOLDER = "meshes"
"""The folder of new files beside an original that has no folder for meshes."""


def with_same_paths(edited: Contents, image: Contents) -> Mechanism:
    """The edited robot, whose meshes and images have the paths of files with the same content to which the image alone refers."""
    mine, theirs = ({part.uri for _, part in each.mechanism.assets() if part.uri} for each in (edited, image))
    if not (mine - theirs and theirs - mine):
        return edited.mechanism
    known: dict[bytes, list[str]] = defaultdict(list)
    for uri in sorted(theirs - mine):
        data = image.fetch(uri)
        if data is not None:
            known[data].append(uri)
    paths: dict[str, str] = {}
    for uri in mine - theirs:
        data = edited.fetch(uri)
        if data is not None and (same := known.get(data)):
            paths[uri] = next((other for other in same if posixpath.basename(other) == posixpath.basename(uri)), same[0])
    changed: dict[Id, VertexPart] = {
        key: replace(part, uri=paths[part.uri]) for key, part in edited.mechanism.assets() if part.uri is not None and part.uri in paths
    }
    return edited.mechanism.replace(vertices=changed)


def with_new_assets(before: Mechanism, after: Mechanism, edited: Source) -> tuple[Mechanism, dict[str, bytes]]:
    """The mechanism with the paths that files get beside the original which only the edited robot has, and their contents."""
    folder = next((posixpath.dirname(part.uri) for _, part in before.vertices(Mesh) if part.uri and _is_below(part.uri)), _FOLDER)
    names: dict[str, str] = {}
    contents: dict[str, bytes] = {}
    for uri in _new_assets(before, after):
        path = edited.files.find(uri) if _is_below(uri) else None
        with suppress(OSError):
            if path is not None:
                names[uri] = posixpath.join(folder, posixpath.basename(uri))
                contents[names[uri]] = edited.files.read(path)
    changed: dict[Id, VertexPart] = {}
    for key, part in after.assets():
        if isinstance(part, Mesh | Texture) and part.uri in names:
            changed[key] = replace(part, uri=names[part.uri])
    return after.replace(vertices=changed), contents


def _is_below(uri: str) -> bool:
    """Whether a uri is a relative path that stays below its folder."""
    return "://" not in uri and not os.path.isabs(uri) and ".." not in uri.split("/")


def _new_assets(before: Mechanism, after: Mechanism) -> Iterator[str]:
    """The uris of meshes and images that only the edited mechanism refers to."""
    known = {part.uri for _, part in before.assets()}
    for _, part in after.assets():
        if isinstance(part, Mesh | Texture) and part.uri and part.uri not in known:
            yield part.uri
