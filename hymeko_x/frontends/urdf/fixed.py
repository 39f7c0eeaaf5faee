"""What exporters write into fixed joints although it means nothing there: an axis, a limit, dynamics.

Where most fixed joints say the same, it is kept once for the whole mechanism; what is special stays an extra.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from hymeko_x.formats import urdf as words
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.parts import Joint
from hymeko_x.xml.text import attributes_text

if TYPE_CHECKING:
    from hymeko_x.frontends.urdf.draft import Draft
    from hymeko_x.xml.tree import Node


def gather_meaningless(joints: list[Node], draft: Draft) -> None:
    """Note what at least half of the fixed joints, and at least two, carry alike, and take it out of them."""
    fixed = [node for node in joints if _is_fixed(node, draft)]
    usual = [text for tag in words.MEANINGLESS_IF_FIXED if (text := _take_usual(fixed, tag))]
    if usual:
        draft.note(ROOT, words.FIXED, "".join(usual))


def _take_usual(fixed: list[Node], tag: str) -> str:
    """The most frequent text of this child, taken out of the joints that have it; empty when it is not frequent enough."""
    said = [(node, _text(node, tag)) for node in fixed]
    votes = Counter(text for _, text in said if text)
    text, count = votes.most_common(1)[0] if votes else ("", 0)
    if count < 2 or 2 * count < len(fixed):
        return ""
    for node, own in said:
        if own == text:
            node.take_whole(tag)
    return text


def _text(node: Node, tag: str) -> str:
    """The first such child as text, if it has nothing but attributes; empty otherwise."""
    for kid in node.children:
        if kid.tag == tag and not kid.taken:
            return "" if kid.children or kid.text is not None else f"<{tag}{attributes_text(kid.attributes)}/>"
    return ""


def _is_fixed(node: Node, draft: Draft) -> bool:
    joint = draft.edges[node.owner].data if node.owner is not None else None
    return isinstance(joint, Joint) and not joint.dofs
