"""Bodies that are being written, and the <frame> elements that their authors put into them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct, field

from hymeko_x.formats.mjcf.classes import merge
from hymeko_x.formats.mjcf.codec import POSE, BadAttribute
from hymeko_x.formats.mjcf.notations import frame, frame_of
from hymeko_x.ir.values import IDENTITY, Pose, compose
from hymeko_x.xml.printing import Tag

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.sheet import MjcfSheet
    from hymeko_x.ir.mechanism import Id


class FrameTag(Struct, frozen=True):
    """A <frame>: its attributes, its pose in the body, its childclass, the frame around it, and its depth, 1 for the outermost."""

    number: str
    attributes: dict[str, str]
    pose: Pose
    childclass: str | None
    outer: FrameTag | None
    depth: int


class BodyTag(Struct):
    """A body (or the world) that is being written: its element, the childclass in force in it, and its frames by number."""

    key: Id
    tag: Tag
    childclass: str | None
    frames: dict[str, FrameTag]
    opened: list[tuple[str, Tag]] = field(default_factory=list)

    def frame_of(self, sheet: MjcfSheet, key: Id, prefix: str = "") -> FrameTag | None:
        """The frame that the author put an element into, or None; ``prefix`` as of the element's notations."""
        return self.frames.get(sheet.note(key, frame_of(prefix)) or "") if self.frames else None

    def add(self, tag: Tag, frame: FrameTag | None) -> None:
        """Put an element into the frame; frames are opened and closed where they change, and named when they open first."""
        if frame is None and not self.opened:
            self.tag.children.append(tag)
            return
        closed: list[FrameTag] = []
        while frame is not None and not self._is_open(frame):
            closed.append(frame)
            frame = frame.outer
        del self.opened[frame.depth if frame else 0 :]
        for found in reversed(closed):
            inner = Tag("frame", dict(found.attributes))
            found.attributes.pop("name", None)
            self._innermost.children.append(inner)
            self.opened.append((found.number, inner))
        self._innermost.children.append(tag)

    def _is_open(self, frame: FrameTag) -> bool:
        return len(self.opened) >= frame.depth and self.opened[frame.depth - 1][0] == frame.number

    @property
    def _innermost(self) -> Tag:
        return self.opened[-1][1] if self.opened else self.tag


def open_body(sheet: MjcfSheet, key: Id, tag: Tag, childclass: str | None) -> BodyTag:
    """A body with the frames that its author put into it."""
    frames: dict[str, FrameTag] = {}
    while sheet.from_mjcf and (noted := sheet.mechanism.notation(key, frame(len(frames) + 1))) is not None:
        number = str(len(frames) + 1)
        outer, attributes = noted
        parent = frames.get(outer)
        try:
            pose = POSE.read(merge({}, attributes), sheet.settings)
        except BadAttribute:
            pose = IDENTITY
        inherited = parent.childclass if parent else childclass
        frames[number] = FrameTag(
            number,
            attributes,
            compose(parent.pose, pose) if parent else pose,
            attributes.get("childclass", inherited),
            parent,
            parent.depth + 1 if parent else 1,
        )
    return BodyTag(key, tag, childclass, frames)
