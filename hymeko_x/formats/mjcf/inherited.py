"""The values that elements of MJCF inherit from their classes, or from MuJoCo itself, computed once for all that inherit the same."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

from hymeko_x.formats.mjcf.codec import BadAttribute

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.formats.mjcf.codec import Group, Settings

REFUSED = object()
"""In place of a value that MuJoCo refuses."""


class InheritedValues:
    """The values of the groups of an element that has no attributes itself, computed once per class.

    Groups are known by their place in memory, as is the ``base`` of a class; neither is given up before this is.
    """

    def __init__(self) -> None:
        self._known: dict[tuple[int, int], tuple[tuple[Group, Any], ...]] = {}
        self._groups: list[tuple[Group, ...]] = []
        self._forms: dict[tuple[Any, ...], tuple[dict[str, Any], list[tuple[Group, list[str]]]]] = {}

    def apart(
        self, own: Mapping[str, str], groups: tuple[Group, ...], base: Mapping[str, str], settings: Settings
    ) -> tuple[Mapping[str, Any], list[tuple[Group, list[str]]]]:
        """The values that an element with these attributes inherits, by the keys of their groups; and the groups that it has values of
        its own for, each with its attributes. Computed once for all elements that have attributes of the same names.
        """
        form = (id(groups), id(base) if base else 0, *own)
        found = self._forms.get(form)
        if found is None:
            found = self._forms[form] = _apart(own, self.of(groups, base, settings))
        return found

    def of(self, groups: tuple[Group, ...], base: Mapping[str, str], settings: Settings) -> tuple[tuple[Group, Any], ...]:
        """Each group with its value for the attributes ``base`` that the class gives; REFUSED where MuJoCo refuses them."""
        place = id(groups), id(base) if base else 0
        found = self._known.get(place)
        if found is None:
            found = self._known[place] = _values_of(groups, base, settings) if base else _own_defaults(groups, settings)
            self._groups.append(groups)
        return found


def _apart(own: Mapping[str, str], values: tuple[tuple[Group, Any], ...]) -> tuple[dict[str, Any], list[tuple[Group, list[str]]]]:
    names = own.keys()
    inherited: dict[str, Any] = {}
    groups: list[tuple[Group, list[str]]] = []
    for group, value in values:
        if value is not REFUSED and names.isdisjoint(group.names) and names.isdisjoint(group.needs):
            inherited[group.key] = value
        else:
            groups.append((group, [name for name in group.names if name in own]))
    return inherited, groups


@lru_cache(256)
def _own_defaults(groups: tuple[Group, ...], settings: Settings) -> tuple[tuple[Group, Any], ...]:
    """The values that the groups have where no class gives any: MuJoCo's own."""
    return _values_of(groups, {}, settings)


def _values_of(groups: tuple[Group, ...], base: Mapping[str, str], settings: Settings) -> tuple[tuple[Group, Any], ...]:
    return tuple([(group, _value_of(group, base, settings)) for group in groups])


def _value_of(group: Group, base: Mapping[str, str], settings: Settings) -> Any:
    try:
        return group.read(base, settings)
    except BadAttribute:
        return REFUSED
