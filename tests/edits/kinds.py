"""What an editor does to a file, by the file's format: edits of SDF texts, and moves to another parent, beside the edits of all laws."""

from __future__ import annotations

from collections.abc import Callable
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
    link = _chosen([*root.iter("link")], place)
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
}
VALUES = ("mass", "weigh", "limit", "range", "place")
"""Edits of one value, which change one line."""
