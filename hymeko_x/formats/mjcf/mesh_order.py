"""The order of the meshes of a file, which MuJoCo keeps: it follows from the order in which a text uses them, or from a few names.

The plain order is that of first uses, then of the names of those that nothing uses. Three other orders
have a word. Any order is one of these in runs: the names with which the runs begin, in the order of the file.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from hymeko_x.ir.ids import ROOT
from hymeko_x.ir.notations import Notation
from hymeko_x.ir.parts import Mesh, Role
from hymeko_x.ir.uses import first_uses

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from hymeko_x.ir.mechanism import Id, Mechanism

_MOST = 16
"""Names that may stand for an order; more of them are numbers instead: places among the sorted names."""

MESHES: Notation[tuple[str, ...]] = Notation("meshes", " ".join, lambda text: tuple(text.split()))
"""Mechanism: the order of the meshes, where it is not the plain one: a word, then the names of runs; or places."""


def mesh_order(mechanism: Mechanism) -> list[Id]:
    """The meshes in the order of the file, as noted; in the plain order where the note does not fit any more."""
    words = mechanism.notation(ROOT, MESHES) or ()
    orders = _orders(mechanism)
    plain = orders[_PLAIN]
    if words and all(word.isdecimal() for word in words):
        places = [int(word) for word in words]
        by_name = orders[_BY_NAME]
        return [by_name[place] for place in places] if sorted(places) == list(range(len(by_name))) else plain
    base = words[0] if words and words[0] in orders else _PLAIN
    found = _in_runs(orders[base], words[base != _PLAIN :])
    return plain if found is None else found


def noted_order(mechanism: Mechanism, order: Sequence[Id]) -> tuple[str, ...]:
    """What :data:`MESHES` has to note for this order; nothing for the plain one."""
    notes = [((word,) if word else (), _starts(found, order)) for word, found in _orders(mechanism).items()]
    word, starts = min(notes, key=lambda note: len(note[0]) + len(note[1]))
    names = tuple(key.name for key in starts)
    if len(names) > _MOST or any(not name.isidentifier() or name in _WORDS for name in names):
        places = {key: place for place, key in enumerate(sorted(order, key=_name))}
        return tuple(str(places[key]) for key in order)
    return (*word, *names)


_PLAIN, _BY_NAME = "", "sorted"
_WORDS = ("sorted", "collisions", "visuals")


def _orders(mechanism: Mechanism) -> dict[str, list[Id]]:
    """The orders that have a word, and the plain one."""
    meshes = [key for key, _ in mechanism.vertices(Mesh)]
    by_name = sorted(meshes, key=_name)
    known = set(meshes)
    plain = list(dict.fromkeys(key for key in (*first_uses(mechanism), *by_name) if key in known))
    seen = {view.mesh for view in mechanism.every_shape() if view.shape.role is Role.VISUAL}
    return {
        _PLAIN: plain,
        "collisions": _first(plain, lambda key: key not in seen),
        "visuals": _first(plain, lambda key: key in seen),
        _BY_NAME: by_name,
    }


def _first(keys: Iterable[Id], wanted: Callable[[Id], bool]) -> list[Id]:
    return sorted(keys, key=lambda key: not wanted(key))


def _name(key: Id) -> str:
    return key.name


def _starts(base: Sequence[Id], order: Sequence[Id]) -> list[Id]:
    """The meshes with which the runs of an order begin that stand together in the base; none where both are the same."""
    follower = dict(pairwise(base))
    before = [None, *order]
    starts = [key for last, key in zip(before, order, strict=False) if last is None or follower.get(last) != key]
    return starts if starts[1:] or starts[:1] != [*base[:1]] else []


def _in_runs(base: list[Id], names: Sequence[str]) -> list[Id] | None:
    """The base in runs that begin with these names, in their order; None where there is no such mesh."""
    if not names:
        return base
    starts = {key.name: place for place, key in enumerate(base) if key.name in names}
    if len(starts) != len(names) or 0 not in starts.values():
        return None
    ends = dict(zip(sorted(starts.values()), [*sorted(starts.values())[1:], len(base)], strict=True))
    return [key for name in names for key in base[starts[name] : ends[starts[name]]]]
