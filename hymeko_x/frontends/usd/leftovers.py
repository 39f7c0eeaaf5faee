"""Everything that was not read of any prim, as extras of the nearest element: nobody has to remember to keep it.

An extra is the text of a prim in USD's own language, without its children; its path leads from the element's prim to it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pxr import Gf, Sdf, Usd, UsdGeom

from hymeko_x.formats import usd as words
from hymeko_x.frontends.usd.places import matrix_of
from hymeko_x.ir.mechanism import ROOT, Extra

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.draft import Draft
    from hymeko_x.ir.mechanism import Id

STAGE = "/"
"""The path of the extra that holds what the stage as a whole says."""
_STAGE_KNOWN = ("upAxis", "metersPerUnit", "kilogramsPerUnit", "defaultPrim", "subLayers", "subLayerOffsets", "primChildren")
_ARCS = ("references", "payload", "inheritPaths", "specializes", "variantSetNames", "variantSelection")
_COMPOSED = ("specifier", "typeName", "apiSchemas", "instanceable", *_ARCS)


def gather_leftovers(draft: Draft) -> None:
    """Add the extras of all prims. Runs last, when everything that is typed has been taken."""
    layer = draft.scene.layer
    _turn_gravity(draft)
    scratch = Sdf.Layer.CreateAnonymous(".usda")
    _gather_stage(layer, draft)
    folded = _above_typed(draft)
    owners: dict[Any, tuple[Id, Any]] = {}
    stack = list(reversed(layer.rootPrims))
    while stack:
        spec = stack.pop()
        path = spec.path
        found = draft.elements.get(str(path))
        owner = (found[0], _home(found[0], path, draft)) if found else owners.get(path.GetParentPath(), (ROOT, Sdf.Path.absoluteRootPath))
        owners[path] = owner
        if _is_scope(spec):
            continue
        _gather_prim(spec, owner, folded, scratch, draft)
        stack.extend(reversed(spec.nameChildren))


def _home(key: Id, path: Any, draft: Draft) -> Any:
    """The prim from which the extras of an element are counted: the first one where it was made of several."""
    noted = draft.notations.get(key, {}).get(words.PATH, "")
    return Sdf.Path(noted.split()[0]) if " " in noted else path


def _is_scope(spec: Any) -> bool:
    return bool(spec.attributes.get(f"{words.PREFIX}scope"))


def _gather_prim(spec: Any, owner: tuple[Id, Any], folded: set[str], scratch: Any, draft: Draft) -> None:
    path = str(spec.path)
    taken = draft.taken.get(path, set())
    if "@spec" in taken:
        return
    is_typed = path in draft.elements
    moved = None if is_typed else _new_place(spec, folded, draft)
    copy = Sdf.CreatePrimInLayer(scratch, f"/{spec.name}")
    copy.specifier = Sdf.SpecifierOver if is_typed or "@type" in taken else spec.specifier
    if "@type" not in taken and spec.typeName:
        copy.typeName = spec.typeName
        copy.specifier = spec.specifier
    is_worth_it = _copy_metadata(spec, copy, taken, owner[0] if is_typed else None)
    for item in filter(None, spec.properties):  # a damaged crate may list properties that it does not have
        name = item.name
        if name in taken or name.startswith(words.PREFIX) or (moved is not None and name.startswith("xformOp")):
            continue
        Sdf.CopySpec(spec.layer, item.path, scratch, copy.path.AppendProperty(name))
        is_worth_it = True
    if moved is not None and moved != Gf.Matrix4d(1):
        _author_matrix(copy, moved)
        is_worth_it = True
    has_own_type = bool(copy.typeName) and (is_typed or copy.typeName != "Xform" or path not in folded)
    if is_worth_it or has_own_type or not (is_typed or spec.typeName):
        relative = str(spec.path.MakeRelativePath(owner[1])) if spec.path != owner[1] else ""
        text = copy.GetAsText().strip().replace(draft.scene.folder + "/", "")
        draft.extras.setdefault(owner[0], []).append(Extra(words.FORMAT, relative, text))
    del scratch.rootPrims[spec.name]


def _copy_metadata(spec: Any, copy: Any, taken: set[str], element: Id | None) -> bool:
    """Copy what is said about the prim itself; returns whether there was something."""
    schemas = spec.GetInfo("apiSchemas").GetAppliedItems() if spec.HasInfo("apiSchemas") else []
    left = [schema for schema in schemas if f"@{schema}" not in taken]
    if left:
        copy.SetInfo("apiSchemas", Sdf.TokenListOp.Create(prependedItems=left))
    any_left = bool(left)
    for name in spec.ListInfoKeys():
        if name in _COMPOSED or name in taken or (name == "displayName" and element is not None and spec.GetInfo(name) == element.name):
            continue
        copy.SetInfo(name, spec.GetInfo(name))
        any_left = True
    return any_left


def _gather_stage(layer: Any, draft: Draft) -> None:
    """What the root layer says besides its units, as the header of an empty layer."""
    header = Sdf.Layer.CreateAnonymous(".usda")
    for name in layer.pseudoRoot.ListInfoKeys():
        if name not in _STAGE_KNOWN and not (name == "customLayerData" and not layer.customLayerData):
            header.pseudoRoot.SetInfo(name, layer.pseudoRoot.GetInfo(name))
    if header.pseudoRoot.ListInfoKeys():
        draft.extras.setdefault(ROOT, []).append(Extra(words.FORMAT, STAGE, header.ExportToString().strip()))


# ---- places of prims that are not typed ------------------------------------------------------------------------------------------


def _above_typed(draft: Draft) -> set[str]:
    """The paths of all prims with a typed one somewhere below: their transformations are part of what is below."""
    above: set[str] = set()
    for path in draft.elements:
        way = Sdf.Path(path).GetParentPath()
        while way != Sdf.Path.absoluteRootPath and str(way) not in above:
            above.add(str(way))
            way = way.GetParentPath()
    return above


def _new_place(spec: Any, folded: set[str], draft: Draft) -> Any | None:
    """The matrix of a prim in the frame in which it will stand, or None where what it says stays true.

    Groups above typed prims stand in the frame of their body or the world; what hangs below such a group alone gets its
    own matrix there; what hangs deeper keeps its own.
    """
    path = str(spec.path)
    if path in folded:
        return Gf.Matrix4d(1)
    parent = spec.path.GetParentPath()
    prim = draft.scene.stage.GetPrimAtPath(spec.path)
    is_top = parent.IsAbsoluteRootPath() or str(parent) in folded or str(parent) in draft.elements
    if not is_top or not prim or not UsdGeom.Xformable(prim):
        return None
    if _is_skin(parent, draft):
        return None
    body = _body_of(prim, draft)
    matrix = draft.places.relative(prim, body)
    if body is None and spec.attributes.get("xformOpOrder") is None and Gf.IsClose(matrix, Gf.Matrix4d(1), 1e-12):
        return None
    return None if Gf.IsClose(matrix, _own_matrix(prim), 1e-12) else matrix


def _is_skin(path: Any, draft: Draft) -> bool:
    """Whether the prim is a body and its geometry at once: it keeps its scale, so what is below keeps its place."""
    return {"body", "shape"} <= {key.kind for key in draft.elements.get(str(path), ())}


def _own_matrix(prim: Any) -> Any:
    return UsdGeom.Xformable(prim).GetLocalTransformation(Usd.TimeCode.Default())


def _body_of(prim: Any, draft: Draft) -> Any | None:
    from hymeko_x.frontends.usd.bodies import body_at

    found = body_at(prim, draft)
    return found[0] if found is not None else None


def _author_matrix(copy: Any, matrix: Any) -> None:
    order = Sdf.AttributeSpec(copy, "xformOpOrder", Sdf.ValueTypeNames.TokenArray, Sdf.VariabilityUniform)
    order.default = ["xformOp:transform"]
    Sdf.AttributeSpec(copy, "xformOp:transform", Sdf.ValueTypeNames.Matrix4d).default = matrix


def _turn_gravity(draft: Draft) -> None:
    """Gravity in metres, seen with z up, where the stage has other units or another up axis."""
    turn = matrix_of(draft.places.of(draft.scene.stage.GetPseudoRoot()).pose) if draft.scene.stage else Gf.Matrix4d(1)
    if draft.scene.metres == 1.0 and turn == Gf.Matrix4d(1):
        return
    for prim in draft.scene.stage.Traverse():
        if prim.GetTypeName() != "PhysicsScene":
            continue
        spec = draft.scene.layer.GetPrimAtPath(prim.GetPath())
        direction, magnitude = (spec.attributes.get(f"physics:gravity{name}") for name in ("Direction", "Magnitude"))
        if direction is not None and direction.default is not None:
            direction.default = Gf.Vec3f(turn.TransformDir(Gf.Vec3d(direction.default)))
        if magnitude is not None and magnitude.default is not None:
            magnitude.default = magnitude.default * draft.scene.metres
