"""USD out as a binary crate file: the same stage as the text, smaller and faster to open.

USD encodes crates only onto a disk, so the bytes pass through a temporary file, which is gone afterwards.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hymeko_x.backends.usd import write_layers
from hymeko_x.source import Package

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism


def write(mechanism: Mechanism, report: Report) -> Package:
    """The mechanism as a crate file. Textures are not part of it: `assets.pack` returns them."""
    crates = {name: encoded(layer) for name, layer in write_layers(mechanism, report, ".usdc").items()}
    return Package(crates.pop(""), crates)


def encoded(layer: Any) -> bytes:
    """A layer as the bytes of a crate file."""
    with tempfile.TemporaryDirectory(prefix="hymeko-usd-") as folder:
        path = Path(folder) / "stage.usdc"
        layer.Export(str(path))
        return path.read_bytes()
