"""What the packing of meshes and of textures for MuJoCo share: one run, and its warnings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import field

from hymeko_x import codes
from hymeko_x.assets.pack import package_hint
from hymeko_x.ir.builder import Builder

if TYPE_CHECKING:
    from hymeko_x.assets.shelf import Shelf
    from hymeko_x.diagnostics import Code, Report
    from hymeko_x.ir.mechanism import Extra, Id, Mechanism
    from hymeko_x.ir.parts import Rgba
    from hymeko_x.source import Files


class Packing(Builder, kw_only=True):
    """One run: what it reads from, and what it adds to the mechanism.

    ``attributes`` are those of meshes and textures in MJCF, ``materials`` those of appearances in files, by colour and image, ``plain``
    those of the robot itself without more than these, by colour.
    """

    mechanism: Mechanism
    shelf: Shelf
    files: Files
    report: Report
    gone: list[Id] = field(default_factory=list)
    attributes: dict[Id, Extra] = field(default_factory=dict)
    materials: dict[tuple[object, bytes | None], Id] = field(default_factory=dict)
    plain: dict[Rgba | None, list[Id]] | None = None


def warn(run: Packing, key: Id, code: Code, message: str, uri: str | None = None) -> None:
    """Report that an asset is left out."""
    hint = package_hint(uri or "") if code is codes.ASSET_NOT_FOUND else ""
    run.report.warn(code, f"{key}: {message}", run.mechanism.origin(key), element=str(key), hint=hint)
