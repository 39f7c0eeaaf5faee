"""Edits of named configurations that a format keeps as texts (keyframes), and of poses of bodies that their joints overrule."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import formats
from hymeko_x.compare.diff import Tolerance
from hymeko_x.compare.relevance import same_pose
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.kinematics import reference_poses
from hymeko_x.ir.parts import Stance

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc, RobotEdge
    from hymeko_x.ir.values import Pose

_NEAR = Tolerance(5e-6, 0.0)
"""How near in m and rad a pose in single precision is to what it was."""


def displaced(edited: Mechanism, image: Mechanism, format: Format) -> list[str]:
    """The bodies that ``edited`` puts where neither their joints do nor ``image`` did, in words; both are of the format."""
    if format.places is None or not (moved := formats.loaded(format.places)(edited)):
        return []
    before: dict[Id, Pose] = {**reference_poses(image), **formats.loaded(format.places)(image)}
    return [
        f"{key} stands at [{numbers_text(pose.xyz)}] with the quaternion [{numbers_text(pose.quat)}], where its joint does not put it"
        for key, pose in moved.items()
        if key in before and not same_pose(pose, before[key], _NEAR)
    ]


def with_edited_poses(robot: Mechanism, image: Mechanism, edited: Mechanism, format: Format) -> Mechanism:
    """The robot with the coordinates, in rad or m, that its named poses have in ``edited`` and not in ``image``; both are of the format."""
    moved = {} if format.poses is None else _moved(dict(formats.loaded(format.poses)(image)), dict(formats.loaded(format.poses)(edited)))
    changed: dict[Id, RobotEdge] = {}
    for key, _, arcs in robot.edges(Stance):
        values = next((moved[arc.target.name] for arc in arcs if arc.sign > 0 and arc.target.name in moved), {})
        if any(arc.target in values for arc in arcs):
            changed[key] = Edge(Stance(), tuple([_at(arc, values) for arc in arcs]))
    return robot.replace(edges=changed)


Poses = dict[str, "Mapping[Id, tuple[float, ...]]"]


def _moved(before: Poses, after: Poses) -> Poses:
    """The coordinates that differ, of each pose that both have."""
    both = {name: (before[name], values) for name, values in after.items() if name in before}
    found = {name: {key: at for key, at in new.items() if old.get(key) != at} for name, (old, new) in both.items()}
    return {name: values for name, values in found.items() if values}


def _at(arc: RobotArc, values: Mapping[Id, tuple[float, ...]]) -> RobotArc:
    return Arc(arc.target, arc.sign, values[arc.target], arc.role) if arc.target in values else arc
