"""The main file of a source on a disk, where USD wants it: a package (usdz) is unpacked beside it."""

from __future__ import annotations

import io
import os
import posixpath
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse

if TYPE_CHECKING:
    from hymeko_x.source import Source

MOST_FILES = 10_000
MOST_BYTES = 1 << 30
MOST_PACKED = 1 << 26
"""Files in packages are stored as they are; those who compress them anyway have no need for many."""
_LAYERS = (".usda", ".usdc", ".usd")


def lay_out(source: Source, base: str) -> str:
    """Write the source into a folder; returns the path of the layer to open.

    Raises: Refusal with HX001 (a damaged package), HX007 (too much in it).
    """
    if source.data.startswith(b"PK\x03\x04"):
        return _unpack(source, base)
    main = os.path.join(base, f"stage{_suffix(source)}")
    Path(main).write_bytes(source.data)
    return main


def _suffix(source: Source) -> str:
    """The suffix by which USD chooses its parser: by content where the name does not say."""
    if source.data.startswith(b"PXR-USDC"):
        return ".usdc"
    suffix = posixpath.splitext(source.name.lower())[1]
    return suffix if suffix in (".usda", ".usdc") else ".usda"


def _unpack(source: Source, base: str) -> str:
    """Every file of a package at its place; its first layer is the one to open."""
    try:
        with zipfile.ZipFile(io.BytesIO(source.data)) as package:
            items = [item for item in package.infolist() if not item.is_dir()]
            if len(items) > MOST_FILES or sum(item.file_size for item in items) > MOST_BYTES:
                raise refuse(codes.TOO_LARGE, f"the package holds more than {MOST_FILES} files or {MOST_BYTES} bytes", Origin(source.name))
            if sum(item.file_size for item in items if item.compress_type != zipfile.ZIP_STORED) > MOST_PACKED:
                raise refuse(codes.TOO_LARGE, f"the package holds more than {MOST_PACKED} bytes of compressed files", Origin(source.name))
            for item in items:
                _write(item.filename, package.read(item), base)
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError, OSError, ValueError) as error:
        raise refuse(codes.CANNOT_READ, f"the package is damaged: {error}", Origin(source.name)) from error
    main = next((item.filename for item in items if item.filename.lower().endswith(_LAYERS) and _is_inside(item.filename)), None)
    if main is None:
        raise refuse(codes.CANNOT_READ, "the package holds no layer of USD", Origin(source.name))
    return os.path.join(base, os.path.normpath(main))


def _is_inside(name: str) -> bool:
    return not (name.startswith("/") or "\\" in name or ":" in name or ".." in name.split("/"))


def _write(name: str, data: bytes, base: str) -> None:
    """One file; a name that leads out of the package is left alone."""
    if not _is_inside(name):
        return
    target = Path(base, os.path.normpath(name))
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(data)
