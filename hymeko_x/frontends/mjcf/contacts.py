"""<contact>: pairs of geoms that collide, and pairs of bodies that do not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.frontends.mjcf.mounts import take_parameters
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Contact

if TYPE_CHECKING:
    from hymeko_x.frontends.mjcf.builder import MjcfBuilder
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.xml.tree import XmlNode

_ENDS = {"pair": ("geom", "geom1", "geom2"), "exclude": ("body", "body1", "body2")}


def read_contacts(sections: list[XmlNode], builder: MjcfBuilder) -> None:
    """Pairs and exclusions in order."""
    for section in sections:
        for element in section.children:
            if element.tag in _ENDS:
                _read_contact(element, builder)
            else:
                builder.keep_at_root(element, "contact")


def _read_contact(element: XmlNode, builder: MjcfBuilder) -> None:
    kind, *ends = _ENDS[element.tag]
    key = builder.own(element, "contact", element.tag)
    base = builder.base(element, key)
    arcs: tuple[RobotArc, ...] = tuple(Arc(find_end(element, kind, name, builder)) for name in ends)
    builder.edges[key] = Edge(Contact(element.tag, take_parameters(element, base)), arcs)
    builder.keep(element, key)
    builder.show(key)


def find_end(element: XmlNode, kind: str, attribute: str, builder: MjcfBuilder) -> Id:
    """What an attribute refers to; the world may be called a body."""
    name = element.take(attribute) or ""
    if kind == "body" and name == "world" and ("body", "world") not in builder.named:
        return WORLD
    return builder.find(element, kind, name)
