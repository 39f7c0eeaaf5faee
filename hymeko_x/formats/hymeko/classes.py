"""Which default class is in force at an element that names none: that of the nearest body around it with ``childclass``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats.hymeko import CHILD_CLASS
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import ROOT

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Id, Mechanism


def classes_in_force(mechanism: Mechanism) -> dict[Id, str]:
    """By joint, shape, frame and body the class that a body around it gives; elements where there is none are not in it."""
    parents = {view.child: view.parent for view in mechanism.joints.values()}
    own = {key: notations[CHILD_CLASS] for key, notations in mechanism.notations.items() if CHILD_CLASS in notations and key != ROOT}
    if not own:
        return {}
    bodies: dict[Id, str] = {}
    for body in parents:
        way: list[Id] = []
        here: Id | None = body
        while here is not None and here not in bodies and here not in own:
            way.append(here)
            here = parents.get(here)
            if len(way) > len(parents):
                break
        name = "" if here is None else bodies.get(here, own.get(here, ""))
        bodies.update(dict.fromkeys(way, name))
    bodies.update(own)
    return {key: name for key, name in _at_elements(mechanism, bodies) if name}


def _at_elements(mechanism: Mechanism, bodies: dict[Id, str]) -> list[tuple[Id, str]]:
    found = [*bodies.items()]
    found += [(key, bodies.get(view.child, "")) for key, view in mechanism.joints.items()]
    found += [(view.id, bodies.get(body, "")) for body, views in mechanism.shapes.items() for view in views]
    for _, _, arcs in mechanism.edges(parts.Mount):
        found += [(arcs[-1].target, bodies.get(arcs[0].target, ""))] if len(arcs) > 1 else []
    return found
