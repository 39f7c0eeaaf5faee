"""Sensors on bodies, for formats in which a sensor measures at a named pose."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import counted, listed
from hymeko_x.ir.mechanism import mount_edge, sense_edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import Frame, Sensor

if TYPE_CHECKING:
    from collections.abc import Collection

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge
    from hymeko_x.rewrite.context import Context

_SHOWN = 3


def measure_at_frames(mechanism: Mechanism, context: Context, kinds: Collection[str]) -> Mechanism:
    """A sensor of one of these kinds that is on a body measures at a frame, which is on the body in its place."""
    mounted = [view for views in mechanism.mounts.values() for view in views if _is_of(mechanism, view.mounted, kinds)]
    if not mounted:
        return mechanism
    names = names_in_use(mechanism)
    frames: dict[Id, Frame] = {}
    edges: dict[Id, RobotEdge] = {}
    for view in mounted:
        frame = names.take("frame", view.mounted.name)
        frames[frame] = Frame()
        edges[view.id] = mount_edge(view.body, frame, view.pose)
        edges[names.take("sense", view.mounted.name)] = sense_edge(frame, view.mounted)
    shown = listed([f"'{view.mounted.name}'" for view in mounted], _SHOWN)
    how = "measures at a frame of its own" if len(mounted) == 1 else "measure at frames of their own"
    context.report.note(codes.REWRITTEN, f"{counted(len(mounted), 'sensor')} {how}: {shown}", element=str(mounted[0].mounted))
    return mechanism.replace(vertices=frames, edges=edges)


def _is_of(mechanism: Mechanism, key: Id, kinds: Collection[str]) -> bool:
    part = mechanism.graph.vertices.get(key)
    return isinstance(part, Sensor) and part.kind in kinds
