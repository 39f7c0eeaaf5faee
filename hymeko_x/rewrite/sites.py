"""Frames on bodies as links of their own, for formats in which a named pose is a link with a fixed joint."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import counted, listed
from hymeko_x.ir.mechanism import WORLD, joint_edge, mount_edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import Body, Frame, Joint, Tendon
from hymeko_x.ir.values import IDENTITY

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Id, Mechanism, MountView, RobotEdge

_SHOWN = 4


def make_frames_links(mechanism: Mechanism, report: Report, reason: str) -> Mechanism:
    """Every frame on a body stands on a body of its own, which a fixed joint holds there and which has its name.

    Frames on the world and those through which a tendon leads stay as they are. Idempotent.
    """
    led = {arc.target for _, _, arcs in mechanism.edges(Tendon) for arc in arcs}
    chosen = [view for views in mechanism.mounts.values() for view in views if _needs_link(view, mechanism) and view.mounted not in led]
    if not chosen:
        return mechanism
    names = names_in_use(mechanism)
    bodies: dict[Id, Body] = {}
    edges: dict[Id, RobotEdge] = {}
    origins = dict(mechanism.origins)
    for view in chosen:
        body = names.take("body", view.mounted.name)
        bodies[body] = Body()
        edges[names.take("joint", f"{body.name}_joint")] = joint_edge(Joint(), view.body, body, view.pose)
        edges[view.id] = mount_edge(body, view.mounted)
        if view.mounted in origins:
            origins[body] = origins[view.mounted]
    shown = listed([f"'{view.mounted.name}'" for view in chosen], _SHOWN)
    how = "written as a link with a fixed joint" if len(chosen) == 1 else "written as links with fixed joints"
    message = f"{counted(len(chosen), 'site')} {how} ({reason}): {shown}"
    report.note(codes.FOR_TARGET, message, element=str(chosen[0].mounted))
    return replace(mechanism.replace(vertices=bodies, edges=edges), origins=origins)


def _needs_link(view: MountView, mechanism: Mechanism) -> bool:
    return view.body != WORLD and isinstance(mechanism.graph.vertices.get(view.mounted), Frame) and not is_link(view)


def is_link(view: MountView) -> bool:
    """Whether a frame is where the body of its name is, which stands for it in formats without frames."""
    return view.mounted.kind == "frame" and view.pose == IDENTITY and view.body.name.partition("#")[0] == view.mounted.name
