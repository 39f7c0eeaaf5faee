"""Cameras and IMUs that a file holds as text for another program, as elements of the robot."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes, formats
from hymeko_x.diagnostics import listed
from hymeko_x.ir.mechanism import ROOT, WORLD, Id, mount_edge, sense_edge
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.parts import Camera, Frame, Sense, Sensor

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.ir.mechanism import Mechanism, RobotEdge
    from hymeko_x.ir.parts import VertexPart
    from hymeko_x.ir.values import Pose
    from hymeko_x.rewrite.context import Context

IMU = ("accelerometer", "gyro")
"""What an IMU measures at its frame."""
_SHOWN = 3


def mount_sensors_of_fragments(mechanism: Mechanism, context: Context) -> Mechanism:
    """Cameras of fragments are cameras of their links; IMUs are frames, with a sensor of accelerations and one of angular velocities.

    What the robot has by the same name already is not added. The fragments themselves stay, as do sensors that are IMUs.
    """
    mounted = [*_mounted(mechanism)]
    if not mounted:
        return mechanism
    vertices: dict[Id, VertexPart] = {}
    edges: dict[Id, RobotEdge] = {}
    names = names_in_use(mechanism)
    for link, name, pose, part in mounted:
        body, key = Id("body", link), Id("camera" if isinstance(part, Camera) else "frame", name)
        if body not in mechanism.graph.vertices or key in mechanism.graph.vertices or key in vertices:
            continue
        vertices[key] = part
        edges[names.take("mount", name)] = mount_edge(body, key, pose)
        for kind in () if key.kind == "camera" else IMU:
            sensor = names.take("sensor", f"{name}_{kind}")
            vertices[sensor] = Sensor(kind)
            edges[names.take("sense", sensor.name)] = sense_edge(key, sensor)
    if not vertices:
        return mechanism
    found = [key for key in vertices if key.kind != "sensor"]
    shown = listed([f"'{key.name}'" for key in found], _SHOWN)
    message = f"cameras and IMUs that the file holds for a simulator are written: {shown}"
    context.report.note(codes.REWRITTEN, message, element=str(found[0]))
    return mechanism.replace(vertices=vertices, edges=edges)


def held(mechanism: Mechanism) -> list[str]:
    """The fragments of cameras on bodies, and of frames at which accelerations and angular velocities are measured."""
    writers = [formats.loaded(row.fragment_of) for row in formats.FORMATS if row.fragment_of is not None]
    measured: dict[Id, set[str]] = {}
    for _, _, arcs in mechanism.edges(Sense):
        kinds = [part.kind for arc in arcs if isinstance(part := mechanism.graph.vertices.get(arc.target), Sensor)]
        for arc in arcs:
            measured.setdefault(arc.target, set()).update(kinds)
    found = []
    for view in (view for body, views in mechanism.mounts.items() if body != WORLD for view in views):
        part = mechanism.graph.vertices.get(view.mounted)
        if isinstance(part, Camera) or (isinstance(part, Frame) and measured.get(view.mounted, set()).issuperset(IMU)):
            found += [write((view.body.name, view.mounted.name, view.pose, part)) for write in writers]
    return found


def _mounted(mechanism: Mechanism) -> Iterator[tuple[str, str, Pose, Camera | Frame]]:
    own = mechanism.extras.get(ROOT, ())
    readers = [formats.loaded(row.fragment_mounts) for row in formats.FORMATS if row.fragment_mounts is not None] if own else []
    for extra in own:
        for read in readers:
            yield from read(extra.text)
    for views in mechanism.mounts.values():
        for view in views:
            part = mechanism.graph.vertices.get(view.mounted)
            if isinstance(part, Sensor) and part.kind == "imu":
                yield view.body.name, view.mounted.name, view.pose, Frame()
