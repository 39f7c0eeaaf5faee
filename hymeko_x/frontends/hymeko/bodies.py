"""Bodies, their inertials and their shapes, from HyMeKo text."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from msgspec.structs import replace

from hymeko_x.formats.hymeko import SHAPE_WORDS
from hymeko_x.formats.hymeko.attached import attached_edge
from hymeko_x.frontends.hymeko.block import Block
from hymeko_x.frontends.hymeko.build import sign_of
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import Id, file_stem, shape_edge
from hymeko_x.ir.values import IDENTITY, ZERO, Pose, Tensor, Vec3, rotate_tensor
from hymeko_x.ir.written import length_of
from hymeko_x.language.syntax import ArcItem, Field, Node, Ref, is_list

if TYPE_CHECKING:
    from hymeko_x.frontends.hymeko.block import Context
    from hymeko_x.frontends.hymeko.build import Build
    from hymeko_x.language.expansion import Element, Scope
    from hymeko_x.language.syntax import Value

_ROLES = {"visual": parts.Role.VISUAL, "collision": parts.Role.COLLISION, "shape": parts.Role.BOTH, "geometry": parts.Role.BOTH}
_FILE_WORDS = ("file", "url", "uri")
SHAPE_PLACES = {parts.Role.VISUAL: "visual", parts.Role.COLLISION: "collision", parts.Role.BOTH: "shape"}
"""What a shape without a given id is called after: its body and this word."""


def read_body(build: Build, key: Id, element: Element) -> None:
    """A body, or the world's geometry, with everything in its block."""
    plain = tuple(item for item in element.node.items if not _is_shape(item) and not is_base_arc(item))
    block = Block(plain, build.context)
    place = _place(block)
    inertial = _inertial(block, place)
    if key.kind == "body":
        build.vertices[key] = parts.Body(inertial)
    for item in element.node.items:
        if _is_shape(item):
            _read_shape(build, key, _with_geometry(item, block), place, element.scope)
    for node in [node for node in block.nodes if _named_geometry(element.node.items, node)]:
        block.nodes.remove(node)
    block.rest(str(key))
    build.keep(key, block)


def is_base_arc(item: object) -> bool:
    """Whether an item of a body's block says what the body is fixed to: ``[0 0 1] + arm``."""
    return isinstance(item, ArcItem) and not item.role and sign_of(item) > 0


def read_fixed(build: Build, key: Id, element: Element) -> None:
    """The joint without freedom that holds a body to what its block names."""
    arcs = [item for item in element.node.items if isinstance(item, ArcItem) and is_base_arc(item)]
    if len(arcs) > 1:
        raise build.context.refuse(arcs[1], f"body '{key.name}' is fixed to several others; joints say that")
    body = Id("body", key.name)
    build.edges[key] = attached_edge(body, (build.arc("joint", arcs[0], element.scope),))


def _is_shape(item: object) -> bool:
    return (isinstance(item, Node | Field) and item.name in _ROLES) or (isinstance(item, ArcItem) and item.role in _ROLES)


def _named_geometry(items: tuple[object, ...], node: Node) -> bool:
    """Whether a nested node is the geometry that a `visual -> name` of the same body refers to."""
    return any(isinstance(item, ArcItem) and item.role in _ROLES and item.ref.path == (node.name,) for item in items)


def _with_geometry(item: object, block: Block) -> object:
    """``visual -> name`` with what a nested ``name : mesh { .. }`` or ``name : capsule { .. }`` of the same body says of it."""
    if not isinstance(item, ArcItem):
        return item
    node = next((node for node in block.nodes if item.ref.path == (node.name,)), None)
    if node is None:
        return item
    said = tuple(inner._replace(name="mesh") if isinstance(inner, Field) and inner.name in _FILE_WORDS else inner for inner in node.items)
    kind = node.stereotypes[0].ref.path[-1] if node.stereotypes else "mesh"
    if kind != "mesh":
        said = (Field("type", kind, "", node.line, node.column), *said)
    return Node(item.role, (*said, *item.items), line=item.line, column=item.column)


# ---- inertials -----------------------------------------------------------------------------------------------------------


def _place(block: Block) -> Pose:
    """``translation`` and ``rotation`` of a link: where its geometry and mass sit, as in the published listings."""
    context = block.context
    translation, rotation = block.take("translation"), block.take("rotation")
    if translation is None and rotation is None:
        return IDENTITY
    xyz: tuple[Value, ...] = cast("tuple[Value, ...]", translation.value) if translation else (0.0, 0.0, 0.0)
    if rotation is None:
        assert translation is not None
        return context.pose(xyz, translation)
    return context.pose((xyz, cast("tuple[Value, ...]", rotation.value)), rotation)


def _inertial(block: Block, place: Pose) -> parts.Inertial | None:
    context = block.context
    mass, com, tensor, axes = block.take("mass"), block.take("com"), block.take("inertia"), block.take("axes")
    marker = block.take_node("inertial")
    if mass is None and com is None and tensor is None and axes is None and marker is None:
        return None
    inertial = parts.Inertial(
        None if mass is None else context.number(mass.value, "mass", mass),
        place.xyz if com is None else context.vec3(com.value, "length", com),
    )
    if tensor is None:
        return inertial
    local = _tensor(context.numbers(tensor.value, "", tensor), tensor, block)
    if axes is None:
        return replace(inertial, tensor=local)
    turn = cast("tuple[Value, ...]", axes.value)
    frame = context.pose((ZERO, *turn) if turn and isinstance(turn[0], str) else (ZERO, turn), axes)
    return replace(
        inertial, tensor=rotate_tensor(frame.quat, local), written=parts.InertialWritten(replace(frame, xyz=inertial.com), local)
    )


def _tensor(numbers: tuple[float, ...], item: Field, block: Block) -> Tensor:
    """Six entries xx yy zz xy xz yz, or the three of a diagonal tensor."""
    if len(numbers) == 3:
        return (*numbers, 0.0, 0.0, 0.0)
    if len(numbers) != 6:
        raise block.context.refuse(item, f"'inertia' takes [xx yy zz] or [xx yy zz xy xz yz], not {len(numbers)} numbers")
    return numbers


# ---- shapes --------------------------------------------------------------------------------------------------------------


def _read_shape(build: Build, body: Id, item: object, place: Pose, scope: Scope) -> None:
    """``visual { .. }``, ``visual "file"`` (a mesh's file), ``visual=mesh``, or ``visual -> mesh { .. }``."""
    match item:
        case Field(name=word):
            block = Block((Field("mesh", item.value, "", item.line, item.column),), build.context)
        case ArcItem(role=word):
            block = Block(item.items, build.context)
            block.arcs.append(item._replace(role="mesh"))
        case Node(name=word):
            block = Block(item.items, build.context)
        case _:
            raise AssertionError(item)
    shape_id = block.take_text("id") if word != "geometry" else None
    role = _ROLES[word]
    key = _shape_id(build, body, role, shape_id, item)
    pose = _shape_pose(block, place)
    geometry, mesh = _geometry(build, block, key, scope, pose)
    material = _material(build, block, key, scope)
    shape = parts.Shape(geometry, role, **block.take_words(SHAPE_WORDS))  # type: ignore[arg-type]
    build.edges[key] = shape_edge(shape, body, pose, mesh, material)
    block.rest(str(key))
    build.keep(key, block)


def _shape_id(build: Build, body: Id, role: parts.Role, given: str | None, item: Node | Field | ArcItem) -> Id:
    if given is not None:
        return build.reserve("shape", given, item)
    return build.name_after_place("shape", f"{body.name}/{SHAPE_PLACES[role]}", item)


def _shape_pose(block: Block, place: Pose) -> Pose:
    at, ends = block.take("at"), block.take("fromto")
    if ends is not None:
        return block.context.pose(("fromto", cast("Value", ends.value)), ends)
    if at is not None:
        return block.context.pose(at.value, at)
    own = _place(block)
    if own == IDENTITY:
        return place
    return Pose(own.xyz if own.xyz != ZERO else place.xyz, own.quat, own.written)


def _geometry(build: Build, block: Block, key: Id, scope: Scope, pose: Pose) -> tuple[parts.Geometry, Id | None]:
    context = block.context
    if (item := block.take("mesh")) is not None:
        if isinstance(item.value, Ref):
            return parts.MeshShape(), build.target(item.value, scope, ("mesh",), item)
        return parts.MeshShape(), _inline_mesh(build, block, context.text(item.value, item), item)
    if (arc := block.take_role("mesh")) is not None:
        return parts.MeshShape(), build.target(arc.ref, scope, ("mesh",), arc)
    if (item := block.take("box")) is not None:
        return parts.Box(context.vec3(item.value, "length", item)), None
    if (item := block.take("sphere")) is not None:
        return parts.Sphere(context.number(item.value, "length", item)), None
    if (item := block.take("ellipsoid")) is not None:
        return parts.Ellipsoid(context.vec3(item.value, "length", item)), None
    if (item := block.take("cylinder")) is not None:
        return parts.Cylinder(*_round(context, item, pose)), None
    if (item := block.take("capsule")) is not None:
        return parts.Capsule(*_round(context, item, pose)), None
    if (item := block.take("plane")) is not None:
        x, y = context.numbers(item.value, "length", item, 2)
        return parts.Plane((x, y)), None
    return _described_geometry(block, key)


def _round(context: Context, item: Field, pose: Pose) -> tuple[float, ...]:
    """Radius and length: ``[r l]``, or ``r`` alone where two points tell the length."""
    if pose.written is not None and pose.written.kind == "fromto" and not is_list(item.value):
        return (context.number(item.value, "length", item), length_of(pose.written))
    return context.numbers(item.value, "length", item, 2)


def _described_geometry(block: Block, key: Id) -> tuple[parts.Geometry, None]:
    """``type = cylinder dimensions = [radius, length]``, as in the published listings; nothing at all is an empty geometry."""
    context = block.context
    kind, size = block.take("type"), block.take("dimensions", "dimension")
    if kind is None or size is None:
        if kind is not None or size is not None:
            raise context.refuse(kind or size, f"{key} needs both 'type' and 'dimensions'")  # type: ignore[arg-type]
        return parts.NoShape(), None
    word = context.text(kind.value, kind)
    numbers = context.numbers(size.value, "length", size)
    match word, numbers:
        case "box", (x, y, z):
            return parts.Box((x, y, z)), None
        case "cylinder", (radius, length):
            return parts.Cylinder(radius, length), None
        case "capsule", (radius, length):
            return parts.Capsule(radius, length), None
        case "sphere", (radius,):
            return parts.Sphere(radius), None
    raise context.refuse(
        kind, f"'{word}' with {len(numbers)} dimensions is not a geometry; there are box [x y z], cylinder [r l], capsule [r l], sphere [r]"
    )


def _inline_mesh(build: Build, block: Block, uri: str, item: Field) -> Id:
    """The mesh vertex of a file named in a shape: called after the file unless an id is given."""
    scale_item = block.take("scale")
    scale: Vec3 = (1.0, 1.0, 1.0)
    if scale_item is not None:
        value = scale_item.value
        context = block.context
        single = not is_list(value)
        scale = (context.number(value, "", scale_item),) * 3 if single else context.vec3(value, "", scale_item)
    given = block.take_text("mesh_id")
    key = build.reserve("mesh", given, item) if given is not None else build.name_after_place("mesh", file_stem(uri) or "mesh", item)
    build.vertices[key] = parts.Mesh(build_uri(build, uri), scale)
    return key


def build_uri(build: Build, uri: str) -> str:
    """The uri of a file: behind the mechanism's ``files`` prefix where it begins with ``~/``."""
    return build.files + uri[2:] if build.files and uri.startswith("~/") else uri


def _material(build: Build, block: Block, key: Id, scope: Scope) -> Id | None:
    if (arc := block.take_role("material")) is not None or (arc := block.take_role("color")) is not None:
        return build.target(arc.ref, scope, ("material",), arc)
    named = block.fields.get("material")
    if named is not None:
        block.take("material")
        if isinstance(named.value, Ref):
            return build.target(named.value, scope, ("material",), named)
        raise block.context.refuse(named, "'material' takes a reference: material=steel")
    color = block.take("color")
    if color is None:
        return None
    material = build.name_after_place("material", f"{key.name}/material", color)
    build.vertices[material] = parts.Material(None, block.context.rgba(color.value, color))
    return material
