"""Everything exactly, in ``hymeko:`` attributes: each element on its own prim, or on a prim that only carries it.

Beside the elements of a prim stands a digest of its native values, so that an edit of those wins on reading.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from pxr import Sdf, Vt

from hymeko_x.backends.usd.prims import T, add_attribute, authored_pairs, drafted_pairs, stored
from hymeko_x.backends.usd.surfaces import surface_of
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
        spec = sheet.layer.GetPrimAtPath(path)
        for key in found.values():
            _carry(sheet, spec, key)
    alone = [key for key in (*graph.vertices, *graph.edges) if key not in carried and key != WORLD]
    if alone:
        _carry_alone(sheet, alone)
    _carry_mechanism(sheet)
    for path, made in sheet.made.items():
        spec = sheet.layer.GetPrimAtPath(path)
        names = dict.fromkeys((*made, *_zeros(sheet, path)))
        own = [name for name in names if name not in sheet.restored.get(path, ())]
        if own:
            add_attribute(spec, f"{words.PREFIX}made", T.StringArray, Vt.StringArray(own))
        add_attribute(spec, words.DIGEST, T.String, words.digest(_native_pairs(sheet, path, spec)))


def _zeros(sheet: Sheet, path: Any) -> list[str]:
    """The numbers of a prim that say nothing by themselves, with its schemas: the reader would keep them as they are."""
    prim = sheet.prims.get(path)
    if prim is None:
        return []
    numbers = {name: stored(kind, value) for name, (kind, value) in prim.attributes.items() if isinstance(value, float)}
    found = [name for name, value in numbers.items() if value == 0.0 or math.isinf(value)]
    return [*found, *(f"@{schema}" for schema in prim.schemas)] if found else []


def _native_pairs(sheet: Sheet, path: Any, spec: Any) -> Iterator[tuple[str, bytes]]:
    """The native values of a prim: as drafted, unless extras have changed it since."""
    prim = sheet.prims.get(path)
    if prim is not None and path not in sheet.restored:
        return drafted_pairs(prim, sheet.prims)
    return (pair for pair in authored_pairs(spec, sheet.layer) if not pair[0].startswith(words.PREFIX))


def _carry_alone(sheet: Sheet, keys: list[Id]) -> None:
    """Elements without a prim, each on one that stands for nothing else."""
    path = sheet.root.AppendChild(words.SCOPE)
    group = sheet.layer.GetPrimAtPath(path)
    if not group:
        group = _new_prim(sheet.layer, path, "Scope")
        add_attribute(group, f"{words.PREFIX}scope", T.Bool, True)
    for number, key in enumerate(keys):
        spec = _new_prim(sheet.layer, path.AppendChild(f"e{number}"), "Scope")
        add_attribute(spec, f"{words.PREFIX}alone", T.Bool, True)
        _carry(sheet, spec, key)


def _new_prim(layer: Any, path: Any, kind: str) -> Any:
    spec = Sdf.CreatePrimInLayer(layer, path)
    spec.specifier = Sdf.SpecifierDef
    spec.typeName = kind
    return spec


# ---- elements --------------------------------------------------------------------------------------------------------------------


def _carry(sheet: Sheet, spec: Any, key: Id) -> None:
    graph = sheet.mechanism.graph
    if key in graph.vertices:
        part = graph.vertices[key]
        pairs = _mesh_pairs(part, key in sheet.homes) if isinstance(part, Mesh) else words.flat(part)
    else:
        edge = graph.edges[key]
        pairs = words.flat(edge.data) | {"arcs:count": len(edge.arcs)}
        for number, arc in enumerate(edge.arcs):
            pairs |= {f"arcs:{number}:{name}": value for name, value in _arc_pairs(arc)}
    _author(spec, key.kind, {"id": key.name, **pairs, **dict(_tables(sheet, key))})


def _author(spec: Any, kind: str, pairs: dict[str, Value]) -> None:
    """One text for all that an element says, beside which long arrays stand as such."""
    long = {name: value for name, value in pairs.items() if isinstance(value, tuple) and words.is_long(value)}
    said = {name: value for name, value in pairs.items() if name not in long}
    add_attribute(spec, words.PREFIX + kind, T.String, words.text_of(said))
    for name, value in long.items():
        whole = all(type(item) is int for item in value)
        array = Vt.Int64Array(list(value)) if whole else Vt.DoubleArray([float(item) for item in value])
        add_attribute(spec, f"{words.PREFIX}{kind}:{name}", T.Int64Array if whole else T.DoubleArray, array)


def _mesh_pairs(mesh: Mesh, has_prim: bool) -> dict[str, Value]:
    """The points of a mesh are the prim's own, unless single precision would change them; those of a file are not said."""
    pairs = words.flat(replace(mesh, vertices=(), faces=()))
    if mesh.uri is not None:
        return pairs
    if not has_prim or surface_of(mesh) is None:
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
    pairs: dict[str, Value] = {"version": words.VERSION, "id": sheet.mechanism.name, **dict(_tables(sheet, ROOT))}
    if sheet.mechanism.layout:
        pairs["layout"] = tuple(text for key in sheet.mechanism.layout for text in key)
    if WORLD in sheet.mechanism.graph.vertices:
        pairs["world"] = True
    pairs |= {f"world_{name}": value for name, value in _tables(sheet, WORLD)}
    _author(sheet.layer.GetPrimAtPath(sheet.root), "mechanism", pairs)
