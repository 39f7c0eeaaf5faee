"""The leaves in which two parts differ: values that are not the same to the last bit, with their paths in the part.

The ledger and the residue are made from the same leaves, which are computed once.
"""

from __future__ import annotations

from itertools import compress
from operator import is_not
from typing import TYPE_CHECKING, Any, NamedTuple

from msgspec import NODEFAULT, Struct
from msgspec.structs import replace

from hymeko_x.ir.fields import attributes_of, have_same_bytes, identical, layout_of
from hymeko_x.ir.graph import Edge
from hymeko_x.ir.values import Pose

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge

Path = tuple[str | int, ...]
"""Where in a part a value stands: names of fields and places in tuples (``("dofs", 0, "limits", "upper")``)."""

TURN = "turn"
"""The last step to a pose's rotation: its quaternion together with the notation that it was written in."""


class Leaf(NamedTuple):
    """Two values that are not the same, the field's default (NODEFAULT if none), and whether it is more than a notation."""

    path: Path
    before: object
    after: object
    default: object
    counts: bool


Leaves = list[Leaf]


def leaves_between(a: Mechanism, b: Mechanism) -> dict[Id, Leaves]:
    """The leaves in which the elements that both have differ, by element."""
    return {**_of_elements(a.graph.vertices, b.graph.vertices), **_of_elements(a.graph.edges, b.graph.edges)}


def _of_elements(a: Mapping[Id, object], b: Mapping[Id, object]) -> dict[Id, Leaves]:
    found = {}
    for key, before in a.items():
        after = b.get(key)
        if after is not None and before is not after and (leaves := leaves_of(before, after)):
            found[key] = leaves
    return found


def leaves_again(other: Mechanism, a: Mechanism, b: Mechanism, between: Mapping[Id, Leaves]) -> Mapping[Id, Leaves]:
    """The leaves between another mechanism and ``b``, given those between ``a``, most of whose vertices the other one shares, and ``b``."""
    if other.graph is a.graph:
        return between
    again = {key: part for key, part in other.graph.vertices.items() if part is not a.graph.vertices.get(key)}
    changed = _of_elements(again, b.graph.vertices)
    known = {key: between[key] for key in between if key not in again}
    return {key: leaves for key in (*other.graph.vertices, *other.graph.edges) if (leaves := changed.get(key) or known.get(key))}


def leaves_of(a: object, b: object) -> Leaves:
    """The leaves in which two values differ, in the order of their fields. Depth is that of the parts, which is small."""
    found: Leaves = []
    if not have_same_bytes(a, b):
        _collect(a, b, (), NODEFAULT, True, found)
    return found


def _collect(a: object, b: object, path: Path, default: object, counts: bool, found: Leaves) -> None:
    """What differs between two values that do not have the same bytes, as nearly all have."""
    kind = type(a)
    layout = layout_of(kind) if kind is type(b) else None
    if layout is None:
        if kind is tuple and _are_alike(a, b):
            for place, (before, after) in enumerate(zip(a, b, strict=True)):  # type: ignore[call-overload]
                if not have_same_bytes(before, after):
                    _collect(before, after, (*path, place), NODEFAULT, counts, found)
        elif not identical(a, b):
            found.append(Leaf(path, a, b, default, counts))
    elif kind is Pose:
        _collect_pose(a, b, path, counts, found)  # type: ignore[arg-type]
    elif kind is Edge and len(a.arcs) == len(b.arcs):  # type: ignore[attr-defined]
        _collect_edge(a, b, path, counts, found)  # type: ignore[arg-type]
    else:
        befores, afters = layout.values(a), layout.values(b)
        fields = zip(layout.attributes, befores, afters, strict=True)
        for (name, own, compare), before, after in compress(fields, map(is_not, befores, afters)):
            if not have_same_bytes(before, after):
                _collect(before, after, (*path, name), own, counts and compare, found)


def _collect_edge(a: RobotEdge, b: RobotEdge, path: Path, counts: bool, found: Leaves) -> None:
    """The same for two edges with as many arcs: nearly all lead to the same elements."""
    if not have_same_bytes(a.data, b.data):
        _collect(a.data, b.data, (*path, "data"), NODEFAULT, counts, found)
    for place, (x, y) in enumerate(zip(a.arcs, b.arcs, strict=True)):
        if have_same_bytes(x, y):
            continue
        if x.target != y.target or x.sign != y.sign or x.role != y.role:
            _collect(x, y, (*path, "arcs", place), NODEFAULT, counts, found)
        else:
            _collect(x.weight, y.weight, (*path, "arcs", place, "weight"), None, counts, found)


def _collect_pose(a: Pose, b: Pose, path: Path, counts: bool, found: Leaves) -> None:
    if not identical(a.xyz, b.xyz):
        found.append(Leaf((*path, "xyz"), a.xyz, b.xyz, NODEFAULT, counts))
    if not (identical(a.quat, b.quat) and identical(a.written, b.written)):
        found.append(Leaf((*path, TURN), turn_of(a), turn_of(b), NODEFAULT, counts))


def _are_alike(a: object, b: object) -> bool:
    """Whether two tuples hold parts of the same types, so that they can be compared part by part."""
    assert isinstance(a, tuple)
    if type(b) is not tuple or len(a) != len(b) or not a or layout_of(type(a[0])) is None:
        return False
    if len(a) == 1:
        return type(a[0]) is type(b[0])
    kinds = [*map(type, a)]
    return kinds == [*map(type, b)] and None not in map(layout_of, kinds)


def turn_of(pose: Pose) -> tuple[object, object]:
    """The rotation with its notation."""
    return pose.quat, pose.written


# ---- one field by its path ---------------------------------------------------------------------------------------------


def get(part: object, path: Path) -> object:
    """The value at a path.

    Raises: LookupError when the part has no such place.
    """
    for step in path:
        if isinstance(part, Pose) and step == TURN:
            return turn_of(part)
        try:
            part = part[step] if isinstance(step, int) else getattr(part, step)  # type: ignore[index]
        except (AttributeError, TypeError) as error:
            raise LookupError(step) from error
    return part


def put(part: Any, path: Path, value: object) -> Any:
    """The part with another value at a path.

    Raises: LookupError when the part has no such place.
    """
    if not path:
        return value
    step, rest = path[0], path[1:]
    if isinstance(step, int):
        return (*part[:step], put(get(part, (step,)), rest, value), *part[step + 1 :])
    if isinstance(part, Pose) and step == TURN:
        turn: Any = value
        return replace(part, quat=turn[0], written=turn[1])
    return replace(part, **{step: put(get(part, (step,)), rest, value)})


def default_at(part: object, path: Path) -> object:
    """The default of the field at a path; NODEFAULT where it has none."""
    *above, last = path
    owner = get(part, tuple(above))
    if isinstance(owner, Pose) or not isinstance(owner, Struct):
        return NODEFAULT
    return next((item.default for item in attributes_of(owner) if item.name == last), NODEFAULT)
