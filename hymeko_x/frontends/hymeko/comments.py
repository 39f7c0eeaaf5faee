"""Comments of a text as extras of the whole: those between its elements, and those in blocks that no element stands for."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.ir.mechanism import ROOT, Extra
from hymeko_x.language.comments import comments_in
from hymeko_x.language.markup import SECTION, SECTION_COMMENT

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.language.syntax import Comment, Document


def standing_comment(comment: Comment, place: int) -> Extra:
    """A comment at a place among the elements; ``[asset] text`` stands in that section of its format."""
    section = SECTION_COMMENT.fullmatch(comment.text)
    return Extra("comment", section[1], section[2], place) if section else Extra("comment", "", comment.text, place)


def with_all_comments(mechanism: Mechanism, document: Document) -> Mechanism:
    """The mechanism with the comments of its text that no element has kept before the root: those in the blocks of axes, for example."""
    graph, own = mechanism.graph, mechanism.extras.get(ROOT, ())
    there = [extras for key, extras in mechanism.extras.items() if key == ROOT or key in graph.vertices or key in graph.edges]
    kept = Counter(_written(extra) for extras in there for extra in extras if extra.format == "comment")
    lost: list[Extra] = []
    before = sum(extra.format == "comment" and extra.path == "preceding" for extra in own)
    for comment in comments_in(document.items):
        kept[comment.text] -= 1
        if kept[comment.text] < 0:
            lost.append(Extra("comment", "preceding", comment.text, before + len(lost)))
    return replace(mechanism, extras={**mechanism.extras, ROOT: (*own, *lost)}) if lost else mechanism


def _written(comment: Extra) -> str:
    """The text of a comment as it stands in HyMeKo."""
    return f"[{comment.path}] {comment.text}" if SECTION.fullmatch(comment.path) else comment.text
