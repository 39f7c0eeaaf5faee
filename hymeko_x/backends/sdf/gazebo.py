"""`<gazebo>` fragments of robots from ROS: what they say of links, joints and the model in the words of SDF itself.

Source: libsdformat's reader of such files. Fixed joints always stay, so what asks for that (``preserveFixedJoint``,
``disableFixedJointLumping``) is obeyed by nothing being lumped.
"""

from __future__ import annotations

import re
import sys
from types import MappingProxyType
from typing import TYPE_CHECKING
from xml.parsers.expat import ExpatError

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import fragments
from hymeko_x.formats.sdf.values import NUMBER, BadText
from hymeko_x.ir.mechanism import ROOT, Extra, Id
from hymeko_x.ir.names import free_name
from hymeko_x.ir.parts import Role
from hymeko_x.xml.parse import parse_text
from hymeko_x.xml.printing import markup
from hymeko_x.xml.text import escaped, unescaped

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.ir.mechanism import Mechanism, RobotEdge
    from hymeko_x.rewrite.context import Context
    from hymeko_x.xml.tree import Node

_START = f"<{fragments.TAG}"
_IMU_NOISE = re.compile(r"(?<=<imu>)\s*(?:<!--.*?-->\s*)*(<noise>.*?</noise>)", re.DOTALL)
_IMU_PARTS: Mapping[str, str] = MappingProxyType({"rate": "angular_velocity", "accel": "linear_acceleration"})
_PREFIX = re.compile(r"<([A-Za-z_][\w.-]*):|\s([A-Za-z_][\w.-]*):[\w.-]+=")
_SENSOR_NAME = re.compile(r"<(?:sensor|projector)\b[^>]*?\sname=([\"'])(.*?)\1")
_XMLNS = "@xmlns:"
_LAST = sys.maxsize
_MATERIALS = "file://media/materials/scripts/gazebo.material"


def obey_gazebo_fragments(mechanism: Mechanism, context: Context) -> Mechanism:
    """<gazebo> elements become the elements of SDF that they stand for; they themselves belong to the format that they came from."""
    own = mechanism.extras.get(ROOT, ())
    texts = [extra.text for extra in own if extra.text.startswith(_START) and extra.format != words.FORMAT]
    if not texts:
        return mechanism
    declared = {extra.path.removeprefix(_XMLNS): extra.text for extra in mechanism.extras[ROOT] if extra.path.startswith(_XMLNS)}
    added: dict[Id, list[Extra]] = {}
    held = {(key, extra) for key, extras in mechanism.extras.items() for extra in extras if extra.format == words.FORMAT}
    names: dict[Id, set[str]] = {}
    edges: dict[Id, RobotEdge] = {}
    for text in texts:
        try:
            node = parse_text(text)
        except ExpatError:
            continue
        for key, found in _extras_of(node, mechanism, edges):
            extra = _with_namespaces(found, declared, context)
            if extra is not None and (key, extra) not in held:
                held.add((key, extra))
                added.setdefault(key, []).append(_named_once(extra, key, names.setdefault(key, set()), context))
    extras = {**mechanism.extras, **{key: (*mechanism.extras.get(key, ()), *found) for key, found in added.items()}}
    return replace(mechanism, graph=mechanism.graph.replace(edges=edges) if edges else mechanism.graph, extras=extras)


def _with_namespaces(extra: Extra, declared: Mapping[str, str], context: Context) -> Extra | None:
    """An extra that declares its prefixes as the root of its file did. None, with a warning, where that did not declare one."""
    for prefix in dict.fromkeys(a or b for a, b in _PREFIX.findall(extra.text)):
        if prefix in ("xml", "xmlns") or f"xmlns:{prefix}=" in extra.text:
            continue
        if prefix not in declared:
            context.report.warn(codes.NOT_SAID, f"'{extra.text[:60]}' is left out: its file does not declare the prefix '{prefix}'")
            return None
        name = re.match(r"<[^\s/>]+", extra.text)
        assert name is not None
        text = f'{name[0]} xmlns:{prefix}="{escaped(declared[prefix])}"{extra.text[name.end() :]}'
        extra = replace(extra, text=text)
    return extra


def _named_once(extra: Extra, key: Id, taken: set[str], context: Context) -> Extra:
    """A sensor under a name that no other one of its link or joint has; the name is taken then."""
    found = _SENSOR_NAME.match(extra.text)
    if found is None:
        return extra
    name = free_name(found[2], taken.__contains__, "_")
    taken.add(name)
    if name == found[2]:
        return extra
    context.report.note(codes.RENAMED, f"{key} has two sensors called '{unescaped(found[2])}'; the second one is '{unescaped(name)}'")
    return replace(extra, text=extra.text[: found.start(2)] + name + extra.text[found.end(2) :])


def _extras_of(node: Node, mechanism: Mechanism, edges: dict[Id, RobotEdge]) -> Iterator[tuple[Id, Extra]]:
    reference = node.attributes.get("reference")
    body, joint = Id("body", reference or ""), Id("joint", reference or "")
    for child in node.children:
        if not child.is_element or child.tag in fragments.OBEYED:
            continue
        if not reference:
            if (child.tag in fragments.OF_MODEL or ":" in child.tag) and not _is_taken(child, mechanism):
                yield ROOT, _at_end("model", markup(child))
        elif body in mechanism.graph.vertices:
            yield from _of_link(child, body, mechanism, edges)
        elif joint in mechanism.graph.edges and child.tag in fragments.OF_JOINT:
            yield joint, _extra(*fragments.OF_JOINT[child.tag], child)
        elif joint in mechanism.graph.edges and child.tag == "sensor":
            yield joint, _at_end("", markup(child))


def _is_taken(child: Node, mechanism: Mechanism) -> bool:
    """Whether a child of a model would have the name of a link or joint of the robot, which SDF refuses."""
    name = child.attributes.get("name", "")
    return Id("body", name) in mechanism.graph.vertices or Id("joint", name) in mechanism.graph.edges


def _of_link(child: Node, body: Id, mechanism: Mechanism, edges: dict[Id, RobotEdge]) -> Iterator[tuple[Id, Extra]]:
    shapes = mechanism.shapes.get(body, ())
    if child.tag in fragments.OF_LINK:
        yield body, _extra("", fragments.OF_LINK[child.tag], child)
    elif child.tag == "turnGravityOff":
        yield body, _at_end("", f"<gravity>{'false' if _text(child) in ('true', '1') else 'true'}</gravity>")
    elif child.tag in fragments.IN_LINK:
        yield body, _at_end("", _IMU_NOISE.sub(_noise_by_axis, markup(child)))
    elif child.tag in fragments.OF_COLLISION:
        yield from ((view.id, _extra(*fragments.OF_COLLISION[child.tag], child)) for view in shapes if view.shape.role is Role.COLLISION)
    elif child.tag == "material" and _text(child):
        script = f"<script><uri>{_MATERIALS}</uri><name>{escaped(_text(child))}</name></script>"
        yield from ((view.id, _at_end("material", script)) for view in shapes if view.shape.role is Role.VISUAL)
    elif child.tag == "mu1":
        try:
            friction = (NUMBER.read(_text(child)),)
        except BadText:
            return
        for view in shapes:
            edge = mechanism.graph.edges[view.id]
            if view.shape.role is Role.COLLISION:
                edges[view.id] = replace(edge, data=replace(view.shape, friction=friction))


def _noise_by_axis(found: re.Match[str]) -> str:
    """The noise of an <imu> of SDF 1.4, one of all rates and one of all accelerations, as that of each axis since SDF 1.5."""
    noise = parse_text(found[1])
    kind = next((_text(child) for child in noise.children if child.tag == "type"), "none")
    texts = []
    for old, new in _IMU_PARTS.items():
        part = noise.child(old)
        if part is not None:
            numbers = "".join(markup(child) for child in part.children if child.is_element)
            axes = "".join(f'<{axis}><noise type="{escaped(kind)}">{numbers}</noise></{axis}>' for axis in "xyz")
            texts.append(f"<{new}>{axes}</{new}>")
    return "".join(texts)


def _text(node: Node) -> str:
    return " ".join((node.text or "").split())


def _extra(path: str, tag: str, child: Node) -> Extra:
    return _at_end(path, f"<{tag}>{escaped(_text(child))}</{tag}>")


def _at_end(path: str, text: str) -> Extra:
    """An extra behind the elements that the writer puts there, and in the order in which such extras are found."""
    return Extra(words.FORMAT, path, text, _LAST)
