"""The same robot written otherwise in URDF and in xacro: order, digits, blanks, defaults, angles, expressions."""

from __future__ import annotations

import math
from random import Random

from lxml import etree

from hymeko_x.ir.values import quat_from_rpy
from tests.notations.numbers import apart, digits, joined, numbers

NUMERIC = frozenset(
    (
        *("xyz", "rpy", "quat_xyzw", "value", "ixx", "ixy", "ixz", "iyy", "iyz", "izz", "size", "radius", "length"),
        *("lower", "upper", "effort", "velocity", "damping", "friction", "multiplier", "offset"),
    )
)
XACRO = "http://www.ros.org/wiki/xacro"


def otherwise(text: bytes, chance: Random, *, quaternions: bool = False) -> bytes:
    """Another text of the same robot; ``quaternions`` are those of URDF 1.1, which not every reader knows."""
    root = etree.fromstring(text)
    if quaternions:
        root.set("version", "1.1")
    for element in list(root.iter("origin")):
        _turn(element, chance, quaternions)
    for element in root.iter("visual", "collision", "joint", "inertial"):
        if element.find("origin") is None and chance.random() < 0.5:
            element.append(etree.Element("origin", rpy="0 0 0"))
    for element in list(root.iter("*")):
        _spell(element, numbers, chance)
        shuffled(element, chance)
    return bytes(etree.tostring(root, encoding=chance.choice(["utf-8", "ascii"])))


def _turn(origin: etree._Element, chance: Random, with_quaternions: bool) -> None:
    """The same rotation in other angles, or as a quaternion."""
    roll, pitch, yaw = map(float, origin.get("rpy", "0 0 0").split())
    way = chance.choice(["as it is", "other angles", "more turns", "quaternion" if with_quaternions else "as it is"])
    if way == "other angles":
        origin.set("rpy", joined((roll + math.pi, math.pi - pitch, yaw - math.pi)))
    elif way == "more turns":
        origin.set("rpy", joined((roll + 2 * math.pi, pitch, yaw - 4 * math.pi)))
    elif way == "quaternion":
        w, x, y, z = quat_from_rpy((roll, pitch, yaw))
        factor = chance.choice([1.0, -1.0, 2.5])
        origin.attrib.pop("rpy", None)
        origin.set("quat_xyzw", joined((factor * x, factor * y, factor * z, factor * w)))


def _spell(element: etree._Element, spell: object, chance: Random) -> None:
    for name, value in element.attrib.items():
        if name in NUMERIC:
            element.set(name, spell(value, chance))  # type: ignore[operator]


def shuffled(element: etree._Element, chance: Random, kept: frozenset[str] = frozenset()) -> None:
    """Attributes and children in another order, with comments and blanks in between; children of ``kept`` stay in theirs."""
    attributes = list(element.attrib.items())
    chance.shuffle(attributes)
    element.attrib.clear()
    element.attrib.update(attributes)
    if element.tag in kept:
        return
    children = list(element)
    chance.shuffle(children)
    for child in children:
        child.tail = chance.choice(["", "\n", " \t"])
    element[:] = children
    if chance.random() < 0.1:
        element.append(etree.Comment(" a comment "))


# ---- xacro --------------------------------------------------------------------------------------------------------------------


def as_xacro(text: bytes, chance: Random) -> bytes:
    """A xacro file that expands to the same robot: expressions, properties, conditions, a macro."""
    old = etree.fromstring(text)
    root = etree.Element("robot", dict(old.attrib), nsmap={"xacro": XACRO})
    root[:] = list(old)
    properties: dict[str, str] = {}

    def expressed(value: str, chance: Random) -> str:
        return apart([_expression(word, properties, chance) for word in value.split()], chance)

    for element in list(root.iter("*")):
        if chance.random() < 0.7:
            _spell(element, expressed, chance)
        shuffled(element, chance)
    for child in [child for child in root if isinstance(child.tag, str)]:
        _wrap(child, chance)
    for name, value in properties.items():
        root.insert(0, etree.Element(f"{{{XACRO}}}property", name=name, value=value))
    return bytes(etree.tostring(root, encoding="utf-8"))


def _expression(word: str, properties: dict[str, str], chance: Random) -> str:
    value = float(word)
    name = f"p{len(properties)}"
    match chance.choice(["plain", "number", "twice", "sum", "property", "expression"]):
        case "number":
            return f"${{{value!r}}}"
        case "twice":
            return f"${{2*({value / 2!r})}}"
        case "sum":
            return f"${{{value!r} + 0}}"
        case "property":
            properties[name] = digits(word, chance)
        case "expression":
            properties[name] = f"${{-({-value!r})}}"
        case _:
            return word
    return f"${{{name}}}"


def _wrap(element: etree._Element, chance: Random) -> None:
    """Put an element under a condition that holds."""
    if chance.random() < 0.3:
        tag, value = chance.choice([("if", "true"), ("if", "${1 < 2}"), ("unless", "0"), ("unless", "${[] != []}")])
        condition = etree.Element(f"{{{XACRO}}}{tag}", value=value)
        parent = element.getparent()
        assert parent is not None
        parent.replace(element, condition)
        condition.append(element)
