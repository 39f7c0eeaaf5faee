"""`hymeko-x info`, `formats` and `explain`: what is in a file, what can be read, and what a code means."""

from __future__ import annotations

import json
import textwrap
from collections import Counter
from typing import TYPE_CHECKING

from hymeko_x import formats, targets
from hymeko_x.cli import exits
from hymeko_x.cli.exits import UsageError
from hymeko_x.cli.inputs import input_arguments, lenient_argument, read_input
from hymeko_x.cli.report import show_diagnostics
from hymeko_x.codes import CODES
from hymeko_x.diagnostics import Report
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.severities import reasons

if TYPE_CHECKING:
    import argparse

    from hymeko_x.cli.inputs import Input
    from hymeko_x.ir.mechanism import Id, Mechanism

COORDINATES = {parts.DofKind.BALL: 3, parts.DofKind.FREE: 6}
"""Degrees of freedom of the dofs that have more than one."""

# ---- info --------------------------------------------------------------------------------------------------------------


def info_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `info`."""
    parser.add_argument("input", metavar="FILE", help="the robot to look at; - is standard input")
    parser.add_argument("--json", action="store_true", help="print JSON")
    input_arguments(parser)
    lenient_argument(parser)


def run_info(chosen: argparse.Namespace) -> int:
    """Print what is in the file."""
    report = Report()
    given = read_input(chosen.input, chosen, report)
    facts = describe(given)
    show_diagnostics(report, chosen)
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


# ---- formats and codes -------------------------------------------------------------------------------------------------


def formats_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `formats`."""
    parser.add_argument("--json", action="store_true", help="print JSON")


def run_formats(chosen: argparse.Namespace) -> int:
    """Print one line per format, and one per target."""
    rows = [
        {
            "name": row.name,
            "title": row.title,
            "suffixes": row.suffixes,
            "read": row.frontend is not None,
            "write": row.backend is not None,
            "verify": row.reference is not None,
            "targets": [target.name for target in targets.of_format(row)],
        }
        for row in formats.FORMATS
    ]
    if chosen.json:
        print(json.dumps(rows, indent=2))
        return exits.DONE
    print(f"{'format':<8} {'read':<5} {'write':<6} {'verify':<7} {'suffixes':<18} title")
    for row in formats.FORMATS:
        can_read, can_write, can_verify = ("yes" if module else "no" for module in (row.frontend, row.backend, row.reference))
        print(f"{row.name:<8} {can_read:<5} {can_write:<6} {can_verify:<7} {' '.join(row.suffixes):<18} {row.title}")
    print(f"\n{'target':<10} {'formats':<14} title")
    for target in targets.TARGETS:
        print(f"{target.name:<10} {' '.join(target.formats):<14} {target.title}")
    return exits.DONE


def explain_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `explain`."""
    parser.add_argument("code", nargs="?", metavar="CODE", help="a code such as HX044; without it all codes are listed")


def run_explain(chosen: argparse.Namespace) -> int:
    """Print the explanation of one code, or the titles of all."""
    if chosen.code is None:
        for code in sorted(CODES.values(), key=lambda code: code.id):
            print(f"{code.id}  {code.title}")
        return exits.DONE
    found = CODES.get(_canonical(chosen.code))
    if found is None:
        raise UsageError(f"there is no code '{chosen.code}'; `hymeko-x explain` lists all")
    why = [textwrap.fill(f"{severity.value}: {reason}", 100, subsequent_indent="  ") for severity, reason in reasons(found)]
    print("\n".join((f"{found.id}: {found.title}", "", textwrap.fill(found.explanation, 100), "", *why)))
    return exits.DONE


def _canonical(text: str) -> str:
    """`hx44`, `44` and `HX044` are the same code."""
    digits = text.strip().upper().removeprefix("HX")
    return f"HX{digits.zfill(3)}"
