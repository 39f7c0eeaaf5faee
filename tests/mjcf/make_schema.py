"""`python -m tests.mjcf.make_schema`: writes hymeko_x/formats/mjcf/schema.json, from the MuJoCo that is installed.

The elements and attributes are those of `mujoco.mj_printSchema`. What each attribute may hold, which ones an element needs and which may
not be empty is found by asking MuJoCo's parser: attribute by attribute, with values that tell the kinds apart. Words are looked for among
the strings in MuJoCo's library, which takes a quarter of an hour.
"""

from __future__ import annotations

import json
import re
import warnings
from collections.abc import Iterable, Iterator
from itertools import combinations
from pathlib import Path

import mujoco

from hymeko_x.xml.text import attributes_text

FILE = Path(__file__).parents[2] / "hymeko_x/formats/mjcf/schema.json"

UNPRINTED = {
    "body/frame": "axisangle childclass euler massscale name pos quat scale scaling xyaxes zaxis",
    "body/replicate": "count euler offset sep",
}
"""Elements that MuJoCo does not print, from its XML reference."""
UNASKED = ("asset/model", "body/attach", "body/flexcomp", "mujoco")
"""Elements that need files or are expanded before they are read: all of their attributes count as texts."""
GIVEN = {
    "body/replicate": {"count": "int 1", "euler": "3", "offset": "3", "sep": "text"},
    "asset/hfield": {"elevation": "n"},
    "visual/headlight": {"active": "0|1|2|auto|false|true"},
    "asset/mesh": {"builtin": "text"},
    "sensor/plugin": {"objtype": "text"},
    "sensor/user": {"objtype": "text"},
    "custom/tuple/element": {"objtype": "text"},
}
"""Attributes that MuJoCo judges only together with others."""

NEEDED = {
    "role": "rgb", "plugin": "mujoco.pid", "size": "1 1 1 1", "bindpos": "0 0 0", "bindquat": "1 0 0 0", "vertid": "0", "vertweight": "1",
    "mass": "1", "pos": "0 0 0", "element": "0 1 2", "divisor": "1", "coef": "1", "objtype": "body", "dim": "1",
}  # fmt: skip
"""What an element needs so that MuJoCo gets as far as the attribute in question."""
BESIDE: dict[str, dict[str, str]] = {
    "default/default": {"class": "c1"},
    "asset/material": {"name": "m2"},
    "asset/mesh": {"name": "m2", "vertex": "0 0 0 1 0 0 0 1 0 0 0 1"},
    "asset/texture": {"name": "t2", "type": "2d", "builtin": "flat", "width": "2", "height": "2"},
    "asset/hfield": {"name": "h2", "nrow": "2", "ncol": "2", "size": "1 1 1 1"},
    "body/geom": {"size": "1 1 1"},
    "body/inertial": {"mass": "1", "pos": "0 0 0", "diaginertia": "1 1 1"},
    "body/joint": {"type": "hinge"},
    "equality/connect": {"body1": "b", "anchor": "0 0 0"},
    "equality/weld": {"body1": "b"},
    "equality/joint": {"joint1": "j"},
    "equality/tendon": {"tendon1": "tn"},
    "contact/pair": {"geom1": "g", "geom2": "h"},
    "contact/exclude": {"body1": "b", "body2": "c"},
    "tendon/spatial/geom": {"geom": "g"},
    "tendon/spatial/pulley": {"divisor": "1"},
    "tendon/fixed/joint": {"joint": "k", "coef": "1"},
    "sensor/distance": {"geom1": "g", "geom2": "h"},
    "sensor/normal": {"geom1": "g", "geom2": "h"},
    "sensor/fromto": {"geom1": "g", "geom2": "h"},
    "sensor/contact": {"geom1": "g"},
    "sensor/rangefinder": {"site": "s"},
    "sensor/camprojection": {"site": "s", "camera": "cam"},
    "sensor/user": {"dim": "1"},
    "sensor/ballquat": {"joint": "ball"},
    "sensor/ballangvel": {"joint": "ball"},
    "actuator/adhesion": {"body": "b"},
    "actuator/dcmotor": {"joint": "j", "motorconst": "1", "resistance": "1"},
    "actuator/muscle": {"joint": "j", "lengthrange": "0 1"},
    "actuator/damper": {"joint": "j", "ctrlrange": "0 1"},
    "actuator/orientation": {"joint": "ball"},
    "custom/numeric": {"name": "n", "data": "1"},
    "custom/text": {"name": "n", "data": "x"},
    "custom/tuple": {"name": "n"},
    "custom/tuple/element": {"objtype": "body", "objname": "b"},
    "default/dcmotor": {"motorconst": "1", "resistance": "1"},
}
"""What an element needs beside its required attributes, in a model that means something."""
NEEDED_BESIDE: dict[str, dict[str, str]] = {
    **BESIDE,
    "default": {"class": "c"},
    "deformable/flex": {"body": "b", "element": "0 1 2", "vertex": "0 0 0 1 0 0 0 1 0"},
    "actuator/plugin": {"joint": "j"},
}
COMPLAINTS = ("bad format", "problem reading", "invalid keyword", "enough data", "too much data", "too large", "unknown exception")
MANY = 60


def printed_elements() -> dict[str, list[str]]:
    """The attributes of every element by its place, as MuJoCo prints them."""
    found: dict[str, list[str]] = {}
    path: list[str] = []
    for line in mujoco.mj_printSchema(False, False).splitlines():
        start = re.match(r"( *)(\S+) \([!?*R]\) *(.*)", line)
        if start is None:
            found["/".join(path)] += line.split()
            continue
        depth = len(start[1]) // 3
        path = [*path[: max(depth - 1, 0)], start[2].removeprefix("(world)")]
        found["/".join(path)] = start[3].split()
    return {**found, **{place: names.split() for place, names in UNPRINTED.items()}}


def complaint(path: str, attributes: dict[str, str], required: dict[str, list[str]]) -> str:
    """What MuJoCo says of an element with these attributes; empty when it takes them or objects to something else than their form."""
    tags = ["worldbody", *path.split("/")] if path.startswith("body") else path.split("/") if path != "default" else ["default", "default"]
    text = ""
    for number, tag in enumerate(tags, 1):
        place = "/".join(tags[1:number] if tags[0] == "worldbody" else tags[:number])
        needed = {name: NEEDED.get(name, "x") for name in required.get(place, ())} | NEEDED_BESIDE.get(place, {})
        own = needed | attributes if number == len(tags) else needed if place != "default" else {}
        text += f"<{tag}{attributes_text(own)}>"
    text += "".join(f"</{tag}>" for tag in reversed(tags))
    try:
        mujoco.MjSpec.from_string(f"<mujoco>{text}{'' if tags[0] == 'worldbody' else '<worldbody/>'}</mujoco>")
    except (ValueError, RuntimeError) as error:
        return str(error)
    return ""


def is_of_form(message: str) -> bool:
    return any(word in message for word in COMPLAINTS)


def required_of(path: str, required: dict[str, list[str]]) -> list[str]:
    """The attributes without which MuJoCo does not read an element."""
    found: list[str] = []
    while missing := re.search(r"required attribute missing: '(\w+)'", _bare_complaint(path, found, required)):
        if missing[1] in found:
            break
        found.append(missing[1])
    return sorted(found)


def _bare_complaint(path: str, names: Iterable[str], required: dict[str, list[str]]) -> str:
    beside, NEEDED_BESIDE[path] = NEEDED_BESIDE.get(path), {}
    try:
        return complaint(path, {name: NEEDED.get(name, "x") for name in names}, {**required, path: []})
    finally:
        NEEDED_BESIDE.pop(path)
        if beside is not None:
            NEEDED_BESIDE[path] = beside


def kind_of(path: str, name: str, words: Iterable[str], required: dict[str, list[str]]) -> str:
    """What an attribute may hold, as :func:`hymeko_x.formats.mjcf.schema.kinds_of` reads it."""

    def bad(value: str) -> bool:
        return is_of_form(complaint(path, {name: value}, required))

    if not bad("zz"):
        return "text"
    if "keyword" in complaint(path, {name: "zz"}, required):
        taken = [word for word in words if not bad(word)]
        return ("*" if any(not bad(" ".join(pair)) for pair in combinations(taken, 2)) else "") + "|".join(taken)
    counts = [count for count in (*range(1, 12), 30, 31, 32, MANY) if not bad(" ".join(["1"] * count))]
    whole = "int " if bad(" ".join(["1.5"] * counts[0])) else ""
    if MANY in counts:
        return f"{whole}n"
    return f"{whole}{counts[0]}" + (f"-{counts[-1]}" if len(counts) > 1 else "")


def library_words() -> list[str]:
    """Every string in MuJoCo's library that might be a keyword."""
    library = next(Path(mujoco.__file__).parent.glob("libmujoco*"))
    return sorted({word.decode() for word in re.findall(rb"(?<=\0)[A-Za-z0-9]{1,16}(?=\0)", library.read_bytes())} | set("0123456789"))


def schema(words: Iterable[str]) -> dict[str, object]:
    """The schema of the MuJoCo that is installed; keywords are looked for among ``words``."""
    elements = printed_elements()
    words = list(words)
    required: dict[str, list[str]] = {}
    for path in elements:
        found = required_of(path, required) if not path.startswith(UNASKED) else []
        if found:
            required[path] = found
    kinds: dict[str, dict[str, str]] = {}
    filled: dict[str, list[str]] = {}
    known: dict[tuple[str, str], list[str]] = {}
    for path, names in elements.items():
        own = kinds[path] = {}
        for name in sorted(names):
            if path.startswith(UNASKED) or name in GIVEN.get(path, {}):
                own[name] = GIVEN.get(path, {}).get(name, "text")
                continue
            own[name] = kind_of(path, name, known.get((path.rpartition("/")[2], name), words), required)
            if "|" in own[name]:
                known[path.rpartition("/")[2], name] = words if own[name] == "" else own[name].lstrip("*").split("|")
            if own[name][-1].isdigit() and "|" not in own[name] and is_of_form(complaint(path, {name: ""}, required)):
                filled.setdefault(path, []).append(name)
    return {"mujoco": mujoco.__version__, "elements": kinds, "required": required, "filled": filled}


def lines(found: dict[str, object]) -> Iterator[str]:
    """The schema as JSON with one element in a line."""
    for name, part in found.items():
        if isinstance(part, dict):
            rows = ",\n".join(f"    {json.dumps(key)}: {json.dumps(value)}" for key, value in part.items())
            yield f"  {json.dumps(name)}: {{\n{rows}\n  }}"
        else:
            yield f"  {json.dumps(name)}: {json.dumps(part)}"


def text_of(found: dict[str, object]) -> str:
    return "{\n" + ",\n".join(lines(found)) + "\n}\n"


if __name__ == "__main__":
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        FILE.write_text(text_of(schema(library_words())))
