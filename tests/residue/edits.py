"""What an editor does to a file: edits of URDF, xacro, MJCF and USD texts, drawn at random."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

from hypothesis import strategies as st
from lxml import etree
from pxr import Sdf

Edit = Callable[[Any], str]
"""Changes a tree or a layer in place and says what it did."""

_VALUES = st.floats(0.001, 2.0).map(lambda value: round(value, 4))


def applied(text: str, edits: list[Edit]) -> tuple[str, list[str]]:
    """The text after the edits, and what they did."""
    root = etree.fromstring(text.encode(), etree.XMLParser(strip_cdata=False, huge_tree=True))
    done = [edit(root) for edit in edits]
    return etree.tostring(root, encoding="unicode"), done


def applied_to_stage(text: str, edits: list[Edit]) -> tuple[str, list[str]]:
    """The same for the text of a stage."""
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.ImportFromString(text)
    done = [edit(layer) for edit in edits]
    return layer.ExportToString(), done


@st.composite
def _edits(draw: st.DrawFn, kinds: dict[str, Callable[[Any, float, int], str]]) -> Edit:
    """One edit of one of these kinds."""
    kind = draw(st.sampled_from(sorted(kinds)))
    value, place = draw(_VALUES), draw(st.integers(0, 1000))
    return lambda target: f"{kind}: {kinds[kind](target, value, place)}"


# ---- URDF ------------------------------------------------------------------------------------------------------------------


def urdf_edits() -> st.SearchStrategy[Edit]:
    """One edit of a URDF text."""
    return _edits(_URDF)


def _chosen(items: list[Any], place: int) -> Any:
    return items[place % len(items)] if items else None


def _free_name(taken: set[str]) -> str:
    """What a new body may be called: a name is free again once its body was removed, so that counting them is not enough."""
    return next(name for name in (f"tool{count}" for count in itertools.count()) if name not in taken)


def _limit(root: Any, value: float, place: int) -> str:
    limit = _chosen(root.findall("joint/limit"), place)
    if limit is None:
        return "nothing"
    limit.set("upper", str(float(limit.get("lower", "0")) + value))
    return str(limit.getparent().get("name"))


def _mass(root: Any, value: float, place: int) -> str:
    mass = _chosen([mass for mass in root.findall("link/inertial/mass") if float(mass.get("value")) > 1e-3], place)
    if mass is None:
        return "nothing"
    mass.set("value", str(value))
    return str(mass.getparent().getparent().get("name"))


def _move(root: Any, value: float, place: int) -> str:
    origin = _chosen(root.findall("link/collision/origin") + root.findall("link/visual/origin"), place)
    if origin is None:
        return "nothing"
    x, y, z = (origin.get("xyz") or "0 0 0").split()
    origin.set("xyz", f"{float(x) + value} {y} {z}")
    return str(origin.getparent().getparent().get("name"))


def _place(root: Any, value: float, place: int) -> str:
    origin = _chosen(root.findall("joint/origin"), place)
    if origin is None:
        return "nothing"
    x, y, z = (origin.get("xyz") or "0 0 0").split()
    origin.set("xyz", f"{x} {float(y) + value} {z}")
    return str(origin.getparent().get("name"))


def _add(root: Any, value: float, place: int) -> str:
    link = _chosen(root.findall("link"), place)
    if link is None:
        return "nothing"
    parent = link.get("name")
    name = _free_name({link.get("name") for link in root.iter("link")})
    link = etree.SubElement(root, "link", name=name)
    inertial = etree.SubElement(link, "inertial")
    etree.SubElement(inertial, "mass", value=str(value))
    etree.SubElement(inertial, "inertia", ixx="0.01", ixy="0", ixz="0", iyy="0.01", iyz="0", izz="0.01")
    for tag in ("visual", "collision"):
        etree.SubElement(etree.SubElement(etree.SubElement(link, tag), "geometry"), "box", size=f"0.1 0.2 {value}")
    joint = etree.SubElement(root, "joint", name=f"{name}_mount", type="fixed")
    etree.SubElement(joint, "origin", xyz=f"0 {value} 0")
    etree.SubElement(joint, "parent", link=parent)
    etree.SubElement(joint, "child", link=name)
    return f"{name} on {parent}"


def _remove(root: Any, value: float, place: int) -> str:
    parents = {parent.get("link") for parent in root.findall("joint/parent")}
    mimicked = {mimic.get("joint") for mimic in root.findall("joint/mimic")}
    leaves = [
        joint for joint in root.findall("joint") if joint.find("child").get("link") not in parents and joint.get("name") not in mimicked
    ]
    joint = _chosen(leaves, place)
    if joint is None:
        return "nothing"
    name = joint.find("child").get("link")
    gone = [joint, *(link for link in root.findall("link") if link.get("name") == name)]
    gone += [other for other in root.findall("transmission") if other.find("joint").get("name") == joint.get("name")]
    for element in gone:
        root.remove(element)
    return str(name)


def _rename_link(root: Any, value: float, place: int) -> str:
    link = _chosen([link for link in root.findall("link") if link.get("name") != "world"], place)  # which stands for the world
    old, new = link.get("name"), f"new_{link.get('name')}"
    link.set("name", new)
    for end in (*root.findall("joint/parent"), *root.findall("joint/child")):
        if end.get("link") == old:
            end.set("link", new)
    return f"{old} -> {new}"


def _rename_joint(root: Any, value: float, place: int) -> str:
    joint = _chosen(root.findall("joint"), place)
    old, new = joint.get("name"), f"new_{joint.get('name')}"
    joint.set("name", new)
    for user in (*root.findall("joint/mimic"),):
        if user.get("joint") == old:
            user.set("joint", new)
    for user in root.findall("transmission/joint"):
        if user.get("name") == old:
            user.set("name", new)
    return f"{old} -> {new}"


_URDF: dict[str, Callable[[Any, float, int], str]] = {
    "limit": _limit,
    "mass": _mass,
    "move": _move,
    "place": _place,
    "add": _add,
    "remove": _remove,
    "rename link": _rename_link,
    "rename joint": _rename_joint,
}


# ---- MJCF ------------------------------------------------------------------------------------------------------------------


def mjcf_edits() -> st.SearchStrategy[Edit]:
    """One edit of an MJCF text."""
    return _edits(_MJCF)


def _range(root: Any, value: float, place: int) -> str:
    joint = _chosen([joint for joint in root.findall(".//worldbody//joint") if joint.get("range")], place)
    if joint is None:
        return "nothing"
    lower = joint.get("range").split()[0]
    joint.set("range", f"{lower} {float(lower) + value}")
    return str(joint.get("name"))


def _shift(root: Any, value: float, place: int) -> str:
    geom = _chosen(root.findall(".//worldbody//geom"), place)
    if geom is None:
        return "nothing"
    x, y, z = (geom.get("pos") or "0 0 0").split()
    geom.set("pos", f"{float(x) + value} {y} {z}")
    return str(geom.get("name"))


def _weigh(root: Any, value: float, place: int) -> str:
    inertial = _chosen([inertial for inertial in root.findall(".//worldbody//inertial") if float(inertial.get("mass")) > 1e-3], place)
    if inertial is None:
        return "nothing"
    inertial.set("mass", str(value))
    return str(inertial.getparent().get("name"))


def _add_body(root: Any, value: float, place: int) -> str:
    parent = _chosen(root.findall(".//worldbody//body"), place)
    name = _free_name({body.get("name") for body in root.iter("body")})
    body = etree.SubElement(parent, "body", name=name, pos=f"0 {value} 0")
    etree.SubElement(body, "geom", type="sphere", size=str(value), mass="1")
    return str(body.get("name"))


def _remove_body(root: Any, value: float, place: int) -> str:
    used = {user.get("joint") or user.get("joint1") for user in root.iter() if isinstance(user.tag, str)}
    used |= {user.get("joint2") for user in root.iter() if isinstance(user.tag, str)}
    leaves = [body for body in root.findall(".//worldbody//body") if body.find("body") is None]
    body = _chosen([body for body in leaves if not any(joint.get("name") in used for joint in body.findall("joint"))], place)
    if body is None or body.getparent().tag == "worldbody":
        return "nothing"
    body.getparent().remove(body)
    return str(body.get("name"))


def _rename_body(root: Any, value: float, place: int) -> str:
    body = _chosen(root.findall(".//worldbody//body"), place)
    old, new = body.get("name"), f"new_{body.get('name')}"
    for user in root.iter():
        for name in ("body", "body1", "body2"):
            if user.get(name) == old:
                user.set(name, new)
    body.set("name", new)
    return f"{old} -> {new}"


_MJCF: dict[str, Callable[[Any, float, int], str]] = {
    "range": _range,
    "shift": _shift,
    "weigh": _weigh,
    "add": _add_body,
    "remove": _remove_body,
    "rename body": _rename_body,
}


# ---- xacro -----------------------------------------------------------------------------------------------------------------

_XACRO_NAME = "{http://www.ros.org/wiki/xacro}"


def xacro_edits() -> st.SearchStrategy[Edit]:
    """One edit of a xacro text: of what calls of macros say, and of links that stand by themselves."""
    return _edits(_XACRO)


def _call(root: Any, value: float, place: int) -> str:
    calls = [call for call in root.iter() if isinstance(call.tag, str) and call.tag.startswith(_XACRO_NAME)]
    numbers = [(call, name) for call in calls for name in ("mass", "upper", "radius") if _is_number(call.get(name))]
    if not numbers:
        return "nothing"
    call, name = _chosen(numbers, place)
    call.set(name, str(float(call.get(name)) + value))
    return f"{call.tag} {name}"


def _is_number(text: str | None) -> bool:
    return text is not None and text.replace(".", "", 1).lstrip("-").isdigit()


_XACRO: dict[str, Callable[[Any, float, int], str]] = {"call": _call, "add": _add, "mass": _mass}


# ---- USD -------------------------------------------------------------------------------------------------------------------


def usd_edits() -> st.SearchStrategy[Edit]:
    """One edit of the layer of a stage with flat bodies."""
    return _edits(_USD)


def _prims(layer: Any, *types: str) -> list[Any]:
    found: list[Any] = []
    layer.Traverse("/", lambda path: found.append(layer.GetPrimAtPath(path)) if path.IsPrimPath() else None)
    return [prim for prim in found if prim.typeName in types]


def _bodies(layer: Any) -> list[Any]:
    return [prim for prim in _prims(layer, "Xform") if "physics:mass" in prim.properties]


def _users(layer: Any, path: Any) -> list[Any]:
    """The joints on a body."""
    joints = _prims(layer, "PhysicsRevoluteJoint", "PhysicsPrismaticJoint", "PhysicsFixedJoint", "PhysicsJoint")
    return [prim for prim in joints if any(path in _targets(prim, name) for name in ("physics:body0", "physics:body1"))]


def _targets(prim: Any, name: str) -> list[Any]:
    return list(prim.properties[name].targetPathList.GetAppliedItems()) if name in prim.properties else []


def _upper(layer: Any, value: float, place: int) -> str:
    joint = _chosen([prim for prim in _prims(layer, "PhysicsRevoluteJoint") if "physics:upperLimit" in prim.properties], place)
    if joint is None:
        return "nothing"
    joint.properties["physics:upperLimit"].default = joint.properties["physics:lowerLimit"].default + 10 * value
    return str(joint.name)


def _heavier(layer: Any, value: float, place: int) -> str:
    body = _chosen(_bodies(layer), place)
    if body is None:
        return "nothing"
    body.properties["physics:mass"].default += value
    return str(body.name)


def _slide(layer: Any, value: float, place: int) -> str:
    shapes = _prims(layer, "Capsule", "Cube", "Sphere", "Cylinder")
    shape = _chosen([prim for prim in shapes if "xformOp:translate" in prim.properties], place)
    if shape is None:
        return "nothing"
    translate = shape.properties["xformOp:translate"]
    translate.default = (translate.default[0] + value, *translate.default[1:])
    return str(shape.path)


def _add_prim(layer: Any, value: float, place: int) -> str:
    parent = _chosen(_bodies(layer), place)
    if parent is None:
        return "nothing"
    name = _free_name({prim.name for prim in _prims(layer, "Xform")})
    body = Sdf.PrimSpec(parent.nameParent, name, Sdf.SpecifierDef, "Xform")
    schemas = Sdf.TokenListOp()
    schemas.prependedItems = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]
    body.SetInfo("apiSchemas", schemas)
    Sdf.AttributeSpec(body, "physics:mass", Sdf.ValueTypeNames.Float).default = value
    Sdf.AttributeSpec(body, "physics:diagonalInertia", Sdf.ValueTypeNames.Float3).default = (0.01, 0.01, 0.01)
    ball = Sdf.PrimSpec(body, "ball", Sdf.SpecifierDef, "Sphere")
    Sdf.AttributeSpec(ball, "radius", Sdf.ValueTypeNames.Double).default = value
    joint = Sdf.PrimSpec(parent.nameParent, f"{name}_mount", Sdf.SpecifierDef, "PhysicsFixedJoint")
    for side, end in (("physics:body0", parent), ("physics:body1", body)):
        Sdf.RelationshipSpec(joint, side).targetPathList.explicitItems = [end.path]
    return f"{name} on {parent.name}"


def _remove_prim(layer: Any, value: float, place: int) -> str:
    leaves = [prim for prim in _bodies(layer) if len(_users(layer, prim.path)) == 1]
    body = _chosen(leaves, place)
    if body is None or _targets(_users(layer, body.path)[0], "physics:body0") == [body.path]:
        return "nothing"
    joint, name = _users(layer, body.path)[0], str(body.name)
    for prim in (joint, body):
        del prim.nameParent.nameChildren[prim.name]
    return name


_USD: dict[str, Callable[[Any, float, int], str]] = {
    "limit": _upper,
    "mass": _heavier,
    "move": _slide,
    "add": _add_prim,
    "remove": _remove_prim,
}
