"""Two mechanisms as one: the files of the part keep leading to where they are, its side tables come along."""

from __future__ import annotations

import posixpath
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import formats
from hymeko_x.assets.pack import is_of_package
from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.mechanism import ROOT, WORLD, Id, Mechanism, Provenance
from hymeko_x.robot.errors import EditError
from hymeko_x.robot.parting import ASSETS
from hymeko_x.source import ManyFiles

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.ir.mechanism import RobotEdge
    from hymeko_x.ir.parts import Mesh, Texture, VertexPart
    from hymeko_x.source import Files


# ---- formats -------------------------------------------------------------------------------------------------------------------


def provenance_of(host: Mechanism, part: Mechanism) -> Provenance:
    """That of the host where both came from one format; else that of a robot made by a program, beside the file of the host."""
    same = host.source.format == part.source.format
    return host.source if same or not (formats.native_format(host) or formats.native_format(part)) else Provenance(file=host.source.file)


# ---- tables --------------------------------------------------------------------------------------------------------------------


def merged(host: Mechanism, part: Mechanism, source: Provenance) -> Mechanism:
    """All elements and side tables of both; equal materials, meshes and textures are shared.

    Raises: EditError when another element of both has the same id.
    """
    taken = {*host.graph.vertices, *host.graph.edges} - _shared(host, part)
    clash = next((key for table in (part.graph.vertices, part.graph.edges) for key in table if key in taken and key != WORLD), None)
    if clash is not None:
        raise EditError(f"{clash} is in robot '{host.name}' and in robot '{part.name}'; give a prefix")
    start = len(host.layout) + len(host.extras.get(ROOT, ()))
    later = tuple([replace(extra, index=extra.index + start) for extra in part.extras.get(ROOT, ())])
    extras = {**host.extras, **part.extras, ROOT: host.extras.get(ROOT, ()) + later}
    return replace(
        host,
        graph=Hypergraph({**host.graph.vertices, **part.graph.vertices}, {**host.graph.edges, **part.graph.edges}),
        extras={key: found for key, found in extras.items() if found},
        origins={**host.origins, **part.origins},
        notations={**host.notations, **{key: found for key, found in part.notations.items() if key != ROOT}},
        stereotypes={**host.stereotypes, **part.stereotypes},
        layout=host.layout + part.layout,
        places={**part.places, **host.places},
        originals={**part.originals, **host.originals},
        stored={**host.stored, **part.stored},
        source=source,
    )


def _shared(host: Mechanism, part: Mechanism) -> set[Id]:
    """The assets that both have, with the same name, value, extras and layers."""
    found = set()
    for one, other in ((host.graph.vertices, part.graph.vertices), (host.graph.edges, part.graph.edges)):
        for key in other:
            if key.kind in ASSETS and one.get(key) == other[key] and host.extras.get(key) == part.extras.get(key):
                found.add(key)
    return {key for key in found if _layers(host, key) == _layers(part, key)}


def _layers(mechanism: Mechanism, key: Id) -> list[RobotEdge]:
    """What a material is made of."""
    return (
        [mechanism.graph.edges[edge] for edge, _, _ in mechanism.graph.edges_at(key) if edge.kind == "layer"]
        if key.kind == "material"
        else []
    )


# ---- files ---------------------------------------------------------------------------------------------------------------------


class PartFiles:
    """The files of a part under the uris that they have in the robot of which it became one."""

    def __init__(self, uris: Mapping[str, str], files: Files) -> None:
        self._uris, self._files = uris, files

    def find(self, uri: str) -> str | None:
        """The path of a file of the part."""
        return self._files.find(self._uris.get(uri, uri))

    def read(self, path: str) -> bytes:
        """The content of a path that :meth:`find` returned. Raises: OSError."""
        return self._files.read(path)


def with_files(host: Mechanism, part: Mechanism, of_host: Files, of_part: Files) -> tuple[Mechanism, Files]:
    """The part with its relative uris seen from the folder of the host, and the files of both."""
    here, there = (posixpath.dirname(mechanism.source.file.replace("\\", "/")) or "." for mechanism in (host, part))
    if here == there or here.startswith("/") != there.startswith("/"):
        return part, of_host if of_host == of_part else ManyFiles((of_host, of_part))
    way = posixpath.relpath(there, here)
    moved: dict[Id, VertexPart] = {}
    uris: dict[str, str] = {}
    for key, uri, asset in _relative_assets(part):
        new = posixpath.normpath(f"{way}/{uri}")
        moved[key], uris[new] = replace(asset, uri=new), uri
    return part.replace(vertices=moved), ManyFiles((of_host, PartFiles(uris, of_part)))


def _relative_assets(mechanism: Mechanism) -> Iterator[tuple[Id, str, Mesh | Texture]]:
    for key, asset in mechanism.assets():
        uri = asset.uri
        if uri and not uri.startswith("/") and "://" not in uri and not is_of_package(uri) and uri[1:2] != ":":
            yield key, uri, asset
