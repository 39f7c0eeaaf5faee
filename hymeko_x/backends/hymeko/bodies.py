"""Bodies, inertials and shapes as HyMeKo text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.hymeko.foreign import foreign_items, verbatim
from hymeko_x.backends.hymeko.parts import Context, pose_value, short_uri, word_fields, written_items
from hymeko_x.formats.hymeko import SHAPE_WORDS
from hymeko_x.ir import parts
from hymeko_x.ir.fields import identical
from hymeko_x.ir.mechanism import Id, file_stem
from hymeko_x.ir.names import Names
from hymeko_x.ir.values import IDENTITY, ZERO
from hymeko_x.ir.written import length_of
from hymeko_x.language.syntax import Field, Item, Node, Value

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.backends.hymeko.angles import Angles
    from hymeko_x.ir.mechanism import Mechanism, ShapeView
    from hymeko_x.ir.values import Pose

_PLACES = {parts.Role.VISUAL: "visual", parts.Role.COLLISION: "collision", parts.Role.BOTH: "shape"}


def body_items(context: Context, key: Id, part: parts.Body | parts.World) -> list[Item]:
    """The block of a body or of the world: inertial, then shapes in order."""
    items: list[Item] = [context.arc("joint", arc) for arc in context.attached.get(key, ())]
    if isinstance(part, parts.Body) and part.inertial is not None:
        items.extend(_inertial_items(part.inertial, context.angles))
    names = Names()
    for view in context.mechanism.shapes.get(key, ()):
        items.append(_shape(context, view, names))
    return items


def _inertial_items(inertial: parts.Inertial, angles: Angles) -> list[Item]:
    items: list[Item] = []
    if inertial.mass is not None:
        items.append(Field("mass", inertial.mass))
    if not identical(inertial.com, ZERO):
        items.append(Field("com", inertial.com))
    tensor = inertial.tensor
    if tensor is not None:
        if inertial.written is not None:
            items.append(Field("axes", _axes(inertial.written.frame, angles)))
            tensor = inertial.written.tensor
        items.append(Field("inertia", tensor[:3] if identical(tensor[3:], ZERO) else tensor))
    return items or [Node("inertial")]


def _axes(frame: Pose, angles: Angles) -> Value:
    """A rotation: roll-pitch-yaw, a quaternion, or another notation with its kind before it."""
    if frame.written is not None and frame.written.kind == "fromto":
        return frame.quat  # two points say more than a rotation
    rotation = pose_value(frame, angles)
    if len(rotation) == 2:
        return rotation[1]
    return rotation[1:] if isinstance(rotation[1], str) else (0.0, 0.0, 0.0)


# ---- shapes --------------------------------------------------------------------------------------------------------------


def _shape(context: Context, view: ShapeView, names: Names) -> Item:
    """``visual { .. }``, or ``visual "file"`` and ``visual=mesh`` where there is nothing else to say."""
    word = _PLACES[view.shape.role]
    items = _shape_items(context, view)
    expected = names.take("shape", f"{view.body.name}/{word}")
    if expected != view.id:
        items.append(Field("id", view.id.name))
    items.extend(context.class_items(view.id))
    notations = context.mechanism.notations.get(view.id)
    if notations:
        items.extend(written_items(notations))
    extras = context.mechanism.extras.get(view.id, ())
    items.extend(foreign_items(extra for extra in extras if extra.format != "comment"))
    items.extend(verbatim(extra) for extra in extras if extra.format == "comment")  # this deep in a text comments are not kept
    if len(items) == 1 and isinstance(items[0], Field) and items[0].name == "mesh":
        return Field(word, items[0].value)
    return Node(word, tuple(items))


def _shape_items(context: Context, view: ShapeView) -> list[Item]:
    items = _geometry(context, view)
    if not identical(view.pose, IDENTITY):
        items.append(_place(view.pose, context.angles))
    if view.material is not None:
        items.append(_material(context, view.material))
    items.extend(word_fields(view.shape, SHAPE_WORDS, context.angles))
    return items


def _place(pose: Pose, angles: Angles) -> Field:
    """``at`` with the pose, or ``fromto`` with two points."""
    if pose.written is not None and pose.written.kind == "fromto":
        return Field("fromto", pose.written.numbers)
    return Field("at", pose_value(pose, angles))


def _round(word: str, radius: float, length: float, pose: Pose) -> Field:
    """A cylinder or capsule: its length is not said where the two points that it lies between tell it."""
    written = pose.written
    told = written is not None and written.kind == "fromto" and str(length_of(written)) == str(length)
    return Field(word, radius if told else (radius, length))


def _geometry(context: Context, view: ShapeView) -> list[Item]:
    match view.shape.geometry:
        case parts.Box(size):
            return [Field("box", size)]
        case parts.Sphere(radius):
            return [Field("sphere", radius)]
        case parts.Cylinder(radius, length):
            return [_round("cylinder", radius, length, view.pose)]
        case parts.Capsule(radius, length):
            return [_round("capsule", radius, length, view.pose)]
        case parts.Ellipsoid(radii):
            return [Field("ellipsoid", radii)]
        case parts.Plane(half_size):
            return [Field("plane", half_size)]
        case parts.MeshShape():
            return _mesh(context, view)
        case parts.NoShape():
            return []


def _mesh(context: Context, view: ShapeView) -> list[Item]:
    """The mesh where it is used first: its file; elsewhere a reference."""
    if view.mesh is None:
        return []
    if context.inline.get(view.mesh) != view.id:
        return [Field("mesh", context.ref(view.mesh, ("mesh",)))]
    mesh = context.mechanism.vertex(view.mesh, parts.Mesh)
    assert mesh.uri is not None
    items: list[Item] = [Field("mesh", short_uri(context, mesh.uri))]
    x, y, z = mesh.scale
    if mesh.scale != (1.0, 1.0, 1.0):
        scale: Value = x if x == y == z else mesh.scale
        items.append(Field("scale", scale))
    if view.mesh in context.given_names:
        items.append(Field("mesh_id", view.mesh.name))
    return items


def _material(context: Context, key: Id) -> Item:
    """An unnamed colour of this shape alone, or a reference."""
    if key not in context.inline:
        return Field("material", context.ref(key, ("material",)))
    rgba = context.mechanism.vertex(key, parts.Material).rgba
    assert rgba is not None
    return Field("color", rgba[:3] if rgba[3] == 1.0 else rgba)


# ---- what is said in place -----------------------------------------------------------------------------------------------


def _first_uses(mechanism: Mechanism) -> dict[Id, Id]:
    """For every mesh and material the first shape that uses it, in the order in which shapes are printed."""
    graph = mechanism.graph
    order = [key for key in dict.fromkeys(mechanism.layout) if key.kind in ("body", "world")]
    placed = set(order)
    order += [key for key in graph.vertices if key.kind == "world" and key not in placed]
    order += [key for key in graph.vertices if key.kind == "body" and key not in placed]
    found: dict[Id, Id] = {}
    for body in order:
        for view in mechanism.shapes.get(body, ()):
            for used in (view.mesh, view.material):
                if used is not None:
                    found.setdefault(used, view.id)
    return found


def inline_assets(mechanism: Mechanism) -> dict[Id, Id]:
    """Meshes given by a file alone, and nameless colours of one shape, with the shape in which they are defined."""
    side = {key for table in (mechanism.extras, mechanism.notations) for key in table} | set(mechanism.layout)
    inline: dict[Id, Id] = {}
    for key, shape in _first_uses(mechanism).items():
        if key in side or key not in mechanism.graph.vertices:
            continue
        part = mechanism.graph.vertices[key]
        if isinstance(part, parts.Mesh):
            plain = part == parts.Mesh(part.uri, part.scale) and part.uri is not None and not part.uri.startswith("~/")
        else:
            users = [arc for _, edge, arc in mechanism.graph.edges_at(key)]
            bare = isinstance(part, parts.Material) and part == parts.Material(None, part.rgba) and part.rgba is not None
            plain = bare and len(users) == 1 and key.name == f"{shape.name}/material"
        if plain:
            inline[key] = shape
    return inline


def given_names(mechanism: Mechanism, inline: Mapping[Id, Id]) -> frozenset[Id]:
    """The meshes defined in place that a reader would not call so by itself: their ids must be said."""
    names = Names()
    for key, _ in mechanism.vertices(parts.Mesh):
        if key not in inline:
            names.take(*key)
    given: set[Id] = set()
    for key in inline:
        part = mechanism.graph.vertices[key]
        if isinstance(part, parts.Mesh) and part.uri is not None and names.free("mesh", file_stem(part.uri) or "mesh") != key:
            given.add(key)
        names.take(*key)
    return frozenset(given)


def files_prefix(mechanism: Mechanism) -> str:
    """The folder that most files share, when saying it once is shorter; empty when there is none."""
    uris = [part.uri for part in mechanism.graph.vertices.values() if isinstance(part, parts.Mesh | parts.Texture) and part.uri]
    folders: dict[str, int] = {}
    for uri in uris:
        folder = uri[: uri.rfind("/") + 1]
        while folder:
            folders[folder] = folders.get(folder, 0) + 1
            folder = folder[: folder.rfind("/", 0, len(folder) - 1) + 1]
    saved = {folder: (len(folder) - 2) * count - len(folder) - 7 for folder, count in folders.items() if not folder.endswith("//")}
    best = max(saved, key=lambda folder: (saved[folder], folder), default="")
    return best if best and saved[best] > 0 and not any(uri.startswith("~/") for uri in uris) else ""
