"""USD out as a binary crate file: the same stage as the text, smaller and faster to open."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.usd import write_layers
from hymeko_x.backends.usd.layers import crate_with_residue, encoded
from hymeko_x.source import Package

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Options


def write(mechanism: Mechanism, options: Options, report: Report) -> Package:
    """The mechanism as a crate file. Textures are not part of it: `assets.pack` returns them."""
    crates = {name: encoded(layer) for name, layer in write_layers(mechanism, options, report, ".usdc").items()}
    main = crates.pop("")
    return Package(main, crates, with_residue=lambda residue: crate_with_residue(main, residue))
