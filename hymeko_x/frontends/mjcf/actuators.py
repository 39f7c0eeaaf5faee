"""<actuator>: what drives, and what it acts on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf.codec import parameter_text
from hymeko_x.formats.mjcf.words import LAW, LIMITED, RESOLVED, TRANSMISSIONS, UNBOUNDED, is_range
from hymeko_x.frontends.mjcf.mounts import take_parameters
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.parts import Actuator, Drive
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.frontends.mjcf.builder import MjcfBuilder
    from hymeko_x.ir.mechanism import RobotArc
    from hymeko_x.ir.parts import Parameters
    from hymeko_x.xml.tree import XmlNode

_KINDS = {"jointinparent": "joint", "cranksite": "site", "slidersite": "site", "refsite": "site"}
_ROLES = {"cranksite": "crank", "slidersite": "slider", "refsite": "reference"}


def read_actuators(sections: list[XmlNode], builder: MjcfBuilder) -> None:
    """Actuators in order, each with the edge to what it acts on."""
    for section in sections:
        for element in section.children:
            if element.tag.startswith("#"):
                builder.keep_at_root(element, "actuator")
            else:
                _read_actuator(element, builder)


def _read_actuator(element: XmlNode, builder: MjcfBuilder) -> None:
    target = next((element.attributes[word] for word in TRANSMISSIONS if word in element.attributes), "")
    key = builder.own(element, "actuator", f"{target}_{element.tag}")
    tag = element.tag if element.tag != "plugin" else "general"
    base = builder.base(element, key, tag=tag)
    gear = element.take("gear")
    arcs: list[RobotArc] = [Arc(key, 1)]
    words = [word for word in TRANSMISSIONS if word in element.attributes]
    _check(element, {**base, **element.attributes}, words, builder)
    weight = read_numbers(gear or base.get("gear", "")) or None
    for word in words:
        arcs.append(_arc(element, word, weight if word == words[0] else None, builder))
    if not words and gear is not None:
        element.attributes["gear"] = gear
    kind = "jointinparent" if "jointinparent" in words else ""
    given = take_parameters(element, base, RESOLVED, LAW)
    builder.vertices[key] = Actuator(element.tag, _own(given, base, autolimits=builder.settings.autolimits))
    builder.keep(element, key)
    builder.show(key)
    if words:
        drive = builder.names.take("drive", key.name)
        builder.edges[drive] = Edge(Drive(kind), tuple(arcs))
        builder.show(drive)


def _own(parameters: Parameters, base: Mapping[str, str], *, autolimits: bool) -> Parameters:
    """The parameters but for those that only take a limit of the class away, or say that a range applies where one has to say so."""
    given = dict(parameters)
    taken = {name for name, value in given.items() if name in base and parameter_text(value) == UNBOUNDED.get(name) != base[name]}
    if not autolimits:
        taken |= {flag for flag, span in LIMITED.items() if given.get(flag) == "true" and is_range(given.get(span))}
    return tuple(pair for pair in parameters if pair[0] not in taken) if taken else parameters


def _check(element: XmlNode, attributes: dict[str, str], words: list[str], builder: MjcfBuilder) -> None:
    """What MuJoCo refuses."""
    if not words:
        raise refuse(codes.MISSING_ATTRIBUTE, f"<{element.tag}> acts on nothing: it needs {', '.join(TRANSMISSIONS[:6])}", element.origin)
    if "cranksite" in words and "slidersite" not in words:
        raise refuse(codes.MISSING_ATTRIBUTE, f"<{element.tag} cranksite> needs slidersite", element.origin)
    for word in ("ctrl", "force"):
        flag, numbers = attributes.get(f"{word}limited", "auto"), read_numbers(attributes.get(f"{word}range", "")) or (0.0, 0.0)
        forced = word == "ctrl" and element.tag in ("adhesion", "damper")
        if flag == "auto" and any(numbers) and not (builder.settings.autolimits or forced):
            raise refuse(
                codes.BAD_NUMBER,
                f"<{element.tag}> has {word}range but not {word}limited, and <compiler autolimits> is false",
                element.origin,
            )
        if (flag == "true" or forced) and not numbers[0] < numbers[-1] and not attributes.get("inheritrange"):
            raise refuse(
                codes.BAD_NUMBER,
                f"<{element.tag} {word}range> is '{attributes.get(f'{word}range', '')}', expected a lower and a greater number",
                element.origin,
            )


def _arc(element: XmlNode, word: str, gear: tuple[float, ...] | None, builder: MjcfBuilder) -> RobotArc:
    name = element.take(word) or ""
    target = builder.find(element, _KINDS.get(word, word), name)
    role = _ROLES.get(word) or (builder.roles.get(target, {}).get(name, "") if target.kind == "joint" else "")
    return Arc(target, -1, gear, role)
