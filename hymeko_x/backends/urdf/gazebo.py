"""<gazebo> elements: what another format represents and URDF hands on to the programs that read them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes, formats
from hymeko_x.diagnostics import counted
from hymeko_x.formats import urdf as words
from hymeko_x.ir.mechanism import ROOT, Extra
from hymeko_x.rewrite.fragments import held

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Context


def hold_sensors(mechanism: Mechanism, context: Context) -> Mechanism:
    """Cameras, and frames with accelerometer and gyro, are sensors in <gazebo> elements, unless its own format writes them."""
    own = mechanism.extras.get(ROOT, ())
    rows = [row for row in formats.FORMATS if row.fragments is not None]
    if any(formats.loaded(row.fragments or "")(mechanism) for row in rows):
        return mechanism
    sensors = [formats.loaded(row.fragment_sensors or "") for row in rows]
    known = {name for names in sensors for name in names(extra.text for extra in own)}
    texts = [text for text in held(mechanism) if not known & {name for names in sensors for name in names([text])}]
    if not texts:
        return mechanism
    context.report.note(codes.FOR_TARGET, f"{counted(len(texts), 'camera or IMU', 'cameras and IMUs')} in <gazebo> ({context.reason})")
    return _with_fragments(mechanism, texts)


def _with_fragments(mechanism: Mechanism, texts: list[str]) -> Mechanism:
    """The mechanism with these elements behind all others."""
    own = mechanism.extras.get(ROOT, ())
    last = 1 + max((extra.index for extra in own), default=0) + len(mechanism.graph.vertices) + len(mechanism.graph.edges)
    extras = tuple(Extra(words.FORMAT, "", text, number) for number, text in enumerate(texts, last))
    return replace(mechanism, extras={**mechanism.extras, ROOT: (*own, *extras)}) if extras else mechanism


def write_gazebo_fragments(mechanism: Mechanism, _context: Context) -> Mechanism:
    """What formats with fragments of their own represent of the robot is in <gazebo> elements behind it."""
    own = mechanism.extras.get(ROOT, ())
    known = {extra.text for extra in own if extra.format == words.FORMAT}
    rows = [row for row in formats.FORMATS if row.fragments is not None]
    named = {name for row in rows for name in formats.loaded(row.fragment_sensors or "")(known)}
    found = [(row, text) for row in rows for text in formats.loaded(row.fragments or "")(mechanism) if text not in known]
    texts = [text for row, text in found if not named & formats.loaded(row.fragment_sensors or "")([text])]
    return _with_fragments(mechanism, texts)
