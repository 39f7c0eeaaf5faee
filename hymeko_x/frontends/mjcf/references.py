"""References of attributes that have no arc in the IR: they are looked up all the same, once everything is read."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec import Struct

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.formats.mjcf.tree import Element
    from hymeko_x.frontends.mjcf.draft import Draft

_REFERENCES: Mapping[str, tuple[tuple[str, str], ...]] = MappingProxyType(
    {
        "body/geom": (("hfield", "hfield"),),
        "body/site": (("material", "material"), ("mesh", "mesh")),
        "body/camera": (("target", "body"),),
        "body/light": (("target", "body"), ("texture", "texture")),
        "asset/skin": (("material", "material"),),
        "asset/skin/bone": (("body", "body"),),
        "deformable/skin": (("material", "material"),),
        "deformable/skin/bone": (("body", "body"),),
        "tendon/spatial": (("material", "material"),),
        "equality/joint": (("joint1", "joint"),),
        "equality/tendon": (("tendon1", "tendon"), ("tendon2", "tendon")),
        "equality/flex": (("flex", "flex"),),
        "equality/flexstrain": (("flex", "flex"),),
    }
)


class Reference(Struct, frozen=True):
    """An element that names another one."""

    element: Element
    kind: str
    name: str


def references_at(path: str) -> tuple[tuple[str, str], ...]:
    """The attributes that refer without an arc, of the elements of this place of the schema, each with the kind that it refers to."""
    return _REFERENCES.get(path, ())


def references_of(element: Element, attributes: tuple[tuple[str, str], ...]) -> list[Reference]:
    """What the element refers to by these attributes."""
    said = [(kind, element.attributes.get(attribute)) for attribute, kind in attributes]
    return [Reference(element, kind, name) for kind, name in said if name]


def check_references(found: Iterable[Reference], draft: Draft) -> None:
    """Raises: Refusal (HX040) at the first one that leads nowhere."""
    for reference in found:
        if reference.kind != "body" or reference.name != "world":
            draft.find(reference.element, reference.kind, reference.name)
