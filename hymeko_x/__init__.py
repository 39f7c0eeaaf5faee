"""hymeko-x: robot descriptions in, robot descriptions out, over one hypergraph.

    import hymeko_x as hx

    robot = hx.load("robot.urdf")
    print(robot.joints["elbow"].limits.upper)
    hx.dump(robot, "robot.xml")
    print(hx.dumps(robot, "hymeko"))
    print(hx.verify("robot.urdf", "robot.xml").verdict)
    result = hx.convert("a.urdf", "b.xml", packages={"a_description": "..."})

The words are those of `json` and `yaml`. Everything is loaded when it is first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hymeko_x.api import convert, dump, dumps, load, loads, update
    from hymeko_x.compare.diff import diff
    from hymeko_x.diagnostics import Diagnostic, Refusal, Report, Severity
    from hymeko_x.dynamics import dynamics
    from hymeko_x.ir.geometry import Box, Capsule, Cylinder, Ellipsoid, Plane, Sphere
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.values import Pose
    from hymeko_x.robot import EditError, Robot, compose
    from hymeko_x.robot.units import deg, mm
    from hymeko_x.verify import verify
    from hymeko_x.version import __version__ as __version__

__all__ = [
    "Box",
    "Capsule",
    "Cylinder",
    "Diagnostic",
    "EditError",
    "Ellipsoid",
    "Id",
    "Mechanism",
    "Plane",
    "Pose",
    "Refusal",
    "Report",
    "Robot",
    "Severity",
    "Sphere",
    "compose",
    "convert",
    "deg",
    "diff",
    "dump",
    "dumps",
    "dynamics",
    "load",
    "loads",
    "mm",
    "update",
    "verify",
]

_HOMES = {
    **dict.fromkeys(("convert", "dump", "dumps", "load", "loads", "update"), "hymeko_x.api"),
    **dict.fromkeys(("Diagnostic", "Refusal", "Report", "Severity"), "hymeko_x.diagnostics"),
    "diff": "hymeko_x.compare.diff",
    "dynamics": "hymeko_x.dynamics",
    "verify": "hymeko_x.verify",
    "__version__": "hymeko_x.version",
    **dict.fromkeys(("Id", "Mechanism"), "hymeko_x.ir.mechanism"),
    **dict.fromkeys(("EditError", "Robot", "compose"), "hymeko_x.robot"),
    **dict.fromkeys(("deg", "mm"), "hymeko_x.robot.units"),
    "Pose": "hymeko_x.ir.values",
    **dict.fromkeys(("Box", "Capsule", "Cylinder", "Ellipsoid", "Plane", "Sphere"), "hymeko_x.ir.geometry"),
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'hymeko_x' has no attribute '{name}'")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
