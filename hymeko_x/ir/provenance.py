"""What a mechanism keeps of its source: format and version among the kept notations, and meshes that the file itself holds."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.ir.ids import ROOT

if TYPE_CHECKING:
    from collections.abc import Container, Mapping

    from hymeko_x.ir import parts
    from hymeko_x.ir.ids import Id


class Provenance(NamedTuple):
    """Where a mechanism came from: the format whose extras, notations and default classes it has, and the file that was read.

    ``version`` is given where the format needs one to be understood; then texts and residues keep format and version. All empty:
    the mechanism was made by a program.
    """

    format: str = ""
    version: str = ""
    file: str = ""


class StoredLook(NamedTuple):
    """What some triangles of a mesh show: a material, with its image if it has one."""

    material: parts.Material
    texture: parts.Texture | None
    faces: tuple[int, ...]


class StoredMesh(NamedTuple):
    """A mesh as the file that was read has it, where the mechanism refers to another one: its points or file, and its appearance there."""

    mesh: parts.Mesh
    looks: tuple[StoredLook, ...] = ()


def kept_notations(notations: Mapping[Id, Mapping[str, str]], source: Provenance) -> Mapping[Id, Mapping[str, str]]:
    """The notations by element; where the source has a version, the mechanism as a whole has an entry of the format's name."""
    if not source.version:
        return notations
    return {**notations, ROOT: {**notations.get(ROOT, {}), source.format: source.version}}


def take_provenance(notations: Mapping[Id, dict[str, str]], formats: Container[str], otherwise: Provenance) -> Provenance:
    """Take the entry of a format out of kept notations: the provenance that it means, or the other one without a version."""
    own = notations.get(ROOT, {})
    for name in own:
        if name in formats:
            return Provenance(name, own.pop(name), otherwise.file)
    return otherwise if not otherwise.version else Provenance(file=otherwise.file)
