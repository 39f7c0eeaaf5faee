"""The same robot written otherwise in MJCF: classes, angles, kinds of rotations, frames, flags, order, digits, blanks."""

from __future__ import annotations

import math
import warnings
from random import Random

import numpy as np
from lxml import etree
from scipy.spatial.transform import Rotation

from hymeko_x.ir.values import Pose, compose, inverse, quat_about, unit, unit_quat
from tests.notations.numbers import BLANKS, joined, numbers
from tests.notations.urdf import shuffled

_AS_THEY_ARE = frozenset(
    (
        *("name", "class", "type", "joint1", "joint2", "model", "angle", "eulerseq"),
        *("autolimits", "limited", "actuatorfrclimited", "contype", "conaffinity", "group"),
    )
)


def plain(text: bytes) -> etree._Element:
    """The model without classes, and with a name for each geom."""
    root = etree.fromstring(text)
    classes: dict[str, dict[str, dict[str, str]]] = {}
    for default in root.findall(".//default"):
        above = default.getparent()
        inherited = classes.get(above.get("class", "main"), {}) if above is not None and above.tag == "default" else {}
        own = {child.tag: dict(child.attrib) for child in default if child.tag != "default"}
        classes[default.get("class", "main")] = {tag: inherited.get(tag, {}) | own.get(tag, {}) for tag in (*inherited, *own)}
    for default in root.findall("default"):
        root.remove(default)
    assert not root.findall(".//*[@childclass]")
    for number, element in enumerate(root.iter("geom", "joint")):
        if element.getparent().tag == "equality":
            continue
        written = dict(element.attrib)
        element.attrib.clear()
        element.attrib.update(classes.get(written.pop("class", "main"), classes.get("main", {})).get(element.tag, {}) | written)
        if element.tag == "geom":
            element.set("name", f"geom {number}")
    return root


def otherwise(plain: etree._Element, chance: Random, *, round_about: bool = False) -> bytes:
    """Another text of the same robot; ``round_about`` turns what is round about its own axis, which nobody sees."""
    root = etree.fromstring(etree.tostring(plain))
    compiler = root.find("compiler")
    assert compiler is not None
    sequence = chance.choice(["xyz", "zyx", "XYZ", "ZXY", "yzx", "XYX", "zxz"])
    in_degrees = chance.random() < 0.5
    compiler.set("eulerseq", sequence)
    _flags(root, compiler, chance)
    for body in list(root.iter("body")):
        if chance.random() < 0.3:
            _frame(body, chance)
    for element in list(root.iter("geom", "body", "frame")):
        if round_about and element.get("type") in ("cylinder", "capsule") and chance.random() < 0.7:
            _from_to(element)
        else:
            _turn(element, chance, sequence, in_degrees)
    for element in root.iter("inertial"):
        _principal(element, chance, sequence, in_degrees)
    if in_degrees:
        compiler.attrib.pop("angle")
        for joint in root.iter("joint"):
            if joint.get("type", "hinge") == "hinge" and joint.get("range"):
                joint.set("range", joined(math.degrees(float(word)) for word in joint.get("range", "").split()))
    for element in list(root.iter("*")):
        for name, value in element.attrib.items():
            if name not in _AS_THEY_ARE:
                element.set(name, numbers(value, chance, BLANKS))
        shuffled(element, chance)
    return bytes(etree.tostring(root, encoding="utf-8"))


def _flags(root: etree._Element, compiler: etree._Element, chance: Random) -> None:
    """Say that there are limits, which MuJoCo would find out by itself unless told not to."""
    if chance.random() < 0.5:
        compiler.set("autolimits", "false")
    for joint in root.iter("joint"):
        for ranged, flag in (("range", "limited"), ("actuatorfrcrange", "actuatorfrclimited")):
            if ranged in joint.attrib and (compiler.get("autolimits") == "false" or chance.random() < 0.3):
                joint.set(flag, "true")


def _pose(element: etree._Element) -> Pose:
    x, y, z = map(float, element.get("pos", "0 0 0").split())
    w, i, j, k = map(float, element.get("quat", "1 0 0 0").split())
    return Pose((x, y, z), unit_quat((w, i, j, k)))


def _frame(body: etree._Element, chance: Random) -> None:
    """The body in a frame: what the frame moves, the body moves back."""
    turn = quat_about(unit((1.0, chance.choice([-2.0, 0.0, 1.0]), chance.choice([0.0, 1.0]))), chance.choice([0.5, 1.0, -2.0]))
    moved = Pose((chance.choice([0.0, 1.0]), -0.5, 0.25), turn)
    inner = compose(inverse(moved), _pose(body))
    frame = etree.Element("frame", pos=joined(moved.xyz), quat=joined(moved.quat))
    parent = body.getparent()
    assert parent is not None
    parent.replace(body, frame)
    frame.append(body)
    body.set("pos", joined(inner.xyz))
    body.set("quat", joined(inner.quat))


def _turn(element: etree._Element, chance: Random, sequence: str, in_degrees: bool) -> None:
    """The same rotation in other words."""
    w, x, y, z = _pose(element).quat
    rotation = Rotation.from_quat([x, y, z, w])
    angle = math.degrees if in_degrees else float
    element.attrib.pop("quat", None)
    way = chance.choice(["quat", "euler", "axisangle", "xyaxes", "zaxis"])
    if way == "euler":
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about angles that are not unique
            element.set("euler", joined(map(angle, rotation.as_euler(sequence.swapcase()))))
    elif way == "axisangle":
        turn = rotation.as_rotvec()
        size = float(np.linalg.norm(turn))
        element.set("axisangle", joined((*((turn if size else np.ones(3)) * 3.0), angle(size))))
    elif way == "xyaxes":
        matrix = rotation.as_matrix()
        element.set("xyaxes", joined((*(2.0 * matrix[:, 0]), *(0.5 * matrix[:, 1] + 0.25 * matrix[:, 0]))))
    elif way == "zaxis" and z == 0.0 and w > 1e-3:
        element.set("zaxis", joined(3.0 * rotation.as_matrix()[:, 2]))
    else:
        factor = chance.choice([1.0, -1.0, 3.0])
        element.set("quat", joined(factor * part for part in (w, x, y, z)))


def _from_to(geom: etree._Element) -> None:
    """The two ends of something round."""
    radius, half = geom.get("size", "").split()
    pose = _pose(geom)
    along = Rotation.from_quat([*pose.quat[1:], pose.quat[0]]).as_matrix()[:, 2] * float(half)
    geom.attrib.pop("quat", None)
    geom.attrib.pop("pos", None)
    geom.set("size", radius)
    geom.set("fromto", joined((*(pose.xyz + along), *(pose.xyz - along))))


def _principal(inertial: etree._Element, chance: Random, sequence: str, in_degrees: bool) -> None:
    """The principal moments and their axes, instead of the whole tensor, or the other way round."""
    if "fullinertia" not in inertial.attrib or chance.random() < 0.5:
        return
    xx, yy, zz, xy, xz, yz = map(float, inertial.attrib.pop("fullinertia").split())
    moments, axes = np.linalg.eigh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    turn = Rotation.from_matrix(axes * np.sign(np.linalg.det(axes)))
    x, y, z, w = turn.as_quat()
    inertial.set("diaginertia", joined(moments))
    inertial.set("quat", joined((w, x, y, z)))
    _turn(inertial, chance, sequence, in_degrees)
