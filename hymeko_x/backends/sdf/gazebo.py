"""`<gazebo>` fragments of robots from ROS: what they say of links, joints and the model in the words of SDF itself.

Source: libsdformat's reader of such files. Fixed joints always stay, so what asks for that (``preserveFixedJoint``,
``disableFixedJointLumping``) is obeyed by nothing being lumped.
"""

from __future__ import annotations

import re
import sys
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import fragments
from hymeko_x.formats.sdf.values import COLOUR, NUMBER, BadText, ValueField
from hymeko_x.ir.mechanism import ROOT, Extra, Id
from hymeko_x.ir.names import free_name
from hymeko_x.ir.parts import Joint, Role
from hymeko_x.xml.parse import parse_text
from hymeko_x.xml.printing import in_lines, markup
from hymeko_x.xml.text import escaped, unescaped

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.ir.mechanism import Mechanism, RobotEdge
    from hymeko_x.rewrite.context import Context
    from hymeko_x.xml.tree import XmlNode

Fields = dict[tuple[Id, str], Any]
"""Values by joint or shape, and the name of the field: one of the shape, or of the joint's only dof."""
_START = f"<{fragments.TAG}"
_IMU_NOISE = re.compile(r"(?<=<imu>)\s*(?:<!--.*?-->\s*)*(<noise>.*?</noise>)", re.DOTALL)
_IMU_PARTS: Mapping[str, str] = MappingProxyType({"rate": "angular_velocity", "accel": "linear_acceleration"})
_PREFIX = re.compile(r"<([A-Za-z_][\w.-]*):|\s([A-Za-z_][\w.-]*):[\w.-]+=")
_SENSOR_NAME = re.compile(r"<(?:sensor|projector)\b[^>]*?\sname=([\"'])(.*?)\1")
_XMLNS = "@xmlns:"
_LAST = sys.maxsize
_FIELDS = {
    field.path: field
    for field in (ValueField("surface/friction/ode/mu", "friction", NUMBER), ValueField("material/diffuse", "rgba", COLOUR))
}
_FLAGS = ("0", "1", "false", "true")
"""The words for a flag in SDF."""


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
    fields: Fields = {}
    for node in filter(None, map(fragments.parsed, texts)):
        for key, found in extras_of(node, mechanism, fields):
            extra = _with_namespaces(found, declared, context)
            if extra is not None and (key, extra) not in held:
                held.add((key, extra))
                added.setdefault(key, []).append(_named_once(extra, key, names.setdefault(key, set()), context))
    extras = {**mechanism.extras, **{key: (*mechanism.extras.get(key, ()), *found) for key, found in added.items()}}
    return _with_fields(replace(mechanism, extras=extras), fields)


def _with_fields(mechanism: Mechanism, fields: Fields) -> Mechanism:
    """The mechanism with other values of its shapes, and of the dofs of its joints."""
    edges: dict[Id, RobotEdge] = {}
    for (key, name), value in fields.items():
        edge = edges.get(key, mechanism.graph.edges[key])
        data = edge.data
        changed = Joint((replace(data.dofs[0], **{name: value}),)) if isinstance(data, Joint) else replace(data, **{name: value})
        edges[key] = replace(edge, data=changed)
    return mechanism.replace(edges=edges)


def _with_namespaces(extra: Extra, declared: Mapping[str, str], context: Context) -> Extra | None:
    """An extra that declares its prefixes as the root of its file did. None, with a warning, where that did not declare one."""
    for prefix in dict.fromkeys(a or b for a, b in _PREFIX.findall(extra.text)):
        if prefix in ("xml", "xmlns") or f"xmlns:{prefix}=" in extra.text:
            continue
        if prefix not in declared:
            context.report.warn(codes.NOT_REPRESENTED, f"'{extra.text[:60]}' is left out: its file does not declare the prefix '{prefix}'")
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


def extras_of(node: XmlNode, mechanism: Mechanism, fields: Fields) -> Iterator[tuple[Id, Extra]]:
    """What a <gazebo> element gives to elements of a robot, as extras of SDF; values of joints and shapes go into ``fields``."""
    reference = node.attributes.get("reference")
    body, joint = Id("body", reference or ""), Id("joint", reference or "")
    for child in node.children:
        if not child.is_element or child.tag in fragments.OBEYED:
            continue
        if not reference:
            if (child.tag in fragments.OF_MODEL or ":" in child.tag) and not _is_taken(child, mechanism):
                yield ROOT, _at_end("model", in_lines(markup(child)))
        elif body in mechanism.graph.vertices:
            yield from _of_link(child, body, mechanism, fields)
        elif joint in mechanism.graph.edges:
            yield from _of_joint(child, joint, mechanism, fields)


def _is_taken(child: XmlNode, mechanism: Mechanism) -> bool:
    """Whether a child of a model would have the name of a link or joint of the robot, which SDF refuses."""
    name = child.attributes.get("name", "")
    return Id("body", name) in mechanism.graph.vertices or Id("joint", name) in mechanism.graph.edges


def _of_joint(child: XmlNode, key: Id, mechanism: Mechanism, fields: Fields) -> Iterator[tuple[Id, Extra]]:
    if child.tag in fragments.OF_JOINT:
        yield from _values(child, *fragments.OF_JOINT[child.tag], [key])
    elif child.tag == "sensor":
        yield key, _at_end("", in_lines(markup(child)))
    elif child.tag in fragments.OF_DOF and (value := _number(child)) is not None:
        name, joint = fragments.OF_DOF[child.tag], mechanism.graph.edges[key].data
        if isinstance(joint, Joint) and len(joint.dofs) == 1 and (value >= 0.0 or name != "stiffness"):
            fields[key, name] = value


def _of_link(child: XmlNode, body: Id, mechanism: Mechanism, fields: Fields) -> Iterator[tuple[Id, Extra]]:
    shapes = mechanism.shapes.get(body, ())
    collisions, visuals = ([view.id for view in shapes if view.shape.role is role] for role in (Role.COLLISION, Role.VISUAL))
    if child.tag in fragments.OF_LINK:
        yield from _values(child, "", fragments.OF_LINK[child.tag], [body])
    elif child.tag == fragments.TURN_GRAVITY_OFF:
        yield body, _at_end("", f"<gravity>{'true' if _text(child).lower() in ('false', 'no', '0') else 'false'}</gravity>")
    elif child.tag == fragments.DAMPING and _number(child) is not None:
        yield body, _at_end("", "<velocity_decay><linear>{0}</linear><angular>{0}</angular></velocity_decay>".format(_text(child)))
    elif child.tag in fragments.IN_LINK:
        yield body, _at_end("", in_lines(_IMU_NOISE.sub(_noise_by_axis, markup(child))))
    elif child.tag in fragments.OF_COLLISION:
        yield from _values(child, *fragments.OF_COLLISION[child.tag], collisions)
    elif child.tag == "material" and _text(child):
        script = f"<script><uri>{fragments.MATERIALS}</uri><name>{escaped(_text(child))}</name></script>"
        yield from ((key, _at_end("material", script)) for key in visuals)
    elif child.tag == "mu1":
        _set(_FIELDS["surface/friction/ode/mu"], child, collisions, fields)
    elif child.tag in words.ROLES:
        yield from _of_shapes(child, visuals if words.ROLES[child.tag] is Role.VISUAL else collisions, fields)


def _of_shapes(child: XmlNode, keys: list[Id], fields: Fields) -> Iterator[tuple[Id, Extra]]:
    """What a fragment gives to all visuals or all collisions of a link, in the words of SDF. The ambient colour is as the diffuse one."""
    rest = [("", inner) for inner in child.children if inner.is_element]
    while rest:
        path, node = rest.pop()
        place = f"{path}/{node.tag}".lstrip("/")
        if place in _FIELDS:
            _set(_FIELDS[place], node, keys, fields)
        elif inner := [(place, inner) for inner in node.children if inner.is_element and not node.attributes]:
            rest += inner
        elif place != "material/ambient":
            yield from ((key, _at_end(path, in_lines(markup(node)))) for key in keys)


def _set(field: ValueField, node: XmlNode, keys: list[Id], fields: Fields) -> None:
    """Give a value to these shapes, if it is one."""
    try:
        value = field.codec.read(_text(node))
    except BadText:
        return
    fields.update({(key, field.name): value if field.name == "rgba" else (value,) for key in keys})


def _values(child: XmlNode, path: str, name: str, keys: list[Id]) -> Iterator[tuple[Id, Extra]]:
    """The value of a fragment at a path of these elements; none where it is no value of its kind."""
    text = _text(child)
    if child.tag in fragments.FLAGS:
        text = text if text in _FLAGS else _FLAGS[3 if text.lower() in ("true", "yes") else 2]
    elif not text or (child.tag not in fragments.VECTORS and _number(child) is None):
        return
    yield from ((key, _at_end(path, f"<{name}>{escaped(text)}</{name}>")) for key in keys)


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


def _number(node: XmlNode) -> float | None:
    """The number that a fragment gives; None for what is none."""
    try:
        return float(NUMBER.read(_text(node)))
    except BadText:
        return None


def _text(node: XmlNode) -> str:
    """What a fragment gives: its attribute ``value``, as in older files, or else its text."""
    return " ".join((node.attributes.get("value") or node.text or "").split())


def _at_end(path: str, text: str) -> Extra:
    """An extra behind the elements that the writer puts there, and in the order in which such extras are found."""
    return Extra(words.FORMAT, path, text, _LAST)
