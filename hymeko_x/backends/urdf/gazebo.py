"""<gazebo> elements: what another format represents and URDF hands on to the programs that read them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import formats
from hymeko_x.formats import urdf as words
from hymeko_x.ir.mechanism import ROOT, Extra

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Context


def write_gazebo_fragments(mechanism: Mechanism, _context: Context) -> Mechanism:
    """What formats with fragments of their own represent of the robot is in <gazebo> elements behind it."""
    own = mechanism.extras.get(ROOT, ())
    known = {extra.text for extra in own if extra.format == words.FORMAT}
    rows = [row for row in formats.FORMATS if row.fragments is not None]
    named = {name for row in rows for name in formats.loaded(row.fragment_sensors or "")(known)}
    found = [(row, text) for row in rows for text in formats.loaded(row.fragments or "")(mechanism) if text not in known]
    texts = [text for row, text in found if not named & formats.loaded(row.fragment_sensors or "")([text])]
    last = 1 + max((extra.index for extra in own), default=0) + len(mechanism.graph.vertices) + len(mechanism.graph.edges)
    extras = tuple(Extra(words.FORMAT, "", text, number) for number, text in enumerate(texts, last))
    return replace(mechanism, extras={**mechanism.extras, ROOT: (*own, *extras)}) if extras else mechanism
