"""<material>: colours and PBR textures of a visual."""

from __future__ import annotations

import posixpath
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats.sdf import materials as words
from hymeko_x.formats.sdf.values import COLOUR, NUMBER
from hymeko_x.ir.mechanism import layer_edge
from hymeko_x.ir.parts import Material, Texture

if TYPE_CHECKING:
    from hymeko_x.frontends.sdf.builder import SdfBuilder
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.parts import Rgba
    from hymeko_x.xml.tree import XmlNode


def read_material(visual: XmlNode, key: Id, builder: SdfBuilder) -> tuple[Rgba | None, Id | None]:
    """The colour of a visual, or, where it has textures, the material with them. Scripts and further colours stay as written."""
    node = visual.child("material")
    if node is None or not node.children:
        return None, None
    node.taken = True
    script = node.child("script")
    texts = {} if script is None else {child.tag: (child.text or "").strip() for child in script.children}
    missing = [] if script is None else [f"<{tag}>" for tag in ("uri", "name") if texts.get(tag, "") in ("", "__default__")]
    if script is not None and missing:
        message = f"{visual.subject}: <script> without a {' and a '.join(missing)}, which libsdformat refuses, is kept as written"
        builder.warn(codes.MISSING_PART, script, message)
    rgba = _read_colour(node, key, builder)
    pbr = node.child("pbr")
    metal = None if pbr is None else pbr.child("metal")
    if pbr is None or metal is None:
        return rgba, None
    pbr.taken = metal.taken = True
    values = {name: builder.child_value(metal, tag, NUMBER, None, key, f"material/pbr/metal/{tag}") for tag, name in words.NUMBERS.items()}
    material = builder.names.take("material", key.name)
    builder.vertices[material] = Material(None, rgba, **values)
    builder.origins[material] = node.origin
    for tag, use in words.MAPS.items():
        child = next((child for child in metal.children if child.tag == tag and (child.text or "").strip()), None)
        if child is not None:
            child.taken = True
            uri = child.take_text()
            texture = builder.names.take("texture", posixpath.splitext(posixpath.basename(uri))[0] or "texture")
            builder.vertices[texture] = Texture(uri)
            builder.edges[builder.names.take("layer", texture.name)] = layer_edge(texture, material, use)
    return None, material


def _read_colour(node: XmlNode, key: Id, builder: SdfBuilder) -> Rgba | None:
    """The diffuse colour. An ambient one with the same text is a notation: files that were written from other formats have both."""
    texts = [None if (child := node.child(tag)) is None or child.children else child.text for tag in ("ambient", "diffuse")]
    rgba: Rgba | None = builder.child_value(node, "diffuse", COLOUR, None, key, "material/diffuse")
    if rgba is not None and texts[0] is not None and texts[0] == texts[1] and (ambient := node.take_child("ambient")) is not None:
        builder.written.setdefault(key, {})[words.AMBIENT] = " ".join(ambient.take_text().split())
    return rgba
