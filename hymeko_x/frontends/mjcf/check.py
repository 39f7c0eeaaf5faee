"""Words that MJCF does not have are refused, as MuJoCo refuses them."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf_classes import TURNS
from hymeko_x.formats.mjcf_schema import CHILDREN, REMOVED, attributes_of
from hymeko_x.formats.mjcf_tree import COMMENT

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Refusal
    from hymeko_x.formats.mjcf_tree import Element


def check_words(root: Element) -> None:
    """Raises: Refusal (HX027) at the first element or attribute that MuJoCo 4.0 does not know there."""
    stack = [(root, "mujoco")]
    while stack:
        element, path = stack.pop()
        _check_attributes(element, path)
        known = CHILDREN.get(path, {})
        for child in element.children:
            if child.tag == COMMENT:
                continue
            below = known.get(child.tag)
            if below is None:
                raise _unknown(child, f"<{element.tag}> has no <{child.tag}>", child.tag, list(known))
            stack.append((child, below))


def _check_attributes(element: Element, path: str) -> None:
    known = attributes_of(path)
    turns = 0
    for name in element.attributes:
        turns += name in TURNS
        if name not in known and ":" not in name and not name.startswith("xmlns"):
            raise _unknown(element, f"<{element.tag}> has no attribute '{name}'", name, sorted(known))
    if turns > 1:
        found = ", ".join(name for name in element.attributes if name in TURNS)
        raise refuse(codes.REPEATED, f"<{element.tag}> has more than one orientation: {found}", element.origin)


def _unknown(element: Element, message: str, word: str, known: list[str]) -> Refusal:
    near = get_close_matches(word, known, n=2)
    hint = REMOVED.get(word, "") or (f"did you mean {' or '.join(near)}?" if near else "")
    return refuse(codes.UNKNOWN_WORD, message, element.origin, hint=hint)
