"""A composed stage from bytes, with its variants chosen, its instances expanded and its units."""

from __future__ import annotations

import os
import re
import tempfile
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from msgspec import Struct
from pxr import Gf, Sdf, Tf, Usd, UsdGeom, UsdPhysics

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.frontends.usd.layers import _UP, _gather, _words, check_paths, check_size, drop_unknown_types, lay_out
from hymeko_x.frontends.usd.messages import warnings_reported
from hymeko_x.frontends.usd.prims import read_layer

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.diagnostics import Report
    from hymeko_x.frontends.usd.prims import Prim, UsdLayer
    from hymeko_x.source import Source

MOST_PRIMS = 2_000_000
_MOST_UNIT = 1e12
"""Units of a stage lie between this and its inverse: from less than a picometre to more than the solar system."""
MOST_NESTED_INSTANCES = 32


class OpenStage(Struct, frozen=True):
    """An open stage in its own units; ``world`` turns its world into metres with z up; ``folder`` is where its layers lie.

    ``layer`` is self-contained, and ``prims`` are its prims by path.
    """

    stage: Any
    prims: Mapping[str, Prim]
    world: Any
    kilograms: float
    metres: float
    folder: str
    layer: Any


@contextmanager
def open_scene(source: Source, report: Report) -> Iterator[OpenStage]:
    """The composed stage of a source, with every instance expanded; everything is gone after the block.

    Raises: Refusal with HX001 (USD cannot read it, which it may find out only in the block), HX007 (too large).
    """
    try:
        with tempfile.TemporaryDirectory(prefix="hymeko-usd-", ignore_cleanup_errors=True) as folder:
            base = os.path.join(folder, *["d"] * _UP)
            os.makedirs(base)
            main = lay_out(source, base)
            with warnings_reported(source, main, report), _opened(main, base, source, report) as scene:
                yield scene
    except (Tf.ErrorException, UnicodeDecodeError) as error:
        raise refuse(codes.CANNOT_READ, f"the file is damaged: {_words(error)}", Origin(source.name)) from error


@contextmanager
def _opened(main: str, base: str, source: Source, report: Report) -> Iterator[OpenStage]:
    """The stage whose first layer was laid out at ``main``, in the folder ``base``."""
    layers = _gather(main, base, source, report)
    found = _read_plain(layers, source, report)
    if found is None:
        check_size(layers, MOST_PRIMS, source)
        drop_unknown_types(layers, source, report)
    stage = _composed(main, source)
    flat = stage.GetRootLayer()
    if found is None:
        _choose_variants(stage, source)
        _expand_instances(stage, source)
        flat = stage.Flatten(False)
        found = _read_layer(flat, source)
    _report_composition_errors(stage, base, source, report)
    found.stage = stage
    metres = _unit("metersPerUnit", UsdGeom.GetStageMetersPerUnit(stage), 0.01, source, report)
    kilograms = _unit("kilogramsPerUnit", UsdPhysics.GetStageKilogramsPerUnit(stage), 1.0, source, report)
    up = UsdGeom.GetStageUpAxis(stage)
    turn = Gf.Rotation(Gf.Vec3d(1, 0, 0), 90.0 if up == UsdGeom.Tokens.y else 0.0)
    world = Gf.Matrix4d().SetScale(metres) * Gf.Matrix4d().SetRotate(turn)
    try:
        yield OpenStage(stage, found.prims, world, kilograms, metres, base, flat)
    finally:
        found.close()
        del stage, layers, flat


def _unit(name: str, value: float, usual: float, source: Source, report: Report) -> float:
    """A unit of the stage; the usual one where the file has none that could be."""
    if 1.0 / _MOST_UNIT <= value <= _MOST_UNIT:
        return value
    report.error(codes.BAD_NUMBER, f"{name} is {value:g}, which is no unit; read as {usual:g}", Origin(source.name))
    return usual


def _composed(main: str, source: Source) -> Any:
    try:
        return Usd.Stage.Open(main, Usd.Stage.LoadAll)
    except Tf.ErrorException as error:
        raise refuse(codes.CANNOT_READ, f"USD cannot read it: {_words(error)}", Origin(source.name)) from error


_ARCS = frozenset(("references", "payload", "inheritPaths", "specializes", "variantSetNames", "instanceable"))


def _read_plain(layers: list[Any], source: Source, report: Report) -> UsdLayer | None:
    """The prims of a self-contained layer, which composing does not change; None where other layers or arcs contribute."""
    root = layers[0]
    if len(layers) > 1 or root.subLayerPaths or root.relocates or source.variants:
        return None
    found = _read_layer(root, source)
    if any(not _ARCS.isdisjoint(prim.metadata) for prim in found.prims.values()):
        return None
    if not found.has_unknown_types:
        return found
    drop_unknown_types(layers, source, report)
    return _read_layer(root, source)


def _read_layer(layer: Any, source: Source) -> UsdLayer:
    found = read_layer(layer, MOST_PRIMS)
    if found is None:
        raise refuse(codes.TOO_LARGE, f"it has more than {MOST_PRIMS} prims", Origin(source.name))
    check_paths(found.prims, source)
    return found


# ---- composition ---------------------------------------------------------------------------------------------------------------


def _choose_variants(stage: Any, source: Source) -> None:
    """Select the user's variants on every prim that has the set, also where only another selection defines the prim.

    Raises: Refusal HX040 when no prim has the set, or none has that variant.
    """
    known: dict[str, set[str]] = {}
    for _ in range(MOST_NESTED_INSTANCES if source.variants else 0):
        found = [(prim, name) for prim in stage.Traverse() for name in prim.GetVariantSets().GetNames() if name in source.variants]
        for prim, name in found:
            known.setdefault(name, set()).update(prim.GetVariantSets().GetVariantSet(name).GetVariantNames())
        if not _select(stage, source, found):
            break
    for name, variant in source.variants.items():
        if variant not in known.get(name, ()):
            message = f"the variant set '{name}' has no variant '{variant}'" if name in known else f"no prim has a variant set '{name}'"
            hint = f"it has: {', '.join(sorted(known[name]))}" if name in known else ""
            raise refuse(codes.UNDEFINED_REFERENCE, message, Origin(source.name), hint=hint)


def _select(stage: Any, source: Source, found: list[tuple[Any, str]]) -> bool:
    """Make the selections that are not made yet; returns whether there were any."""
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        sets = [(prim.GetVariantSets().GetVariantSet(name), source.variants[name]) for prim, name in found]
        changed = [(item, variant) for item, variant in sets if item.GetVariantSelection() != variant and variant in item.GetVariantNames()]
        for item, variant in changed:
            item.SetVariantSelection(variant)
    return bool(changed)


def _expand_instances(stage: Any, source: Source) -> None:
    """Turn every instance into prims of its own, level by level, so that each can be read at its place."""
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for _ in range(MOST_NESTED_INSTANCES):
            instances = []
            for count, prim in enumerate(stage.Traverse()):
                if count >= MOST_PRIMS:
                    raise refuse(codes.TOO_LARGE, f"it has more than {MOST_PRIMS} prims", Origin(source.name))
                if prim.IsInstance():
                    instances.append(prim)
            if not instances:
                return
            with Sdf.ChangeBlock():
                for prim in instances:
                    Sdf.CreatePrimInLayer(stage.GetSessionLayer(), prim.GetPath()).SetInfo("instanceable", False)
    raise refuse(codes.TOO_LARGE, f"instances are nested deeper than {MOST_NESTED_INSTANCES} levels", Origin(source.name))


_OURS = re.compile(r",?@anon:0x[0-9a-f]+:[^@]*@")


def _report_composition_errors(stage: Any, base: str, source: Source, report: Report) -> None:
    for error in stage.GetCompositionErrors()[:20]:
        authored = _OURS.sub("", str(error).replace(base + "/", ""))
        report.error(codes.UNDEFINED_REFERENCE, f"composition: {' '.join(authored.split())[:300]}", Origin(source.name))
