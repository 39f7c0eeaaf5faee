"""Odd texts in every attribute of URDF that holds numbers: decimal numbers are read, all else is reported once, at its place, and kept."""

from __future__ import annotations

import math
import re
from xml.sax.saxutils import quoteattr

import pytest
from msgspec import Struct

from hymeko_x.compare.diff import Tolerance, diff
from hymeko_x.diagnostics import Report
from tests.odd_numbers import ODD
from tests.urdf.samples import LIMIT, TWO_LINKS, dump, joint, load, robot, visual

LAST_BITS = Tolerance(absolute=2e-14)
"""A rotation that was not written as angles comes back so exactly."""

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


class Place(Struct, frozen=True):
    """An attribute that holds ``count`` numbers, and a robot that has it on its second line, as ``VALUE``."""

    attribute: str
    text: str
    count: int = 1
    version: str = "1.0"

    @property
    def id(self) -> str:
        return f"{self.attribute} of {re.findall('<([a-z_]+)[^<]*$', self.text.partition('VALUE')[0])[0]}"

    def filled(self, odd: str) -> tuple[str, str]:
        """The attribute's value with an odd number in front, and the robot that has it."""
        value = " ".join([odd, *["1"] * (self.count - 1)])
        text = self.text.replace('"VALUE"', quoteattr(value))
        return value, robot(text, f' name="r" version="{self.version}"')


def _in(link: str) -> str:
    return f'<link name="a">{link}</link>'


_MOVES = TWO_LINKS + joint(f"{LIMIT}INSIDE")
_LED = f'{TWO_LINKS}<link name="c"/>{joint(LIMIT)}{joint(LIMIT + "INSIDE", name="k", child="c")}'
_TENSOR = dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), '"0"')
_LIMITS = dict.fromkeys(("lower", "upper", "effort", "velocity", "acceleration", "jerk"), '"1"')
_SAFETY = dict.fromkeys(("k_velocity", "k_position", "soft_lower_limit", "soft_upper_limit"), '"1"')
_SPHERE = '<geometry><sphere radius="1"/></geometry>'


def _with_value(attributes: dict[str, str], name: str) -> str:
    return " ".join(f"{key}={value}" for key, value in {**attributes, name: '"VALUE"'}.items())


def _inertial(inside: str) -> str:
    mass, tensor = (
        "" if "<mass" in inside else '<mass value="1"/>',
        "" if "<inertia" in inside else f"<inertia {_with_value(_TENSOR, 'ixx')}/>",
    )
    return _in(f"<inertial>{inside}{mass}{tensor.replace('VALUE', '1')}</inertial>")


PLACES = (
    Place("value", _inertial('<mass value="VALUE"/>')),
    *(Place(name, _inertial(f"<inertia {_with_value(_TENSOR, name)}/>")) for name in _TENSOR),
    *(Place(name, _inertial(f'<origin {name}="VALUE"/>'), 3) for name in ("xyz", "rpy")),
    *(Place(name, visual(f'<origin {name}="VALUE"/>{_SPHERE}', tag), 3) for tag in ("visual", "collision") for name in ("xyz", "rpy")),
    Place("size", visual('<geometry><box size="VALUE"/></geometry>'), 3),
    Place("radius", visual('<geometry><sphere radius="VALUE"/></geometry>')),
    Place("radius", visual('<geometry><cylinder radius="VALUE" length="1"/></geometry>')),
    Place("length", visual('<geometry><cylinder radius="1" length="VALUE"/></geometry>')),
    Place("radius", visual('<geometry><capsule radius="VALUE" length="1"/></geometry>'), version="1.1"),
    Place("length", visual('<geometry><capsule radius="1" length="VALUE"/></geometry>'), version="1.1"),
    Place("scale", visual('<geometry><mesh filename="m.stl" scale="VALUE"/></geometry>', "collision"), 3),
    Place("rgba", visual(f'{_SPHERE}<material name="m"><color rgba="VALUE"/></material>'), 4),
    *(Place(name, _MOVES.replace("INSIDE", f'<origin {name}="VALUE"/>'), 3) for name in ("xyz", "rpy")),
    Place("quat_xyzw", _MOVES.replace("INSIDE", '<origin quat_xyzw="VALUE"/>'), 4, "1.1"),
    Place("xyz", _MOVES.replace("INSIDE", '<axis xyz="VALUE"/>'), 3),
    *(Place(name, TWO_LINKS + joint(f"<limit {_with_value(_LIMITS, name)}/>"), version="1.2") for name in _LIMITS),
    *(Place(name, _MOVES.replace("INSIDE", f'<dynamics {name}="VALUE"/>')) for name in ("damping", "friction")),
    *(Place(name, _MOVES.replace("INSIDE", f"<safety_controller {_with_value(_SAFETY, name)}/>")) for name in _SAFETY),
    *(Place(name, _MOVES.replace("INSIDE", f'<calibration {name}="VALUE"/>')) for name in ("rising", "falling", "reference_position")),
    *(Place(name, _LED.replace("INSIDE", f'<mimic joint="j" {name}="VALUE"/>')) for name in ("multiplier", "offset")),
)


def is_readable(value: str, count: int) -> bool:
    """Whether these are so many finite decimal numbers between blanks of XML, in every country."""
    words = re.split(r"[ \t\r\n]+", value.strip(" \t\r\n"))
    return len(words) == count and all(_NUMBER.fullmatch(word) and math.isfinite(float(word)) for word in words)


@pytest.mark.parametrize("place", PLACES, ids=lambda place: place.id)
@pytest.mark.unread("HX020", "HX028", "HX040")
def test_an_odd_number_is_read_or_reported_once_where_it_stands_and_kept(place: Place) -> None:
    wrong = []
    for odd in ODD:
        value, text = place.filled(odd)
        report = Report()
        mechanism = load(text, report)
        reported = [diagnostic for diagnostic in report if diagnostic.code.id == "HX020"]
        at = [diagnostic.origin for diagnostic in reported if diagnostic.origin is not None and diagnostic.origin.line == 2]
        if is_readable(value, place.count):
            wrong += [(odd, "is not read", str(line)) for line in reported]
        elif len(reported) != 1 or len(at) != 1 or f" {place.attribute}> is '{value[:50]}" not in str(reported[0]):
            wrong.append((odd, "is not reported once", *map(str, report)))
        elif f"{place.attribute}={quoteattr(value)}" not in dump(mechanism):
            wrong.append((odd, "is not kept", dump(mechanism)))
        if diff(mechanism, load(dump(mechanism)), LAST_BITS):
            wrong.append((odd, "does not come back", dump(mechanism)))
    assert wrong == []
