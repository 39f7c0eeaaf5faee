"""Bodies, inertials and shapes as HyMeKo text."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from hymeko_x.backends.hymeko.extras import with_extras
from hymeko_x.backends.hymeko.parts import word_fields
from hymeko_x.backends.hymeko.sheet import written_items
from hymeko_x.backends.hymeko.values import pose_value, value_of
from hymeko_x.formats.hymeko import SHAPE_ROLES, SHAPE_WORDS, SOLIDS
from hymeko_x.formats.hymeko.files import SHORT, files_of
from hymeko_x.ir import parts
from hymeko_x.ir.fields import identical
from hymeko_x.ir.names import Names
from hymeko_x.ir.uses import first_uses
from hymeko_x.ir.values import IDENTITY, ZERO
from hymeko_x.ir.written import length_of
from hymeko_x.language.syntax import Field, Item, Node, Value
from hymeko_x.source import file_stem

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from hymeko_x.backends.hymeko.sheet import HymekoSheet
    from hymeko_x.backends.hymeko.values import Angles
    from hymeko_x.ir.mechanism import Id, Mechanism, ShapeView
    from hymeko_x.ir.values import Pose

_SOLID_WORDS = {kind: word for word, kind in SOLIDS.items()}


def body_items(sheet: HymekoSheet, key: Id, part: parts.Body | parts.World) -> list[Item]:
    """The block of a body or of the world: inertial, then shapes in order."""
    items: list[Item] = [sheet.arc("joint", arc) for arc in sheet.attached.get(key, ())]
    if isinstance(part, parts.Body) and part.inertial is not None:
        items.extend(_inertial_items(part.inertial, sheet.angles))
    return items + _shape_items(sheet, sheet.mechanism.shapes.get(key, ()))


def _shape_items(sheet: HymekoSheet, views: Sequence[ShapeView]) -> list[Item]:
    """The shapes in order; ``collision`` alone where the body collides with what the visuals directly before show."""
    items: list[Item] = []
    names = Names()
    named = [names.take("shape", f"{view.body.name}/{SHAPE_ROLES[view.shape.role]}") == view.id for view in views]
    place = first = 0  # of this shape, and of the first in a run of visuals that ends before it
    while place < len(views):
        end = 2 * place - first
        seen, twins = views[first:place], views[place:end]
        if seen and len(twins) == len(seen) and all(named[place:end]) and all(map(partial(_is_twin, sheet), seen, twins)):
            items.append(Field("collision"))
            place = first = end
            continue
        items.append(_shape(sheet, views[place], is_named=not named[place]))
        place += 1
        first = first if views[place - 1].shape.role is parts.Role.VISUAL else place
    return items


def _is_twin(sheet: HymekoSheet, visual: ShapeView, view: ShapeView) -> bool:
    """Whether a shape is a collision shape with the geometry, the mesh, the pose and the notations of a visual, and nothing else."""
    mechanism = sheet.mechanism
    plain = parts.Shape(visual.shape.geometry, parts.Role.COLLISION)
    if (
        sheet.is_flat
        or sheet.around is not None
        or view.id in mechanism.extras
        or view.id in mechanism.stereotypes
        or view.material is not None
    ):
        return False
    same = identical(plain, view.shape) and identical(visual.pose, view.pose) and visual.mesh == view.mesh
    return same and mechanism.notations.get(visual.id) == mechanism.notations.get(view.id)


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
        return frame.quat  # two points are more than a rotation
    rotation = pose_value(frame, angles)
    if len(rotation) == 2:
        return rotation[1]
    return rotation[1:] if isinstance(rotation[1], str) else (0.0, 0.0, 0.0)


def _shape(sheet: HymekoSheet, view: ShapeView, *, is_named: bool) -> Item:
    """``visual { .. }``, or ``visual "file"`` and ``visual=mesh`` for a mesh alone; ``is_named`` with its id."""
    word = SHAPE_ROLES[view.shape.role]
    items = _described(sheet, view)
    if is_named:
        items.append(Field("id", view.id.name))
    items.extend(sheet.class_items(view.id))
    notations = sheet.mechanism.notations.get(view.id)
    if notations:
        items.extend(written_items(notations))
    items = with_extras(items, sheet.mechanism.extras.get(view.id, ()))
    if len(items) == 1 and isinstance(items[0], Field) and items[0].name == "mesh":
        return Field(word, items[0].value)
    return Node(word, tuple(items))


def _described(sheet: HymekoSheet, view: ShapeView) -> list[Item]:
    items = _geometry(sheet, view)
    if not identical(view.pose, IDENTITY):
        items.append(_place(view.pose, sheet.angles))
    if view.material is not None:
        items.append(_material(sheet, view.material))
    after = (view.mesh or view.body).name
    fields = word_fields(view.shape, SHAPE_WORDS, sheet.angles)
    items.extend(Field("name") if item.name == "name" and view.shape.name == after else item for item in fields)
    return items


def _place(pose: Pose, angles: Angles) -> Field:
    """``at`` with the pose, or ``fromto`` with two points."""
    if pose.written is not None and pose.written.kind == "fromto":
        return Field("fromto", pose.written.numbers)
    return Field("at", pose_value(pose, angles))


def _geometry(sheet: HymekoSheet, view: ShapeView) -> list[Item]:
    geometry = view.shape.geometry
    value: Value
    match geometry:
        case parts.MeshShape():
            return _mesh(sheet, view)
        case parts.NoShape():
            return []
        case parts.Cylinder(radius, length) | parts.Capsule(radius, length):
            written = view.pose.written  # two points that it lies between give the length
            is_between = written is not None and written.kind == "fromto" and str(length_of(written)) == str(length)
            value = radius if is_between else (radius, length)
        case parts.Sphere(radius):
            value = radius
        case parts.Box(size) | parts.Ellipsoid(size):
            value = size
        case parts.Plane(half_size):
            value = half_size
    return [Field(_SOLID_WORDS[type(geometry)], value)]


def _mesh(sheet: HymekoSheet, view: ShapeView) -> list[Item]:
    """The mesh where it is used first: its file; elsewhere a reference."""
    if view.mesh is None:
        return []
    if sheet.inline.get(view.mesh) != view.id:
        return [Field("mesh", sheet.ref(view.mesh, ("mesh",)))]
    mesh = sheet.mechanism.vertex(view.mesh, parts.Mesh)
    assert mesh.uri is not None
    items: list[Item] = [Field("mesh", sheet.short_uri(mesh.uri))]
    x, y, z = mesh.scale
    if mesh.scale != (1.0, 1.0, 1.0):
        scale: Value = x if x == y == z else mesh.scale
        items.append(Field("scale", scale))
    if view.mesh in sheet.given_names:
        items.append(Field("mesh_id", value_of(view.mesh.name)))
    return items


def _material(sheet: HymekoSheet, key: Id) -> Item:
    """An unnamed colour of this shape alone, or a reference."""
    if key not in sheet.inline:
        return Field("material", sheet.ref(key, ("material",)))
    rgba = sheet.mechanism.vertex(key, parts.Material).rgba
    assert rgba is not None
    return Field("color", rgba[:3] if rgba[3] == 1.0 else rgba)


def inline_assets(mechanism: Mechanism) -> dict[Id, Id]:
    """Meshes given by a file alone, and nameless colours of one shape, with the shape in which they are defined."""
    side = {key for table in (mechanism.extras, mechanism.notations) for key in table} | set(mechanism.layout)
    inline: dict[Id, Id] = {}
    for key, shape in first_uses(mechanism).items():
        if key in side or key not in mechanism.graph.vertices:
            continue
        part = mechanism.graph.vertices[key]
        if isinstance(part, parts.Mesh):
            plain = part == parts.Mesh(part.uri, part.scale) and part.uri is not None and not part.uri.startswith(SHORT)
        else:
            users = [arc for _, edge, arc in mechanism.graph.edges_at(key)]
            bare = isinstance(part, parts.Material) and part == parts.Material(None, part.rgba) and part.rgba is not None
            plain = bare and len(users) == 1 and key.name == f"{shape.name}/material"
        if plain:
            inline[key] = shape
    return inline


def given_names(mechanism: Mechanism, inline: Mapping[Id, Id]) -> frozenset[Id]:
    """The meshes defined in place whose ids must be written, because they do not follow from the file."""
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
    """The folder that most files share, and their ending, when writing them once is shorter; empty when there is none."""
    uris = [part.uri for part in mechanism.graph.vertices.values() if isinstance(part, parts.Mesh | parts.Texture) and part.uri]
    folders: dict[str, int] = {}
    for uri in uris:
        folder = uri[: uri.rfind("/") + 1]
        while folder:
            folders[folder] = folders.get(folder, 0) + 1
            folder = folder[: folder.rfind("/", 0, len(folder) - 1) + 1]
    saved = {folder: (len(folder) - 2) * count - len(folder) - 7 for folder, count in folders.items() if not folder.endswith("//")}
    best = max(saved, key=lambda folder: (saved[folder], folder), default="")
    is_short = best and saved[best] > 0 and "*" not in best and not any(uri.startswith(SHORT) for uri in uris)
    return files_of(best, uris) if is_short else ""
