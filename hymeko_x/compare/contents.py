"""Files compared by their content: meshes by what they show, images by their pixels. Places and names of files do not count."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, NamedTuple

from msgspec.structs import replace

from hymeko_x import formats
from hymeko_x.compare.diff import Difference
from hymeko_x.ir.digits import number_text
from hymeko_x.ir.parts import MESH_POINTS, Mesh, Role, Texture
from hymeko_x.source import suffix_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.values import Pose
    from hymeko_x.meshes.change import MeshChange
    from hymeko_x.meshes.submesh import Submesh

    Fetch = Callable[[str], bytes | None]
    """The content of a file by its uri; None where there is none."""


class Contents(NamedTuple):
    """A mechanism, and what gives the contents of its files."""

    mechanism: Mechanism
    fetch: Fetch


def with_same_files(a: Contents, b: Contents) -> Mechanism:
    """The mechanism of ``b`` that has the files of ``a`` by the names of ``a``, where the contents are the same: to be compared with it."""
    changed: dict[Id, Mesh | Texture] = {}
    pieces = _pieces(a.mechanism, b.mechanism)
    for key, part in a.mechanism.assets():
        other = b.mechanism.graph.vertices.get(key)
        if type(other) is type(part) and _reference(other) != _reference(part) and not any(_of_asset(key, a, b, pieces)):
            changed[key] = _with_reference(other, part)
    mechanism = b.mechanism.replace(vertices=changed)
    return _with_same_extras(a, b, mechanism)


def content_differences(a: Contents, b: Contents, keys: Callable[[Id], bool] = lambda _: True) -> Iterator[Difference]:
    """In what the files of both differ that are found, asset by asset; ``keys`` chooses among them.

    A mesh that ``b`` has in pieces, one per appearance, is compared with all of them together.
    """
    pieces = _pieces(a.mechanism, b.mechanism)
    for key, part in a.mechanism.assets():
        other = b.mechanism.graph.vertices.get(key)
        if type(other) is type(part) and keys(key):
            yield from (found for found in _of_asset(key, a, b, pieces) if found is not None)


def _pieces(a: Mechanism, b: Mechanism) -> dict[Id, tuple[Id, ...]]:
    """By mesh of ``a``, the further meshes of ``b`` that may show it: those of visuals that ``a`` has not, where a visual of it is."""
    found: dict[Id, tuple[Id, ...]] = {}
    for body, views in b.shapes.items():
        here = {view.id: view for view in views}
        ours = [view for view in a.shapes.get(body, ()) if view.mesh is not None and view.shape.role is Role.VISUAL and view.id in here]
        new = here.keys() - {view.id for view in a.shapes.get(body, ())} if ours else ()
        places: dict[Pose, list[Id]] = {}
        for view in views:
            if view.id in new and view.mesh is not None and view.mesh not in a.graph.vertices:
                places.setdefault(view.pose, []).append(view.mesh)
        for view in ours:
            if view.mesh is not None and (meshes := places.get(here[view.id].pose)):
                found.setdefault(view.mesh, tuple(meshes))
    return found


def _of_asset(key: Id, a: Contents, b: Contents, pieces: Mapping[Id, tuple[Id, ...]]) -> Iterator[Difference | None]:
    """The differences of one asset; None where a content is not known, so that nothing is known."""
    part, other = a.mechanism.graph.vertices[key], b.mechanism.graph.vertices[key]
    before, after = _data(part, a), _data(other, b)
    if before is not None and before == after and (isinstance(part, Texture) or suffix_of(part.uri or "") == suffix_of(other.uri or "")):  # type: ignore[union-attr]
        return
    if isinstance(part, Mesh) and isinstance(other, Mesh):
        if any(formats.is_placing(extra) for each in (a, b) for extra in each.mechanism.extras.get(key, ())):
            yield None  # its points are elsewhere than in its file
            return
        further = [_mesh_of(piece, b) for piece in pieces.get(key, ())]
        yield from _of_meshes(key, _submesh(part, before, a), _submesh(other, after, b), further)
    elif before is None or after is None:
        yield None
    else:
        yield from _of_images(key, before, after)


def _of_meshes(key: Id, before: Submesh | None, after: Submesh | None, further: Sequence[Submesh | None]) -> Iterator[Difference | None]:
    if before is None or after is None:
        yield None
        return
    from hymeko_x.meshes.change import changes, sorted_triangles
    from hymeko_x.meshes.reader import merged

    found: Sequence[MeshChange] = changes(before, after)
    if found and (pieces := tuple(piece for piece in further if piece is not None)):
        found = min(found, changes(*map(sorted_triangles, (before, merged((after, *pieces))))), key=_triangles_changed)
    for name, was, now in found:
        yield Difference(key, f"content.{name}", _shown(was), _shown(now))


def _triangles_changed(found: Sequence[MeshChange]) -> float:
    from hymeko_x.meshes.change import TRIANGLES

    return sum(abs(change.before - change.after) for change in found if change.name == TRIANGLES) if found else -1.0


def _shown(value: float) -> str:
    return number_text(float(f"{value:.6g}"))


def _of_images(key: Id, before: bytes, after: bytes) -> Iterator[Difference | None]:
    from hymeko_x.meshes.images import UnreadableImage, pixels

    try:
        was, now = pixels(before), pixels(after)
    except UnreadableImage:
        yield None
        return
    if was.size != now.size:
        yield Difference(key, "content.size", repr(f"{was.size[0]} x {was.size[1]}"), repr(f"{now.size[0]} x {now.size[1]}"))
    elif was.data != now.data:
        count = sum(one != other for one, other in zip(was.rows(), now.rows(), strict=True))
        yield Difference(key, "content.rows of pixels", "0", str(count))


def _data(part: object, of: Contents) -> bytes | None:
    uri = getattr(part, "uri", None)
    return None if uri is None else of.fetch(uri)


def _mesh_of(key: Id, of: Contents) -> Submesh | None:
    mesh = of.mechanism.vertex(key, Mesh)
    return _submesh(mesh, _data(mesh, of), of)


def _submesh(mesh: Mesh, data: bytes | None, of: Contents) -> Submesh | None:
    """The triangles of a mesh as the engine of the mechanism's format reads them."""
    from hymeko_x.meshes.reader import inline_part, read_mapped
    from hymeko_x.meshes.submesh import Unreadable

    with suppress(Unreadable):
        if mesh.vertices and mesh.uri is None:
            return _scaled(inline_part(mesh), mesh) if mesh.faces else None
        suffix, read = suffix_of(mesh.uri or ""), formats.mesh_reader(of.mechanism)
        if data is not None:
            found = None if read is None else read(data, suffix)
            return _scaled(read_mapped(data, suffix, _nothing) if found is None else found, mesh)
    return None


def _scaled(part: Submesh, mesh: Mesh) -> Submesh:
    return part if mesh.scale == (1.0, 1.0, 1.0) else replace(part, points=part.points * mesh.scale)


def _nothing(name: str) -> bytes:
    raise FileNotFoundError(name)


def _reference(part: object) -> object:
    """How a mechanism has the content of an asset."""
    if isinstance(part, Mesh):
        return part.uri, *(getattr(part, name) for name in MESH_POINTS)
    return getattr(part, "uri", None)


def _with_reference(part: object, other: Mesh | Texture) -> Mesh | Texture:
    """The part with the content of the other one, by reference or in itself."""
    assert isinstance(part, Mesh | Texture)
    if isinstance(part, Mesh) and isinstance(other, Mesh):
        return replace(part, uri=other.uri, **{name: getattr(other, name) for name in MESH_POINTS})
    return replace(part, uri=other.uri)


def _with_same_extras(a: Contents, b: Contents, mechanism: Mechanism) -> Mechanism:
    """The mechanism whose extras name the files of ``a`` as ``a`` does, where only places and names of files differ."""
    row = formats.of_source(a.mechanism)
    other = formats.of_source(b.mechanism)
    if row is None or other is not row or row.files_in_extras is None or row.tells_places is None:
        return mechanism
    ours, theirs = (list(formats.loaded(row.files_in_extras)(each)) for each in (a.mechanism, b.mechanism))
    if ours == theirs or len(ours) != len(theirs):
        return mechanism
    if any(a.fetch(uri) is None or a.fetch(uri) != b.fetch(there) for (_, uri), (_, there) in zip(ours, theirs, strict=True)):
        return mechanism
    tells_places = formats.loaded(row.tells_places)
    extras = {
        key: tuple([extra for extra in found if not tells_places(extra)]) + tuple(filter(tells_places, a.mechanism.extras.get(key, ())))
        for key, found in mechanism.extras.items()
    }
    return replace(mechanism, extras=extras)
