"""The table of targets: one row holds what a program expects of a robot beyond the format that it reads.

A target's rules run after the options of the user, and before the format's own rules; what they add or change is a note in the report and
belongs to the robot from then on. Adding a target means its rules in a file of this room, and one row here.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from msgspec import Struct, field
from msgspec.structs import replace

from hymeko_x import codes, formats
from hymeko_x.diagnostics import refuse
from hymeko_x.rewrite.context import Context

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.diagnostics import Report
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Options, Rule
    from hymeko_x.source import Files, Package


class Target(Struct, frozen=True):
    """One target: ``docs/targets.md`` says with sources what its program expects."""

    name: str
    """Its name on the command line."""
    title: str
    """The program, with the version whose expectations these are."""
    formats: tuple[str, ...]
    """The families of formats in which it takes a robot, first the usual one."""
    rules: str
    """The module with the rewriting rules in order: ``RULES``."""
    defaults: Mapping[str, Any] = field(default_factory=dict)
    """Options where the user gives none, by their names in :class:`hymeko_x.rewrite.Options`."""
    beside: str | None = None
    """The function ``(printed, package, files, options) -> files`` that gives what stands beside the main file, by relative path."""


MUJOCO = Target(
    "mujoco",
    "MuJoCo 4.0, laid out as in MuJoCo Menagerie",
    ("mjcf",),
    "hymeko_x.targets.mujoco",
    beside="hymeko_x.targets.scene:scene_beside",
)
MJX = Target(
    "mjx", "MuJoCo MJX 3.17, its implementation in JAX", ("mjcf",), "hymeko_x.targets.mjx", beside="hymeko_x.targets.scene:scene_beside"
)
ROS2 = Target(
    "ros2",
    "ROS 2 Jazzy: robot_state_publisher, MoveIt, ros2_control",
    ("urdf",),
    "hymeko_x.targets.ros2",
    MappingProxyType({"sites": True, "mesh_prefix": "package://"}),
    "hymeko_x.backends.urdf.srdf:srdf_beside",
)
PINOCCHIO = Target(
    "pinocchio", "Pinocchio 4.1, with mimic=True", ("urdf",), "hymeko_x.targets.pinocchio", MappingProxyType({"sites": True})
)
DRAKE = Target("drake", "Drake 1.51", ("urdf",), "hymeko_x.targets.drake")
_LAYERS = MappingProxyType({"layout": "rep158"})
NEWTON = Target("newton", "Newton 1.8, with stages that follow REP 158", ("usd",), "hymeko_x.targets.newton", _LAYERS)
ISAAC = Target("isaac", "Isaac Sim 5, which takes the same stages as Newton", ("usd",), "hymeko_x.targets.newton", _LAYERS)
GAZEBO = Target("gazebo", "Gazebo Sim 9 (Ionic)", ("sdf",), "hymeko_x.targets.gazebo")

TARGETS: tuple[Target, ...] = (MUJOCO, MJX, ROS2, PINOCCHIO, DRAKE, NEWTON, ISAAC, GAZEBO)
"""Every target, by format."""


def by_name(name: str) -> Target:
    """The target of this name. Raises: Refusal HX012."""
    known = {target.name: target for target in TARGETS}
    if name.lower() in known:
        return known[name.lower()]
    from difflib import get_close_matches

    near = get_close_matches(name.lower(), known, 1)
    hint = f"did you mean '{near[0]}'?" if near else f"known: {', '.join(known)}"
    raise refuse(codes.UNKNOWN_TARGET, f"there is no target '{name}'; {hint}")


def of_format(format: Format) -> tuple[Target, ...]:
    """The targets that take robots in this format."""
    return tuple(target for target in TARGETS if format.family in target.formats)


def chosen(options: Options, format: Format) -> tuple[Options, Target | None]:
    """The options with the defaults of the target that they name, and this target; None where they name none.

    Raises: Refusal HX012 where there is no such target, or it takes no robots in this format.
    """
    if options.target is None:
        return options, None
    target = by_name(options.target)
    if format.family not in target.formats:
        takes = " or ".join(target.formats)
        raise refuse(codes.UNKNOWN_TARGET, f"target '{target.name}' takes {takes}, and the output is {format.name}")
    unset = {name: value for name, value in target.defaults.items() if getattr(options, name) is None}
    return replace(options, **unset), target


def aimed(mechanism: Mechanism, target: Target | None, files: Files, report: Report, printed: Callable[[Mechanism], Package]) -> Mechanism:
    """The mechanism as the target's program expects it; ``printed`` gives one as it would be written. Idempotent."""
    if target is None:
        return mechanism
    context = Context(report, files, f"--for {target.name}", printed)
    rules: tuple[Rule, ...] = formats.loaded(target.rules).RULES
    for rule in rules:
        mechanism = rule(mechanism, context)
    return mechanism


def files_beside(printed: Mechanism, package: Package, files: Files, options: Options) -> Mapping[str, bytes]:
    """The files that the program of the options' target expects beside the main one of a package, by relative path."""
    target = None if options.target is None else by_name(options.target)
    if target is None or target.beside is None:
        return MappingProxyType({})
    found: Mapping[str, bytes] = formats.loaded(target.beside)(printed, package, files, options)
    return found
