"""Meshes whose files are not there, but in the file that carried the mechanism: stages of USD hold their geometry."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import field
from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.assets.refer import is_of_package
from hymeko_x.ir.builder import Builder
from hymeko_x.ir.mechanism import subset_edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import Mesh, Role

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.parts import Material, Texture
    from hymeko_x.ir.provenance import StoredLook, StoredMesh
    from hymeko_x.source import Files


class _Standing(Builder):
    """What stands in for files; equal looks share a material."""

    known: dict[tuple[Material, Texture | None], Id] = field(default_factory=dict)

    def show(self, shape: Id, look: StoredLook) -> None:
        """Let a shape look in places as its file does."""
        if (look.material, look.texture) not in self.known:
            self.known[look.material, look.texture] = self.add_material(look.material, look.texture)
        material = self.known[look.material, look.texture]
        self.edges[self.names.take("subset", material.name)] = subset_edge(look.faces, shape, material)


def with_stored_meshes(mechanism: Mechanism, format: Format, files: Files, report: Report) -> Mechanism:
    """The mechanism with the points and looks that are stored of every mesh whose file is missing. An exact format keeps the reference."""
    if not mechanism.stored or format.is_exact:
        return mechanism
    standing = _Standing(names=names_in_use(mechanism))
    found: dict[Id, StoredMesh] = {}
    for key, mesh in mechanism.vertices(Mesh):
        stored = mechanism.stored.get(mesh.uri or "")
        if stored is None or (format.keeps_package_uris and is_of_package(mesh.uri or "")) or files.find(mesh.uri or "") is not None:
            continue
        found[key] = stored
        standing.vertices[key] = replace(stored.mesh, scale=mesh.scale, name=mesh.name)
        said = f"{key}: '{mesh.uri}' was not found; it becomes the points that the source has of it"
        report.note(codes.ASSET_NOT_FOUND, said, mechanism.origin(key), element=str(key))
    for view in mechanism.every_shape() if found else ():
        if view.mesh in found and view.shape.role is Role.VISUAL and view.id not in mechanism.subsets:
            for look in found[view.mesh].looks:
                standing.show(view.id, look)
    return standing.added_to(mechanism) if found else mechanism
