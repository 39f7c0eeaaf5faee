"""The sections and names of MJCF, and the settings of <compiler>: for reader and writer."""

from __future__ import annotations

from math import comb
from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x.formats.mjcf import NAME as NAME
from hymeko_x.formats.mjcf.codec import Settings
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.parts import Role

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.ir.mechanism import Mechanism


VERSION = "4.0"
"""The version of MuJoCo whose MJCF is read; a mechanism that came from MJCF has it as its notation ``mjcf``."""

KEPT_SECTIONS = (
    "compiler",
    "option",
    "size",
    "visual",
    "statistic",
    "default",
    "extension",
    "custom",
    "deformable",
    "keyframe",
)
"""The sections that are kept verbatim."""

SECTIONS = (
    "compiler",
    "option",
    "size",
    "visual",
    "statistic",
    "extension",
    "default",
    "custom",
    "asset",
    "worldbody",
    "deformable",
    "contact",
    "equality",
    "tendon",
    "actuator",
    "sensor",
    "keyframe",
)
"""All sections in the usual order."""

KINDS: Mapping[str, str] = MappingProxyType(
    {
        "body": "body",
        "joint": "joint",
        "freejoint": "joint",
        "site": "frame",
        "camera": "camera",
        "light": "light",
        "material": "material",
        "exclude": "contact",
        "pair": "contact",
        "connect": "loop",
        "weld": "loop",
        "spatial": "tendon",
        "fixed": "tendon",
    }
)
"""The kind of id that the name of an element is, for elements whose ids are their names."""


EXPANDED_BY_MUJOCO = frozenset(("replicate", "attach", "flexcomp"))
"""Elements that only MuJoCo can expand."""


def kind_of(tag: str, section: str) -> str | None:
    """The kind of id that the name of an element in this section is."""
    if section in ("actuator", "sensor"):
        return section
    return "coupling" if section == "equality" and tag == "joint" else KINDS.get(tag)


NAMESPACES: Mapping[str, str] = MappingProxyType({"frame": "site", "loop": "equality", "coupling": "equality"})
"""What MJCF calls the kind of an id, where that is another word; names are unique among elements of one kind."""


def settings_of(compilers: Iterable[Mapping[str, str]]) -> Settings:
    """The meaning of numbers and file names from the attributes of all <compiler> elements; a later one wins."""
    found: dict[str, str] = {}
    for attributes in compilers:
        found.update(attributes)
    assets = found.get("assetdir", "")
    return Settings(
        degree=found.get("angle", "degree") != "radian",
        eulerseq=found.get("eulerseq", "xyz"),
        autolimits=found.get("autolimits", "true") != "false",
        inertia_from_geoms=found.get("inertiafromgeom", "auto") == "true",
        mesh_folder=found.get("meshdir", assets),
        texture_folder=found.get("texturedir", assets),
        strip_path=found.get("strippath", "false") == "true",
    )


def from_mjcf(mechanism: Mechanism) -> bool:
    """Whether a mechanism came from MJCF: directly, through HyMeKo text, or carried by another file."""
    return mechanism.source.format == NAME


def compilers(mechanism: Mechanism) -> list[str]:
    """The <compiler> elements of the file that a mechanism came from, verbatim."""
    return [extra.text for extra in mechanism.extras.get(ROOT, ()) if extra.format == NAME and extra.text.startswith("<compiler")]


def compiler_has(mechanism: Mechanism, names: Iterable[str]) -> bool:
    """Whether a <compiler> of the file has one of these attributes."""
    return any(f"{name}=" in text for text in compilers(mechanism) for name in names)


def shapes_have_weight(mechanism: Mechanism) -> bool:
    """Whether the masses of shapes may count although their bodies have inertials."""
    return compiler_has(mechanism, ("inertiafromgeom",))


def mentions(mechanism: Mechanism, attribute: str) -> bool:
    """Whether an element or a class has an attribute of this name, as far as extras show it."""
    return any(attribute in extra.path or attribute in extra.text for own in mechanism.extras.values() for extra in own)


def joined(folder: str, file: str, settings: Settings) -> str:
    """The uri of an asset's file: below the folder that <compiler> names, unless it is absolute."""
    file = file.replace("\\", "/")
    if settings.strip_path:
        file = file.rpartition("/")[2]
    if not folder or file.startswith("/"):
        return file
    return f"{folder.rstrip('/')}/{file}"


def below(folder: str, uri: str) -> str | None:
    """The uri seen from that folder, or None when it is not in it."""
    if not folder:
        return uri
    start = f"{folder.rstrip('/')}/"
    return uri.removeprefix(start) if uri.startswith(start) else None


PLACES: Mapping[Role, str] = MappingProxyType({Role.VISUAL: "visual", Role.COLLISION: "collision", Role.BOTH: "shape"})
"""What shapes are called after, behind the name of their body."""

PLAIN_ATTRIBUTES = frozenset({"user"})
"""Attributes that are never parameters of a part."""

COEFFICIENTS = 5
"""How many coefficients the polynomial of a joint equality has."""


def shifted(coefficients: tuple[float, ...], by: float) -> list[float]:
    """The coefficients of p(x + by), padded with zeros to a quartic.

    Raises: OverflowError where numbers leave the range of doubles.
    """
    padded = [*coefficients[:COEFFICIENTS], *[0.0] * (COEFFICIENTS - len(coefficients))]
    if by == 0.0:
        return padded
    return [sum(padded[n] * comb(n, k) * by ** (n - k) for n in range(k, COEFFICIENTS) if padded[n]) for k in range(COEFFICIENTS)]


def trimmed(coefficients: list[float]) -> list[float]:
    """The coefficients without zeros at their end, two at least."""
    while len(coefficients) > 2 and coefficients[-1] == 0.0:
        coefficients = coefficients[:-1]
    return coefficients


TRANSMISSIONS = ("joint", "jointinparent", "tendon", "site", "body", "cranksite", "slidersite", "refsite")
"""The attributes of an actuator that name what it acts on; all but the first five stand beside another one."""

RESOLVED = ("kp", "kv", "ctrlrange", "forcerange")
"""Parameters of an actuator that are typed even where its class gives them."""

LAW = (
    *("dyntype", "gaintype", "biastype", "dynprm", "gainprm", "biasprm", "ctrllimited", "forcelimited", "actlimited"),
    *("actrange", "lengthrange", "actdim", "input", "cranklength", "inheritrange", "dampratio", "timeconst", "tausmooth"),
    *("range", "force", "scale", "lmin", "lmax", "vmax", "fpmax", "fvmax", "area", "diameter", "bias"),
)
"""Other parameters of its law; typed even where its class gives them, behind the actuator's own."""

UNBOUNDED: Mapping[str, str] = MappingProxyType(
    {
        **dict.fromkeys(("ctrllimited", "forcelimited", "actlimited"), "auto"),
        **dict.fromkeys(("ctrlrange", "forcerange", "actrange"), "0 0"),
        "inheritrange": "0",
    }
)
"""What is written of an actuator that has none of these parameters, where its class gives one: MuJoCo's own defaults."""

LIMITED: Mapping[str, str] = MappingProxyType({"ctrllimited": "ctrlrange", "forcelimited": "forcerange", "actlimited": "actrange"})
"""The parameters that say whether a range applies. An actuator with a range needs one where <compiler autolimits> is false."""

TENDON_PARAMETERS = (
    "springlength",
    "margin",
    "solreflimit",
    "solimplimit",
    "solreffriction",
    "solimpfriction",
    "actuatorfrclimited",
    "actuatorfrcrange",
    "group",
)
"""Parameters of a tendon, typed even where its class gives them."""

SENSED: Mapping[str, str] = MappingProxyType(
    {
        "site": "site",
        "joint": "joint",
        "tendon": "tendon",
        "actuator": "actuator",
        "body": "body",
        "geom": "geom",
        "camera": "camera",
        "body1": "body",
        "body2": "body",
        "geom1": "geom",
        "geom2": "geom",
        "subtree1": "body",
        "subtree2": "body",
    }
)
"""The attributes of a sensor that refer to something, and to what kind; ``objname`` and ``refname`` go by their types."""

SENSED_TYPES: Mapping[str, str] = MappingProxyType({"body": "body", "xbody": "body", "geom": "geom", "site": "site", "camera": "camera"})
"""What ``objtype`` and ``reftype`` mean."""

ALONE = frozenset({"site", "joint", "tendon", "actuator", "body", "geom", "camera"})
"""Sensed elements whose arc needs no role: the attribute follows from the kind of the target."""

AT_SITES = frozenset({"accelerometer", "gyro", "velocimeter", "force", "torque", "touch", "rangefinder", "magnetometer"})
"""The kinds of sensors that measure at a site."""


def is_range(value: object) -> bool:
    """Whether a parameter is a range that bounds anything: MuJoCo takes two zeros for none."""
    return isinstance(value, tuple) and any(value)
