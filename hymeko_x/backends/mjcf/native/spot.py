"""Where elements stand in the tree, and what is to be printed there."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct, field

from hymeko_x.formats.mjcf.classes import merge
from hymeko_x.formats.mjcf.codec import POSE, BadAttribute
from hymeko_x.formats.mjcf.tree import parse_text
from hymeko_x.ir.values import IDENTITY, Pose, compose

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.native.sheet import Sheet
    from hymeko_x.backends.mjcf.text import Attributes
    from hymeko_x.ir.mechanism import Id


class Around(Struct, frozen=True):
    """A <frame>: its number and attributes, its pose in the body, its childclass, and the frame around it."""

    number: str
    attributes: dict[str, str]
    pose: Pose
    childclass: str | None
    outer: Around | None = None
    depth: int = 1


class Spot(Struct, frozen=True):
    """A body (or the world), the childclass in force in it, and the frames in it by number."""

    body: Id
    childclass: str | None = None
    frames: dict[str, Around] = field(default_factory=dict)

    def around(self, number: str | None) -> Around | None:
        """The frame of this number, or None."""
        return self.frames.get(number) if number else None

    def childclass_in(self, around: Around | None) -> str | None:
        """The childclass in force in a frame, or outside of all."""
        return self.childclass if around is None else around.childclass


class Op(Struct, frozen=True):
    """One element to print: ``kind`` is leaf, body (to be opened and filled with ``spot``) or frame (to be opened)."""

    kind: str
    tag: str
    attributes: Attributes
    inside: tuple[str, ...] = ()
    around: Around | None = None
    spot: Spot | None = None


def spot_of(sheet: Sheet, body: Id, childclass: str | None) -> Spot:
    """A body with the frames that its author put into it."""
    notes = sheet.notes(body)
    frames: dict[str, Around] = {}
    number = 1
    while (said := notes.get(f"frame{number}")) is not None:
        outer, _, rest = said.partition(" ")
        attributes = parse_text(f"<frame {rest}/>").attributes
        parent = frames.get(outer)
        try:
            pose = POSE.read(merge({}, attributes), sheet.settings)
        except BadAttribute:
            pose = IDENTITY
        inherited = parent.childclass if parent else childclass
        above = parent.pose if parent else IDENTITY
        frames[str(number)] = Around(
            str(number),
            attributes,
            compose(above, pose),
            attributes.get("childclass", inherited),
            parent,
            parent.depth + 1 if parent else 1,
        )
        number += 1
    return Spot(body, childclass, frames)
