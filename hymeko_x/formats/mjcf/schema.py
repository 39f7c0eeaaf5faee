"""The elements and attributes of MJCF, with what they may hold: schema.json, which is generated from MuJoCo itself.

`python -m tests.mjcf.make_schema` writes the file anew; only what MuJoCo does not print stands here: what earlier versions had, and which
attributes exclude each other.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec import Struct, json

if TYPE_CHECKING:
    from collections.abc import Mapping

_ANY = 10**9


class AttributeKind(Struct, frozen=True):
    """What an attribute may hold: ``least`` to ``most`` numbers (``whole`` or not), or one of ``words`` (``several``: some of them)."""

    least: int = 0
    most: int = 0
    whole: bool = False
    words: frozenset[str] = frozenset()
    several: bool = False

    def __str__(self) -> str:
        if self.words:
            return f"{'some' if self.several else 'one'} of {', '.join(sorted(self.words))}"
        count = "" if self.most == _ANY else f"{self.least} " if self.least == self.most else f"{self.least} to {self.most} "
        return f"{count}{'whole ' if self.whole else ''}number{'s' if self.most > 1 else ''}"


class Schema(Struct, frozen=True):
    """What schema.json holds, by an element's place, such as ``body/joint``.

    ``elements``: the kind of every attribute, as text; ``required``: the attributes that an element must have; ``filled``: the numbers that
    may not be empty, while MuJoCo takes all other empty ones for missing.
    """

    mujoco: str
    elements: dict[str, dict[str, str]]
    required: dict[str, tuple[str, ...]]
    filled: dict[str, tuple[str, ...]]


@lru_cache(1)
def schema() -> Schema:
    """The schema, read when it is first needed."""
    return json.decode(Path(__file__).with_name("schema.json").read_bytes(), type=Schema)


@lru_cache(512)
def kinds_of(path: str) -> Mapping[str, AttributeKind]:
    """The kinds of the attributes of the element of this place; those that are texts are not in it."""
    found = ((name, _kind(text)) for name, text in schema().elements.get(path, {}).items() if text != "text")
    return MappingProxyType(dict(found))


@lru_cache(512)
def _kind(text: str) -> AttributeKind:
    """``a|b``: one of these words; ``*a|b``: some of them; ``3``: three numbers; ``1-3``: one to three; ``n``: any; ``int 2``: whole."""
    if "|" in text:
        return AttributeKind(words=frozenset(text.removeprefix("*").split("|")), several=text[0] == "*")
    whole, text = text.startswith("int "), text.removeprefix("int ")
    if text == "n":
        return AttributeKind(0, _ANY, whole)
    least, _, most = text.partition("-")
    return AttributeKind(int(least), int(most or least), whole)


@lru_cache(512)
def attributes_of(path: str) -> frozenset[str]:
    """The attributes of the element of this place."""
    return frozenset(schema().elements.get(path, ()))


_BODY_LIKE = ("body", "worldbody", "body/frame", "body/replicate")


@lru_cache(1)
def children() -> Mapping[str, Mapping[str, str]]:
    """For each element, by its place, the elements inside it with their places."""
    elements = schema().elements
    found: dict[str, dict[str, str]] = {path: {} for path in (*elements, "worldbody")}
    for path in elements:
        parent, _, tag = path.rpartition("/")
        if path != "mujoco":
            found[parent or "mujoco"][tag] = path
    found["default"]["default"] = "default"
    for path in _BODY_LIKE:
        content = {tag: below for tag, below in found["body"].items() if path in ("body", "body/frame") or tag != "inertial"}
        found[path] = {**content, "body": "body", "frame": "body/frame", "replicate": "body/replicate"}
    found["mujoco"]["worldbody"] = "worldbody"
    return MappingProxyType(found)


_DISTANCES = (("geom1", "body1"), ("geom2", "body2"))
_CLOSURES = (("site1", "body1"), ("site1", "body2"), ("site1", "anchor"))
EXCLUSIVE: Mapping[str, tuple[tuple[str, ...], ...]] = MappingProxyType(
    {
        **dict.fromkeys(("sensor/distance", "sensor/normal", "sensor/fromto"), _DISTANCES),
        **dict.fromkeys(("equality/connect", "equality/weld"), _CLOSURES),
        "sensor/contact": (("geom1", "body1", "subtree1", "site"), ("geom2", "body2", "subtree2")),
        "sensor/rangefinder": (("site", "camera"),),
        "body/inertial": (("fullinertia", "diaginertia"),),
    }
)
"""The attributes of which an element may have one, by its place."""

REMOVED: Mapping[str, str] = MappingProxyType(
    {
        "composite": "<composite> was removed in MuJoCo 4.0: use <flexcomp> for cables, grids and cloth, <replicate> for rows of bodies",
        "equality/flexvert": "<flexvert> was removed in MuJoCo 4.0: use <flex>, or elasticity",
        "equality/distance": "the equality <distance> was removed in MuJoCo 2.2.2",
        "material/rgb": "textures of a material are <layer role=... texture=...> since MuJoCo 3.2.5",
        "option@collision": "option/collision was removed in MuJoCo 3.0: use contype, conaffinity, <pair> and <exclude>",
        "option@apirate": "option/apirate was removed in MuJoCo 3.3.7; it never changed the simulation",
        "option@mpr_iterations": "mpr_iterations is ccd_iterations since MuJoCo 3.2.3",
        "option@mpr_tolerance": "mpr_tolerance is ccd_tolerance since MuJoCo 3.2.3",
        "flag@passive": "the flag passive was split into spring and damper in MuJoCo 3.3.6",
        "flag@sensornoise": "the flag sensornoise was removed in MuJoCo 3.1.4; noise is added by whoever reads the sensor",
        "compiler@convexhull": "compiler/convexhull was removed in MuJoCo 3.2.5; hulls are always computed",
        "compiler@exactmeshinertia": 'compiler/exactmeshinertia is inertia="exact" of each <mesh> since MuJoCo 3.2.5',
        "camera@orthographic": 'camera/orthographic is projection="orthographic" since MuJoCo 3.5',
        "contact@internal": "flex/contact/internal was removed in MuJoCo 3.15: use selfcollide",
        "contact@vertcollide": "flex/contact/vertcollide was removed in MuJoCo 3.7",
        "contact@evpair": "flex/contact/evpair was removed in MuJoCo 3.15",
        "mujoco.elasticity.cable": 'the plugin was removed in MuJoCo 4.0: use <flexcomp dim="1"> with <elasticity>',
        "mujoco.elasticity.solid": 'the plugin was removed in MuJoCo 3.2.4: use <flexcomp dim="3"> with <elasticity>',
        "mujoco.elasticity.membrane": 'the plugin was removed in MuJoCo 3.2.4: use <flexcomp dim="2"> with <elasticity>',
        "mujoco.elasticity.shell": 'the plugin was removed in MuJoCo 3.3.3: use <flexcomp dim="2"> with <elasticity>',
    }
)
"""What became of elements (ELEMENT or PARENT/ELEMENT), attributes (ELEMENT@ATTRIBUTE) and plugins (by name) of earlier versions."""
