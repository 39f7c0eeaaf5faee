"""Names in verbatim MJCF: what an extra of a part is called, and refers to, in a robot of which the part becomes one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.formats.mjcf.tree import parse_text, verbatim

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.ir.mechanism import Extra

_NUMBERED = ("joint", "body", "geom", "site", "tendon")
NAMES = frozenset(
    {
        *("name", "actuator", "camera", "cranksite", "flex", "hfield", "jointinparent", "layer", "light", "material", "mesh", "numeric"),
        *("objname", "refname", "refsite", "sensor", "sidesite", "skin", "slidersite", "target", "texture", "tuple", "flexbody"),
        *_NUMBERED,
        *(f"{word}{number}" for word in _NUMBERED for number in (1, 2)),
    }
)
"""The attributes that hold the name of an element, its own or that of another one."""
_OF_THE_WHOLE = ("compiler", "option", "size", "visual", "statistic", "keyframe", "default")
"""The sections that a robot has once: those of the host count. Keyframes are written anew."""


def renamed(extra: Extra, change: Callable[[str], str], *, is_of_whole: bool) -> Extra | None:
    """An extra of a part with all names changed; None for a section of which the host's counts."""
    if extra.path.rpartition("/")[2].startswith("@"):
        return replace(extra, text=change(extra.text)) if extra.path.rpartition("@")[2] in NAMES and extra.text else extra
    node = parse_text(extra.text)
    if is_of_whole and (node.tag in _OF_THE_WHOLE or extra.path.startswith("@")):
        return None
    stack = [node]
    while stack:
        element = stack.pop()
        for name in NAMES & element.attributes.keys():
            element.attributes[name] = change(element.attributes[name])
        stack += element.children
    return replace(extra, text=verbatim(node))
