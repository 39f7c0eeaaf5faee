"""What an editor does to a file, by its format: edits of SDF and HyMeKo texts, and moves to another parent, beside those of all laws."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

from lxml import etree

from tests.residue import edits
from tests.residue.edits import _chosen

Kinds = dict[str, Callable[[Any, float, int], str]]

# ---- SDF -------------------------------------------------------------------------------------------------------------------


def _mass(root: Any, value: float, place: int) -> str:
    mass = _chosen([mass for mass in root.iter("mass") if float(mass.text) > 1e-3], place)
    if mass is None:
        return "nothing"
    mass.text = str(value)
    return str(mass.getparent().getparent().get("name"))


def _limit(root: Any, value: float, place: int) -> str:
    upper = _chosen([upper for upper in root.iter("upper") if abs(float(upper.text)) < 1e3], place)
    if upper is None:
        return "nothing"
    upper.text = str(float(upper.text) + value)
    return str(upper.getparent().getparent().getparent().get("name"))


def _move(root: Any, value: float, place: int) -> str:
    shape = _chosen([*root.iter("visual"), *root.iter("collision")], place)
    if shape is None:
        return "nothing"
    pose = shape.find("pose")
    if pose is None:
        pose = etree.SubElement(shape, "pose")
    x, *rest = (pose.text or "0 0 0 0 0 0").split()
    pose.text = " ".join([str(float(x) + value), *rest])
    return str(shape.get("name"))


def _add(root: Any, value: float, place: int) -> str:
    parent = _chosen([*root.iter("link")], place)
    model, name = parent.getparent(), "tool"
    link = etree.SubElement(model, "link", name=name)
    etree.SubElement(link, "pose", relative_to=f"{name}_mount").text = "0 0 0 0 0 0"
    inertial = etree.SubElement(link, "inertial")
    etree.SubElement(inertial, "mass").text = str(value)
    inertia = etree.SubElement(inertial, "inertia")
    for axis in ("ixx", "iyy", "izz"):
        etree.SubElement(inertia, axis).text = "0.01"
    box = etree.SubElement(etree.SubElement(etree.SubElement(link, "collision", name="box"), "geometry"), "box")
    etree.SubElement(box, "size").text = f"0.1 0.2 {value}"
    joint = etree.SubElement(model, "joint", name=f"{name}_mount", type="fixed")
    etree.SubElement(joint, "pose", relative_to=parent.get("name")).text = f"0 {value} 0 0 0 0"
    etree.SubElement(joint, "parent").text = parent.get("name")
    etree.SubElement(joint, "child").text = name
    return f"{name} on {parent.get('name')}"


def _remove(root: Any, value: float, place: int) -> str:
    shape = _chosen([*root.iter("visual"), *root.iter("collision")], place)
    if shape is None:
        return "nothing"
    name = str(shape.get("name"))
    shape.getparent().remove(shape)
    return name


def _rename(root: Any, value: float, place: int) -> str:
    link = _chosen([link for link in root.iter("link") if not link.get("name").startswith("world")], place)  # which stands for the world
    if link is None:
        return "nothing"
    old, new = link.get("name"), f"new_{link.get('name')}"
    link.set("name", new)
    for user in root.iter():
        if user.tag in ("parent", "child") and (user.text or "").strip() == old:
            user.text = new
        for name in ("relative_to", "attached_to", "expressed_in"):
            if user.get(name) == old:
                user.set(name, new)
    return f"{old} -> {new}"


_SDF: Kinds = {"limit": _limit, "mass": _mass, "move": _move, "add": _add, "remove": _remove, "rename link": _rename}

# ---- HyMeKo ------------------------------------------------------------------------------------------------------------------

_NUMBER = r"-?[0-9][-+0-9.e]*"
_MASS = re.compile(rf"\bmass ({_NUMBER})")
_UPPER = re.compile(rf"\blimit \[{_NUMBER} ({_NUMBER})\]")
_PLACE = re.compile(rf"\bat \[({_NUMBER}) {_NUMBER} {_NUMBER}\]")
_CHILD = re.compile(r"^  @\w+ .*?\{ .*?\+ (\w+)", re.MULTILINE)


def applied_to_text(text: str, edits: Sequence[Callable[[Any], str]]) -> tuple[str, list[str]]:
    """The text after the edits, which change the only item of a list, and what they did."""
    held = [text]
    done = [edit(held) for edit in edits]
    return held[0], done


def _with_number(held: list[str], pattern: re.Pattern[str], place: int, change: Callable[[float], float]) -> str:
    """Change one of the numbers that a pattern finds, which stand for no bound where they are huge."""
    text = held[0]
    found = _chosen([found for found in pattern.finditer(text) if abs(float(found[1])) < 1e3], place)
    if found is None:
        return "nothing"
    held[0] = f"{text[: found.start(1)]}{change(float(found[1]))!r}{text[found.end(1) :]}"
    return str(found[0])


def _mass_in_text(held: list[str], value: float, place: int) -> str:
    return _with_number(held, _MASS, place, lambda old: value if old > 1e-3 else old + value)


def _upper_in_text(held: list[str], value: float, place: int) -> str:
    return _with_number(held, _UPPER, place, lambda old: round(old + value, 6))


def _place_in_text(held: list[str], value: float, place: int) -> str:
    return _with_number(held, _PLACE, place, lambda old: round(old + value, 6))


def _add_to_text(held: list[str], value: float, place: int) -> str:
    parent = _chosen([found[1] for found in _CHILD.finditer(held[0])], place)
    if parent is None or not held[0].rstrip().endswith("\n}"):
        return "nothing"
    link = f"  tool {{ mass {value} inertia [0.01 0.01 0.01] collision {{ box [0.1 0.2 {value}] }} }}\n"
    held[0] = f"{held[0].rstrip()[:-1]}{link}  @tool_mount : fixed {{ [0 {value} 0] + {parent} - tool }}\n}}\n"
    return f"tool on {parent}"


_HYMEKO: Kinds = {"mass": _mass_in_text, "limit": _upper_in_text, "move": _place_in_text, "add": _add_to_text}

# ---- to another parent -----------------------------------------------------------------------------------------------------


def _reparent_link(root: Any, value: float, place: int) -> str:
    joint = _chosen(root.findall("joint"), place)
    children = {end.get("link") for end in root.findall("joint/child")}
    top = next((link.get("name") for link in root.findall("link") if link.get("name") not in children), None)
    if joint is None or top in (None, joint.find("parent").get("link")):
        return "nothing"
    joint.find("parent").set("link", top)
    return f"{joint.get('name')} on {top}"


def _reparent_body(root: Any, value: float, place: int) -> str:
    body, top = _chosen(root.findall(".//worldbody/body//body/body"), place), root.find("worldbody/body")
    if body is None or top not in body.iterancestors():
        return "nothing"
    body.getparent().remove(body)
    top.append(body)
    return str(body.get("name"))


KINDS: dict[str, Kinds] = {
    "urdf": {**edits._URDF, "reparent": _reparent_link},
    "mjcf": {**edits._MJCF, "reparent": _reparent_body},
    "usd": edits._USD,
    "sdf": _SDF,
    "xacro": edits._XACRO,
    "hymeko": _HYMEKO,
}
APPLIED: dict[str, Callable[..., tuple[str, list[str]]]] = {"usd": edits.applied_to_stage, "hymeko": applied_to_text}
"""How a text is edited that is no XML."""
VALUES = ("mass", "weigh", "limit", "range", "place")
"""Edits of one value, which change one line, unless it stands in a class or a macro."""
SHARING = ("hymeko", "xacro")
"""The formats whose texts are factored into classes and macros."""
