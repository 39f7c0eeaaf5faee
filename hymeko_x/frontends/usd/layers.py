"""The layers of a stage: the file and every layer that it refers to, written into a private temporary folder.

USD opens layers by path only, and crate files only from a disk. So the bytes that the source's ``files`` hand out are
written below one temporary folder, in which no reference leads anywhere else. Layers are checked before USD composes them:
references that copy references double with every level, and USD's parser recurses.
"""

from __future__ import annotations

import io
import os
import posixpath
import re
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pxr import Sdf, Tf

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from hymeko_x.diagnostics import Report
    from hymeko_x.source import Source

MOST_FILES = 10_000
MOST_BYTES = 1 << 30
MOST_PACKED = 1 << 26
"""Files in packages are stored uncompressed by rule; compressed ones are accepted up to this size."""
_LAYERS = (".usda", ".usdc", ".usd")


def lay_out(source: Source, base: str) -> str:
    """Write the source into a folder; returns the path of the layer to open.

    Raises: Refusal with HX001 (a damaged package), HX007 (too much in it).
    """
    if source.data.startswith(b"PK\x03\x04"):
        return _unpack(source, base)
    main = os.path.join(base, f"stage{_suffix_of(source)}")
    Path(main).write_bytes(source.data)
    return main


def _suffix_of(source: Source) -> str:
    """The suffix by which USD chooses its parser: by content where the name does not have one."""
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
                _write_file(item.filename, package.read(item), base)
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError, OSError, ValueError) as error:
        raise refuse(codes.CANNOT_READ, f"the package is damaged: {error}", Origin(source.name)) from error
    main = next((item.filename for item in items if item.filename.lower().endswith(_LAYERS) and _is_inside(item.filename)), None)
    if main is None:
        raise refuse(codes.CANNOT_READ, "the package holds no layer of USD", Origin(source.name))
    return os.path.join(base, os.path.normpath(main))


def _is_inside(name: str) -> bool:
    return not (name.startswith("/") or "\\" in name or ":" in name or ".." in name.split("/"))


def _write_file(name: str, data: bytes, base: str) -> None:
    """One file; a name that leads out of the package is left alone."""
    if not _is_inside(name):
        return
    target = Path(base, os.path.normpath(name))
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(data)


MOST_LAYERS = 10_000
_FOLDER = re.compile(r"[^\s'<@]*hymeko-usd-[^\s'>@]*/")
_UP = 8
"""How many folders a reference may lead upwards from the file."""
_SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")


def _words(error: Exception) -> str:
    """The first sentence of an error of USD, without its own source files and the temporary folder."""
    try:
        text = str(error)
    except UnicodeDecodeError:  # USD quotes the bytes of the file
        return "it is not UTF-8"
    authored = text.rsplit(" : ", 1)[-1].split(" matching ")[0] if " : " in text else text
    return " ".join(_FOLDER.sub("", authored).strip("' \n\t").split())[:300] or "no reason is given"


# ---- layers ------------------------------------------------------------------------------------------------------------------


def _gather(main: str, base: str, source: Source, report: Report) -> list[Any]:
    """Every layer that can be reached, written where the reference expects it; a missing one is reported and left out."""
    waiting, kept, seen = [main], [], {main}
    while waiting:
        path = waiting.pop()
        layer = _layer(path, base, source, report, is_main=path == main)
        if layer is None:
            continue
        kept.append(layer)
        if len(kept) > MOST_LAYERS:
            raise refuse(codes.TOO_LARGE, f"it is made of more than {MOST_LAYERS} layers", Origin(source.name))
        for uri in sorted(layer.GetCompositionAssetDependencies()):
            found = _fetch(uri, layer.realPath, base, source, report)
            layer.UpdateCompositionAssetDependency(uri, found or "")
            if found and found not in seen:
                seen.add(found)
                waiting.append(found)
    return kept


def _layer(path: str, base: str, source: Source, report: Report, *, is_main: bool) -> Any | None:
    check_depth(path, source)
    try:
        return Sdf.Layer.FindOrOpen(path)
    except Tf.ErrorException as error:
        if is_main:
            raise refuse(codes.CANNOT_READ, f"USD cannot read it: {_words(error)}", Origin(source.name)) from error
        message = f"layer '{os.path.relpath(path, base)}' cannot be read: {_words(error)}; it is left out"
        report.error(codes.CANNOT_READ, message, Origin(source.name))
        return None


def _fetch(uri: str, layer: str, base: str, source: Source, report: Report) -> str | None:
    """The path in the temporary folder of the file that a layer refers to; None when there is none."""
    if not uri:
        return None
    folder = posixpath.dirname(os.path.relpath(layer, base).replace(os.sep, "/"))
    there = os.path.normpath(os.path.join(base, folder, uri))
    if not _is_absolute(uri) and there.startswith(base + os.sep) and os.path.isfile(there):
        return there
    for way in dict.fromkeys((uri if _is_absolute(uri) else posixpath.normpath(posixpath.join(folder, uri)), uri)):
        found = source.files.find(way)
        if found is None:
            continue
        target = _target(way, found, base)
        try:
            data = source.files.read(found)
        except OSError:
            continue
        os.makedirs(os.path.dirname(target), exist_ok=True)
        Path(target).write_bytes(data)
        return target
    report.error(codes.ASSET_NOT_FOUND, f"the layer '{uri}' was not found; its content is missing", Origin(source.name))
    return None


def _target(way: str, found: str, base: str) -> str:
    """Where a file is laid: at its place relative to the main file where it has one, else in a folder for such files."""
    place = os.path.normpath(os.path.join(base, way))
    root = os.path.join(base, *[".."] * _UP)
    is_inside = not _is_absolute(way) and place.startswith(os.path.normpath(root) + os.sep)
    if is_inside and posixpath.splitext(way)[1].lower() in _SUFFIXES and not os.path.basename(place).startswith("stage."):
        return place
    return os.path.join(base, "elsewhere", found.replace(os.sep, "/").strip("/").replace("/", "__").replace(":", "_"))


def _is_absolute(uri: str) -> bool:
    return uri.startswith(("/", "\\")) or "://" in uri or (len(uri) > 1 and uri[1] == ":")


FEW = 12
"""With fewer references than these a stage is not counted: it cannot grow far."""

MOST_DEPTH = 2048
"""How deep blocks of a text may be nested: USD's parser recurses."""

Place = tuple[str, str]
"""A layer by its identifier, and the path of a prim in it."""


_PIECES = re.compile(rb'''"""(?:\\.|[^\\])*?"""|'{3}(?:\\.|[^\\])*?'{3}|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|#[^\n]*|[{}]''', re.DOTALL)


def check_depth(path: str, source: Source) -> None:
    """Refuse a text that would overflow the stack of USD's parser.

    Raises: Refusal HX007.
    """
    with open(path, "rb") as file:
        data = file.read() if file.read(5) == b"#usda" else b""
    if data.count(b"{") <= MOST_DEPTH:
        return
    depth = 0
    for found in _PIECES.finditer(data):
        depth += (found[0] == b"{") - (found[0] == b"}")
        if depth > MOST_DEPTH:
            raise refuse(codes.TOO_LARGE, f"blocks are nested more than {MOST_DEPTH} deep", Origin(source.name))


def check_paths(paths: Iterable[str], source: Source) -> None:
    """Refuse prims that lie too deep, which a binary layer shows only when it is open: composing them recurses.

    Raises: Refusal HX007.
    """
    if any(path.count("/") > MOST_DEPTH for path in paths):
        raise refuse(codes.TOO_LARGE, f"prims are nested more than {MOST_DEPTH} deep", Origin(source.name))


def check_size(layers: list[Any], most: int, source: Source) -> None:
    """Refuse a stage of more than ``most`` prims before USD composes it. A prim that refers to itself counts once.

    Raises: Refusal HX007.
    """
    known = {layer.identifier: layer for layer in layers} | {layer.realPath: layer for layer in layers}
    below = {(layer.identifier, str(spec.path)): list(_parts(layer, spec, known)) for layer in layers for spec in specs(layer)}
    check_paths((path for _, path in below), source)
    if sum(len(parts) for parts in below.values()) - len(below) < FEW:
        return
    sizes: dict[Place, int] = {}
    for start in below:
        if _count(start, below, sizes) > most:
            raise refuse(codes.TOO_LARGE, f"it has more than {most} prims when everything is composed", Origin(source.name))


def _count(start: Place, below: dict[Place, list[Place]], sizes: dict[Place, int]) -> int:
    """The number of prims at a place with everything that is in it and everything that it refers to."""
    stack, open_now = [start], set()
    while stack:
        place = stack[-1]
        if place in sizes:
            stack.pop()
        elif place in open_now:
            open_now.discard(place)
            sizes[place] = 1 + sum(sizes.get(part, 0) for part in below.get(place, ()))
            stack.pop()
        else:
            open_now.add(place)
            stack.extend(part for part in below.get(place, ()) if part not in open_now and part not in sizes)
    return sizes[start]


def specs(layer: Any) -> Iterator[Any]:
    """Every prim that a layer has an opinion about, also in variants. Not recursive."""
    stack = [layer.pseudoRoot]
    while stack:
        spec = stack.pop()
        yield spec
        stack.extend(spec.nameChildren)
        stack.extend(variant.primSpec for group in spec.variantSets for variant in group.variants)


def _parts(layer: Any, spec: Any, known: dict[str, Any]) -> Iterator[Place]:
    """What a prim is made of: the prims in it, and those that it refers to."""
    for inside in (*spec.nameChildren, *(variant.primSpec for group in spec.variantSets for variant in group.variants)):
        yield layer.identifier, str(inside.path)
    for path in (*spec.inheritPathList.GetAppliedItems(), *spec.specializesList.GetAppliedItems()):
        yield layer.identifier, str(path)
    for arc in (*spec.referenceList.GetAppliedItems(), *spec.payloadList.GetAppliedItems()):
        target = known.get(layer.ComputeAbsolutePath(arc.assetPath)) if arc.assetPath else layer
        path = str(arc.primPath) or (f"/{target.defaultPrim}" if target is not None else "")
        if target is not None:
            yield target.identifier, path


def drop_unknown_types(layers: list[Any], source: Source, report: Report) -> None:
    """Remove attributes of types that USD cannot read, which have no usable value, from the layers (copies)."""
    for layer in layers:
        for prim in specs(layer):
            unknown = [attribute for attribute in prim.attributes if attribute.typeName.type == Tf.Type.Unknown]
            for attribute in unknown:
                message = f"'{attribute.path}' has the type '{attribute.typeName}', which USD cannot read; it is left out"
                report.error(codes.BAD_VALUE, message, Origin(source.name), element=str(prim.path))
                prim.RemoveProperty(attribute)
