"""What a mechanism keeps of its source: format and version among the kept notations, and meshes that the file itself holds."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.ir.mechanism import ROOT, Provenance

if TYPE_CHECKING:
    from collections.abc import Container, Mapping

    from hymeko_x.ir import parts
    from hymeko_x.ir.mechanism import Id, Mechanism


class StoredLook(NamedTuple):
    """What some triangles of a mesh show: a material, with its image if it has one."""

    material: parts.Material
    texture: parts.Texture | None
    faces: tuple[int, ...]


class StoredMesh(NamedTuple):
    """A mesh that a file itself holds, which the mechanism only refers to: its points, and its appearance there."""

    mesh: parts.Mesh
    looks: tuple[StoredLook, ...] = ()


def kept_notations(mechanism: Mechanism) -> Mapping[Id, Mapping[str, str]]:
    """The notations by element; where the source has a version, the mechanism as a whole has an entry of the format's name."""
    format, version, _ = mechanism.source
    if not version:
        return mechanism.notations
    return {**mechanism.notations, ROOT: {**mechanism.notations.get(ROOT, {}), format: version}}


def take_provenance(notations: Mapping[Id, dict[str, str]], formats: Container[str], otherwise: Provenance) -> Provenance:
    """Take the entry of a format out of kept notations: the provenance that it means, or the other one without a version."""
    own = notations.get(ROOT, {})
    for name in own:
        if name in formats:
            return Provenance(name, own.pop(name), otherwise.file)
    return otherwise if not otherwise.version else Provenance(file=otherwise.file)
