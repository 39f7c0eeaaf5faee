"""Where USD carries a residue: a string in the custom data of the root layer."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pxr import Sdf, Tf

from hymeko_x.backends.usd.archive import unzipped, zipped
from hymeko_x.formats import carrier

if TYPE_CHECKING:
    from hymeko_x.source import Package


def carry_in_text(package: Package, text: str) -> Package:
    """The package with a residue in its text layer, of which only the header is parsed."""
    whole = package.main.decode()
    head, end, prims = whole.partition("\n)\n")
    header = _parsed(head + end)
    if header is None:  # a string in the header looks like its end
        header, prims = _parsed(whole), ""
    assert header is not None
    _put(header, text)
    said = header.ExportToString()
    return replace(package, main=(said.rstrip("\n") + "\n" + prims if prims else said).encode())


def _parsed(text: str) -> Any | None:
    layer = Sdf.Layer.CreateAnonymous(".usda")
    try:
        return layer if layer.ImportFromString(text) else None
    except Tf.ErrorException:
        return None


def carry_in_crate(package: Package, text: str) -> Package:
    """The package with a residue in its crate file."""
    return replace(package, main=_rewritten(package.main, text))


def carry_in_zip(package: Package, text: str) -> Package:
    """The package with a residue in the first layer of its zip file; everything else in it stays."""
    files = unzipped(package.main)
    first = next(iter(files))
    return replace(package, main=zipped(files | {first: _rewritten(files[first], text)}))


def _rewritten(crate: bytes, text: str) -> bytes:
    with tempfile.TemporaryDirectory(prefix="hymeko-usd-") as folder:
        old, new = Path(folder) / "old.usdc", Path(folder) / "new.usdc"
        old.write_bytes(crate)
        layer = Sdf.Layer.OpenAsAnonymous(str(old))
        _put(layer, text)
        layer.Export(str(new))
        return new.read_bytes()


def _put(layer: Any, text: str) -> None:
    layer.customLayerData = {**layer.customLayerData, carrier.USD_KEY: text}
