"""Extras of MJCF in a robot of another size: margins, gaps, widths of impedances, height fields and the like by their dimension."""

from __future__ import annotations

import re
from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.formats.mjcf import NAME
from hymeko_x.formats.mjcf.tree import parse_text, verbatim
from hymeko_x.ir.digits import number_text
from hymeko_x.ir.mechanism import ROOT

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.ir.mechanism import Extra, Id, Mechanism
    from hymeko_x.xml.tree import XmlNode

LENGTHS = frozenset({"margin", "gap", "solimp", "solimplimit"})
"""What is measured as the constraint is; of an impedance the third number, its width."""
_POWERS: Mapping[str, Mapping[str, int]] = MappingProxyType(
    {
        "hfield": {"size": 1},
        "skin": {"vertex": 1, "inflate": 1},
        "bone": {"bindpos": 1},
        "statistic": {"extent": 1, "center": 1, "meansize": 1, "meanmass": 3, "meaninertia": 5},
        "compiler": {"settotalmass": 3, "boundmass": 3, "boundinertia": 5},
        **{tag: dict.fromkeys(sorted(LENGTHS), 1) for tag in ("geom", "pair")},
    }
)
"""By element of the whole, and of default classes, the powers of the factor."""
_SIGNED = frozenset({"vertex", "bindpos", "center"})
"""Coordinates, which may be negative."""
_OF_OTHERS = ("joint", "tendon", "equality")
"""Elements of default classes whose widths may be angles of one element and lengths of another one."""
_ATTRIBUTE = re.compile(r"(?:joint\[(\d+)\]/)?@(\w+)")


def resized(mechanism: Mechanism, s: float, factor: Callable[[Id, int], float]) -> Mechanism | None:
    """The mechanism with extras for lengths times ``s``; ``factor(element, dof)`` is that on what a joint or a coupling measures.

    None where default classes give joints, tendons or equalities such values, which have to be written out first.
    """
    extras: dict[Id, tuple[Extra, ...]] = {}
    for key, found in mechanism.extras.items():
        if key == ROOT:
            whole = [parse_text(extra.text) if extra.format == NAME and extra.text.startswith("<") else None for extra in found]
            if any(_is_ambiguous(node) for node in whole if node is not None):
                return None
            extras[key] = tuple([_whole(extra, node, s) for extra, node in zip(found, whole, strict=True)])
        else:
            extras[key] = tuple([_of_element(extra, key, factor) for extra in found])
    return replace(mechanism, extras=extras)


def _is_ambiguous(root: XmlNode) -> bool:
    return root.tag == "default" and any(node.tag in _OF_OTHERS and LENGTHS & node.attributes.keys() for node in root.walk())


def _whole(extra: Extra, root: XmlNode | None, s: float) -> Extra:
    """An element of the whole; what has no length stays as it is written."""
    changed = False
    for node in () if root is None else root.walk():
        for name, power in _POWERS.get(node.tag, {}).items():
            if name in node.attributes:
                node.attributes[name] = _times(name, node.attributes[name], s**power)
                changed = True
    return replace(extra, text=verbatim(root)) if root is not None and changed else extra


def _of_element(extra: Extra, key: Id, factor: Callable[[Id, int], float]) -> Extra:
    found = _ATTRIBUTE.fullmatch(extra.path) if extra.format == NAME else None
    if found is None or found[2] not in LENGTHS:
        return extra
    return replace(extra, text=_times(found[2], extra.text, factor(key, int(found[1] or 1) - 1)))


def _times(name: str, text: str, factor: float) -> str:
    """The numbers times the factor; of what has no sign, -1 means that MuJoCo computes it."""
    words = text.split()
    places = range(2, 3) if name.startswith("solimp") else range(len(words))
    for place in places:
        if place < len(words) and (float(words[place]) >= 0 or name in _SIGNED) and factor != 1.0:
            words[place] = number_text(float(words[place]) * factor)
    return " ".join(words)
