"""Stages in several files, and the residue in a root layer.

A layered stage is an interface with the default prim, and behind its payload geometry, materials and physics: the structure
that public guidelines for simulation-ready assets ask for. The interface is small, and each aspect can be replaced alone.
"""

from __future__ import annotations

import posixpath
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pxr import Sdf

from hymeko_x.formats import usd as words

if TYPE_CHECKING:
    from collections.abc import Iterator


GEOMETRY, MATERIALS, PHYSICS = ASPECTS = ("geometry", "materials", "physics")
MUJOCO, NEWTON, PHYSX, OURS = ENGINES = ("mujoco", "newton", "physx", "hymeko")
_CONTENTS = "contents"
_BASE, _POINTS = "base", "geometries"
_PHYSICS = ("physics:", "ext_physics:", "drive:", "limit:", "state:", "collection:colliders")
_OF_ENGINES = {"mjc:": MUJOCO, "newton:": NEWTON, "physx": PHYSX, "urdf:": OURS, "hymeko:": OURS}
_SCHEMAS_OF_ENGINES = {"Mjc": MUJOCO, "Newton": NEWTON, "Physx": PHYSX}
_MATERIALS = ("material:binding", "inputs:", "outputs:", "info:")
_PHYSICS_TYPES = ("Physics", "ExtendedPhysics")
_MATERIAL_TYPES = ("Material", "Shader", "NodeGraph")
_MOST_IN_TEXT = 64
_HEADER = ("metersPerUnit", "kilogramsPerUnit", "timeCodesPerSecond", "upAxis", "defaultPrim")


def split(layer: Any, folder: str, suffix: str) -> dict[str, Any]:
    """The layers of a stage by file name; the interface, under an empty name, refers to the others in this folder."""
    with Sdf.ChangeBlock():
        aspects, interface = _divided(layer, ASPECTS, folder)
        contents = Sdf.Layer.CreateAnonymous(".usda")
        _copy_header(layer, contents, _HEADER)
        suffixes = dict.fromkeys(ASPECTS, suffix) | ({GEOMETRY: ".usdc"} if _has_meshes(layer) else {})
        contents.subLayerPaths = [f"./{aspect}{suffixes[aspect]}" for aspect in reversed(ASPECTS)]
        _write_interface(layer, interface, f"./{folder}/{_CONTENTS}{suffix}")
    parts = {f"{folder}/{aspect}{suffixes[aspect]}": part for aspect, part in aspects.items()}
    return {"": interface, f"{folder}/{_CONTENTS}{suffix}": contents} | parts


def split_by_concern(layer: Any, folder: str, suffix: str) -> dict[str, Any]:
    """The layers of a stage by file name; the one to open, under an empty name, has the others of this folder as sublayers.

    Poses and shapes are the base, long arrays a crate file below it; each engine has a layer of its own above the neutral physics.

    Source: REP 158 (draft of 2026), 1.2.1 and 1.4. Payloads hide no body and no joint (1.2.3), so that there are none.
    """
    with Sdf.ChangeBlock():
        parts, interface = _divided(layer, (*ASPECTS, *ENGINES), folder)
        for root in layer.rootPrims:
            _write_root(root, interface)
    files = {_BASE if concern == GEOMETRY else concern: part for concern, part in parts.items() if part.rootPrims}
    interface.subLayerPaths = [f"./{folder}/{name}{suffix}" for name in reversed(files)]
    aside = set_points_aside(files[_BASE], f"{_POINTS}.usdc") if _BASE in files and suffix == ".usda" else {}
    return (
        {"": interface}
        | {f"{folder}/{name}{suffix}": part for name, part in files.items()}
        | {f"{folder}/{n}": p for n, p in aside.items()}
    )


def _divided(layer: Any, concerns: tuple[str, ...], folder: str) -> tuple[dict[str, Any], Any]:
    """The content of a stage as one layer for each concern, for files in this folder, and the interface, which has no prims yet."""
    parts = {concern: Sdf.Layer.CreateAnonymous(".usda") for concern in concerns}
    interface = Sdf.Layer.CreateAnonymous(".usda")
    for part in parts.values():
        _copy_header(layer, part, _HEADER)
    _copy_header(layer, interface, [name for name in layer.pseudoRoot.ListInfoKeys() if name != "primChildren"])
    for spec in _prims(layer):
        _divide(spec, parts)
    for part in parts.values():
        _lead_out(part, "../" * len(folder.split("/")))
    return parts, interface


def _has_meshes(layer: Any) -> bool:
    """Whether there are long arrays, which are no text for people and slow to read as one."""
    return any(spec.typeName == "Mesh" for spec in _prims(layer))


def set_points_aside(layer: Any, name: str) -> dict[str, Any]:
    """A layer for the arrays that are too long for a text, by its file name, which becomes a sublayer; none where there are none.

    Source: the rule of usdchecker and its successors that long arrays belong into crate files.
    """
    long = [item.path for spec in _prims(layer) for item in spec.attributes if _is_long(item.default)]
    if not long:
        return {}
    aside = Sdf.Layer.CreateAnonymous(".usda")
    _copy_header(layer, aside, _HEADER)
    above = {prefix.GetParentPath() for path in long for prefix in path.GetPrimPath().GetPrefixes()}
    with Sdf.ChangeBlock():
        for spec in _prims(layer):
            if spec.path.GetParentPath() in above:  # all of them: a stage begins with the children that its weaker layers name
                Sdf.CreatePrimInLayer(aside, spec.path)
        for path in long:
            Sdf.CopySpec(layer, path, aside, path)
            spec = layer.GetPrimAtPath(path.GetPrimPath())
            del spec.properties[path.name]
        layer.subLayerPaths.append(f"./{name}")
    return {name: aside}


def _is_long(value: Any) -> bool:
    return hasattr(value, "__len__") and not isinstance(value, str) and len(value) > _MOST_IN_TEXT


def encoded(layer: Any) -> bytes:
    """A layer as the bytes of a crate file, which USD writes only onto a disk: they pass through a temporary file."""
    with tempfile.TemporaryDirectory(prefix="hymeko-usd-") as folder:
        path = Path(folder) / "stage.usdc"
        layer.Export(str(path))
        return path.read_bytes()


def _copy_header(layer: Any, part: Any, names: list[str] | tuple[str, ...]) -> None:
    for name in names:
        if layer.pseudoRoot.HasInfo(name):
            part.pseudoRoot.SetInfo(name, layer.pseudoRoot.GetInfo(name))


def _prims(layer: Any) -> Iterator[Any]:
    """Every prim, those above first. Not recursive."""
    stack = list(reversed(layer.rootPrims))
    while stack:
        spec = stack.pop()
        yield spec
        stack.extend(reversed(spec.nameChildren))


def _write_interface(layer: Any, interface: Any, payload: str) -> None:
    """A prim for each root, which holds its content as a payload."""
    for root in layer.rootPrims:
        spec = _write_root(root, interface)
        spec.payloadList.prependedItems = [Sdf.Payload(payload, root.path)]


def _write_root(root: Any, interface: Any) -> Any:
    """What a root is, without its content."""
    spec = Sdf.CreatePrimInLayer(interface, root.path)
    spec.specifier = root.specifier
    if root.typeName:
        spec.typeName = root.typeName
    for name in ("kind", "displayName", "assetInfo"):
        if root.HasInfo(name):
            spec.SetInfo(name, root.GetInfo(name))
    return spec


# ---- which layer has which opinion -----------------------------------------------------------------------------------------------


def _divide(spec: Any, aspects: dict[str, Any]) -> None:
    """Each property and schema of a prim into the layer that it belongs to; the prim is defined where its type belongs.

    What belongs to an engine without a layer of its own is physics.
    """
    home = _or_physics(_home(str(spec.typeName)), aspects)
    parts = {home: Sdf.CreatePrimInLayer(aspects[home], spec.path)}
    parts[home].specifier = spec.specifier
    if spec.typeName:
        parts[home].typeName = spec.typeName
    for name in spec.ListInfoKeys():
        if name not in ("specifier", "typeName", "apiSchemas", "primChildren", "properties"):
            parts[home].SetInfo(name, spec.GetInfo(name))
    for item in spec.properties:
        aspect = _or_physics(_aspect(item.name, home), aspects)
        if aspect not in parts:
            parts[aspect] = Sdf.CreatePrimInLayer(aspects[aspect], spec.path)
        Sdf.CopySpec(spec.layer, item.path, aspects[aspect], item.path)
    schemas = spec.GetInfo("apiSchemas").GetAppliedItems() if spec.HasInfo("apiSchemas") else []
    for aspect in aspects:
        own = [schema for schema in schemas if _or_physics(_schema_aspect(schema, home), aspects) == aspect]
        if own:
            there = parts.get(aspect) or Sdf.CreatePrimInLayer(aspects[aspect], spec.path)
            there.SetInfo("apiSchemas", Sdf.TokenListOp.Create(prependedItems=own))


def _lead_out(layer: Any, up: str) -> None:
    """Files beside the interface are this far above its layers."""
    for spec in _prims(layer):
        for item in spec.attributes:
            path = item.default.path if isinstance(item.default, Sdf.AssetPath) else ""
            if path and not path.startswith("/") and ":" not in path:
                item.default = Sdf.AssetPath(posixpath.normpath(f"{up}{path}"))


def _or_physics(aspect: str, aspects: dict[str, Any]) -> str:
    return aspect if aspect in aspects else PHYSICS


def _of_engine(name: str, table: dict[str, str]) -> str | None:
    return next((engine for prefix, engine in table.items() if name.startswith(prefix)), None)


def _home(kind: str) -> str:
    if engine := _of_engine(kind, _SCHEMAS_OF_ENGINES):
        return engine
    if kind.startswith(_PHYSICS_TYPES):
        return PHYSICS
    return MATERIALS if kind in _MATERIAL_TYPES else GEOMETRY


def _aspect(name: str, home: str) -> str:
    if engine := _of_engine(name, _OF_ENGINES):
        return engine
    if name.startswith(_PHYSICS):
        return PHYSICS
    return MATERIALS if name.startswith(_MATERIALS) else home


def _schema_aspect(schema: str, home: str) -> str:
    if engine := _of_engine(schema, _SCHEMAS_OF_ENGINES):
        return engine
    if schema.startswith(_PHYSICS_TYPES):
        return PHYSICS
    return MATERIALS if schema.startswith("Material") else home


# ---- residue -----------------------------------------------------------------------------------------------------------------------


def text_with_residue(layer: Any, main: str, residue: str) -> bytes:
    """A layer, which is ``main`` as text, with a residue in its header; the prims stay as they are."""
    header = Sdf.Layer.CreateAnonymous(".usda")
    header.TransferContent(layer)
    for prim in list(header.rootPrims):
        del header.rootPrims[prim.name]
    prims = main[len(header.ExportToString()) :]
    _put(header, residue)
    return f"{header.ExportToString()}{prims}".encode()


def crate_with_residue(crate: bytes, residue: str) -> bytes:
    """A crate file with a residue in its header."""
    with tempfile.TemporaryDirectory(prefix="hymeko-usd-") as folder:
        old, new = Path(folder) / "old.usdc", Path(folder) / "new.usdc"
        old.write_bytes(crate)
        layer = Sdf.Layer.OpenAsAnonymous(str(old))
        _put(layer, residue)
        layer.Export(str(new))
        return new.read_bytes()


def _put(layer: Any, text: str) -> None:
    layer.customLayerData = {**layer.customLayerData, words.RESIDUE: text}
