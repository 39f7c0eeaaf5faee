"""Random SDF models whose links, joints and frames are given in each other: the frame graph in all its freedom."""

from __future__ import annotations

import math
from typing import Any

from hypothesis import strategies as st

NUMBERS = st.integers(-200, 200).map(lambda number: number / 100)
TYPES = ("revolute", "continuous", "prismatic", "fixed", "screw", "ball", "universal")


@st.composite
def poses(draw: Any, known: list[str]) -> str:
    """A <pose>, relative to one of the known frames or to the default one, in one of the three notations; or none at all."""
    if draw(st.integers(0, 4)) == 0:
        return ""
    base = draw(st.sampled_from([None, *known]))
    relative = "" if base is None else f' relative_to="{base}"'
    x, y, z, a, b, c = draw(st.tuples(*[NUMBERS] * 6))
    match draw(st.sampled_from(["radians", "degrees", "quaternion"])):
        case "radians":
            return f"<pose{relative}>{x} {y} {z} {a} {b} {c}</pose>"
        case "degrees":
            return f'<pose{relative} degrees="true">{x} {y} {z} {a * 90} {b * 90} {c * 90}</pose>'
        case _:
            length = math.hypot(a, b, c, 1.5)
            turn = " ".join(repr(value / length) for value in (a, b, c, 1.5))
            return f'<pose{relative} rotation_format="quat_xyzw">{x} {y} {z} {turn}</pose>'


@st.composite
def models(draw: Any, scope: str = "m", depth: int = 0) -> str:
    """A model of up to seven links in a tree, with frames on them, joints of every kind, and models in it."""
    count = draw(st.integers(1, 7 if depth == 0 else 3))
    links = [f"{scope}_l{number}" for number in range(count)]
    if count > 1 and draw(st.booleans()):
        links[-1] = scope  # a link may be called as its model
    known = ["__model__"]
    parts = []
    nested = draw(st.integers(0, 2)) if depth < 2 else 0
    for number in range(nested):
        pose = draw(poses(known))
        inner = draw(models(f"{scope}n{number}", depth + 1))
        start = inner.index(">") + 1
        parts.append(inner[:start] + pose + inner[start:])
        known += [f"{scope}n{number}", f"{scope}n{number}::{scope}n{number}_l0", f"{scope}n{number}::__model__"]
    joints = []
    for number, link in enumerate(links):
        parts.append(f'<link name="{link}">{draw(poses(known))}{_INERTIAL}</link>')
        known.append(link)
        if draw(st.booleans()):
            attached = draw(st.sampled_from(["", *(f' attached_to="{frame}"' for frame in known)]))
            parts.append(f'<frame name="{scope}_f{number}"{attached}>{draw(poses(known))}</frame>')
            known.append(f"{scope}_f{number}")
        if number and draw(st.integers(0, 3)):
            parent = draw(st.sampled_from(links[:number]))
            joints.append(_joint(draw, f"{scope}_j{number}", parent, link, known))
            known.append(f"{scope}_j{number}")
    canonical = draw(st.sampled_from(["", f' canonical_link="{links[-1]}"']))
    placement = draw(st.sampled_from(["", f' placement_frame="{links[0]}"']))
    if placement and any("relative_to" in part and f'"{links[0]}"' in part for part in parts):
        placement = ""
    return f'<model name="{scope}"{canonical}{placement}>{"".join(parts)}{"".join(joints)}</model>'


_INERTIAL = "<inertial><pose>0.1 0.2 0.3 0.4 0 0</pose><mass>2</mass><inertia><ixx>1</ixx><iyy>1.5</iyy><izz>2</izz></inertia></inertial>"


def _joint(draw: Any, name: str, parent: str, child: str, known: list[str]) -> str:
    kind = draw(st.sampled_from(TYPES))
    inside = f"{draw(poses(known))}<parent>{parent}</parent><child>{child}</child>"
    if kind in ("fixed", "ball"):
        return f'<joint name="{name}" type="{kind}">{inside}</joint>'
    if kind == "universal":
        return f'<joint name="{name}" type="{kind}">{inside}<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2></joint>'
    expressed = draw(st.sampled_from(["", *(f' expressed_in="{frame}"' for frame in known)]))
    direction = draw(st.tuples(NUMBERS, NUMBERS, NUMBERS).filter(any))
    limit = "" if kind == "screw" else "<limit><lower>-1</lower><upper>2</upper></limit>"  # Drake has none of screws
    pitch = f"<screw_thread_pitch>{draw(NUMBERS.filter(bool))}</screw_thread_pitch>" if kind == "screw" else ""
    axis = f"<axis><xyz{expressed}>{' '.join(map(str, direction))}</xyz>{limit}</axis>"
    return f'<joint name="{name}" type="{kind}">{inside}{axis}{pitch}</joint>'
