"""Named configurations that a format keeps as texts (keyframes), in a robot that was changed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import formats

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.ir.ids import Id
    from hymeko_x.ir.mechanism import Mechanism

    Numbers = tuple[float, ...]
    Change = Callable[[str, Id | None, Numbers], tuple[Id | None, Numbers]]


def with_states(
    changed: Mechanism, source: Mechanism, change: Change, called: Callable[[str], str | None] = lambda name: name
) -> Mechanism:
    """The changed robot with the named configurations of its source.

    ``change(word, element, numbers)`` gives what the numbers of a joint or an actuator are now, ``called`` the name of a configuration.
    """
    row = formats.native_format(source)
    if row is None or row.restates is None:
        return changed
    found: Mechanism = formats.loaded(row.restates)(changed, source, change, called)
    return found


def states_of(mechanism: Mechanism) -> dict[str, Mapping[Id, Numbers]]:
    """The named configurations that the format of the robot keeps as texts: coordinates by joint, in rad or m."""
    row = formats.native_format(mechanism)
    if row is None or row.poses is None:
        return {}
    found: list[tuple[str, Mapping[Id, Numbers]]] = formats.loaded(row.poses)(mechanism)
    return {name: values for name, values in found if name}


def with_ids(now: Mapping[Id, Id]) -> Change:
    """The change by which elements have other ids, and the same numbers."""
    return lambda _word, key, numbers: (now.get(key, key) if key is not None else None, numbers)
