"""Names of stereotypes: what their elements are by their own names, and on which side; else their type, and what they give."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING

from hymeko_x.factor.words import common_words, limb, meaning, side, telling_words
from hymeko_x.ir.digits import number_text
from hymeko_x.language.syntax import ArcItem, Field, Ref, is_list

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from hymeko_x.backends.hymeko.elements import PrintedElement, Unit
    from hymeko_x.language.syntax import Node, Value

_TYPES = {
    "visual": "visual",
    "collision": "collision",
    "shape": "solid",
    "@": "axle",
    "": "part",
    "motor": "drive",
    "servo": "drive",
    "actuator": "drive",
    "material": "paint",
    "frame": "mark",
    "sensor": "probe",
    "tendon": "cable",
    "texture": "image",
    "prismatic": "slider",
    "fixed": "mount",
    "dof": "turn",
}
"""What a stereotype is called, alone or behind other words, by the type of its elements."""
_BEHIND = {"": "body", "@": "axis", "visual": "look", "collision": "hull"}
"""What stands behind other words instead, where that is shorter or not the word of a kind."""
_TELLING = {"inertia [1 1 1]": "unit_inertia", "mode=trackcom": "tracking_camera"}
"""Names for what a stereotype gives alone."""
_GLOSS = frozenset(("specular", "shininess", "reflectance"))
_SOLIDS = ("box", "sphere", "cylinder", "capsule", "ellipsoid")
_EFFORTS = ("effort", "forcerange", "ctrlrange", "gainprm", "kp")
_ROTATIONS = {"X": "roll", "Y": "pitch", "Z": "yaw"}
_GIVING = {"limit": "limited", "axis": "tilted", "scale": "scaled", "rgba": "painted", "damping": "damped", "min": "limited"}
"""What stands before the name of a stereotype that another one has, by a field that it gives."""
_SHORT = 12
"""Letters of a name that is not too long to be used many times."""
_INTERFACE = re.compile(r"([A-Z][a-z]+)(?:Joint|Actuator)?Interface")
"""Of the controllers of ROS 1: ``hardware_interface/PositionJointInterface``."""
_WORD = re.compile(r"[A-Za-z]\w{1,23}")
"""Words that make a good name."""


def names(kind: str, units: Sequence[Unit], members: Sequence[PrintedElement]) -> Iterator[str]:
    """Names for a stereotype with these units, the best first. The last one may have a number behind it."""
    given = {unit.slot: name for unit in units if isinstance(unit.item, Field) and (name := _word(unit.item.value))}
    plain = _TYPES.get(kind, f"{kind}_kind" if kind.isidentifier() else "kind")
    behind = _BEHIND.get(kind, plain.removesuffix("_kind"))
    found = [given.get("class", ""), given.get("reason", "").lower()]
    texts = [unit.text for unit in units]
    if len(units) == 1:
        found += [given.get("material", ""), given.get("mesh", ""), f"{given['material']}_{behind}" if "material" in given else ""]
    is_inside = len(members[0].path) > 1
    found += _by_mesh(given.get("mesh", ""), members, behind)
    found += _by_owners(members, behind, is_inside=is_inside, sides=kind != "dof")
    found += [given.get("material", ""), given.get("mesh", ""), *(name for text, name in _TELLING.items() if [text] == texts)]
    found += ["glossy"] if kind == "material" and {unit.slot for unit in units} <= _GLOSS else []
    yield from _by_place(units, members, behind)
    yield from sorted(filter(_WORD.fullmatch, found), key=lambda name: len(name) > _SHORT)
    yield plain
    if not is_inside or kind == "dof":
        yield from filter(_WORD.fullmatch, _by_values(units, plain))
        last = plain
    else:
        yield from filter(_WORD.fullmatch, _by_form(units, members, behind))
        last = next(filter(_WORD.fullmatch, [f"{meaning([member.owner for member in members])}_{behind}"]), plain)
    yield last
    interface = _INTERFACE.search(given.get("hardwareInterface", ""))
    yield from [f"{interface[1].lower()}_{last}"] if interface else []
    yield from filter(_WORD.fullmatch, [f"{_GIVING[unit.slot]}_{last}" for unit in units if unit.slot in _GIVING][:1])
    yield last


def _by_form(units: Sequence[Unit], members: Sequence[PrintedElement], behind: str) -> Iterator[str]:
    """Names of shapes whose bodies have given theirs to others: by their form, ``down_capsule``, or by the only body that has them."""
    own = meaning([member.owner for member in members])
    form = next((word for unit in units if (word := unit.text.partition(" ")[0]) in _SOLIDS), "")
    if form:
        yield f"{own}_{form}" if own else f"{form}_{behind}"
    if len({(member.home, member.owner) for member in members}) == 1:
        yield f"{members[0].owner}_{behind}"


def _by_owners(members: Sequence[PrintedElement], behind: str, *, is_inside: bool, sides: bool) -> Iterator[str]:
    """Names from those of the elements, of shapes those of their bodies: what all of them share, or most."""
    owners = [member.owner for member in members]
    own = meaning(owners)
    where = side(f"{member.home}_{member.owner}" for member in members) if sides else ""
    if not is_inside:
        yield common_words(owners)
    yield own
    if own:
        yield from ([f"{where}_{own}"] if where else [])
        yield f"{own}_{behind}"
        yield from ([f"{where}_{own}_{behind}"] if where else [])
    else:
        around = meaning(_ends(members)) or _by_assembly(members)
        if around and behind == _BEHIND["@"]:
            yield f"{around}_joint"
        if around and (behind != _BEHIND["@"] or len(f"{around}_joint") <= _SHORT):  # a shorter name would come first
            yield f"{around}_{behind}"
    counts = Counter(word for owner in owners for word in dict.fromkeys(telling_words(owner)))
    most = max(counts, key=lambda word: counts[word], default="")
    if 2 * counts[most] > len(owners):
        yield from (most, f"{most}_{behind}")


def _by_assembly(members: Sequence[PrintedElement]) -> str:
    """What elements are a part of, by their names with those of their assemblies: ``wrist``, ``finger``, ``leg``; empty for none."""
    full = [f"{member.home}_{member.owner}" for member in members]
    return meaning(full) or limb(full)


def _ends(members: Sequence[PrintedElement]) -> list[str]:
    """The bodies to which joints lead, or on which frames are, that are called by number or by their side."""
    if any(telling_words(member.owner) for member in members):
        return [""]
    return [_end(member.node) for member in members]


def _end(node: Node) -> str:
    """The body to which the arc of a joint leads, or from which that of a frame comes; empty for none."""
    arcs = [item.ref for item in node.items if isinstance(item, ArcItem)]
    return next((ref.path[-1] for ref in arcs if ref.direction == ("-" if node.edge else "+")), "")


def _by_mesh(mesh: str, members: Sequence[PrintedElement], behind: str) -> Iterator[str]:
    """A name from a mesh that is another thing than the bodies: ``foot_look`` of the mesh ``foot`` at each calf."""
    words = telling_words(mesh)
    if words and not any(set(words) & set(telling_words(member.owner)) for member in members):
        yield f"{'_'.join(words)}_{behind}"


def _by_place(units: Sequence[Unit], members: Sequence[PrintedElement], behind: str) -> Iterator[str]:
    """A name from the side to which shapes are moved, along y, where their bodies have no side: ``left_hip_look``."""
    own = meaning([member.owner for member in members])
    if any(side([f"{member.home}_{member.owner}"]) for member in members):
        return
    value = units[0].item.value if own and units[0].slot == "at" and isinstance(units[0].item, Field) else None
    place = value[0] if is_list(value) and is_list(value[0]) else value
    if is_list(place) and len(place) == 3 and isinstance(place[1], float) and place[0] == place[2] == 0.0 != place[1]:
        yield f"{'left' if place[1] > 0.0 else 'right'}_{own}_{behind}"


def _by_values(units: Iterable[Unit], plain: str) -> Iterator[str]:
    """Names from what moves: the greatest effort, or the axis."""
    values = {unit.slot: unit.item.value for unit in units if isinstance(unit.item, Field)}
    for slot in _EFFORTS:
        most = _greatest(values.get(slot))
        if most is not None and most == int(most):
            yield f"{plain}_{number_text(most)}"
    axis = values.get("axis")
    if isinstance(axis, Ref):
        yield _ROTATIONS.get(axis.path[-1], "")


def _greatest(value: Value | None) -> float | None:
    """The number, or that of a range about zero."""
    if is_list(value) and len(value) == 2 and isinstance(value[0], float) and isinstance(value[1], float) and value[0] == -value[1]:
        return value[1]
    return value if isinstance(value, float) else None


def _word(value: object) -> str:
    """The name that a field gives: a word or a text; empty for another value."""
    if isinstance(value, Ref):
        return value.path[-1]
    return value if isinstance(value, str) else ""
