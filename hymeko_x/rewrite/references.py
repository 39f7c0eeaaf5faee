"""References to elements by their names, in what only one format represents."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import formats
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.parts import Camera, Light
from hymeko_x.xml.references import with_new_names_in_fragments

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Extra, Mechanism


def with_references(mechanism: Mechanism, names: Mapping[Id, Id], *, in_extras: bool = True) -> Mechanism:
    """The mechanism, whose elements have their new names already, with these names in its notations, fragments and extras as well.

    Without ``in_extras`` those extras stay that are elements and attributes of their format.
    """
    if not names:
        return mechanism
    fragments = frozenset(row.name for row in formats.FORMATS if row.has_fragments)
    mechanism = with_new_names_in_fragments(mechanism, names, fragments)
    notations = mechanism.notations
    for row in formats.FORMATS:
        if row.references is not None:
            notations = formats.loaded(row.references)(notations, names)
    mechanism = mechanism if notations is mechanism.notations else replace(mechanism, notations=notations)
    mechanism = mechanism.replace(vertices=_with_new_targets(mechanism, names))
    return _with_names_in_extras(mechanism, names) if in_extras else mechanism


_TARGETS: Mapping[str, str] = MappingProxyType({"target": "body", "texture": "texture"})
"""The parameters of cameras and lights that name an element, and its kind."""


def _with_new_targets(mechanism: Mechanism, names: Mapping[Id, Id]) -> dict[Id, Camera | Light]:
    """The cameras and lights that are aimed at something, or show it, that has a new name."""
    found: dict[Id, Camera | Light] = {}
    for key, part in mechanism.graph.vertices.items():
        if isinstance(part, Camera | Light):
            named = {name: Id(_TARGETS[name], str(value)) for name, value in part.parameters if name in _TARGETS}
            new = {name: names[target].name for name, target in named.items() if target in names}
            if new:
                found[key] = replace(part, parameters=tuple([(name, new.get(name, value)) for name, value in part.parameters]))
    return found


def _with_names_in_extras(mechanism: Mechanism, names: Mapping[Id, Id]) -> Mechanism:
    """The mechanism with new names in the extras of formats that say where names are in them."""

    def change(kind: str, name: str) -> str:
        new = names.get(Id(kind, name)) if kind else None
        return name if new is None else new.name

    changers = {row.name: formats.loaded(row.names_in) for row in formats.FORMATS if row.names_in is not None}
    extras: dict[Id, tuple[Extra, ...]] = {}
    for key, found in mechanism.extras.items():
        own = [changers[extra.format](extra, change, is_of_whole=False) if extra.format in changers else extra for extra in found]
        if any(new is not old for new, old in zip(own, found, strict=True)):
            extras[key] = tuple(own)
    return replace(mechanism, extras={**mechanism.extras, **extras}) if extras else mechanism
