"""Capsules that the image shows as a cylinder and two balls: the three stand or fall together."""

from __future__ import annotations

import math
from collections import defaultdict
from itertools import pairwise
from typing import TYPE_CHECKING

from msgspec.structs import astuple

from hymeko_x.ir.graph import Edge
from hymeko_x.ir.mechanism import pose_weight
from hymeko_x.ir.parts import Capsule, Cylinder, Role, Shape, Sphere
from hymeko_x.ir.values import compose
from hymeko_x.residue.alike import is_alike
from hymeko_x.rewrite.shapes import pieces_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge
    from hymeko_x.ir.parts import Geometry
    from hymeko_x.ir.values import Vec3
    from hymeko_x.residue import Residue, WholeElement

GEOMETRY = ("data", "geometry")
"""Where the geometry of a shape stands in its edge."""
_MARK = "#"
"""Behind it stands the number of a shape among those of its body."""
_DIGITS = 6
"""To how many decimals (m) a part of a capsule is where it belongs."""
_NEAR = 10.0**-_DIGITS
"""How far (m) the parts of one capsule may be from where they belong."""


def parts_of(residue: Residue) -> dict[Id, list[WholeElement]]:
    """The two balls at the ends of each capsule that the image has as a cylinder and these."""
    waiting: dict[str, list[WholeElement]] = {}
    for removal in residue.removals:
        if isinstance(removal.part, Edge) and isinstance(removal.part.data, Shape) and isinstance(removal.part.data.geometry, Sphere):
            waiting.setdefault(row_of(removal.id), []).append(removal)
    found: dict[Id, list[WholeElement]] = {}
    for change in residue.changes:
        if change.path == GEOMETRY and isinstance(change.value, Capsule):
            balls = waiting.get(row_of(change.element), [])
            ends = next((list(pair) for pair in pairwise(balls) if _are_ends(change.value, *pair)), [])
            for ball in ends:
                balls.remove(ball)
            if ends:
                found[change.element] = ends
    return found


def capsules_of(residue: Residue) -> dict[Id, Id]:
    """For each cylinder and ball that the image has in the place of a capsule of the source alone, that capsule."""
    there: dict[object, list[Id]] = defaultdict(list)
    for key, part in residue.removals:
        if isinstance(part, Edge) and isinstance(part.data, Shape):
            there[_where(part.arcs[0].target, part.data.role, part.data.geometry, _place(part))].append(key)
    found: dict[Id, Id] = {}
    for key, part in residue.additions:
        if not (isinstance(part, Edge) and isinstance(part.data, Shape) and isinstance(part.data.geometry, Capsule)):
            continue
        places = _places_of_parts(part)
        parts = [there[place].pop(0) for place in places if there[place]]
        if len(parts) == len(places):
            found |= dict.fromkeys(parts, key)
    return found


def _places_of_parts(capsule: RobotEdge) -> list[object]:
    """What the parts of a capsule are known by, for the eye and for contact."""
    shape, arc = capsule.data, capsule.arcs[0]
    assert isinstance(shape, Shape)
    roles = (Role.VISUAL, Role.COLLISION) if shape.role is Role.BOTH else (shape.role,)
    pieces = [(geometry, compose(pose_weight(arc), pose).xyz) for _, geometry, pose in pieces_of(shape.geometry)]
    return [_where(arc.target, role, geometry, place) for role in roles for geometry, place in pieces]


def _where(body: Id, role: Role, geometry: Geometry, place: Vec3) -> object:
    """What a part is known by: where it is to the micrometre, and its size."""
    sizes = astuple(geometry) if isinstance(geometry, (Cylinder, Sphere)) else ()
    return body, role, type(geometry), tuple(round(number, _DIGITS) + 0.0 for number in (*place, *sizes))


def row_of(key: Id) -> str:
    """The name of a shape without the number that it has among those of its body."""
    row, mark, number = key.name.rpartition(_MARK)
    return row if mark and number.isdigit() else key.name


def _are_ends(capsule: Capsule, *balls: WholeElement) -> bool:
    """Whether two balls are those of a capsule."""
    edges = [ball.part for ball in balls if isinstance(ball.part, Edge)]
    sizes = [edge.data.geometry.radius for edge in edges]  # type: ignore[union-attr]
    apart = math.dist(*(_place(edge) for edge in edges))
    return all(is_alike(size, capsule.radius) for size in sizes) and math.isclose(apart, capsule.length, abs_tol=_NEAR)


def broken(image: Mechanism, parts: Mapping[Id, Sequence[WholeElement]]) -> set[Id]:
    """The shapes of which a part was edited, moved, coloured or removed by itself in the image."""
    return {key for key, others in parts.items() if not _are_whole(image, image.graph.edges.get(key), others)}


def _are_whole(image: Mechanism, first: RobotEdge | None, others: Sequence[WholeElement]) -> bool:
    """Whether the parts still make one shape: none was resized, and they were moved and coloured together."""
    now = [image.graph.edges.get(other.id) for other in others]
    if first is None:
        return not any(now)
    parts = [(edge, other.part) for edge, other in zip(now, others, strict=True) if edge is not None and isinstance(other.part, Edge)]
    if len(parts) < len(others) or not all(_are_one(first, edge, then) for edge, then in parts):
        return False
    middle, before = (_middle([_place(pair[turn]) for pair in parts]) for turn in (0, 1))
    moves = [_from(_place(edge), _place(then)) for edge, then in parts]
    return all(_is_near(move, _from(middle, before)) for move in moves) and _is_near(_place(first), middle)


def _are_one(first: RobotEdge, now: RobotEdge, then: RobotEdge) -> bool:
    """Whether a part has the size and the orientation that it had, and the appearance of the first part."""
    if not (isinstance(first.data, Shape) and isinstance(now.data, Shape) and isinstance(then.data, Shape)):
        return False
    is_same = is_alike(now.data.geometry, then.data.geometry) and is_alike(pose_weight(now.arcs[0]).quat, pose_weight(then.arcs[0]).quat)
    appearances = [(edge.data.rgba, [arc.target for arc in edge.arcs[1:]]) for edge in (first, now)]  # type: ignore[union-attr]
    return is_same and appearances[0] == appearances[1]


def _place(part: RobotEdge) -> Vec3:
    return pose_weight(part.arcs[0]).xyz


def _middle(places: Sequence[Vec3]) -> Vec3:
    x, y, z = (sum(numbers) / len(places) for numbers in zip(*places, strict=True))
    return x, y, z


def _from(place: Vec3, start: Vec3) -> Vec3:
    return place[0] - start[0], place[1] - start[1], place[2] - start[2]


def _is_near(a: Vec3, b: Vec3) -> bool:
    return all(abs(x - y) <= _NEAR for x, y in zip(a, b, strict=True))
