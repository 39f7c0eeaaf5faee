"""What the reader kept of prims as USD text, put back on the prims of the elements that it belongs to."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from pxr import Sdf

from hymeko_x import codes
from hymeko_x.backends.usd.sheet import parsed_layer, set_schemas
from hymeko_x.formats.usd import FORMAT
from hymeko_x.ir.mechanism import ROOT, Extra

if TYPE_CHECKING:
    from hymeko_x.backends.usd.sheet import UsdSheet
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Id

_STAGE = "/"


def restore_extras(sheet: UsdSheet, report: Report) -> None:
    """Every extra of this format: its attributes win over those that were derived, its API schemas are added."""
    found = [(key, extra) for key, extras in sheet.mechanism.extras.items() for extra in extras if extra.format == FORMAT]
    for key, extra in found:
        if extra.path == _STAGE and key == ROOT:
            _restore_stage(sheet, extra, report)
    blocks = [(key, extra) for key, extra in found if not (extra.path == _STAGE and key == ROOT)]
    if not blocks:
        return
    for (key, extra), parsed in zip(blocks, _parsed(blocks, report), strict=True):
        path = _target(sheet, key, extra.path)
        if path is not None and parsed is not None:
            _merge(sheet, parsed[1], path)


Parsed = tuple[Any, Any] | None


def _parsed(blocks: list[tuple[Id, Extra]], report: Report) -> list[Parsed]:
    """The layer and prim of each block; all are parsed at once, and one by one only where one of them is damaged."""
    text = "#usda 1.0\n" + "".join(f'over "e{number}"\n{{\n{extra.text}\n}}\n' for number, (_, extra) in enumerate(blocks))
    layer = parsed_layer(text)
    if layer is not None and all(len(spec.nameChildren) == 1 for spec in layer.rootPrims):
        return [(layer, spec.nameChildren[0]) for spec in layer.rootPrims]
    found: list[Parsed] = []
    for key, extra in blocks:
        alone = parsed_layer(f"#usda 1.0\n{extra.text}\n")
        if alone is None or len(alone.rootPrims) != 1:
            report.warn(codes.NOT_REPRESENTED, f"an extra of {key} is no USD text; it is left out", element=str(key))
        found.append((alone, alone.rootPrims[0]) if alone is not None and len(alone.rootPrims) == 1 else None)
    return found


def _restore_stage(sheet: UsdSheet, extra: Extra, report: Report) -> None:
    header = parsed_layer(extra.text)
    if header is None:
        report.warn(codes.NOT_REPRESENTED, "an extra of the stage is no USD text; it is left out")
        return
    for name in header.pseudoRoot.ListInfoKeys():
        if name not in ("primChildren", "subLayers"):
            sheet.layer.pseudoRoot.SetInfo(name, header.pseudoRoot.GetInfo(name))


def _target(sheet: UsdSheet, key: Id, relative: str) -> Any | None:
    home = sheet.paths.get(key, Sdf.Path.absoluteRootPath if key == ROOT else None)
    if home is None:
        return None
    if not relative:
        return home
    if not Sdf.Path.IsValidPathString(relative):
        return None
    path = Sdf.Path(relative).MakeAbsolutePath(home)
    return path if path.IsPrimPath() else None


def _merge(sheet: UsdSheet, spec: Any, path: Any) -> None:
    """Every opinion of a block, on the prim at this path, which may have to be made."""
    there = sheet.layer.GetPrimAtPath(path)
    if there is None:
        there = _new_prim(sheet, path)
        there.specifier = spec.specifier
    if spec.specifier != Sdf.SpecifierOver:
        there.specifier = spec.specifier
    if spec.typeName and (there.typeName in ("", "Xform") or not sheet.is_made(path)):
        there.typeName = spec.typeName
    if not spec.typeName and spec.specifier != Sdf.SpecifierOver and path not in sheet.element_paths:
        there.ClearInfo("typeName")
    if spec.HasInfo("apiSchemas"):
        schemas = spec.GetInfo("apiSchemas").GetAppliedItems()
        present = list(there.GetInfo("apiSchemas").GetAppliedItems()) if there.HasInfo("apiSchemas") else []
        set_schemas(there, [*present, *(schema for schema in schemas if schema not in present)])
    for name in spec.ListInfoKeys():
        if name not in ("specifier", "typeName", "apiSchemas"):
            there.SetInfo(name, spec.GetInfo(name))
    for item in spec.properties:
        if item.name in there.properties and _is_default(item):
            continue
        Sdf.CopySpec(spec.layer, item.path, sheet.layer, path.AppendProperty(item.name))


def _is_default(item: Any) -> bool:
    """Whether a number is only a default, so that a typed value beside it counts."""
    value = getattr(item, "default", None)
    return isinstance(value, float) and (value == 0.0 or math.isinf(value))


def _new_prim(sheet: UsdSheet, path: Any) -> Any:
    """A new prim; groups above it that have no opinion become Xforms."""
    missing = [above for above in path.GetPrefixes()[:-1] if not sheet.layer.GetPrimAtPath(above)]
    spec = Sdf.CreatePrimInLayer(sheet.layer, path)
    for above in missing:
        group = sheet.layer.GetPrimAtPath(above)
        group.specifier = Sdf.SpecifierDef
        group.typeName = "Xform"
    return spec
