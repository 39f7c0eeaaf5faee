"""USD out: one stage in metres and kilograms with z up, flat bodies, joint frames on both sides, drives and materials.

The residue of the root layer contains parts that USD cannot represent, and the digits that single precision cuts off.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pxr import Kind, Sdf, UsdGeom

from hymeko_x.backends.usd.actuators import write_actuators, write_drives
from hymeko_x.backends.usd.bodies import write_bodies
from hymeko_x.backends.usd.contacts import write_contacts, write_frictions
from hymeko_x.backends.usd.couplings import write_mimics
from hymeko_x.backends.usd.extras import restore_extras
from hymeko_x.backends.usd.joints import write_joints, write_loops
from hymeko_x.backends.usd.layers import encoded, set_points_aside, split, split_by_concern, text_with_residue
from hymeko_x.backends.usd.materials import write_materials
from hymeko_x.backends.usd.mounts import write_mounts
from hymeko_x.backends.usd.shapes import write_shapes
from hymeko_x.backends.usd.sheet import UsdSheet, apply, author, valid_name
from hymeko_x.backends.usd.tendons import write_tendons
from hymeko_x.formats import usd as words
from hymeko_x.formats.usd.articulations import ARTICULATION, BEGUN
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.source import Package

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Options

_SECTIONS = (
    write_materials,
    write_bodies,
    write_shapes,
    write_mounts,
    write_contacts,
    write_frictions,
    write_joints,
    write_loops,
    write_drives,
    write_tendons,
    write_actuators,
    write_mimics,
)


def write(mechanism: Mechanism, options: Options, report: Report) -> Package:
    """The mechanism as USD text. Textures are not part of it: `assets.pack` returns them."""
    layers = write_layers(mechanism, options, report, ".usda")
    if options.beside and len(layers) == 1:
        layers |= set_points_aside(layers[""], f"{options.within}{options.beside}_meshes.usdc")
    root = layers.pop("")
    main = root.ExportToString()
    beside = {name: encoded(layer) if name.endswith(".usdc") else layer.ExportToString().encode() for name, layer in layers.items()}
    return Package(main.encode(), beside, with_residue=lambda residue: text_with_residue(root, main, residue))


def write_layers(mechanism: Mechanism, options: Options, report: Report, suffix: str) -> dict[str, Any]:
    """The layers of the stage by file name, the one to open under an empty name."""
    layer = write_layer(mechanism, options, report)
    if options.layout == words.REP_158 and options.beside:
        return split_by_concern(layer, f"{options.within}{valid_name(mechanism.name)}_layers", suffix)
    if options.layout != "layered":
        return {"": layer}
    return split(layer, f"{options.within}{valid_name(mechanism.name)}_payload", suffix)


def write_layer(mechanism: Mechanism, options: Options, report: Report) -> Any:
    """The mechanism as one layer in memory."""
    layer = Sdf.Layer.CreateAnonymous(".usda")
    sheet = UsdSheet(mechanism, layer, _root(mechanism), is_nested=bool(options.nested))
    with Sdf.ChangeBlock():
        _write_stage(sheet)
        for section in _SECTIONS:
            section(sheet)
        _write_articulations(sheet)
        author(sheet.prims.values(), layer)
        restore_extras(sheet, report)
    return layer


def _root(mechanism: Mechanism) -> Any:
    noted = mechanism.notation(ROOT, words.ROOT_PRIM)
    if noted is not None and Sdf.Path.IsValidPathString(noted) and Sdf.Path(noted).IsRootPrimPath():
        return Sdf.Path(noted)
    return Sdf.Path.absoluteRootPath.AppendChild(valid_name(mechanism.name))


def _write_stage(sheet: UsdSheet) -> None:
    """Units, up axis and the default prim, which represents the robot."""
    stage = sheet.layer.pseudoRoot
    stage.SetInfo("metersPerUnit", 1.0)
    stage.SetInfo("kilogramsPerUnit", 1.0)
    stage.SetInfo("upAxis", UsdGeom.Tokens.z)
    sheet.layer.defaultPrim = sheet.root.name
    prim = sheet.define(sheet.root, "Xform", sheet.mechanism.name)
    sheet.group_paths.add(sheet.root)
    if sheet.mechanism.notation(ROOT, words.ROOT_PRIM) is None:
        prim.info["kind"] = Kind.Tokens.component


def _write_articulations(sheet: UsdSheet) -> None:
    """The robot's prim is the root of its articulation; several trees have one root each. Those of the source stay."""
    if any(ARTICULATION in extra.text for extras in sheet.mechanism.extras.values() for extra in extras if extra.format == words.FORMAT):
        return
    roots = sheet.mechanism.roots
    is_author = sheet.mechanism.notation(ROOT, words.ROOT_PRIM) is not None and sheet.mechanism.notation(ROOT, BEGUN) is None
    if is_author or not sheet.dofs:
        return
    for path in [sheet.root] if len(roots) == 1 else [sheet.paths[root] for root in roots if sheet.mechanism.children.get(root)]:
        apply(sheet.prims[path], ARTICULATION)
