"""Reading a xacro file: its expansion is read as URDF, and every origin and message is traced back to the xacro files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, Refusal, Report, refuse
from hymeko_x.frontends import urdf
from hymeko_x.frontends.xacro.expand import expand
from hymeko_x.ir.mechanism import ROOT, Provenance
from hymeko_x.source import Reading

if TYPE_CHECKING:
    from hymeko_x.frontends.xacro.expand import Expansion
    from hymeko_x.source import Source

_SRDF = frozenset(
    (
        "group",
        "group_state",
        "virtual_joint",
        "end_effector",
        "passive_joint",
        "disable_collisions",
        "enable_collisions",
        "link_sphere_approximation",
    )
)
"""Elements of a semantic description, whose root is a <robot> too."""

_OTHER_ROOTS = {
    "sdf": "SDF (Gazebo)",
    "world": "SDF (Gazebo)",
    "model": "SDF (Gazebo)",
    "mujoco": "MJCF (MuJoCo)",
    "launch": "a launch file",
}


def read(source: Source, report: Report) -> Reading:
    """See :func:`hymeko_x.frontends.xacro.read`."""
    expansion = expand(source, report)
    _check_is_urdf(expansion)
    if "link" not in expansion.children:
        hint = "a file that only defines macros is meant to be included by a robot that calls them"
        report.warn(codes.NOT_URDF, "the expansion has no links", Origin(source.name), hint=hint)
    mechanism, residue = _read_text(expansion, source, report)
    lines = {key: origin.line for key, origin in mechanism.origins.items()}
    origins = {key: expansion.origin(line) for key, line in lines.items()}
    macros = {key: (macro,) for key, line in lines.items() if (macro := expansion.macro(line))}
    provenance = Provenance("xacro", file=source.name)
    return Reading(replace(mechanism, origins={ROOT: expansion.root_origin, **origins}, stereotypes=macros, source=provenance), residue)


def _check_is_urdf(expansion: Expansion) -> None:
    if expansion.root == "robot" and ("link" in expansion.children or not expansion.children & _SRDF):
        return
    found = f"<{expansion.root}>"
    if expansion.root == "robot":
        found = f"SRDF, which describes the use of a robot and not the robot: <{min(expansion.children & _SRDF)}>"
    elif expansion.root in _OTHER_ROOTS:
        found = f"{_OTHER_ROOTS[expansion.root]}: <{expansion.root}>"
    hint = "read the URDF that it belongs to" if expansion.root == "robot" else "expected <robot> with links"
    raise refuse(codes.NOT_URDF, f"the file expands to {found}", expansion.root_origin, hint=hint)


def _read_text(expansion: Expansion, source: Source, report: Report) -> Reading:
    """Read the expansion as URDF; diagnostics about it become diagnostics about the source."""
    diagnostics = Report()
    try:
        return urdf.read(replace(source, name=expansion.name, data=expansion.text), diagnostics)
    except Refusal as refusal:
        raise Refusal(expansion.traced(refusal.diagnostic)) from refusal
    finally:
        report.extend(expansion.traced(diagnostic) for diagnostic in diagnostics)
