"""The builder of an SDF file's mechanism, and the readers of what several elements contain: values, poses and references."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from msgspec import Struct, field

from hymeko_x import codes
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.formats.sdf.notations import WrittenPose
from hymeko_x.formats.sdf.values import BadText, is_same_text, is_unit, read_pose
from hymeko_x.frontends.sdf.frames import Frames
from hymeko_x.ir.builder import Builder
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.mechanism import ROOT, WORLD, Id, Provenance
from hymeko_x.ir.values import IDENTITY, NO_ROTATION, ZERO, Pose
from hymeko_x.xml.unread import Unread

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.diagnostics import Code, Report
    from hymeko_x.formats.sdf.values import Codec, ValueField
    from hymeko_x.ir.mechanism import Extra, Mechanism
    from hymeko_x.ir.values import Vec3
    from hymeko_x.xml.tree import XmlNode


class TextsUnread(Unread):
    """What is unread in a tree whose elements come from several files: their texts are looked up by the file of the element."""

    def __init__(self, root: XmlNode, texts: Mapping[str, bytes], report: Report) -> None:
        super().__init__(root, texts[root.file], words.FORMAT, report)
        self._texts = texts

    def verbatim(self, node: XmlNode) -> str:
        """The element as its own file has it."""
        self._data = self._texts[node.file]
        return super().verbatim(node)


class SdfModel(Struct, frozen=True):
    """A <model>: its node, the scope of the names in it, the frame that it is, and the model around it (None = at top level)."""

    node: XmlNode
    scope: str
    frame: Id
    around: SdfModel | None = None
    is_static: bool = False


class SdfBuilder(Builder):
    """The mechanism of an SDF file so far. ``named`` has the element that a name means, by its name outside of all models."""

    report: Report
    unread: Unread
    versions: Mapping[str, int]
    frames: Frames = field(default_factory=Frames)
    named: dict[str, Id] = field(default_factory=dict)
    meshes: dict[tuple[str, Vec3], Id] = field(default_factory=dict)
    joints: dict[str, Id] = field(default_factory=dict)
    attached: dict[Id, Id] = field(default_factory=dict)
    moves_with: dict[Id, Id | None] = field(default_factory=dict)
    gearboxes: list[tuple[XmlNode, SdfModel]] = field(default_factory=list)
    left: set[Id] = field(default_factory=set)
    bad_numbers: set[int] = field(default_factory=set)
    written: dict[Id, dict[str, str]] = field(default_factory=dict)

    # ---- diagnostics -----------------------------------------------------------------------------------------------------

    def warn(self, code: Code, node: XmlNode, message: str) -> None:
        """Report something odd about a node, and how it is read."""
        self.report.warn(code, message, node.origin, element=node.element)

    def error(self, code: Code, node: XmlNode, message: str) -> None:
        """Report something wrong about a node, and what is used instead."""
        self.report.error(code, message, node.origin, element=node.element)

    def version_of(self, node: XmlNode) -> int:
        """The minor version of SDF in which the file of a node is written."""
        return self.versions[node.file]

    # ---- names -----------------------------------------------------------------------------------------------------------

    def own(self, node: XmlNode, kind: str, scope: str) -> Id:
        """The id of a named child of a model, from which its unread content belongs to it; a missing or repeated name is reported."""
        name = node.take("name")
        if not name:
            self.error(codes.BAD_NAME, node, f"a <{node.tag}> has no name; it is called '{node.tag}'")
            name = node.tag
        elif words.SCOPE in name or (name.startswith("__") and name.endswith("__")) or (name == words.WORLD_FRAME and kind != "shape"):
            self.warn(codes.BAD_NAME, node, f"the name '{name}' of a <{node.tag}> is reserved in SDF; it is kept")
        wanted = name if scope == words.WORLD_SCOPE else words.scoped(scope, name)
        node.owner = key = self.fresh(kind, wanted, node.origin)
        if key.name != wanted:
            self.written.setdefault(key, {})["@name"] = name
        if key.name != wanted and scope != words.WORLD_SCOPE:
            message = f"there are two <{node.tag}> called '{name}' ({self.origins[Id(kind, wanted)]}); this one is '{key.name}'"
            self.error(codes.DUPLICATE_NAME, node, message)
        return key

    def find(self, scope: str, name: str) -> Id | None:
        """The element or frame that a name in a model means; None when there is none."""
        if name == words.WORLD_FRAME:
            return WORLD
        return self.named.get(words.scoped(scope, name))

    # ---- values ----------------------------------------------------------------------------------------------------------

    def value(self, node: XmlNode, field: ValueField, key: Id, prefix: str = "") -> Any:
        """The value of a field below a node; where it would not be written like this again, its text is noted under ``prefix`` and path."""
        *steps, last = field.path.split("/")
        path = []
        for step in steps:
            found = node.child(step)
            if found is None:
                return field.default
            path.append(found)
            node = found
        if path and not node.has(last):  # an empty element stays as it is
            return field.default
        for found in path:
            found.taken = True
        return self.child_value(node, last, field.codec, field.default, key, f"{prefix}{field.path}")

    def values(self, node: XmlNode, tag: str, fields: tuple[ValueField, ...], key: Id, prefix: str = "") -> dict[str, Any]:
        """The values of fields in a child of a node, by name; see :meth:`value`."""
        found = {each.name: each.default for each in fields}
        place = node.child(tag)
        if place is None:
            return found
        children: dict[str, XmlNode] = {}
        for child in place.children:
            children.setdefault(child.tag, child)
        for each in fields:
            if (present := children.get(each.path)) is not None:
                place.taken = present.taken = True
                found[each.name] = self._value_of(present, place, each.codec, each.default, key, f"{prefix}{tag}/{each.path}")
        return found

    def child_value(self, node: XmlNode, tag: str, codec: Codec, default: Any, key: Id, path: str) -> Any:
        """The value of a child element; see :meth:`value`. A text that cannot be read is reported and stays an extra."""
        child = node.take_child(tag)
        return default if child is None else self._value_of(child, node, codec, default, key, path)

    def _value_of(self, child: XmlNode, node: XmlNode, codec: Codec, default: Any, key: Id, path: str) -> Any:
        """The value of a child element that was taken."""
        text = " ".join((child.text or "").split())
        try:
            value = codec.read(text)
        except BadText as error:
            node.leave(child)
            self.bad_numbers.add(child.start)
            problem = f"<{child.tag}> is '{text[:60]}', expected {error}"
            self.error(codes.BAD_NUMBER, child, f"{node.subject}: {problem}; the default is used, and the text is kept as written")
            return default
        if "; " in text:
            node.leave(child)
            return value
        child.text = None
        if value == default or not (codec.is_plain or is_same_text(codec.write(value), text)):
            self.written.setdefault(key, {})[path] = text
        return value

    # ---- poses -----------------------------------------------------------------------------------------------------------

    def pose(self, node: XmlNode, key: Id) -> tuple[Pose, str | None]:
        """The pose in a node's <pose>, and the name of the frame that it is relative to (None = the element's default)."""
        child = node.take_child("pose")
        if child is None:
            return IDENTITY, None
        relative_to = child.take("relative_to" if self.version_of(node) >= 7 else "frame")
        text = " ".join((child.text or "").split())
        written = WrittenPose(relative_to, child.take("rotation_format"), child.take("degrees"), text)
        try:
            pose = read_pose(written)
        except BadText as error:
            message = f"{node.subject}: <pose> is '{text[:60]}', expected {error}; the identity is used"
            self.error(codes.BAD_NUMBER, child, message)
            return IDENTITY, written.relative_to
        child.text = None
        if written.rotation_format == "quat_xyzw" and pose.written is not None and not is_unit(pose.written.numbers):
            message = f"{node.subject}: the quaternion of <pose> does not have unit length; it is normalised, which libsdformat does not do"
            self.warn(codes.NOT_UNIT, child, message)
        if key.kind != "shape" or not _is_as_printed(written, pose):
            self.note(key, notations.POSE, written)
        return pose, written.relative_to

    def base_of(self, node: XmlNode, scope: str, name: str | None, default: Id) -> Id:
        """The frame that a pose is relative to; an unknown one is reported."""
        if not name:
            return default
        found = self.find(scope, name)
        if found is None:
            message = f"{node.subject}: <pose> is relative to '{name}', which is not defined; its usual frame is used"
            self.error(codes.UNDEFINED_REFERENCE, node, message)
        return found or default

    # ---- finishing -------------------------------------------------------------------------------------------------------

    def finish(self, name: str, around: list[Extra], file: str, version: str) -> Mechanism:
        """The finished mechanism; ``around`` are the extras from before and after the root element, and ``file`` is its name."""
        for key, texts in self.written.items():
            self.note(key, notations.WRITTEN, texts)
        for key, extras in self.unread.finish().items():
            self.add_extras(key, *extras)
        self.add_extras(ROOT, *around)
        self.layout = [key for key in self.layout if key not in self.left]
        return self.build(name, Provenance(words.FORMAT, version, file))


def _is_as_printed(written: WrittenPose, pose: Pose) -> bool:
    """Whether a pose without rotation is written as the writer would write it."""
    return pose.quat == NO_ROTATION and pose.xyz != ZERO and written == WrittenPose(text=f"{numbers_text(pose.xyz)} 0 0 0")
