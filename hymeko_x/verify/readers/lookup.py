"""What a reference reader gets beside the path of a file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct, field

from hymeko_x.assets.resolve import DiskFiles

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from hymeko_x.source import Files


class Lookup(Struct, frozen=True):
    """Where a robot's files are, and which of its choices are meant.

    ``packages`` are the user's own NAME=DIR, ``search_path`` the folders of further packages, ``arguments`` those of a file with macros,
    ``variants`` the selected variant of each variant set.
    """

    packages: Mapping[str, Path] = field(default_factory=dict)
    search_path: tuple[Path, ...] = ()
    arguments: Mapping[str, str] = field(default_factory=dict)
    variants: Mapping[str, str] = field(default_factory=dict)

    def files(self, folder: Path) -> Files:
        """The files that a robot in this folder may refer to."""
        return DiskFiles(folder, self.packages, self.search_path)
