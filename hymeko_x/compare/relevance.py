"""The differences between two mechanisms that count as loss: not values that nothing uses, nor other descriptions of the same."""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import zip_longest
from typing import TYPE_CHECKING

from hymeko_x import formats
from hymeko_x.compare.closures import Closures
from hymeko_x.compare.extras import format_of
from hymeko_x.ir.kinematics import displacement
from hymeko_x.ir.mechanism import ROOT, WORLD, Id, end_of, numbers_weight, pose_weight
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import MESH_POINTS, Body, DofKind, Frame, Joint, Layer, Material, Mesh, Mount, Sense, Shape, Stance
from hymeko_x.ir.values import ZERO, X, Y, Z, apply, compose, cross, inverse, rotate, rotation_angle, scaled
from hymeko_x.rewrite.efforts import actuator_efforts
from hymeko_x.rewrite.sites import is_link

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

    from hymeko_x.compare.diff import Difference, Tolerance
    from hymeko_x.ir.mechanism import Mechanism, RobotEdge, ShapeView
    from hymeko_x.ir.parts import Dof, Rgba
    from hymeko_x.ir.values import Pose, Vec3

_AXIS = re.compile(r"dofs\[(\d+)\]\.axis")
_EFFORT = re.compile(r"dofs\[(\d+)\]\.limits\.effort")
_FRAMES = re.compile(r"\[[01]\]\.weight.*|dofs\[\d+\]\.(axis|anchor)")
_TURNING_FREELY = (DofKind.BALL, DofKind.FREE)
_SAMPLES = (0.0, 0.5, -0.8)
"""Coordinates in m or rad at which two motions are compared: two turns that agree at three angles are about one axis."""
_NO_AXES = (X, Z)
"""The axes of URDF and MJCF where none is given."""
_WEIGHTS = ("mass", "density")
ABSENT = ("none", "[]", "0")
"""How a difference shows that a field has no value."""
_NO_NAME = "none"
"""How a difference shows that there is no name; a name is shown in quotes."""


Judge = Callable[["Difference"], bool]


def in_fragments(found: Collection[Difference], before: Mechanism, after: Mechanism) -> Judge:
    """Whether one of the differences found is in fragments of one of the robots, which only some programs read."""
    judges = [formats.loaded(row.held)(before, after) for row in formats.FORMATS if found and row.held is not None]
    return lambda difference: any(judge(difference) for judge in judges)


def relevant(
    found: Collection[Difference], before: Mechanism, after: Mechanism, tolerance: Tolerance, is_held: Judge = lambda _: False
) -> Iterator[Difference]:
    """The differences from ``before`` to ``after`` without those that are none of the robot.

    No loss is: another axis of a ball or a free joint, which has none; another mass or density of a shape without one, on the world or
    on a body whose mass and tensor are given; a centre of mass and a tensor that HyMeKo text leaves to the shapes; other frames of a
    joint that moves its body alike; the colour of a material on the shape itself; another axis along which a turned mesh is mirrored;
    an effort limit that is what the actuators of the source can exert; a frame that is where the body of its name is; frames at which a
    closure holds the same points together; an extra that holds nothing; a pose that is a keyframe; a sensor, a camera or a text that is
    held in a fragment, as ``is_held`` says. What an author wrote counts, used or not.
    """
    is_none = _Relevance(found, before, after, tolerance).is_none
    for difference in found:
        if not is_none(difference) and (_is_of_robot(difference) or not is_held(difference)):
            yield difference


class _Relevance:
    """What is known of two robots before their differences are judged one by one."""

    def __init__(self, found: Collection[Difference], before: Mechanism, after: Mechanism, tolerance: Tolerance) -> None:
        self.before, self.after, self.tolerance = before, after, tolerance
        self.native = native = formats.native_format(before)
        self.efforts = actuator_efforts(before)
        self.colours = _colours(before)
        self.turned = frozenset(_in_other_axes(before, after, found, tolerance))
        self.described = {*_links(before, after), *_keyframes(before, after, tolerance)}
        if native is None or native.held is None:
            self.described |= {*_in_fragments(before, after)}
        self.weighed = native is None or native.shapes_have_weight is None or not formats.loaded(native.shapes_have_weight)(before)
        self.closures = Closures(before, after, tolerance)
        self._alike: dict[Id, bool] = {}

    def is_none(self, difference: Difference) -> bool:
        """Whether a difference is none of the robot."""
        key, field = difference.element, difference.field
        if _is_described_otherwise(difference, self.before, self.after) or is_idle(difference):
            return True
        if not field and difference.after is None and key in self.described:
            return True
        if self.closures.describes_the_same(difference):
            return True
        if key in self.turned and (field == "scale" or field.startswith("[0].weight")):
            return True
        if key.kind == "shape" and self._is_none_of_shape(difference):
            return True
        if self.native is None and _is_weight_of_shapes(self.before, difference):
            return True
        if self.efforts and _is_effort_of_actuators(difference, self.after, self.efforts, self.tolerance):
            return True
        return key.kind == "joint" and self._moves_alike(difference)

    def _is_none_of_shape(self, difference: Difference) -> bool:
        if difference.field in _WEIGHTS and self.weighed and _needs_no_weight(self.before, difference.element, difference.field):
            return True
        return bool(self.colours) and _has_colour_of_material(self.before, self.after, difference, self.colours)

    def _moves_alike(self, difference: Difference) -> bool:
        """Whether it is in the frames or axes of a joint that moves its body alike."""
        key = difference.element
        if not _FRAMES.fullmatch(difference.field):
            return False
        if key not in self._alike:
            self._alike[key] = _move_alike(self.before.graph.edges[key], self.after.graph.edges[key], self.tolerance)
        return self._alike[key] and not _is_idle_axis(self.before, difference)


def is_idle(difference: Difference) -> bool:
    """Whether it is an extra that holds nothing of a robot: a group, the root of an articulation, the extent of a geometry."""
    row = format_of(difference.field)
    if row is None or not row.idle_extras:
        return False
    texts = [text for text in (difference.before, difference.after) if text is not None]
    return bool(texts) and all(re.fullmatch(row.idle_extras, text) for text in texts)


def _is_of_robot(difference: Difference) -> bool:
    """Whether a robot lacks what other programs than those that read fragments understand: a closure, a field of a joint or a shape."""
    gone = difference.after is None or difference.after in ABSENT
    return gone and difference.element.kind in ("loop", "joint", "shape") and " " not in difference.field


def _is_described_otherwise(difference: Difference, before: Mechanism, after: Mechanism) -> bool:
    """A name where there was none, or that of the file; a world, which its shapes imply; the points of a mesh, which its file has."""
    key, field = difference.element, difference.field
    if key == WORLD:
        return not field
    if field == "name":
        return difference.before == _NO_NAME or (key == ROOT and _are_called_by_their_files(before, after))
    return key.kind == "mesh" and field in MESH_POINTS and _came_as_file(before.graph.vertices.get(key), after.graph.vertices.get(key))


def _are_called_by_their_files(before: Mechanism, after: Mechanism) -> bool:
    """Whether both robots have no name in their texts."""
    return all(robot.notation(ROOT, UNNAMED) is not None for robot in (before, after))


def _came_as_file(before: object, after: object) -> bool:
    """Whether a mesh that was a file is held by the file that was written, which the mesh's uri tells."""
    return isinstance(before, Mesh) and before.uri is not None and not before.vertices and isinstance(after, Mesh) and after.uri is None


def _links(before: Mechanism, after: Mechanism) -> frozenset[Id]:
    """The mounts of frames that are links of their own in both mechanisms, and the frames, but for those that a size shows."""
    views = [view for views in before.mounts.values() for view in views if is_link(view) and view.body in after.graph.vertices]
    return frozenset([*(view.id for view in views), *(view.mounted for view in views if before.vertex(view.mounted, Frame) == Frame())])


def _keyframes(before: Mechanism, after: Mechanism, tolerance: Tolerance) -> Iterator[Id]:
    """The poses, with their stances, that the other mechanism keeps as texts of its format."""
    row = formats.of_source(after)
    kept = dict(formats.loaded(row.poses)(after)) if row is not None and row.poses is not None else {}
    for key, _, arcs in before.edges(Stance) if kept else ():
        pose = end_of(arcs, 1)
        values = kept.get(pose.name, {}) if pose is not None else {}
        pairs = [(values.get(arc.target, ()), numbers_weight(arc)) for arc in arcs if arc.sign == 0]
        if pose is not None and all(len(a) == len(b) and tolerance.accepts_all(a, b) for a, b in pairs):
            yield from (key, pose)


def _in_fragments(before: Mechanism, after: Mechanism) -> Iterator[Id]:
    """The sensors and cameras, with their edges, that the other mechanism holds as texts in which a third format describes them."""
    texts = [extra.text for extra in after.extras.get(ROOT, ())]
    rows = [row.fragment_sensors for row in formats.FORMATS if row.fragment_sensors is not None]
    names = frozenset(name for row in rows for name in formats.loaded(row)(texts)) if texts else frozenset()
    for key in before.graph.vertices if names else ():
        if key.kind in ("camera", "sensor") and key.name in names:
            yield key
            yield from (edge for edge, data, _ in before.graph.edges_at(key) if isinstance(data.data, Mount | Sense))


def _is_effort_of_actuators(
    difference: Difference, after: Mechanism, efforts: Mapping[tuple[Id, int], float], tolerance: Tolerance
) -> bool:
    """Whether an effort limit, where there was none, is what the actuators of the source can exert."""
    match, edge = _EFFORT.fullmatch(difference.field), after.graph.edges.get(difference.element)
    if match is None or edge is None or not isinstance(edge.data, Joint):
        return False
    number = int(match[1])
    wanted, found = efforts.get((difference.element, number)), edge.data.dofs[number].limits.effort
    return wanted is not None and found is not None and abs(found - wanted) <= tolerance.absolute + tolerance.relative * wanted


def _needs_no_weight(mechanism: Mechanism, shape: Id, field: str) -> bool:
    """Whether a shape has no such value, and its body needs none: neither the body's mass nor its tensor is left open."""
    edge = mechanism.graph.edges.get(shape)
    if edge is None or not isinstance(edge.data, Shape) or getattr(edge.data, field) is not None:
        return False
    owner = end_of(edge.arcs, 1) or WORLD
    body = mechanism.part(owner, Body)
    inertial = None if body is None else body.inertial
    return owner == WORLD or (inertial is not None and inertial.mass is not None and inertial.tensor is not None)


def _is_weight_of_shapes(mechanism: Mechanism, difference: Difference) -> bool:
    """Whether the centre of mass or the tensor of a body differs that has a mass and neither of them: its shapes give them."""
    body = mechanism.part(difference.element, Body)
    inertial = None if body is None else body.inertial
    return (
        inertial is not None
        and inertial.tensor is None
        and inertial.com == ZERO
        and difference.field.startswith(("inertial.com", "inertial.tensor"))
        and bool(mechanism.shapes.get(difference.element))
    )


def _in_other_axes(before: Mechanism, after: Mechanism, found: Iterable[Difference], tolerance: Tolerance) -> Iterator[Id]:
    """Meshes with another scale, and their shapes, where these have another rotation so that every point is where it was.

    A mirrored mesh is mirrored along another axis and turned by half a turn.
    """
    scaled_anew = {each.element for each in found if each.field == "scale" and each.element.kind == "mesh"}
    users, others = (robot.shapes_by_mesh() if scaled_anew else {} for robot in (before, after))
    for mesh in scaled_anew:
        pairs = list(zip_longest(users.get(mesh, ()), others.get(mesh, ())))
        if pairs and all(a and b and a.id == b.id and _are_in_place(a, b, mesh, before, after, tolerance) for a, b in pairs):
            yield from (mesh, *(view.id for view, _ in pairs))


def _are_in_place(a: ShapeView, b: ShapeView, mesh: Id, before: Mechanism, after: Mechanism, tolerance: Tolerance) -> bool:
    """Whether the scaled axes of a mesh point where they did, from the same place."""
    ends = []
    for view, robot in ((a, before), (b, after)):
        x, y, z = robot.vertex(mesh, Mesh).scale
        ends.append([apply(view.pose, end) for end in (ZERO, scaled(X, x), scaled(Y, y), scaled(Z, z))])
    return all(_near(one, other, tolerance) for one, other in zip(*ends, strict=True))


def _colours(mechanism: Mechanism) -> dict[Id, Rgba | None]:
    """The colours of the materials that have only that and a name."""
    with_image = {arc.target for _, _, arcs in mechanism.edges(Layer) for arc in arcs}
    plain = {key: material for key, material in mechanism.vertices(Material) if key not in with_image}
    return {key: material.rgba for key, material in plain.items() if material == Material(material.name, material.rgba)}


def _has_colour_of_material(before: Mechanism, after: Mechanism, difference: Difference, colours: Mapping[Id, Rgba | None]) -> bool:
    """Whether a shape has itself the colour that its material gave it, and so is seen as it was."""
    edge, now = before.graph.edges.get(difference.element), after.graph.edges.get(difference.element)
    if edge is None or now is None or not (isinstance(edge.data, Shape) and isinstance(now.data, Shape)) or edge.data.rgba is not None:
        return False
    places = {f"[{number}]": arc.target for number, arc in enumerate(edge.arcs) if arc.target.kind == "material"}
    is_alone = len(now.arcs) == len(edge.arcs) - len(places)
    known = [colours.get(key) for key in places.values()]
    return difference.field in ("rgba", *places) and is_alone and known == [now.data.rgba] and known != [None]


def _is_idle_axis(mechanism: Mechanism, difference: Difference) -> bool:
    """Whether an author wrote an axis for a joint that turns about all."""
    match, edge = _AXIS.fullmatch(difference.field), mechanism.graph.edges[difference.element]
    if match is None or not isinstance(edge.data, Joint):
        return False
    dof = edge.data.dofs[int(match[1])]
    return dof.kind in _TURNING_FREELY and dof.axis not in _NO_AXES


def _move_alike(a: RobotEdge, b: RobotEdge, tolerance: Tolerance) -> bool:
    """Whether two joints between the same bodies move these alike: the pose P M(q) C^-1 is the same at every q.

    For dofs with one coordinate it is compared at a few q. For others P M C^-1 = (P C^-1) (C M C^-1), in which C M C^-1 turns about C's
    image of the axis, through C's image of the anchor.
    """
    first, second = a.data, b.data
    if not (isinstance(first, Joint) and isinstance(second, Joint)) or len(a.arcs) != 2 or len(b.arcs) != 2:
        return False
    if [(arc.target, arc.sign, arc.role) for arc in a.arcs] != [(arc.target, arc.sign, arc.role) for arc in b.arcs]:
        return False
    if [dof.kind for dof in first.dofs] != [dof.kind for dof in second.dofs]:
        return False
    if not any(dof.kind in _TURNING_FREELY for dof in first.dofs):
        return all(same_pose(_moved(a, first.dofs, by), _moved(b, second.dofs, by), tolerance) for by in _SAMPLES)
    (above, below), (other_above, other_below) = (tuple(pose_weight(arc) for arc in edge.arcs) for edge in (a, b))
    return same_pose(compose(above, inverse(below)), compose(other_above, inverse(other_below)), tolerance) and all(
        _move_alike_dofs(dof, below, other, other_below, tolerance) for dof, other in zip(first.dofs, second.dofs, strict=True)
    )


def _moved(joint: RobotEdge, dofs: Sequence[Dof], by: float) -> Pose:
    """The pose of a joint's child in its parent where its first coordinate is ``by``, and every further one another number."""
    above, below = map(pose_weight, joint.arcs)
    for number, dof in enumerate(dofs, 1):
        above = compose(above, displacement(dof, number * by - dof.ref))
    return compose(above, inverse(below))


def same_pose(a: Pose, b: Pose, tolerance: Tolerance) -> bool:
    """Whether two poses are one, up to the tolerance in m and rad."""
    return _near(a.xyz, b.xyz, tolerance) and rotation_angle(a.quat, b.quat) <= tolerance.absolute + tolerance.relative


def _near(a: Vec3, b: Vec3, tolerance: Tolerance) -> bool:
    """Whether two points are one, up to what is lost when numbers as large as theirs are turned and added."""
    size = max(map(abs, (*a, *b)))
    return all(abs(x - y) <= tolerance.absolute + tolerance.relative * size for x, y in zip(a, b, strict=True))


def _move_alike_dofs(dof: Dof, below: Pose, other: Dof, other_below: Pose, tolerance: Tolerance) -> bool:
    """The same for two dofs of a kind in frames ``below``: a slide is anchored nowhere, a hinge on its line."""
    if dof.kind is DofKind.FREE:
        return True
    anchor, other_anchor = apply(below, dof.anchor), apply(other_below, other.anchor)
    if dof.kind is DofKind.BALL:
        return _near(anchor, other_anchor, tolerance)
    axis, other_axis = rotate(below.quat, dof.axis), rotate(other_below.quat, other.axis)
    if dof.kind is DofKind.SLIDE or not _near(axis, other_axis, tolerance):
        return _near(axis, other_axis, tolerance)
    return _near(cross(axis, anchor), cross(axis, other_anchor), tolerance)
