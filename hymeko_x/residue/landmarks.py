"""By what else than its name an element is known: what it is on, and a few of its numbers. So it is found again when it is renamed."""

from __future__ import annotations

from collections import Counter, defaultdict
from typing import TYPE_CHECKING

from hymeko_x.ir.parts import Body, Material
from hymeko_x.residue import Landmark

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Set

    from hymeko_x.ir.mechanism import Id, Mechanism

    Mark = tuple[str, tuple[Id, ...], tuple[str, ...]]

NAMED = frozenset({"body", "joint", "frame", "material", "actuator", "sensor", "camera", "light", "tendon"})
"""Kinds of elements that people give names to."""


def landmarks_of(mechanism: Mechanism, keys: Iterable[Id]) -> tuple[Landmark, ...]:
    """The landmarks of elements: bodies from the roots on, and then what is on them."""
    look = _Look(mechanism)
    wanted = dict.fromkeys(key for key in keys if key in mechanism.graph)
    bodies = (key for key in mechanism.depth_first() if key in wanted)
    ordered = dict.fromkeys([*bodies, *(key for key in wanted if key.kind != "body")])
    return tuple([_shortened(look.at(key)) for key in ordered])


def _shortened(landmark: Landmark) -> Landmark:
    return landmark._replace(numbers=tuple([float(f"{number:.6g}") for number in landmark.numbers]))


class _Look:
    """Landmarks of the elements of a mechanism."""

    def __init__(self, mechanism: Mechanism) -> None:
        self._mechanism = mechanism
        self._places = {view.mounted: view.pose.xyz for views in mechanism.mounts.values() for view in views}
        self._beside: dict[Id, list[Id]] = defaultdict(list)
        for edge in mechanism.graph.edges.values():
            for arc in edge.arcs:
                if arc.target.kind in ("actuator", "sensor", "frame", "camera", "light"):
                    self._beside[arc.target] += [other.target for other in edge.arcs if other.target != arc.target]

    def at(self, key: Id) -> Landmark:
        """The landmark of an element."""
        if key.kind == "body":
            return self._body(key)
        if key.kind == "joint":
            view = self._mechanism.joints.get(key)
            return Landmark(key) if view is None else Landmark(key, (view.child,), tuple([n for dof in view.joint.dofs for n in dof.axis]))
        if key.kind == "tendon":
            return Landmark(key, tuple([arc.target for arc in self._mechanism.graph.edges[key].arcs]))
        part = self._mechanism.graph.vertices[key]
        if isinstance(part, Material):
            return Landmark(key, (), part.rgba or ())
        return Landmark(key, tuple(self._beside[key]), self._places.get(key, ()))

    def _body(self, key: Id) -> Landmark:
        inertial = self._mechanism.vertex(key, Body).inertial
        mass = (inertial.mass or 0.0) if inertial else 0.0
        above = self._mechanism.parent_joint.get(key)
        return Landmark(key, (), (mass,)) if above is None else Landmark(key, (above.parent,), (mass, *above.parent_pose.xyz))


# ---- renames since ---------------------------------------------------------------------------------------------------------


def renamed_since(image: Mechanism, landmarks: Iterable[Landmark], others: Set[Id]) -> dict[Id, Id]:
    """The old ids of renamed elements by their new ones; those for which more than one element may be meant are left out. Linear.

    ``others`` are elements without a landmark that were in the image under these ids already.
    """
    known = {landmark.element: landmark for landmark in landmarks}
    missing = [landmark for key, landmark in known.items() if key not in image.graph]
    if not missing:
        return {}
    look = _Look(image)
    unknown: dict[Mark, list[Id]] = defaultdict(list)
    for key in (*image.graph.vertices, *image.graph.edges):
        if key.kind in NAMED and key not in known and key not in others:
            unknown[_mark(look.at(key), {})].append(key)
    on_joint = {landmark.beside[0]: key for key, landmark in known.items() if key.kind == "joint" and landmark.beside}
    alone = Counter(_mark(landmark, {}) for landmark in missing)
    found: dict[Id, Id] = {}
    for landmark in missing:  # each body after the one that it is on, and then what is on bodies
        held = image.joints.get(on_joint.get(landmark.element, landmark.element))
        if held is not None and landmark.element.kind == "body" and held.child not in known:
            found[landmark.element] = held.child  # the joint that held it is there, and holds another one
            continue
        candidates = unknown[_mark(landmark, found)]
        if len(candidates) == 1 and alone[_mark(landmark, {})] == 1:
            found[landmark.element] = candidates[0]
    back: dict[Id, Id] = {}
    for old, new in found.items():
        back.setdefault(new, old)
    return back


def _mark(landmark: Landmark, found: Mapping[Id, Id]) -> Mark:
    """What two elements share that are the same: kind, neighbours under their new names, and numbers to four digits."""
    beside = tuple([found.get(key, key) for key in landmark.beside])
    return landmark.element.kind, beside, tuple([f"{number + 0.0:.4g}" for number in landmark.numbers])
