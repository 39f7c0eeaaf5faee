"""`hymeko-x info FILE`: what is in a file."""

from __future__ import annotations

import json
from collections import Counter
from typing import TYPE_CHECKING

from hymeko_x.cli import exits
from hymeko_x.cli.inputs import input_arguments, read_input
from hymeko_x.cli.terminal import show
from hymeko_x.diagnostics import Report
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import WORLD

if TYPE_CHECKING:
    import argparse

    from hymeko_x.cli.inputs import Input
    from hymeko_x.ir.mechanism import Id, Mechanism

COORDINATES = {parts.DofKind.BALL: 3, parts.DofKind.FREE: 6}
"""Degrees of freedom of the dofs that have more than one."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """The verb's own words."""
    parser.add_argument("input", metavar="FILE", help="the robot to look at; - is standard input")
    parser.add_argument("--json", action="store_true", help="print JSON")
    input_arguments(parser)


def run(chosen: argparse.Namespace) -> int:
    """Print what is in the file."""
    report = Report()
    given = read_input(chosen.input, chosen, report)
    facts = describe(given)
    show(report)
    if chosen.json:
        print(json.dumps(facts, indent=2, ensure_ascii=False))
        return exits.DONE
    for name, value in facts.items():
        print(f"{name:<12} {_text(value)}")
    return exits.DONE


def describe(given: Input) -> dict[str, object]:
    """The facts about a robot, by name. Masses in kg."""
    robot = given.mechanism
    bodies = list(robot.vertices(parts.Body))
    joints = [view.joint for view in robot.joints.values()]
    others = Counter(key.kind for key in (*robot.graph.vertices, *robot.graph.edges) if key.kind not in ("world", "body", "joint"))
    return {
        "file": given.source.name,
        "format": given.format.name,
        "name": robot.name,
        "bodies": len(bodies),
        "mass": sum(body.inertial.mass or 0.0 for _, body in bodies if body.inertial),
        "no inertial": sum(body.inertial is None for _, body in bodies),
        "joints": dict(Counter(_kind(joint) for joint in joints)),
        "dofs": sum(COORDINATES.get(dof.kind, 1) for joint in joints for dof in joint.dofs),
        "bases": {key.name: _base(robot, key) for key in robot.roots},
        "depth": _depth(robot),
        "also": dict(others),
        "extras": dict(Counter(extra.format for extras in robot.extras.values() for extra in extras)),
    }


def _kind(joint: parts.Joint) -> str:
    return "+".join(dof.kind.value for dof in joint.dofs) or "fixed"


def _base(robot: Mechanism, root: Id) -> str:
    """Fixed or free by the joint that ties it to the world; open where there is none."""
    above = robot.parent_joint.get(root)
    if above is None or above.parent != WORLD:
        return "open"
    return _kind(above.joint)


def _depth(robot: Mechanism) -> int:
    """The joints from a base to the farthest tip."""
    depth: dict[Id, int] = {}
    for body in robot.depth_first():
        above = robot.parent_joint.get(body)
        depth[body] = depth.get(above.parent, -1) + 1 if above else 0
    return max(depth.values(), default=0)


def _text(value: object) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{count} {name}" if isinstance(count, int) else f"{name} ({count})" for name, count in value.items()) or "none"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
