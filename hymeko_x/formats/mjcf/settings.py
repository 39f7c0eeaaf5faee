"""Attributes of the sections of MJCF that are kept verbatim, such as <option>: read and set in a mechanism."""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.parsers.expat import ExpatError

from msgspec.structs import replace

from hymeko_x.formats.mjcf import NAME
from hymeko_x.formats.mjcf.tree import parse_text, verbatim
from hymeko_x.ir.mechanism import ROOT, Extra

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Mechanism


def settings(mechanism: Mechanism, section: str) -> dict[str, str]:
    """The attributes of all sections of this name together; a later one wins."""
    found: dict[str, str] = {}
    for extra in mechanism.extras.get(ROOT, ()):
        if _is_section(extra, section):
            try:
                found |= parse_text(extra.text).attributes
            except ExpatError:
                continue
    return found


def with_settings(mechanism: Mechanism, section: str, attributes: Mapping[str, str]) -> Mechanism:
    """The mechanism with these attributes in the last section of this name, which is added where there is none."""
    own = mechanism.extras.get(ROOT, ())
    last = next((extra for extra in reversed(own) if _is_section(extra, section)), None)
    node = parse_text(f"<{section}/>" if last is None else last.text)
    node.attributes.update(attributes)
    place = 1 + max((extra.index for extra in own), default=len(mechanism.layout)) if last is None else last.index
    new = Extra(NAME, "", verbatim(node), place)
    changed = (*own, new) if last is None else tuple(new if extra is last else extra for extra in own)
    return replace(mechanism, extras={**mechanism.extras, ROOT: changed})


def _is_section(extra: Extra, section: str) -> bool:
    return extra.format == NAME and not extra.path and extra.text.startswith((f"<{section} ", f"<{section}>", f"<{section}/>"))
