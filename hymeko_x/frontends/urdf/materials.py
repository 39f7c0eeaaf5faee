"""Materials: global by name, defined at robot level or inside a visual, or a colour without a name.

A colour in a visual's unnamed material is the shape's own colour. A second definition of a name with other looks is
a material of its own, since readers disagree: urdfdom keeps the first one, MuJoCo the one inside each visual.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats import urdf as words
from hymeko_x.formats.urdf import Defined
from hymeko_x.frontends.urdf.draft import Looks, take_numbers
from hymeko_x.ir.mechanism import Id, file_stem, layer_edge
from hymeko_x.ir.parts import Material, Texture

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.frontends.urdf.draft import Draft
    from hymeko_x.ir.parts import Rgba
    from hymeko_x.xml.tree import Node

Said = tuple["Rgba | None", "str | None"]


def read_robot_material(root: Node, node: Node, draft: Draft) -> None:
    """Add a material of robot level; one that nobody can use, or that says the same again, stays as it was written."""
    name = node.attributes.get("name")
    if not name:
        said = "a <material> of robot level has no name, so that nobody can use it; it is kept as written"
        draft.report.warn(codes.BAD_NAME, said, node.origin)
        root.leave(node)
        return
    node.owner = Id("material", name)
    looks = _resolve(node, name, _read_looks(node, draft), draft)
    if looks.at_robot:
        said = f"the material '{name}' is defined twice at robot level, in the same way; the second one is kept as written"
        draft.report.warn(codes.DUPLICATE_NAME, said, node.origin, element=str(looks.id))
        root.leave(node)
        return
    looks.at_robot = True
    node.take("name")
    node.owner = looks.id
    draft.close(node)


def read_shape_material(shape: Node, draft: Draft) -> tuple[Rgba | None, Id | None]:
    """The colour of a shape's unnamed material, or the id of its named one."""
    node = shape.take_child("material")
    if node is None:
        return None, None
    name = node.attributes.get("name")
    if name:
        node.take("name")
        return None, _use(node, name, draft)
    return _read_unnamed(shape, node, draft)


def _use(node: Node, name: str, draft: Draft) -> Id:
    said = _read_looks(node, draft)
    looks = _resolve(node, name, said, draft)
    looks.uses += 1
    looks.inline += said != (None, None)
    looks.first_use = looks.first_use or node.origin
    return looks.id


def _read_unnamed(shape: Node, node: Node, draft: Draft) -> tuple[Rgba | None, Id | None]:
    rgba, texture = _read_looks(node, draft)
    if (rgba, texture) == (None, None):
        shape.leave(node)
        return None, None
    if node.take("name") is None:
        said = f"{shape.subject}: <material> has no name; its looks are the shape's own (urdfdom drops such a visual)"
        draft.report.warn(codes.BAD_NAME, said, node.origin, element=shape.element)
    if texture is None:
        return rgba, None
    key = draft.names.take("material", str(shape.owner and shape.owner.name))
    _add(Looks(key, rgba, texture, first_use=node.origin), None, draft)
    return None, key


def _read_looks(node: Node, draft: Draft) -> Said:
    rgba = texture = None
    color = node.take_child("color")
    if color is not None:
        rgba = take_numbers(color, "rgba", 4, draft.report, instead="no colour is used")
        if rgba is None and "rgba" not in color.attributes:
            node.leave(color)
    image = node.take_child("texture")
    if image is not None:
        texture = image.take("filename")
        if not texture:
            node.leave(image)
    if rgba is None:
        return None, texture or None
    r, g, b, a = rgba
    return (r, g, b, a), texture or None


def _resolve(node: Node, name: str, said: Said, draft: Draft) -> Looks:
    """The material of this name with these looks: the first one if nothing was said, a new one if other looks were."""
    variants = draft.materials.setdefault(name, [])
    if not variants:
        variants.append(Looks(_material_id(name, node, draft)))
    first = variants[0]
    if said == (None, None):
        return first
    if not first.known:
        first.rgba, first.texture = said
        return first
    same = next((looks for looks in variants if (looks.rgba, looks.texture) == said), None)
    if same is not None:
        return same
    other = Looks(_material_id(name, node, draft), *said)
    variants.append(other)
    draft.report.warn(
        codes.MATERIAL_REDEFINED,
        f"the material '{name}' is defined again with other looks (before: {draft.origins[first.id]}); "
        f"both are kept, this one as '{other.id.name}'",
        node.origin,
        element=str(other.id),
    )
    return other


def _material_id(name: str, node: Node, draft: Draft) -> Id:
    key = draft.names.take("material", name)
    draft.origins[key] = node.origin
    return key


# ---- at the end --------------------------------------------------------------------------------------------------------------


def finish_materials(draft: Draft) -> None:
    """Add the materials, and note where most of them are defined and which ones elsewhere."""
    for name, variants in draft.materials.items():
        for looks in variants:
            _add(looks, name, draft)
            if not looks.known and not looks.at_robot:
                said = f"the material '{name}' is not defined anywhere; it has no looks (urdfdom shows a default grey)"
                draft.report.warn(codes.UNDEFINED_REFERENCE, said, looks.first_use, element=str(looks.id))
    _note_places(draft)


def _add(looks: Looks, name: str | None, draft: Draft) -> None:
    draft.vertices[looks.id] = Material(name, looks.rgba)
    if looks.texture is None:
        return
    texture = draft.textures.get(looks.texture)
    if texture is None:
        texture = draft.names.take("texture", file_stem(looks.texture) or "texture")
        draft.textures[looks.texture] = texture
        draft.vertices[texture] = Texture(looks.texture)
    draft.edges[draft.names.take("layer", looks.id.name)] = layer_edge(texture, looks.id)


def _note_places(draft: Draft) -> None:
    """Where each material is defined: of the places that suit it, the one that suits most."""
    places = dict(_places(draft))
    votes = Counter(place for suiting in places.values() for place in suiting)
    for key, suiting in places.items():
        draft.choose(key, words.DEFINED, max(suiting, key=lambda place: votes[place]).value)


def _places(draft: Draft) -> Iterator[tuple[Id, tuple[Defined, ...]]]:
    for variants in draft.materials.values():
        for number, looks in enumerate(variants):
            if number == 0 and looks.known:
                yield looks.id, _suiting(looks)
            elif looks.at_robot:
                draft.note(looks.id, words.notation(words.DEFINED), Defined.ROBOT.value)


def _suiting(looks: Looks) -> tuple[Defined, ...]:
    """The places that write at least the definitions that the file has."""
    if looks.at_robot:
        return (Defined.BOTH,) if looks.inline else (Defined.ROBOT, Defined.BOTH) if not looks.uses else (Defined.ROBOT,)
    if looks.inline > 1:
        return (Defined.INLINE,)
    return (Defined.INLINE, Defined.FIRST) if looks.uses == 1 else (Defined.FIRST,)
