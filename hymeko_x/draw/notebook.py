"""A robot in a notebook: its picture, where that can be drawn, and its tree. Both are images, which have no markup of their own."""

from __future__ import annotations

from base64 import b64encode
from typing import TYPE_CHECKING

from hymeko_x.draw.attempt import attempt
from hymeko_x.draw.graph.letters import visible
from hymeko_x.draw.graph.picture import picture
from hymeko_x.draw.render import PictureOptions, choose_backend, open_studio
from hymeko_x.ir.parts import Body
from hymeko_x.xml.text import escaped

if TYPE_CHECKING:
    from hymeko_x.robot import Robot

_OPTIONS = PictureOptions((480, 360))
_MOST_BODIES = 60
"""The tree of a robot with more bodies is folded away."""


def html(robot: Robot) -> str:
    """The markup that a notebook shows."""
    still, _ = attempt(lambda: _still(robot))
    shown = "" if still is None else _image("png", still, _OPTIONS.size[0], visible(robot.name))
    tree = _image("svg+xml", picture(robot.mechanism).encode(), None, f"tree of {visible(robot.name)}")
    bodies = sum(1 for _ in robot.mechanism.vertices(Body))
    folded = f"<details><summary>{escaped(visible(repr(robot)))}</summary>{tree}</details>"
    return f"<div>{shown}{tree if bodies <= _MOST_BODIES else folded}</div>"


def _still(robot: Robot) -> bytes:
    choose_backend()
    from hymeko_x.draw.files import png

    return png(open_studio(robot, None, _OPTIONS).still())


def _image(kind: str, data: bytes, width: int | None, words: str) -> str:
    size = "" if width is None else f' width="{width}"'
    return f'<img alt="{escaped(words)}"{size} src="data:image/{kind};base64,{b64encode(data).decode()}"/>'
