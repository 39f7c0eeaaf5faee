"""Everything exactly, in ``hymeko:`` attributes: each element on its own prim, or on a prim that only carries it.

Beside the elements of a prim stands a digest of its native values, so that an edit of those wins on reading.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from pxr import Sdf

from hymeko_x.backends.usd.shapes import is_drawable
from hymeko_x.backends.usd.sheet import T, put, put_value
from hymeko_x.formats import usd as words
from hymeko_x.ir.mechanism import ROOT, WORLD, Id
from hymeko_x.ir.parts import Mesh
from hymeko_x.ir.values import Pose

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.backends.usd.sheet import Sheet
    from hymeko_x.formats.usd import Value
    from hymeko_x.ir.mechanism import RobotArc


def carry_elements(sheet: Sheet) -> None:
    """Author what every element says, then what the mechanism says as a whole, then the digests."""
    graph = sheet.mechanism.graph
    carried = {key for found in sheet.carried.values() for key in found.values()}
    for path, found in sheet.carried.items():
        for key in found.values():
            _carry(sheet, sheet.layer.GetPrimAtPath(path), key)
    alone = [key for key in (*graph.vertices, *graph.edges) if key not in carried and key != WORLD]
    for number, key in enumerate(alone):
        spec = sheet.define(_scope(sheet).AppendChild(f"e{number}"), "")
        put(spec, f"{words.PREFIX}alone", T.Bool, True)
        _carry(sheet, spec, key)
    _carry_mechanism(sheet)
    for path, made in sheet.made.items():
        spec = sheet.layer.GetPrimAtPath(path)
        own = tuple(dict.fromkeys(name for name in made if name not in sheet.restored.get(path, ())))
        if own:
            put_value(spec, f"{words.PREFIX}made", own)
        put(spec, words.DIGEST, T.String, words.digest(native_pairs(sheet, spec)))


def _scope(sheet: Sheet) -> Any:
    path = sheet.root.AppendChild(words.SCOPE)
    if not sheet.layer.GetPrimAtPath(path):
        put(sheet.define(path, "Scope"), f"{words.PREFIX}scope", T.Bool, True)
    return path


# ---- elements --------------------------------------------------------------------------------------------------------------------


def _carry(sheet: Sheet, spec: Any, key: Id) -> None:
    graph = sheet.mechanism.graph
    put_value(spec, words.attribute_name(key.kind, "id"), key.name)
    if key in graph.vertices:
        part = graph.vertices[key]
        pairs = _mesh_pairs(part, key in sheet.homes) if isinstance(part, Mesh) else words.flat(part)
    else:
        edge = graph.edges[key]
        pairs = words.flat(edge.data) | {"arcs:count": len(edge.arcs)}
        for number, arc in enumerate(edge.arcs):
            pairs |= {f"arcs:{number}:{name}": value for name, value in _arc_pairs(arc)}
    for name, value in {**pairs, **dict(_tables(sheet, key))}.items():
        put_value(spec, words.attribute_name(key.kind, name), value)


def _mesh_pairs(mesh: Mesh, has_prim: bool) -> dict[str, Value]:
    """The points of a mesh are the prim's own, unless single precision would change them; those of a file are not said."""
    pairs = words.flat(replace(mesh, vertices=(), faces=()))
    if mesh.uri is not None:
        return pairs
    if not has_prim or not is_drawable(mesh):
        return words.flat(mesh)
    points = np.asarray(mesh.vertices, dtype=np.float64)
    with np.errstate(over="ignore"):
        if not np.array_equal(points.astype(np.float32).astype(np.float64), points):
            pairs["vertices"] = mesh.vertices
    return pairs | {"native": True}


def _arc_pairs(arc: RobotArc) -> Iterator[tuple[str, Value]]:
    yield "to", f"{arc.target.kind} {arc.target.name}"
    if arc.sign:
        yield "sign", arc.sign
    if arc.role:
        yield "role", arc.role
    if isinstance(arc.weight, Pose):
        yield "pose:is", "Pose"
        yield from ((f"pose:{name}", value) for name, value in words.flat(arc.weight).items())
    elif arc.weight is not None:
        yield "numbers", arc.weight


def _tables(sheet: Sheet, key: Id) -> Iterator[tuple[str, Value]]:
    mechanism = sheet.mechanism
    extras = [extra for extra in mechanism.extras.get(key, ()) if extra.format != words.FORMAT]
    notations = mechanism.notations.get(key, {})
    stereotypes = mechanism.stereotypes.get(key, ())
    if extras:
        yield "extras", tuple(text for extra in extras for text in (extra.format, extra.path, extra.text, str(extra.index)))
    if notations:
        yield "notations", tuple(text for pair in notations.items() for text in pair)
    if stereotypes:
        yield "stereotypes", tuple(stereotypes)


def _carry_mechanism(sheet: Sheet) -> None:
    spec = sheet.layer.GetPrimAtPath(sheet.root)
    prefix = f"{words.PREFIX}mechanism:"
    put_value(spec, f"{prefix}version", words.VERSION)
    put_value(spec, f"{prefix}id", sheet.mechanism.name)
    for name, value in _tables(sheet, ROOT):
        put_value(spec, prefix + name, value)
    if sheet.mechanism.layout:
        put_value(spec, f"{prefix}layout", tuple(text for key in sheet.mechanism.layout for text in key))
    if WORLD in sheet.mechanism.graph.vertices:
        put(spec, f"{prefix}world", T.Bool, True)


# ---- digests ---------------------------------------------------------------------------------------------------------------------


def native_pairs(sheet: Sheet, spec: Any) -> Iterator[tuple[str, bytes]]:
    """Every property of a prim that is not ours, as the reader will see it through references within the layer."""
    yield "@type", str(spec.typeName).encode()
    schemas = spec.GetInfo("apiSchemas").GetAppliedItems() if spec.HasInfo("apiSchemas") else []
    yield "@apiSchemas", " ".join(sorted(schemas)).encode()
    said: dict[str, Any] = {}
    for reference in spec.referenceList.prependedItems:
        said |= {item.name: item for item in sheet.layer.GetPrimAtPath(reference.primPath).properties}
    said |= {item.name: item for item in spec.properties}
    for name, item in said.items():
        if name.startswith(words.PREFIX):
            continue
        targets = getattr(item, "targetPathList", None)
        yield name, " ".join(map(str, targets.GetAppliedItems())).encode() if targets is not None else value_bytes(item.default)


def value_bytes(value: Any) -> bytes:
    """A value as bytes: arrays by their memory, everything else by its text; a blocked value is none."""
    if isinstance(value, Sdf.ValueBlock):
        return b"None"
    if hasattr(value, "__len__") and not isinstance(value, str) and len(value) > 16:
        array = np.asarray(value)
        if array.dtype != object:
            return array.tobytes()
    return repr(value).encode()
