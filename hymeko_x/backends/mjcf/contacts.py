"""<contact>: pairs of geoms that collide, and pairs of bodies that do not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.sheet import tag_of
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Contact

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.sheet import MjcfSheet
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.xml.printing import Tag

_ENDS = {"pair": ("geom1", "geom2"), "exclude": ("body1", "body2")}


def write_contacts(sheet: MjcfSheet) -> None:
    """Exclusions, and pairs of what came from MJCF; MuJoCo itself leaves out neighbours in the tree."""
    items: list[tuple[Id, Tag]] = []
    for key, contact, arcs in sheet.mechanism.edges(Contact):
        if contact.kind not in (_ENDS if sheet.from_mjcf else ("exclude",)):
            continue
        own_class = sheet.own_class(key)
        attributes = {
            "name": None if sheet.mechanism.notation(key, UNNAMED) else sheet.name(key),
            "class": own_class,
            **{name: sheet.reference(arc) for name, arc in zip(_ENDS[contact.kind], arcs, strict=True)},
            **sheet.parameters(contact.parameters, f"contact/{contact.kind}", sheet.base(contact.kind, own_class)),
            **sheet.kept_attributes(key),
        }
        items.append((key, tag_of(contact.kind, attributes, sheet.inside(key))))
    sheet.write_section("contact", items)
