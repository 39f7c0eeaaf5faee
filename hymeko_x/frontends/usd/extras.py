"""Everything unread of any prim, as extras of the nearest element.

An extra is the text of a prim in USD's own language, without its children; its path leads from the element's prim to it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from msgspec import Struct
from pxr import Gf, Sdf, Usd, UsdGeom

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats import usd as words
from hymeko_x.frontends.usd.bodies import body_at
from hymeko_x.frontends.usd.transforms import decomposed, matrix_of
from hymeko_x.ir.mechanism import ROOT, Extra

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.frontends.usd.builder import UsdBuilder
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.mechanism import Id

STAGE = "/"
"""The path of the extra with the metadata of the stage."""
_STAGE_KNOWN = ("upAxis", "metersPerUnit", "kilogramsPerUnit", "defaultPrim", "subLayers", "subLayerOffsets", "primChildren")
_TARGETS = (("connectionPaths", "connectionPathList"), ("targetPaths", "targetPathList"))
"""What attributes and what relationships lead to."""
_ARCS = ("references", "payload", "inheritPaths", "specializes", "variantSetNames", "variantSelection")
_COMPOSED = ("specifier", "typeName", "apiSchemas", "instanceable", *_ARCS)
_PLACED = {"body", "shape", "mount"}
"""The kinds of elements that have a pose of their own prim; the frames of joints are relative to bodies."""


def gather_extras(builder: UsdBuilder) -> None:
    """Add the extras of all prims. Runs last, when everything that is typed has been taken."""
    layer = builder.scene.layer
    _turn_gravity(builder)
    scratch = Sdf.Layer.CreateAnonymous(".usda")
    _gather_stage(layer, builder)
    folded = _folded(builder)
    owners: dict[Prim | None, tuple[Id, str] | None] = {None: (ROOT, "/")}
    for prim in builder.scene.prims.values():
        above = owners[prim.parent]
        if above is None or f"{words.PREFIX}scope" in prim.types:  # groups of the writer's own, with everything in them
            owners[prim] = None
            continue
        found = builder.elements.get(prim.path)
        owners[prim] = owner = (found[0], _home(found[0], prim.path, builder)) if found else above
        _gather_prim(prim, owner, folded, scratch, builder)


def _home(key: Id, path: str, builder: UsdBuilder) -> str:
    """The prim from which the extras of an element are counted: the first one where it was made of several."""
    paths = builder.noted(key, words.PATH) or ()
    return paths[0] if len(paths) > 1 else path


class _Folded(Struct, frozen=True):
    """Paths of the ``groups`` above typed prims, and of the ``still`` ones among them, which are written without a matrix.

    Such a group moves nothing, or its transformation is part of the pose of an element below.
    """

    groups: set[str]
    still: set[str]


class _Unread(Struct, frozen=True):
    """The unread parts of a prim: whether its type is, its schemas, metadata and properties, and its new matrix."""

    has_type: bool
    schemas: tuple[str, ...]
    metadata: tuple[str, ...]
    properties: tuple[str, ...]
    moved: Any | None

    @property
    def is_any(self) -> bool:
        """Whether anything but a type is left."""
        is_moved = self.moved is not None and self.moved != Gf.Matrix4d(1)
        return bool(self.schemas or self.metadata or self.properties) or is_moved


def _gather_prim(prim: Prim, owner: tuple[Id, str], folded: _Folded, scratch: Any, builder: UsdBuilder) -> None:
    if "@spec" in builder.read_names.get(prim.path, ()):
        return
    is_typed = prim.path in builder.elements
    unread = _unread_of(prim, owner[0] if is_typed else None, None if is_typed else _new_place(prim, folded, builder), builder)
    has_own_type = unread.has_type and (is_typed or prim.kind != "Xform" or prim.path not in folded.groups)
    if unread.is_any or has_own_type or not (is_typed or prim.kind):
        relative = str(Sdf.Path(prim.path).MakeRelativePath(Sdf.Path(owner[1]))) if prim.path != owner[1] else ""
        is_over = is_typed or "@type" in builder.read_names.get(prim.path, ())
        text = _text_of(prim, unread, scratch, builder, is_over=is_over).replace(builder.scene.folder + "/", "")
        builder.add_extras(owner[0], Extra(words.FORMAT, relative, text))


def _unread_of(prim: Prim, element: Id | None, moved: Any | None, builder: UsdBuilder) -> _Unread:
    """What is left of a prim, which is the one of an element or none."""
    taken = builder.read_names.get(prim.path, set())
    metadata = [name for name in prim.metadata if name not in _COMPOSED and name not in taken]
    if "displayName" in metadata and element is not None and prim.display_name == element.name:
        metadata.remove("displayName")
    ignored = (words.PREFIX,) if moved is None else (words.PREFIX, "xformOp")
    return _Unread(
        bool(prim.kind) and "@type" not in taken,
        tuple(schema for schema in prim.schemas if f"@{schema}" not in taken),
        tuple(metadata),
        tuple(name for name in prim.properties if name not in taken and not name.startswith(ignored)),
        moved,
    )


def _text_of(prim: Prim, unread: _Unread, scratch: Any, builder: UsdBuilder, *, is_over: bool) -> str:
    """What is left of a prim as text of USD.

    Raises: Refusal (HX001) for metadata of another type than USD has for it, as damaged files have.
    """
    spec = prim.spec
    copy = Sdf.CreatePrimInLayer(scratch, f"/{prim.name}")
    copy.specifier = Sdf.SpecifierOver if is_over and not unread.has_type else spec.specifier
    if unread.has_type:
        copy.typeName = prim.kind
    if unread.schemas:
        copy.SetInfo("apiSchemas", Sdf.TokenListOp.Create(prependedItems=list(unread.schemas)))
    for name in unread.metadata:
        try:
            copy.SetInfo(name, spec.GetInfo(name))
        except TypeError as error:
            raise refuse(
                codes.CANNOT_READ, f"the file is damaged: '{name}' of {prim.path} has another type", builder.origin_of(prim)
            ) from error
    for name in unread.properties:
        Sdf.CopySpec(spec.layer, f"{prim.path}.{name}", scratch, f"/{prim.name}.{name}")
        _lead_where_it_led(spec.layer.GetObjectAtPath(f"{prim.path}.{name}"), scratch.GetObjectAtPath(f"/{prim.name}.{name}"))
    if unread.moved is not None and unread.moved != Gf.Matrix4d(1):
        _author_matrix(copy, unread.moved)
    text = str(copy.GetAsText().strip())
    del scratch.rootPrims[prim.name]
    return text


def _lead_where_it_led(item: Any, copy: Any) -> None:
    """A copied property whose targets are the prim itself or below it leads there, not to the copy, as USD thinks it should."""
    field, paths = _TARGETS[isinstance(item, Sdf.RelationshipSpec)]
    if item.HasInfo(field):
        getattr(copy, paths).CopyItems(getattr(item, paths))


def _gather_stage(layer: Any, builder: UsdBuilder) -> None:
    """The metadata of the root layer besides its units, as the header of an empty layer."""
    header = Sdf.Layer.CreateAnonymous(".usda")
    for name in layer.pseudoRoot.ListInfoKeys():
        if name not in _STAGE_KNOWN and not (name == "customLayerData" and not layer.customLayerData):
            header.pseudoRoot.SetInfo(name, layer.pseudoRoot.GetInfo(name))
    if header.pseudoRoot.ListInfoKeys():
        builder.add_extras(ROOT, Extra(words.FORMAT, STAGE, header.ExportToString().strip()))


# ---- places of prims that are not typed ------------------------------------------------------------------------------------------


def _folded(builder: UsdBuilder) -> _Folded:
    groups = _above(builder.elements)
    placed = _above(path for path, found in builder.elements.items() if any(key.kind in _PLACED for key in found))
    return _Folded(groups, placed | {path for path in groups - placed if _moves_nothing(builder.prim_at(path))})


def _above(paths: Iterable[str]) -> set[str]:
    """The paths of all prims above these."""
    above: set[str] = set()
    for path in paths:
        way = path.rpartition("/")[0]
        while way and way not in above:
            above.add(way)
            way = way.rpartition("/")[0]
    return above


def _new_place(prim: Prim, folded: _Folded, builder: UsdBuilder) -> Any | None:
    """The matrix of a prim in the frame in which it will be written, or None where its own one stays true.

    Groups above elements with a pose are in the frame of their body or the world; any other child of such a group gets
    its own matrix there; descendants of that keep their own.
    """
    if prim.path in folded.still:
        return Gf.Matrix4d(1)
    parent = prim.parent
    is_top = parent is None or parent.path in folded.still or parent.path in builder.elements
    composed = prim.composed if is_top else None
    if not composed or not UsdGeom.Xformable(composed) or (parent is not None and _is_skin(parent, builder)):
        return None
    found = body_at(prim, builder)
    matrix = builder.transforms.relative(prim, found[0] if found is not None else None)
    if found is None and "xformOpOrder" not in prim.types and Gf.IsClose(matrix, Gf.Matrix4d(1), 1e-12):
        return None
    return None if Gf.IsClose(matrix, _own_matrix(composed), 1e-12) else matrix


def _is_skin(prim: Prim, builder: UsdBuilder) -> bool:
    """Whether the prim is a body and its geometry at once: it keeps its scale, so its children keep their poses."""
    return {"body", "shape"} <= {key.kind for key in builder.elements.get(prim.path, ())}


def _moves_nothing(group: Prim) -> bool:
    return not UsdGeom.Xformable(group.composed) or _own_matrix(group.composed) == Gf.Matrix4d(1)


def _own_matrix(composed: Any) -> Any:
    return UsdGeom.Xformable(composed).GetLocalTransformation(Usd.TimeCode.Default())


def _author_matrix(copy: Any, matrix: Any) -> None:
    order = Sdf.AttributeSpec(copy, "xformOpOrder", Sdf.ValueTypeNames.TokenArray, Sdf.VariabilityUniform)
    order.default = ["xformOp:transform"]
    Sdf.AttributeSpec(copy, "xformOp:transform", Sdf.ValueTypeNames.Matrix4d).default = matrix


def _turn_gravity(builder: UsdBuilder) -> None:
    """Gravity in metres, seen with z up, where the stage has other units or another up axis."""
    turn = matrix_of(decomposed(builder.scene.world).pose)
    if builder.scene.metres == 1.0 and turn == Gf.Matrix4d(1):
        return
    for prim in builder.scene.prims.values():
        if prim.kind != "PhysicsScene" or not prim.is_real:
            continue
        direction, magnitude = (prim.spec.attributes.get(f"physics:gravity{name}") for name in ("Direction", "Magnitude"))
        if direction is not None and direction.default is not None:
            direction.default = Gf.Vec3f(turn.TransformDir(Gf.Vec3d(direction.default)))
        if magnitude is not None and magnitude.default is not None:
            magnitude.default = magnitude.default * builder.scene.metres
