"""References to elements by their names, in what only one format represents."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from hymeko_x import formats
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.parts import Camera, Light
from hymeko_x.xml.references import with_new_names_in_fragments

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterable, Mapping

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


def without_references(mechanism: Mechanism, gone: Container[Id]) -> Mechanism:
    """The mechanism without the extras that name one of these elements, which are not there any more; cameras and lights aim at none."""
    changers = _changers()

    def is_left(extra: Extra) -> bool:
        return extra.format not in changers or not any(Id(*named) in gone for named in names_of(extra))

    kept = {key: tuple(filter(is_left, found)) for key, found in mechanism.extras.items()}
    extras = {key: found for key, found in kept.items() if found}
    return replace(mechanism.replace(vertices=_without_targets(mechanism, gone)), extras=extras)


def names_of(extra: Extra) -> tuple[tuple[str, str], ...]:
    """The kinds and names of the elements that an extra names, its own name among them; "" is a kind that the IR does not have.

    Empty for an extra of a format that does not say where names are in them.
    """
    found: list[tuple[str, str]] = []

    def note(kind: str, name: str) -> str:
        found.append((kind, name))
        return name

    changer = _changers().get(extra.format)
    if changer is not None:
        changer(extra, note, is_of_whole=False)
    return tuple(found)


def named_in(extras: Iterable[Extra]) -> set[Id]:
    """The elements that extras name."""
    return {Id(kind, name) for extra in extras for kind, name in names_of(extra) if kind}


def targets(mechanism: Mechanism) -> set[Id]:
    """What cameras and lights are aimed at, or show."""
    parts = (part for part in mechanism.graph.vertices.values() if isinstance(part, Camera | Light))
    return {Id(_TARGETS[name], str(value)) for part in parts for name, value in part.parameters if name in _TARGETS}


def _changers() -> Mapping[str, Callable[..., Any]]:
    """By format, the function that changes the names in one of its extras."""
    return {row.name: formats.loaded(row.names_in) for row in formats.FORMATS if row.names_in is not None}


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


def _without_targets(mechanism: Mechanism, gone: Container[Id]) -> dict[Id, Camera | Light]:
    """The cameras and lights that named something that is gone, without its name and without the mode that follows it."""
    found: dict[Id, Camera | Light] = {}
    for key, part in mechanism.graph.vertices.items():
        if isinstance(part, Camera | Light):
            lost = {name for name, value in part.parameters if name in _TARGETS and Id(_TARGETS[name], str(value)) in gone}
            lost |= {"mode"} if "target" in lost else set()
            if lost:
                found[key] = replace(part, parameters=tuple([pair for pair in part.parameters if pair[0] not in lost]))
    return found


def _with_names_in_extras(mechanism: Mechanism, names: Mapping[Id, Id]) -> Mechanism:
    """The mechanism with new names in the extras of formats that say where names are in them."""

    def change(kind: str, name: str) -> str:
        new = names.get(Id(kind, name)) if kind else None
        return name if new is None else new.name

    changers = _changers()
    extras: dict[Id, tuple[Extra, ...]] = {}
    for key, found in mechanism.extras.items():
        own = [changers[extra.format](extra, change, is_of_whole=False) if extra.format in changers else extra for extra in found]
        if any(new is not old for new, old in zip(own, found, strict=True)):
            extras[key] = tuple(own)
    return replace(mechanism, extras={**mechanism.extras, **extras}) if extras else mechanism
