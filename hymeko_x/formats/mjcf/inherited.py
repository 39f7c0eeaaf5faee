"""The values that elements of MJCF inherit from their classes, or from MuJoCo itself, computed once for all that inherit the same."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

from hymeko_x.formats.mjcf.codec import BadAttribute

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.formats.mjcf.codec import AttributeGroup, Settings

REFUSED = object()
"""In place of a value that MuJoCo refuses."""


class InheritedValues:
    """The values of the groups of an element that has no attributes itself, computed once per class.

    Groups are known by their place in memory, as is the ``base`` of a class; neither is given up before this is.
    """

    def __init__(self) -> None:
        self._known: dict[tuple[int, int], tuple[tuple[AttributeGroup, Any], ...]] = {}
        self._apart: dict[tuple[int, int, tuple[str, ...]], tuple[dict[str, Any], list[AttributeGroup]]] = {}
        self._groups: list[tuple[AttributeGroup, ...]] = []

    def of(self, groups: tuple[AttributeGroup, ...], base: Mapping[str, str], settings: Settings) -> tuple[tuple[AttributeGroup, Any], ...]:
        """Each group with its value for the attributes ``base`` that the class gives; REFUSED where MuJoCo refuses them."""
        place = id(groups), id(base) if base else 0
        found = self._known.get(place)
        if found is None:
            found = self._known[place] = _values_of(groups, base, settings) if base else _own_defaults(groups, settings)
            self._groups.append(groups)
        return found

    def apart(
        self, groups: tuple[AttributeGroup, ...], base: Mapping[str, str], settings: Settings, names: tuple[str, ...]
    ) -> tuple[Mapping[str, Any], list[AttributeGroup]]:
        """The values that an element with attributes of these names inherits, by the keys of their groups; and the groups that it reads."""
        form = id(groups), id(base) if base else 0, names
        found = self._apart.get(form)
        if found is None:
            own = frozenset(names)
            values, read = found = self._apart[form] = {}, []
            for group, inherited in self.of(groups, base, settings):
                if inherited is REFUSED or not own.isdisjoint(group.names) or not own.isdisjoint(group.needs):
                    read.append(group)
                else:
                    values[group.key] = inherited
        return found


@lru_cache(256)
def _own_defaults(groups: tuple[AttributeGroup, ...], settings: Settings) -> tuple[tuple[AttributeGroup, Any], ...]:
    """The values that the groups have where no class gives any: MuJoCo's own."""
    return _values_of(groups, {}, settings)


def _values_of(groups: tuple[AttributeGroup, ...], base: Mapping[str, str], settings: Settings) -> tuple[tuple[AttributeGroup, Any], ...]:
    return tuple([(group, _value_of(group, base, settings)) for group in groups])


def _value_of(group: AttributeGroup, base: Mapping[str, str], settings: Settings) -> Any:
    try:
        return group.read(base, settings)
    except BadAttribute:
        return REFUSED
