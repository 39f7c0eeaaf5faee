"""Combinations of attributes and values that MuJoCo refuses, element by element.

Each rule takes an element and returns the complaint, or None. Kinds of values have been checked before.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x.formats.mjcf.tree import COMMENT

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.xml.tree import XmlNode

    Rule = Callable[[XmlNode], str | None]


def _numbers(element: XmlNode, name: str) -> list[float]:
    """The numbers of an attribute; none where it is not there. Whole ones come before spellings that only MuJoCo knows."""
    try:
        return [float(word) for word in element.attributes.get(name, "").split()]
    except ValueError:
        return []


def _less_than(least: float, *names: str) -> Rule:
    """A rule: none of these attributes is smaller."""

    def rule(element: XmlNode) -> str | None:
        bad = next((name for name in names if any(number < least for number in _numbers(element, name))), None)
        return None if bad is None else f"<{element.tag} {bad}> is '{element.attributes[bad]}', expected at least {least:g}"

    return rule


def _at_most(most: float, *names: str) -> Rule:
    """A rule: none of these attributes is greater."""

    def rule(element: XmlNode) -> str | None:
        bad = next((name for name in names if any(number > most for number in _numbers(element, name))), None)
        return None if bad is None else f"<{element.tag} {bad}> is '{element.attributes[bad]}', expected at most {most:g}"

    return rule


def _positive(*names: str) -> Rule:
    """A rule: these attributes are greater than zero."""

    def rule(element: XmlNode) -> str | None:
        bad = next((name for name in names if any(number <= 0.0 for number in _numbers(element, name))), None)
        return None if bad is None else f"<{element.tag} {bad}> is '{element.attributes[bad]}', expected more than 0"

    return rule


def _together(*names: str) -> Rule:
    """A rule: an element has all of these attributes or none."""

    def rule(element: XmlNode) -> str | None:
        missing = [name for name in names if name not in element.attributes]
        return None if len(missing) in (0, len(names)) else f"<{element.tag}> needs {' and '.join(names)} together"

    return rule


def _one_of(*names: str) -> Rule:
    """A rule: an element has one of these attributes."""

    def rule(element: XmlNode) -> str | None:
        return None if any(name in element.attributes for name in names) else f"<{element.tag}> needs {' or '.join(names)}"

    return rule


def _only_with(attribute: str, *names: str) -> Rule:
    """A rule: these attributes stand beside that one."""

    def rule(element: XmlNode) -> str | None:
        bad = next((name for name in names if name in element.attributes), None)
        alone = bad is not None and attribute not in element.attributes
        return f"<{element.tag}> has {bad}, which stands beside {attribute} only" if alone else None

    return rule


def _unique(*tags: str) -> Rule:
    """A rule: there is at most one of each of these elements inside, of all elements where none is named."""

    def rule(element: XmlNode) -> str | None:
        found = [
            child.tag for child in element.children if child.tag != COMMENT and (child.tag in tags if tags else child.tag != "default")
        ]
        bad = next((tag for tag in found if found.count(tag) > 1), None) if len(found) > len(set(found)) else None
        return None if bad is None else f"<{element.tag}> has more than one <{bad}>"

    return rule


def _eulerseq(element: XmlNode) -> str | None:
    text = element.attributes.get("eulerseq", "xyz")
    good = len(text) == 3 and set(text) <= set("xyzXYZ")
    return None if good else f"<compiler eulerseq> is '{text}', expected three letters of x, y, z, X, Y, Z"


def _frame_scale(element: XmlNode) -> str | None:
    scale = _numbers(element, "scale")
    if len(set(scale)) > 1 and element.attributes.get("scaling") != "geometry":
        return '<frame scale> has different factors, which needs scaling="geometry"'
    return None


def _rows_and_columns(element: XmlNode) -> tuple[int, int]:
    return int(element.attributes.get("nrow", "0")), int(element.attributes.get("ncol", "0"))


def _hfield(element: XmlNode) -> str | None:
    rows, columns = _rows_and_columns(element)
    heights = element.attributes.get("elevation", "").split()
    if "file" not in element.attributes and (rows < 2 or columns < 2):
        return f"<hfield> has {rows} rows and {columns} columns, expected at least 2 of each"
    if heights and len(heights) != rows * columns:
        return f"<hfield elevation> has {len(heights)} numbers, expected {rows * columns}"
    return None


def _contact_size(element: XmlNode) -> str | None:
    text = element.attributes.get("condim", "3")
    return None if int(text) in (1, 3, 4, 6) else f"<{element.tag} condim> is '{text}', expected 1, 3, 4 or 6"


def _layers(element: XmlNode) -> str | None:
    layers = [child for child in element.children if child.tag == "layer"]
    if layers and "texture" in element.attributes:
        return "<material> has a texture and layers, of which it may have one"
    bad = next((role for layer in layers if (role := layer.attributes.get("role", "")) not in _ROLES), None)
    return None if bad is None else f"<layer role> is '{bad}', expected one of {', '.join(_ROLES)}"


_ROLES = ("rgb", "occlusion", "roughness", "metallic", "opacity", "emissive", "normal", "orm", "rgba", "user")


def _numeric(element: XmlNode) -> str | None:
    room, count = int(element.attributes.get("size", "-1")), len(element.attributes.get("data", "").split())
    if "size" in element.attributes and room < 1:
        return f"<numeric size> is '{room}', expected more than 0"
    if room < 0 and not count:
        return "<numeric> needs data or a size"
    return None if room < 0 or count <= room else f"<numeric data> has {count} numbers, and room for {room}"


def _filled(element: XmlNode) -> str | None:
    return None if element.attributes.get("data") else "<text> needs data that is not empty"


def _inhabited(element: XmlNode) -> str | None:
    return None if any(child.tag == "element" for child in element.children) else "<tuple> is empty"


def _gains(element: XmlNode) -> str | None:
    both = "kv" in element.attributes and "dampratio" in element.attributes
    return f"<{element.tag}> has kv and dampratio, of which it may have one" if both else None


def _springdamper(element: XmlNode) -> str | None:
    found = _numbers(element, "springdamper")
    bad = any(found) and min(found) <= 0.0
    return f"<joint springdamper> is '{element.attributes['springdamper']}', expected two numbers more than 0" if bad else None


def _springlength(element: XmlNode) -> str | None:
    found = _numbers(element, "springlength")
    bad = len(found) == 2 and found[0] > found[1]
    return f"<{element.tag} springlength> is '{element.attributes['springlength']}', expected the lower number first" if bad else None


def _skin(element: XmlNode) -> str | None:
    points = len(element.attributes.get("vertex", "").split()) // 3
    faces = _numbers(element, "face")
    bad = "file" not in element.attributes and bool(faces) and not (min(faces) >= 0.0 and max(faces) < points)
    return f"<skin face> refers to a point that is not there; there are {points}" if bad else None


_DIMENSIONS = MappingProxyType({"axis": "3", "quaternion": "4"})


def _datatype(element: XmlNode) -> str | None:
    kind = element.attributes.get("datatype", "")
    wanted = _DIMENSIONS.get(kind)
    good = wanted is None or element.attributes.get("dim") == wanted
    return None if good else f"<user datatype> is '{kind}', which needs dim=\"{wanted}\""


def _attached(element: XmlNode) -> str | None:
    sites, bodies = ("site1" in element.attributes, "site2" in element.attributes), "body1" in element.attributes
    if all(sites) or (bodies and (element.tag == "weld" or "anchor" in element.attributes)):
        return None
    return f"<{element.tag}> needs site1 and site2, or body1{' and anchor' if element.tag == 'connect' else ''}"


def _hull(element: XmlNode) -> str | None:
    text = element.attributes.get("maxhullvert", "-1")
    return None if int(text) < 0 or int(text) > 3 else f"<mesh maxhullvert> is '{text}', expected more than 3"


def _direct_current(element: XmlNode) -> str | None:
    """What no class can make up for: a constant or resistance of zero that no nominal values give, half of a thermal model."""
    constants, resistance, thermal = (_numbers(element, name) for name in ("motorconst", "resistance", "thermal"))
    own = element.attributes
    if constants and "nominal" not in own and not any(number > 0.0 for number in constants):
        return f"<dcmotor motorconst> is '{own['motorconst']}', expected more than 0"
    if resistance and "nominal" not in own and resistance[0] <= 0.0:
        return f"<dcmotor resistance> is '{own['resistance']}', expected more than 0"
    both = thermal[:2]
    half = len(both) == 2 and max(both) > 0.0 and min(both) <= 0.0
    return f"<dcmotor thermal> is '{own['thermal']}', expected two numbers more than 0 first" if half else None


_NOT_NEGATIVE = _less_than(0.0, "cutoff", "noise")
_COUNTS = tuple(f"nuser_{kind}" for kind in ("body", "jnt", "geom", "site", "cam", "tendon", "actuator", "sensor"))
_TRANSMITS = (_only_with("site", "refsite"), _only_with("cranksite", "slidersite", "cranklength"))

_DAMPED = (_gains, _less_than(0.0, "kv", "dampratio"))
_DRIVES: Mapping[str, tuple[Rule, ...]] = MappingProxyType(
    {
        "position": (*_DAMPED, _less_than(0.0, "timeconst")),
        "intvelocity": _DAMPED,
        "orientation": _DAMPED,
        "pid": (*_DAMPED, _less_than(0.0, "slewmax")),
        "damper": (_less_than(0.0, "kv", "ctrlrange"),),
        "adhesion": (_less_than(0.0, "gain", "ctrlrange"),),
        "muscle": (_less_than(0.0, "tausmooth"),),
        "dcmotor": (_less_than(0.0, "motorconst", "resistance", "inductance"), _direct_current),
    }
)
"""Of actuators and of their classes."""

_RULES: Mapping[str, tuple[Rule, ...]] = MappingProxyType(
    {
        "compiler": (_eulerseq,),
        "size": (_less_than(-1.0, *_COUNTS, "njmax", "nconmax", "nstack"),),
        "option": (_less_than(0.0, "actuatorgroupdisable"),),
        "statistic": (_positive("extent"),),
        "default": (_unique(),),
        "body": (_unique("inertial", "freejoint"),),
        "body/frame": (_positive("scale"), _less_than(0.0, "massscale"), _frame_scale),
        "body/joint": (_springdamper,),
        "body/geom": (_contact_size,),
        "contact/pair": (_contact_size,),
        "visual/global": (_positive("realtime"),),
        "visual/map": (_positive("znear"),),
        "asset/mesh": (_hull,),
        "default/mesh": (_hull,),
        "asset/hfield": (_hfield, _positive("size")),
        "asset/material": (_one_of("name"), _layers),
        "custom/numeric": (_numeric,),
        "custom/text": (_filled,),
        "custom/tuple": (_inhabited,),
        "asset/skin": (_skin,),
        "deformable/skin": (_skin,),
        "equality/connect": (_attached,),
        "equality/weld": (_attached,),
        "tendon/fixed": (_less_than(0.0, "armature"), _springlength),
        "tendon/spatial": (_less_than(0.0, "armature"), _springlength),
        "tendon/spatial/pulley": (_positive("divisor"),),
        **{f"{place}/{tag}": rules for place in ("actuator", "default") for tag, rules in _DRIVES.items()},
        "sensor/contact": (_positive("num"),),
        "sensor/user": (_datatype, _together("objtype", "objname")),
        **dict.fromkeys(("sensor/distance", "sensor/normal", "sensor/fromto"), (_one_of("geom1", "body1"), _one_of("geom2", "body2"))),
    }
)


_MOST_COUNTED = 10_000
"""Numbers of user data for each element, and keyframes."""
_MOST_STEPS = 1_000
"""Steps of a built-in mesh in one direction: of a million points MuJoCo computes the hull for 20 s."""
_MOST_HEIGHTS = 100_000_000


def _grid(element: XmlNode) -> str | None:
    rows, columns = _rows_and_columns(element)
    if rows * columns <= _MOST_HEIGHTS:
        return None
    return f"<hfield> has {rows} rows and {columns} columns, expected at most {_MOST_HEIGHTS} heights"


_LIMITS: Mapping[str, tuple[Rule, ...]] = MappingProxyType(
    {
        "size": (_at_most(_MOST_COUNTED, *_COUNTS, "nkey"),),
        "asset/mesh": (_at_most(_MOST_STEPS, "params"),),
        "asset/hfield": (_grid,),
    }
)
"""Counts for which MuJoCo has no limit: with a few letters a file would make it fill the memory, or compute for hours."""


def complaint(element: XmlNode, rules: tuple[Rule, ...]) -> str | None:
    """What MuJoCo would refuse in this element by these rules; None when it is fine."""
    for rule in rules:
        found = rule(element)
        if found is not None:
            return found
    return None


def rules_of(path: str) -> tuple[Rule, ...]:
    """The rules for the elements of this place of the schema."""
    rules = _RULES.get(path, ())
    if path.startswith("sensor/"):
        return (*rules, _NOT_NEGATIVE, *((_together("reftype", "refname"),) if path.startswith("sensor/frame") else ()))
    return (*rules, *_TRANSMITS) if path.startswith("actuator/") else rules


def limits_of(path: str) -> tuple[Rule, ...]:
    """The limits of counts for the elements of this place of the schema, which are ours and not MuJoCo's."""
    return _LIMITS.get(path, ())
