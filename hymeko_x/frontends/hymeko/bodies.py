"""Bodies, their inertials and their shapes, from HyMeKo text."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from msgspec.structs import replace

from hymeko_x.formats.hymeko import SHAPE_ROLES, SHAPE_WORDS, SOLIDS, attached_edge
from hymeko_x.frontends.hymeko.block import Block
from hymeko_x.frontends.hymeko.builder import sign_of
from hymeko_x.frontends.hymeko.values import describe
from hymeko_x.ir import parts
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.mechanism import Id, shape_edge
from hymeko_x.ir.values import IDENTITY, ZERO, Pose, Tensor, Vec3, rotate_tensor
from hymeko_x.ir.written import length_of
from hymeko_x.language.syntax import ArcItem, Field, Node, Ref, is_field, is_list
from hymeko_x.source import file_stem

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hymeko_x.frontends.hymeko.builder import HymekoBuilder
    from hymeko_x.frontends.hymeko.values import ValueReader
    from hymeko_x.language.expansion import ExpandedElement, Scope
    from hymeko_x.language.syntax import Item, Value

_ROLES = {**{word: role for role, word in SHAPE_ROLES.items()}, "geometry": parts.Role.BOTH}
_FILE_WORDS = ("file", "url", "uri")


def read_body(builder: HymekoBuilder, key: Id, element: ExpandedElement) -> None:
    """A body, or the world's geometry, with everything in its block."""
    items = tuple(item for item in element.node.items if not is_field(item, ("kind",)))
    block = Block([item for item in items if not _is_shape(item) and not is_base_arc(item)], builder.reader)
    place = _place(block)
    inertial = _inertial(block, place)
    color = block.take("color") if any(map(_is_seen, items)) else None
    if key.kind == "body":
        builder.vertices[key] = parts.Body(inertial)
    shapes = [_with_color(_with_geometry(item, block), color) for item in items if _is_shape(item)]
    _read_shapes(builder, key, shapes, place, element.scope)
    block.nodes = [node for node in block.nodes if not _is_referenced(items, node)]
    block.rest(str(key))
    builder.keep(key, block)


def change_inertial(body: parts.Body, block: Block) -> parts.Body:
    """The body with those of mass, centre and tensor that the block gives."""
    given = {word for word in ("mass", "com", "inertia", "axes") if word in block.fields}
    found = _inertial(block, IDENTITY)
    if not given or found is None:
        return body
    if body.inertial is None:
        return parts.Body(found)
    kept = replace(body.inertial, mass=found.mass if "mass" in given else body.inertial.mass)
    if "com" in given:
        kept = replace(kept, com=found.com)
    if "inertia" in given:
        kept = replace(kept, tensor=found.tensor)
    return parts.Body(replace(kept, written=found.written if "inertia" in given else None))


def add_shapes(builder: HymekoBuilder, key: Id, block: Block, items: tuple[Item, ...], scope: Scope) -> None:
    """Give a body the shapes among the items, which are taken out of the block."""
    shapes = [item for item in items if _is_shape(item)]
    _read_shapes(builder, key, shapes, IDENTITY, scope)
    block.nodes = [node for node in block.nodes if node not in shapes]
    block.arcs = [arc for arc in block.arcs if arc not in shapes]
    for item in shapes:
        if isinstance(item, Field):
            block.fields.pop(item.name, None)


def is_base_arc(item: object) -> bool:
    """Whether an item of a body's block names the body that it is fixed to: ``[0 0 1] + arm``."""
    return isinstance(item, ArcItem) and not item.role and sign_of(item) > 0


def read_fixed(builder: HymekoBuilder, key: Id, element: ExpandedElement) -> None:
    """The joint without dofs between a body and the one that its block names."""
    arcs = [item for item in element.node.items if isinstance(item, ArcItem) and is_base_arc(item)]
    if len(arcs) > 1:
        raise builder.reader.refuse(arcs[1], f"body '{key.name}' is fixed to several others; only one is possible without joints")
    builder.edges[key] = attached_edge(Id("body", key.name), (builder.arc("joint", arcs[0], element.scope),))


def _is_shape(item: Item) -> bool:
    return (isinstance(item, Node | Field) and item.name in _ROLES) or (isinstance(item, ArcItem) and item.role in _ROLES)


def _is_seen(item: Item) -> bool:
    return _is_shape(item) and (item.role if isinstance(item, ArcItem) else getattr(item, "name", "")) != "collision"


def _is_referenced(items: tuple[Item, ...], node: Node) -> bool:
    """Whether a nested node is the geometry that a `visual -> name` of the same body refers to."""
    return any(isinstance(item, ArcItem) and item.role in _ROLES and item.ref.path == (node.name,) for item in items)


def _with_geometry(item: Item, block: Block) -> Item:
    """``visual -> name`` with the fields of a nested ``name : mesh { .. }`` or ``name : capsule { .. }`` of the same body."""
    if not isinstance(item, ArcItem):
        return item
    node = next((node for node in block.nodes if item.ref.path == (node.name,)), None)
    if node is None:
        return item
    items = tuple(inner._replace(name="mesh") if isinstance(inner, Field) and inner.name in _FILE_WORDS else inner for inner in node.items)
    kind = node.stereotypes[0].ref.path[-1] if node.stereotypes else _named_geometry(node)
    items = tuple(inner for inner in items if not (isinstance(inner, ArcItem) and inner.role == "geometry"))
    if kind != "mesh":
        items = (Field("type", kind, "", node.line, node.column), *items)
    return Node(item.role, (*items, *item.items), line=item.line, column=item.column)


def _named_geometry(node: Node) -> str:
    """The geometry that ``geometry -> cylinder`` names; a mesh where nothing does."""
    return next((item.ref.path[-1] for item in node.items if isinstance(item, ArcItem) and item.role == "geometry"), "mesh")


def _with_color(item: Item, color: Field | None) -> Item:
    """A shape that is seen, with the colour of its body where it has no appearance of its own."""
    if color is None or not isinstance(item, Node) or item.name == "collision":
        return item
    given = {inner.name for inner in item.items if isinstance(inner, Field)} | {
        inner.role for inner in item.items if isinstance(inner, ArcItem)
    }
    return item if given & {"color", "material", "rgba"} else item._replace(items=(*item.items, color))


def _place(block: Block) -> Pose:
    """``translation`` and ``rotation`` of a link: the frame of its geometry and mass, as in the published listings."""
    translation, rotation = block.take("translation", "origin"), block.take("rotation")
    xyz = cast("Value", translation.value) if translation else ZERO
    if rotation is not None:
        return block.reader.pose((xyz, cast("Value", rotation.value)), rotation)
    return IDENTITY if translation is None else block.reader.pose(xyz, translation)


def _inertial(block: Block, place: Pose) -> parts.Inertial | None:
    reader = block.reader
    mass, com, tensor, axes = block.take("mass"), block.take("com"), block.take("inertia"), block.take("axes")
    marker = block.take_node("inertial")
    if mass is None and com is None and tensor is None and axes is None and marker is None:
        return None
    inertial = parts.Inertial(
        None if mass is None else reader.finite((reader.number(mass.value, "mass", mass),), mass)[0],
        place.xyz if com is None else reader.vec3(com.value, "length", com),
    )
    if tensor is None and axes is not None:
        raise reader.refuse(axes, "'axes' are those of an 'inertia', and there is none")
    if tensor is None:
        return inertial
    local = _tensor(tensor, reader)
    if axes is None:
        return replace(inertial, tensor=local)
    turn = axes.value
    if not is_list(turn):
        raise reader.refuse(axes, f"'axes' takes [roll pitch yaw] or [w x y z], not {describe(turn)}")
    frame = reader.pose((ZERO, *turn) if turn and isinstance(turn[0], str) else (ZERO, turn), axes)
    written = parts.InertialWritten(replace(frame, xyz=inertial.com), local)
    return replace(inertial, tensor=rotate_tensor(frame.quat, local), written=written)


def _tensor(item: Field, reader: ValueReader) -> Tensor:
    """Six entries xx yy zz xy xz yz, or the three of a diagonal tensor."""
    numbers = reader.finite(reader.numbers(item.value, "", item), item)
    if len(numbers) == 3:
        return (*numbers, 0.0, 0.0, 0.0)
    if len(numbers) != 6:
        raise reader.refuse(item, f"'inertia' takes [xx yy zz] or [xx yy zz xy xz yz], not {len(numbers)} numbers")
    return numbers


def _read_shapes(builder: HymekoBuilder, body: Id, items: Sequence[Item], place: Pose, scope: Scope) -> None:
    """The shapes of a body in order; ``collision`` alone is one like each of the visuals directly before it."""
    seen: list[Id] = []
    for item in items:
        if is_field(item, ("collision",)) and item.value is None:
            if not seen:
                raise builder.reader.refuse(item, "'collision' alone means the visuals directly before it, and there is none")
            for visual in seen:
                _collide_as(builder, body, visual, item)
            seen = []
            continue
        key = _read_shape(builder, body, item, place, scope)
        seen = [*seen, key] if cast("parts.Shape", builder.edges[key].data).role is parts.Role.VISUAL else []


def _collide_as(builder: HymekoBuilder, body: Id, visual: Id, item: Item) -> None:
    """A collision shape with the geometry, the mesh, the pose and the notations of a visual."""
    edge = builder.edges[visual]
    key = builder.name_after_place("shape", f"{body.name}/{SHAPE_ROLES[parts.Role.COLLISION]}", item)
    shape = parts.Shape(cast("parts.Shape", edge.data).geometry, parts.Role.COLLISION)
    builder.edges[key] = Edge(shape, tuple(arc for arc in edge.arcs if arc.role != "material"))
    if visual in builder.notations:
        builder.notations[key] = builder.notations[visual]


def _read_shape(builder: HymekoBuilder, body: Id, item: Item, place: Pose, scope: Scope) -> Id:
    """``visual { .. }``, ``visual "file"`` (a mesh's file), ``visual=mesh``, or ``visual -> mesh { .. }``."""
    match item:
        case Field(name=word):
            block = Block((item._replace(name="mesh"),), builder.reader)
        case ArcItem(role=word):
            block = Block(item.items, builder.reader)
            block.arcs.append(item._replace(role="mesh"))
        case Node(name=word):
            block = Block(item.items, builder.reader)
        case _:
            raise AssertionError(item)
    given = block.take_text("id") if word != "geometry" else None
    role = _ROLES[word]
    if given is not None:
        key = builder.reserve("shape", given, item)
    else:
        key = builder.name_after_place("shape", f"{body.name}/{SHAPE_ROLES[role]}", item)
    pose = _shape_pose(block, place)
    geometry, mesh = _geometry(builder, block, key, scope, pose)
    material = _material(builder, block, key, scope)
    named = _named_after(mesh or body, block)
    shape = parts.Shape(geometry, role, **named, **block.take_words(SHAPE_WORDS))  # type: ignore[arg-type]
    builder.edges[key] = shape_edge(shape, body, pose, mesh, material)
    block.rest(str(key))
    builder.keep(key, block)
    return key


def _named_after(key: Id, block: Block) -> dict[str, object]:
    """The name of a shape with the word ``name`` alone: that of its mesh, or of its body where it has none."""
    item = block.fields.get("name")
    if item is None or item.value is not None:
        return {}
    block.take("name")
    return {"name": key.name}


def _shape_pose(block: Block, place: Pose) -> Pose:
    at, ends = block.take("at"), block.take("fromto")
    if ends is not None:
        return block.reader.pose(("fromto", cast("Value", ends.value)), ends)
    if at is not None:
        return block.reader.pose(at.value, at)
    own = _place(block)
    if own == IDENTITY:
        return place
    return Pose(own.xyz if own.xyz != ZERO else place.xyz, own.quat, own.written)


def _geometry(builder: HymekoBuilder, block: Block, key: Id, scope: Scope, pose: Pose) -> tuple[parts.Geometry, Id | None]:
    if (item := block.take("mesh")) is not None:
        if isinstance(item.value, Ref):
            return parts.MeshShape(), builder.target(item.value, scope, ("mesh",), item)
        return parts.MeshShape(), _inline_mesh(builder, block, block.reader.text(item.value, item), item)
    if (arc := block.take_role("mesh")) is not None:
        return parts.MeshShape(), builder.target(arc.ref, scope, ("mesh",), arc)
    for word in SOLIDS:
        if (item := block.take(word)) is not None:
            return _solid(word, item, pose, block.reader), None
    return _described_geometry(block, key), None


def _solid(word: str, item: Field, pose: Pose, reader: ValueReader) -> parts.Geometry:
    """A geometry from its one field: edge lengths, radius, radii, radius and length, or half sizes in metres.

    A cylinder or capsule may have its radius alone where the pose is given by two points.
    """
    match word:
        case "box":
            return parts.Box(reader.vec3(item.value, "length", item))
        case "sphere":
            return parts.Sphere(_radius(item, reader))
        case "ellipsoid":
            return parts.Ellipsoid(reader.vec3(item.value, "length", item))
        case "plane":
            return parts.Plane(cast("tuple[float, float]", reader.finite(reader.numbers(item.value, "length", item, 2), item)))
    kind = parts.Cylinder if word == "cylinder" else parts.Capsule
    if pose.written is not None and pose.written.kind == "fromto" and not is_list(item.value):
        return kind(_radius(item, reader), length_of(pose.written))
    return kind(*reader.finite(reader.numbers(item.value, "length", item, 2), item))


def _radius(item: Field, reader: ValueReader) -> float:
    return reader.finite((reader.number(item.value, "length", item),), item)[0]


def _described_geometry(block: Block, key: Id) -> parts.Geometry:
    """``type = cylinder dimensions = [radius, length]``, as in the published listings; no field at all is an empty geometry."""
    reader = block.reader
    kind, size = block.take("type"), block.take("dimensions", "dimension")
    if kind is None or size is None:
        if kind is not None or size is not None:
            raise reader.refuse(kind or size, f"{key} needs both 'type' and 'dimensions'")  # type: ignore[arg-type]
        return parts.NoShape()
    word = reader.text(kind.value, kind)
    numbers = reader.numbers(size.value, "length", size)
    match word, numbers:
        case "box", (x, y, z):
            return parts.Box((x, y, z))
        case "cylinder", (radius, length):
            return parts.Cylinder(radius, length)
        case "capsule", (radius, length):
            return parts.Capsule(radius, length)
        case "sphere", (radius,):
            return parts.Sphere(radius)
    known = "there are box [x y z], cylinder [r l], capsule [r l], sphere [r]"
    raise reader.refuse(kind, f"'{word}' with {len(numbers)} dimensions is not a geometry; {known}")


def _inline_mesh(builder: HymekoBuilder, block: Block, uri: str, item: Field) -> Id:
    """The mesh vertex of a file named in a shape: called after the file unless an id is given."""
    scale: Vec3 = (1.0, 1.0, 1.0)
    field = block.take("scale")
    if field is not None and is_list(field.value):
        scale = block.reader.vec3(field.value, "", field)
    elif field is not None:
        scale = (block.reader.number(field.value, "", field),) * 3
    given = block.take_text("mesh_id")
    key = builder.reserve("mesh", given, item) if given is not None else builder.name_after_place("mesh", file_stem(uri) or "mesh", item)
    builder.vertices[key] = parts.Mesh(builder.full_uri(uri), scale)
    return key


def _material(builder: HymekoBuilder, block: Block, key: Id, scope: Scope) -> Id | None:
    """The material that a shape refers to, or a new one of a colour."""
    if (arc := block.take_role("material")) is not None or (arc := block.take_role("color")) is not None:
        return builder.target(arc.ref, scope, ("material",), arc)
    if (named := block.take("material")) is not None:
        if isinstance(named.value, Ref):
            return builder.target(named.value, scope, ("material",), named)
        raise block.reader.refuse(named, "'material' takes a reference: material=steel")
    if (color := block.take("color")) is None:
        return None
    material = builder.name_after_place("material", f"{key.name}/material", color)
    builder.vertices[material] = parts.Material(None, block.reader.rgba(color.value, color))
    return material
