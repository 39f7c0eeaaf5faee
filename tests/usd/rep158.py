"""The rules of REP 158 (OpenUSD conventions for simulation assets, draft of 2026) that a stage can break, each by its section.

Only what the text demands ("must"); recommendations are not here. Source: `openrobotics/reps`, REP 0158:2026, sections 1 and 3.
"""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pxr import Sdf, Usd, UsdGeom, UsdPhysics, UsdShade, UsdUtils

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

JOINTS = (
    "PhysicsRevoluteJoint",
    "PhysicsPrismaticJoint",
    "PhysicsFixedJoint",
    "PhysicsSphericalJoint",
    "PhysicsDistanceJoint",
    "PhysicsJoint",
)
VENDORS = ("newton:", "mjc:", "physx", "isaac:", "urdf:", "hymeko:")
LONG = 64
"""Arrays up to this length are no heavy data."""


def problems(path: Path) -> list[str]:
    """The broken rules of the stage in a file, each as `section: what, where`."""
    return problems_of(Usd.Stage.Open(str(path)))


def problems_of(stage: Any) -> list[str]:
    """The broken rules of an open stage."""
    return [f"{section}: {found}" for section, rule in RULES for found in rule(stage)]


def _bodies(stage: Any) -> list[Any]:
    return [prim for prim in stage.TraverseAll() if prim.HasAPI(UsdPhysics.RigidBodyAPI)]


def _colliders(stage: Any) -> list[Any]:
    return [prim for prim in stage.TraverseAll() if prim.HasAPI(UsdPhysics.CollisionAPI)]


def _joints(stage: Any) -> list[Any]:
    return [prim for prim in stage.TraverseAll() if prim.GetTypeName() in JOINTS]


def _schemas(prim: Any) -> set[str]:
    """Every applied schema, also of plugins that are not registered."""
    listed = prim.GetMetadata("apiSchemas")
    return set(listed.GetAppliedItems()) if listed else set()


# ---- 1.1 Coordinate systems and units ----------------------------------------------------------------------------------------


def units(stage: Any) -> Iterator[str]:
    root = stage.GetRootLayer().pseudoRoot
    for name, expected in (("metersPerUnit", 1.0), ("kilogramsPerUnit", 1.0), ("timeCodesPerSecond", 1.0), ("upAxis", "Z")):
        if not root.HasInfo(name) or root.GetInfo(name) != expected:
            yield f"{name} is not {expected}"


def transforms(stage: Any) -> Iterator[str]:
    """Bodies have a translation and an orientation, and nothing else; joints stand nowhere by themselves."""
    for prim in (*_bodies(stage), *_joints(stage)):
        xform = UsdGeom.Xformable(prim)
        kinds = sorted(op.GetOpName() for op in xform.GetOrderedXformOps()) if xform else []
        if kinds and kinds != ["xformOp:orient", "xformOp:translate"]:
            yield f"{prim.GetPath()} has {', '.join(kinds)}"


def root_transform(stage: Any) -> Iterator[str]:
    xform = UsdGeom.Xformable(stage.GetDefaultPrim()) if stage.GetDefaultPrim() else None
    for op in xform.GetOrderedXformOps() if xform else []:
        if re.search("rotate|orient|transform$", op.GetOpName()):
            yield f"the root has {op.GetOpName()}"


# ---- 1.2 Structure -------------------------------------------------------------------------------------------------------------


def encodings(stage: Any) -> Iterator[str]:
    """Layers with schemas are text, those with long arrays are crates."""
    for layer in stage.GetUsedLayers():
        if layer.anonymous:
            continue
        found: set[str] = set()
        layer.Traverse("/", lambda path, layer=layer, found=found: found.update(_contents(layer, path)))
        if "schemas" in found and not layer.identifier.endswith(".usda"):
            yield f"{Path(layer.identifier).name} has schemas and is no .usda"
        if "arrays" in found and not layer.identifier.endswith(".usdc"):
            yield f"{Path(layer.identifier).name} has long arrays and is no .usdc"


def _contents(layer: Any, path: Any) -> Iterator[str]:
    spec = layer.GetObjectAtPath(path)
    if isinstance(spec, Sdf.PrimSpec) and spec.HasInfo("apiSchemas"):
        yield "schemas"
    if isinstance(spec, Sdf.AttributeSpec) and hasattr(spec.default, "__len__") and not isinstance(spec.default, str):
        yield "arrays" if len(spec.default) > LONG else "short"


def kinds(stage: Any) -> Iterator[str]:
    """The root is a component or an assembly, and no component contains another."""
    root = stage.GetDefaultPrim()
    if root and Usd.ModelAPI(root).GetKind() not in ("component", "assembly", "group"):
        yield f"the kind of the root is '{Usd.ModelAPI(root).GetKind()}'"
    for prim in stage.TraverseAll():
        above = prim.GetParent()
        while Usd.ModelAPI(prim).GetKind() == "component" and above and not above.IsPseudoRoot():
            if Usd.ModelAPI(above).GetKind() == "component":
                yield f"component {prim.GetPath()} is inside of component {above.GetPath()}"
            above = above.GetParent()


def payloads(stage: Any) -> Iterator[str]:
    """Bodies, joints and articulations are there before any payload is loaded."""
    light = Usd.Stage.Open(stage.GetRootLayer(), Usd.Stage.LoadNone)
    there = {prim.GetPath() for prim in (*_bodies(light), *_joints(light))}
    hidden = [prim.GetPath() for prim in (*_bodies(stage), *_joints(stage)) if prim.GetPath() not in there]
    if hidden:
        yield f"{len(hidden)} bodies and joints are in payloads"


def variants(stage: Any) -> Iterator[str]:
    for prim in stage.TraverseAll():
        sets = prim.GetVariantSets()
        for name in sets.GetNames():
            if not sets.GetVariantSet(name).GetVariantSelection():
                yield f"variant set '{name}' of {prim.GetPath()} has no selection"


def identity(stage: Any) -> Iterator[str]:
    root = stage.GetDefaultPrim()
    if not root:
        yield "there is no default prim"
        return
    for name in ("identifier", "version"):
        if not root.GetAssetInfo().get(name):
            yield f"assetInfo has no {name}"


def paths(stage: Any) -> Iterator[str]:
    """Every file is named relative to the layer."""
    for layer in stage.GetUsedLayers():
        sublayers, references, payloaded = UsdUtils.ExtractExternalReferences(layer.identifier)
        for file in (*sublayers, *references, *payloaded):
            if file.startswith("/") or re.match(r"(?!package:)\w+:", file):
                yield f"'{file}' is no relative path"


def prefabs(stage: Any) -> Iterator[str]:
    for prim in stage.TraverseAll():
        for item in prim.GetAuthoredAttributes():
            if item.IsCustom() and str(item.GetTypeName()) == "string" and re.search("(?i)(prefab|asset|spawn|model)path", item.GetName()):
                yield f"{item.GetPath()} names a file in a string"


def instancing(stage: Any) -> Iterator[str]:
    for prim in (*_bodies(stage), *_joints(stage)):
        if prim.IsInstanceable() or prim.IsInstanceProxy():
            yield f"{prim.GetPath()} is an instance"


# ---- 1.3 Physics -----------------------------------------------------------------------------------------------------------------


def limits(stage: Any) -> Iterator[str]:
    for prim in _joints(stage):
        for name in ("lowerLimit", "upperLimit") if prim.GetTypeName() in JOINTS[:2] else ():
            if not prim.GetAttribute(f"physics:{name}").IsAuthored():
                yield f"{prim.GetPath()} has no {name}"


def _ends(prim: Any) -> list[Any]:
    return [next(iter(prim.GetRelationship(f"physics:body{side}").GetTargets()), None) for side in (0, 1)]


def trees(stage: Any) -> Iterator[str]:
    """Joints that are no closures form trees with one articulation at most."""
    above: dict[Any, Any] = {}

    def top(path: Any) -> Any:
        while path in above:
            path = above[path]
        return path

    pairs = set()
    for prim in _joints(stage):
        ends = frozenset(_ends(prim))
        if UsdPhysics.Joint(prim).GetExcludeFromArticulationAttr().Get() or None in ends or ends in pairs:
            continue
        pairs.add(ends)
        first, second = (top(path) for path in _ends(prim))
        if first == second:
            yield f"{prim.GetPath()} closes a loop and is part of the articulation"
        else:
            above[first] = second
    roots = [prim.GetPath() for prim in stage.TraverseAll() if prim.HasAPI(UsdPhysics.ArticulationRootAPI)]
    tops = Counter(top(path) for path in roots)
    yield from (f"the tree of {path} has {count} articulations" for path, count in tops.items() if count > 1)
    yield from (
        f"articulation {inner} is inside of {outer}" for inner in roots for outer in roots if inner != outer and inner.HasPrefix(outer)
    )


def masses(stage: Any) -> Iterator[str]:
    for prim in _bodies(stage):
        if not UsdPhysics.RigidBodyAPI(prim).GetKinematicEnabledAttr().Get() and not (prim.GetAttribute("physics:mass").Get() or 0.0) > 0.0:
            yield f"{prim.GetPath()} has no mass"


def frames(stage: Any) -> Iterator[str]:
    """What is neither seen nor touched nor weighed is no body."""
    for prim in _bodies(stage):
        shapes = [inner for inner in Usd.PrimRange(prim) if inner.IsA(UsdGeom.Gprim) and _body_of(inner) == prim]
        if not shapes and not prim.HasAPI(UsdPhysics.MassAPI):
            yield f"{prim.GetPath()} is a frame and a body"


def _body_of(prim: Any) -> Any:
    while prim and not prim.HasAPI(UsdPhysics.RigidBodyAPI):
        prim = prim.GetParent()
    return prim


def tensors(stage: Any) -> Iterator[str]:
    """Moments and their axes are the only form of a tensor."""
    for prim in _bodies(stage):
        for item in prim.GetAuthoredAttributes():
            if re.search("(?i)inertia", item.GetName()) and hasattr(item.Get(), "__len__") and len(item.Get()) == 6:
                yield f"{item.GetPath()} is a tensor of six numbers"


def mimics(stage: Any) -> Iterator[str]:
    """A coupling is also written in the neutral schema, with one leader that turns or slides, and without cycles."""
    leaders: dict[Any, Any] = {}
    for prim in stage.TraverseAll():
        own = _schemas(prim)
        if {"NewtonMimicAPI", "MimicJointAPI"} & own and "ExtendedPhysicsMimicAPI" not in own:
            yield f"{prim.GetPath()} has a mimic of one engine alone"
        if "ExtendedPhysicsMimicAPI" in own:
            found = prim.GetRelationship("ext_physics:mimic:joint").GetTargets()
            if len(found) != 1 or stage.GetPrimAtPath(found[0]).GetTypeName() not in JOINTS[:2] or prim.GetTypeName() not in JOINTS[:2]:
                yield f"{prim.GetPath()} follows no joint of one axis"
            leaders[prim.GetPath()] = found[0]
    for path in leaders:
        passed = [path]
        while passed[-1] in leaders and leaders[passed[-1]] not in passed:
            passed.append(leaders[passed[-1]])
        if passed[-1] in leaders:
            yield f"{path} follows itself"


def contacts(stage: Any) -> Iterator[str]:
    """Every collider has a physics material, with three values."""
    for prim in _colliders(stage):
        path = UsdShade.MaterialBindingAPI(prim).GetDirectBinding("physics").GetMaterialPath()
        material = stage.GetPrimAtPath(path) if not path.isEmpty else None
        if material is None:
            yield f"{prim.GetPath()} has no physics material"
            continue
        missing = [
            name
            for name in ("staticFriction", "dynamicFriction", "restitution")
            if not material.GetAttribute(f"physics:{name}").IsAuthored()
        ]
        if missing:
            yield f"{path} has no {', '.join(missing)}"


# ---- 1.2.1 and 1.4 Layers ------------------------------------------------------------------------------------------------------


def engines(stage: Any) -> Iterator[str]:
    """Layers with UsdPhysics contain no attribute of one engine."""
    for layer in stage.GetUsedLayers():
        names: set[str] = set()
        layer.Traverse("/", lambda path, names=names: names.add(path.name) if path.IsPropertyPath() else None)
        vendors = sorted({name for name in names if name.startswith(VENDORS)})
        if vendors and any(name.startswith("physics:") for name in names):
            yield f"{Path(layer.identifier).name} mixes UsdPhysics with {', '.join(vendors[:3])}"


# ---- 3 Exchange ------------------------------------------------------------------------------------------------------------------


def surfaces(stage: Any) -> Iterator[str]:
    for prim in stage.TraverseAll():
        if prim.GetTypeName() != "Material" or prim.HasAPI(UsdPhysics.MaterialAPI):
            continue
        source = UsdShade.Material(prim).ComputeSurfaceSource()[0]
        if not source or source.GetIdAttr().Get() != "UsdPreviewSurface":
            yield f"{prim.GetPath()} has no UsdPreviewSurface"


def textures(stage: Any) -> Iterator[str]:
    for prim in stage.TraverseAll():
        file = prim.GetAttribute("inputs:file").Get() if prim.GetTypeName() == "Shader" else None
        if file and not re.search(r"(?i)\.(png|jpe?g)$", file.path):
            yield f"{prim.GetPath()} uses {file.path}"


def triangles(stage: Any) -> Iterator[str]:
    for prim in _colliders(stage):
        counts = UsdGeom.Mesh(prim).GetFaceVertexCountsAttr().Get() if prim.IsA(UsdGeom.Mesh) else None
        if counts and set(counts) != {3}:
            yield f"{prim.GetPath()} has faces that are no triangles"


def windings(stage: Any) -> Iterator[str]:
    for prim in stage.TraverseAll():
        if prim.IsA(UsdGeom.Mesh) and UsdGeom.Mesh(prim).GetOrientationAttr().Get() == "leftHanded":
            yield f"{prim.GetPath()} is left-handed"


def lights(stage: Any) -> Iterator[str]:
    for prim in stage.TraverseAll():
        if prim.GetTypeName() in ("RectLight", "CylinderLight"):
            yield f"{prim.GetPath()} is an area light"


RULES: tuple[tuple[str, Callable[[Any], Iterator[str]]], ...] = (
    ("1.1 units", units),
    ("1.1 transforms", transforms),
    ("1.1 root", root_transform),
    ("1.2.1 encoding", encodings),
    ("1.2.2 kind", kinds),
    ("1.2.3 payloads", payloads),
    ("1.2.4 variants", variants),
    ("1.2.5 identity", identity),
    ("1.2.5 paths", paths),
    ("1.2.5 prefabs", prefabs),
    ("1.2.6 instances", instancing),
    ("1.3 limits", limits),
    ("1.3 trees", trees),
    ("1.3 mass", masses),
    ("1.3 frames", frames),
    ("1.3 inertia", tensors),
    ("1.3 mimic", mimics),
    ("1.3.4 contact", contacts),
    ("1.4 engines", engines),
    ("3.1 surfaces", surfaces),
    ("3.2 textures", textures),
    ("3.4 triangles", triangles),
    ("3.4 winding", windings),
    ("3.6 lights", lights),
)
