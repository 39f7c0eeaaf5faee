"""The sheet of the SDF backend: the mechanism to be printed, where its frames are, and how its author wrote its values."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, Any

from hymeko_x.assets.written import files_of_meshes
from hymeko_x.backends.sdf.frames import ZeroPoses
from hymeko_x.backends.sdf.gears import gears
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.formats.sdf.values import BadText, read_pose
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.kinematics import dof_number
from hymeko_x.ir.mechanism import ROOT, WORLD, numbers_weight
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Camera, Coupling, DofKind, Joint, Layer, Sense, Sensor, Texture
from hymeko_x.ir.values import IDENTITY, Pose, rotation_angle, rpy_of
from hymeko_x.xml.printing import Tag, foreign_text, put_back
from hymeko_x.xml.text import attributes_text
from hymeko_x.xml.unread import COMMENT, FOLLOWING, PRECEDING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.backends.sdf.gears import Gear
    from hymeko_x.formats.sdf.values import Codec, ValueField
    from hymeko_x.ir.mechanism import Extra, Id, JointView, Mechanism, RobotArc

_PLACEMENTS = ("@placement_frame", "model/@placement_frame", "world/model/@placement_frame")
_NEAR = 1e-9
"""m and rad: a pose that is this close to what its author wrote is written so again."""


class SdfSheet:
    """A mechanism to be printed; all look-ups are linear to build. Files beside the output are in the folder ``within``."""

    def __init__(self, mechanism: Mechanism, within: str) -> None:
        self.mechanism = mechanism
        self.within = within
        self.from_sdf = notations.is_from_sdf(mechanism)
        self.places = ZeroPoses(mechanism)
        self.declared: dict[str, str] = {}

    @cached_property
    def version(self) -> str:
        """The author's version, or the usual one, unless something needs a later one."""
        own = self.mechanism.notation(ROOT, notations.VERSION) or words.DEFAULT_VERSION
        needed = words.VERSION_OF_MIMIC if any(key not in self.gears for key, _, _ in self.mechanism.edges(Coupling)) else own
        return max(own, needed, key=words.minor)

    @cached_property
    def mesh_files(self) -> Mapping[Id, str]:
        """The new files of the meshes that have points and no file."""
        return files_of_meshes(self.mechanism, self.within)

    @cached_property
    def images(self) -> Mapping[Id, str]:
        """The file of the colours of each material."""
        return {material: uris["rgb"] for material, uris in self.textures.items() if "rgb" in uris}

    @cached_property
    def textures(self) -> Mapping[Id, dict[str, str]]:
        """The files of each material's textures, by their use."""
        found: dict[Id, dict[str, str]] = {}
        for _, layer, arcs in self.mechanism.edges(Layer):
            image = next((self.mechanism.graph.vertices.get(arc.target) for arc in arcs if arc.sign > 0), None)
            if isinstance(image, Texture) and image.uri is not None:
                for arc in arcs:
                    if arc.sign < 0:
                        found.setdefault(arc.target, {}).setdefault(layer.use, image.uri)
        return found

    # ---- what is written, and how ----------------------------------------------------------------------------------------

    @cached_property
    def has_several_models(self) -> bool:
        """Whether there are several models at top level, and none around all others."""
        return self.mechanism.notation(ROOT, notations.SEVERAL) is not None

    def name(self, key: Id, scope: str) -> str:
        """The name of an element in its model: its author's where another element has it as well."""
        return self.written(key).get("@name") or key.name.removeprefix(scope)

    def model_name(self, scope: str) -> str:
        """The name of a model in that around it."""
        return self.written(self.places.model_frame(scope)).get("@name") or words.split_scope(scope.removesuffix(words.SCOPE))[1]

    def says_static(self, scope: str, key: Id) -> bool:
        """Whether a model is written as one that stands; in a file from SDF the models of which the author wrote it."""
        own = "static" in self.written(key)
        if scope not in self._bodies_stand:
            return own  # a model without links
        outer = words.scope_around(scope)
        is_outer = bool(scope) and (bool(outer) or not self.has_several_models) and self.is_static(outer)
        return self.is_static(scope) and (own or not (self._is_static_given or is_outer))

    @cached_property
    def _is_static_given(self) -> bool:
        return any("static" in self.written(key) for key in (ROOT, *self.places.mounts))

    def is_implied(self, view: JointView) -> bool:
        """Whether SDF says without a joint what this joint says: a body floats, or stands as its whole model does."""
        if view.parent != WORLD:
            return False
        if view.joint.dofs:
            return view.joint.dofs[0].kind is DofKind.FREE
        return self.is_static(words.split_scope(view.child.name)[0])

    def is_static(self, scope: str) -> bool:
        """Whether a model stands: nothing in it moves, and nameless joints hold it in the world."""
        return scope in self._static

    @cached_property
    def _static(self) -> frozenset[str]:
        return frozenset(scope for scope, stands in self._bodies_stand.items() if stands)

    @cached_property
    def _bodies_stand(self) -> Mapping[str, bool]:
        """For each model with links whether nameless joints hold all of it in the world and nothing moves.

        In a static model of SDF no joint moves.
        """
        mechanism = self.mechanism
        standing: set[Id] = set()
        found: dict[str, bool] = {}
        for key in mechanism.depth_first():
            above = mechanism.parent_joint.get(key)
            if above is not None and (self.from_sdf or not above.joint.dofs):
                nameless = above.parent == WORLD and not above.joint.dofs and mechanism.notation(above.id, UNNAMED) is not None
                if nameless or above.parent in standing:
                    standing.add(key)
            scope = words.split_scope(key.name)[0]
            while found.get(scope, True) or key not in standing:
                found[scope] = found.get(scope, True) and key in standing
                if not scope:
                    break
                scope = words.scope_around(scope)
        return found

    def is_sensor(self, key: Id) -> bool:
        """Whether SDF has such a sensor."""
        part = self.mechanism.graph.vertices.get(key)
        return isinstance(part, Camera) or (isinstance(part, Sensor) and (self.from_sdf or part.kind in words.SENSORS))

    @cached_property
    def joint_sensors(self) -> Mapping[Id, list[Id]]:
        """The sensors of each joint."""
        found: dict[Id, list[Id]] = {}
        for _, _, arcs in self.mechanism.edges(Sense):
            measured = [arc.target for arc in arcs if arc.sign > 0 and arc.target.kind in ("joint", "loop")]
            sensors = [arc.target for arc in arcs if arc.sign < 0 and self.is_sensor(arc.target)]
            if len(measured) == len(sensors) == 1 and sensors[0] not in self.places.mounts:
                found.setdefault(measured[0], []).append(sensors[0])
        return found

    @cached_property
    def gears(self) -> Mapping[Id, Gear]:
        """The couplings that are written as joints of type gearbox."""
        return gears(self.mechanism, self.places)

    @cached_property
    def leaders(self) -> Mapping[tuple[Id, str], tuple[Id, RobotArc]]:
        """For each axis of a joint that mimics another one, the coupling and its arc to the leader, with the coefficients."""
        found: dict[tuple[Id, str], tuple[Id, RobotArc]] = {}
        for key, _, arcs in self.mechanism.edges(Coupling):
            followers, leaders = [arc for arc in arcs if arc.sign > 0], [arc for arc in arcs if arc.sign < 0]
            if key not in self.gears and len(followers) == len(leaders) == 1 and not any(numbers_weight(leaders[0])[2:]):
                found[followers[0].target, self.axis_name(followers[0])] = key, leaders[0]
        return found

    def axis_name(self, arc: RobotArc) -> str:
        """The name of the axis that an arc to a joint means."""
        edge = self.mechanism.graph.edges.get(arc.target)
        number = dof_number(edge.data, arc.role) if edge is not None and isinstance(edge.data, Joint) else None
        return words.AXES[1 if number == 1 else 0]

    # ---- values ----------------------------------------------------------------------------------------------------------

    def written(self, key: Id) -> Mapping[str, str]:
        """The texts of an element's values, by path, that its author wrote in a way of their own."""
        return (self.mechanism.notation(key, notations.WRITTEN) or {}) if self.from_sdf else {}

    def put(self, tag: Tag, field: ValueField, value: Any, texts: Mapping[str, str], prefix: str = "") -> None:
        """Write a value below a tag: as its author wrote it where that means the same, and not at all where it is the default."""
        own = texts.get(f"{prefix}{field.path}") if texts else None
        if own is None and value == field.default:
            return
        text = field.codec.write(value) if own is None else self.text(field.codec, value, field.default, own)
        if text is None:
            return
        above, _, last = field.path.rpartition("/")
        for step in above.split("/") if above else ():
            tag = tag.child(step)
        self.add_text(tag, last, text)

    def put_all(self, tag: Tag, name: str, values: Iterable[tuple[ValueField, Any]], texts: Mapping[str, str], prefix: str) -> None:
        """Write values as :meth:`put` does, into a new child of a tag; no child without anything in it."""
        place = Tag(name, {})
        for field, value in values:
            self.put(place, field, value, texts, f"{prefix}{name}/" if texts else "")
        if place.children:
            tag.children.append(place)

    def add_text(self, tag: Tag, name: str, text: str, **attributes: str) -> None:
        """Add a child with a text. It is ready text, which prints faster, except in files from SDF, whose extras may be in it."""
        if self.from_sdf or not text:
            tag.add(name, **attributes).children += [text] if text else []
        else:
            tag.children.append(f"<{name}{attributes_text(attributes) if attributes else ''}>{text}</{name}>")

    def text(self, codec: Codec, value: Any, default: Any, own: str | None) -> str | None:
        """The text of a value; None for the default, unless its author wrote it."""
        if own is not None:
            try:
                if is_near(codec.read(own), value):
                    return own
            except BadText:
                pass
        return None if value == default else codec.write(value)

    # ---- poses -----------------------------------------------------------------------------------------------------------

    def add_pose(self, tag: Tag, key: Id, scope: str, default: Id, base: Id | None = None, *, pose: Pose | None = None) -> None:
        """Add <pose>: as its author wrote it where that still is the place, else in ``base``, else in the element's default frame.

        ``pose`` is where the element is in its default frame, for those that are no frames themselves.
        """
        own = self.mechanism.notation(key, notations.POSE) if self.from_sdf else None
        if own is not None and self._add_own_pose(tag, own, scope, key, default, pose):
            return
        frame = default if base is None or self.from_sdf else base
        value = pose if pose is not None else self.places.relative(key, frame)
        is_identity = is_near(value, IDENTITY)
        if frame != default or not is_identity:
            marks = {"relative_to": self.places.name(frame, scope)} if frame != default else {}
            text = "0 0 0 0 0 0" if is_identity else numbers_text((*value.xyz, *rpy_of(value)))
            self.add_text(tag, "pose", text, **marks)

    def add_model_pose(self, tag: Tag, key: Id, outer: str, around: Id, scope: str) -> None:
        """Add the <pose> of a model, which is that of its placement frame where it names one."""
        frame = self.places.model_frame(scope)
        placement = next((extra.text for extra in self.extras(key) if extra.path in _PLACEMENTS), None)
        placed = self.places.find(scope, placement) if placement is not None else None
        shown = frame if placed is None else placed
        own = self.mechanism.notation(key, notations.POSE)
        if own is None:
            value = self.places.relative(shown, around)
            if not is_near(value, IDENTITY):
                tag.add("pose").children.append(numbers_text((*value.xyz, *rpy_of(value))))
            return
        if not self._add_own_pose(tag, own, outer, shown, around, None):
            value = self.places.relative(shown, around)
            tag.add("pose").children.append(numbers_text((*value.xyz, *rpy_of(value))))

    def _add_own_pose(self, tag: Tag, own: notations.WrittenPose, scope: str, key: Id, default: Id, pose: Pose | None) -> bool:
        """Add <pose> in the frame and the notation of its author, with the author's text where that still is the place.

        False where that frame is not there any more, or where none was named and the place is another one.
        """
        named = self.places.find(scope, own.relative_to) if own.relative_to else None
        if own.relative_to and named is None:
            return False
        base = named or default
        value = pose if pose is not None else self.places.relative(key, base)
        if pose is not None and base != default:
            value = self.places.seen_from(base, default, pose)
        text = self._own_text(own, value)
        if text is None and named is None:
            return False
        old = words.minor(self.version) < words.VERSION_OF_RELATIVE_TO
        marks = {"frame" if old else "relative_to": own.relative_to, "rotation_format": own.rotation_format, "degrees": own.degrees}
        if text is None:
            marks = {name: mark for name, mark in marks.items() if mark == own.relative_to}
            text = numbers_text((*value.xyz, *rpy_of(value)))
        child = tag.add("pose", **{name: mark for name, mark in marks.items() if mark is not None})
        if text:
            child.children.append(text)
        return True

    @staticmethod
    def _own_text(own: notations.WrittenPose, value: Pose) -> str | None:
        """The author's text of a pose, if that still is what it means."""
        try:
            return own.text if is_near(read_pose(own), value) else None
        except BadText:
            return None

    # ---- extras ----------------------------------------------------------------------------------------------------------

    def extras(self, key: Id) -> list[Extra]:
        """What SDF alone represents of an element."""
        own = self.mechanism.extras.get(key, ())
        return [extra for extra in own if extra.format == words.FORMAT or (extra.format == COMMENT and self._is_placed(extra))]

    def _is_placed(self, extra: Extra) -> bool:
        """Whether a comment is at a place that SDF has as well."""
        return self.from_sdf or extra.path in ("", PRECEDING, FOLLOWING)

    def put_back(self, tag: Tag, key: Id, without: str = "") -> None:
        """Write the extras of an element into its tag, except elements that begin with ``without``."""
        if key not in self.mechanism.extras:
            return
        own = [extra for extra in self.extras(key) if not (without and extra.text.startswith(without))]
        if own:
            put_back(tag, [extra for extra in own if extra.path not in (PRECEDING, FOLLOWING)], self.declared)

    def around(self) -> tuple[list[str], list[str]]:
        """The lines before and after the root element."""
        own = sorted(self.extras(ROOT), key=lambda extra: extra.index)
        before, after = ([foreign_text(extra, {}) for extra in own if extra.path == path] for path in (PRECEDING, FOLLOWING))
        return before, after


def is_near(a: Any, b: Any) -> bool:
    """Whether two values are the same up to rounding."""
    if isinstance(a, Pose) and isinstance(b, Pose):
        return math.dist(a.xyz, b.xyz) <= _NEAR and (a.quat == b.quat or rotation_angle(a.quat, b.quat) <= _NEAR)
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(is_near(x, y) for x, y in zip(a, b, strict=True))
    if isinstance(a, float) and isinstance(b, int | float):
        return abs(a - b) <= 1e-12 * max(1.0, abs(a))
    return bool(a == b)
