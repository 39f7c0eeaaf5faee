"""What SDF represents of a robot, as <gazebo> fragments for a format that has no more than them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from hymeko_x.backends.sdf.joints import joint_tag
from hymeko_x.backends.sdf.sensors import joint_sensor_tag, sensor_tag
from hymeko_x.backends.sdf.sheet import SdfSheet
from hymeko_x.formats import sdf as sdf_words
from hymeko_x.formats.sdf import fragments as words
from hymeko_x.formats.sdf.values import NUMBER
from hymeko_x.ir.mechanism import ROOT, WORLD
from hymeko_x.ir.parts import Body, Light, Loop, Role
from hymeko_x.xml.namespaces import PREFIX, with_declared
from hymeko_x.xml.parse import parse_text
from hymeko_x.xml.printing import Tag, in_lines, markup, put_back, ready
from hymeko_x.xml.text import escaped
from hymeko_x.xml.tree import XmlNode

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from hymeko_x.ir.mechanism import Id, Mechanism

_SCRIPT = re.compile(r"<script>.*?<name>\s*([^<]*?)\s*</name>.*?</script>", re.DOTALL)
_MODEL_PATHS = ("model", "world/model")


def fragments_of(mechanism: Mechanism) -> list[str]:
    """The <gazebo> elements of a robot that came from SDF: of links, of joints, and of the model; then <ros2_control>. Empty for others."""
    sheet = SdfSheet(mechanism, "")
    if not sheet.from_sdf:
        return []
    bodies = [(key, list(_of_link(key, sheet))) for key, _ in mechanism.vertices(Body)]
    joints = [(view.id, list(_of_joint(view.id, sheet))) for view in mechanism.joints.values() if not sheet.is_implied(view)]
    found = [_fragment({"reference": key.name}, children) for key, children in (*bodies, *joints) if children]
    found += [_fragment({}, [child]) for child in _of_model(sheet)]
    found += [extra.text for extra in sheet.extras(ROOT) if extra.path in _MODEL_PATHS and extra.text.startswith(f"<{words.BESIDE}")]
    declared = {extra.path[1:]: extra.text for extra in sheet.extras(ROOT) if extra.path.startswith(f"@{PREFIX}")}
    return [with_declared(text, declared, again=True) for text in found]


def _fragment(attributes: dict[str, str], children: Sequence[Tag | str]) -> str:
    return ready(Tag(words.TAG, attributes, children), 1)


# ---- links -----------------------------------------------------------------------------------------------------------------------


def _of_link(body: Id, sheet: SdfSheet) -> Iterator[Tag | str]:
    back = {name: word for word, name in words.OF_LINK.items()}
    for node in _content(body, sheet):
        if node.tag == "inertial":  # URDF has the numbers
            continue
        yield _leaf(back[node.tag], _text(node)) if node.tag in back else in_lines(markup(node))
    shapes = sheet.mechanism.shapes.get(body, ())
    collisions = [_whole(view.id, sheet) for view in shapes if view.shape.role is Role.COLLISION]
    frictions = {view.shape.friction[:1] for view in shapes if view.shape.role is Role.COLLISION}
    if len(frictions) == 1 and (friction := next(iter(frictions))):
        yield _leaf("mu1", NUMBER.write(friction[0]))
    for word, (path, name) in words.OF_COLLISION.items() if all(node.children for node in collisions) else ():
        yield from _shared(word, f"{path}/{name}".lstrip("/"), collisions)
    scripts = {_script(view.id, sheet) for view in shapes if view.shape.role is Role.VISUAL}
    if len(scripts) == 1 and (script := next(iter(scripts))):
        yield _leaf("material", script)
    for mount in sheet.mechanism.mounts.get(body, ()):
        if not isinstance(sheet.mechanism.graph.vertices.get(mount.mounted), Light) and sheet.is_sensor(mount.mounted):
            yield sensor_tag(mount, sdf_words.split_scope(body.name)[0], body, sheet)


def _shared(word: str, path: str, elements: Sequence[XmlNode]) -> Iterator[Tag]:
    """The value below all of these elements, where they have the same one: a fragment is for the whole link."""
    found = {_value(path, element) for element in elements}
    if len(found) == 1 and (value := next(iter(found))) is not None:
        yield _leaf(word, value)


def _whole(key: Id, sheet: SdfSheet) -> XmlNode:
    """What SDF alone represents of an element of the mechanism."""
    own = sheet.extras(key)
    if not own:
        return XmlNode("x", {})
    whole = Tag("x", {})
    put_back(whole, own, {})
    return parse_text(ready(whole, 0))


def _value(path: str, element: XmlNode) -> str | None:
    """The text of the first element at a path below this one."""
    nodes = [element]
    for step in path.split("/"):
        nodes = [child for node in nodes for child in node.children if child.tag == step]
    return _text(nodes[0]) if nodes else None


def _script(key: Id, sheet: SdfSheet) -> str | None:
    texts = [found[1] for extra in sheet.extras(key) if (found := _SCRIPT.search(extra.text)) is not None]
    return texts[0] if texts else None


# ---- joints and the model ----------------------------------------------------------------------------------------------------------


def _of_joint(joint: Id, sheet: SdfSheet) -> Iterator[Tag | str]:
    whole = _whole(joint, sheet)
    for word, (path, name) in words.OF_JOINT.items() if whole.children else ():
        yield from _shared(word, f"{path}/{name}", [whole])
    dofs = sheet.mechanism.joints[joint].joint.dofs
    for word, name in words.OF_DOF.items() if len(dofs) == 1 else ():
        if (value := getattr(dofs[0], name)) != 0.0:
            yield _leaf(word, NUMBER.write(value))
    if not dofs:
        yield _leaf(words.OBEYED[0], "true")
    for sensor in sheet.joint_sensors.get(joint, ()):
        yield joint_sensor_tag(sensor, sdf_words.split_scope(joint.name)[0], sheet)


def _of_model(sheet: SdfSheet) -> Iterator[Tag | str]:
    """What the model has besides links and joints, and the closures of its loops."""
    for extra in sheet.extras(ROOT):
        if extra.path in _MODEL_PATHS and extra.text.startswith("<"):
            yield from (in_lines(markup(node)) for node in _nodes(extra.text) if node.tag in words.OF_MODEL)
    if sheet.is_static(""):
        yield _leaf("static", "true")
    for key, _, arcs in sheet.mechanism.edges(Loop):
        if len(arcs) == 2 and all(arc.target.kind == "body" and arc.target != WORLD for arc in arcs):
            yield joint_tag(key, sdf_words.split_scope(key.name)[0], sheet)


def _content(key: Id, sheet: SdfSheet) -> Iterator[XmlNode]:
    """The elements right below an element of the mechanism that SDF alone represents."""
    for extra in sheet.extras(key):
        if not extra.path and extra.text.startswith("<") and not extra.text.startswith("<?"):
            yield from _nodes(extra.text)


def _nodes(text: str) -> list[XmlNode]:
    return [child for child in parse_text(f"<x>{text}</x>").children if child.is_element]


def _text(node: XmlNode) -> str:
    return " ".join((node.text or "").split())


def _leaf(name: str, text: str) -> Tag:
    return Tag(name, {}, [escaped(text)])
