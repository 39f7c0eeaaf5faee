"""<worldbody>: bodies with all that is in them, without recursion."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf import notations
from hymeko_x.formats.mjcf.codec import POSE, BadAttribute
from hymeko_x.formats.mjcf.places import INERTIAL, seen_from
from hymeko_x.formats.mjcf.words import kind_of
from hymeko_x.frontends.mjcf.builder import BodyScope, placed
from hymeko_x.frontends.mjcf.geoms import read_geom
from hymeko_x.frontends.mjcf.joints import read_joints
from hymeko_x.frontends.mjcf.mounts import read_camera, read_light, read_site
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Body
from hymeko_x.ir.values import compose

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.frontends.mjcf.builder import MjcfBuilder
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.parts import Inertial
    from hymeko_x.ir.values import Pose
    from hymeko_x.xml.tree import XmlNode


_READERS: dict[str, Callable[[XmlNode, BodyScope, MjcfBuilder], None]] = {
    "geom": read_geom,
    "site": read_site,
    "camera": read_camera,
    "light": read_light,
}


_PLACE = (POSE,)
_WEIGHT = (INERTIAL,)


def reserve_names(root: XmlNode, builder: MjcfBuilder) -> None:
    """Names that authors gave come before those that we make up."""
    for section in root.children:
        stack = [section]
        while stack:
            element = stack.pop()
            name = element.attributes.get("name")
            kind = kind_of(element.tag, section.tag) if name else None
            if name and kind:
                builder.names.reserve(kind, name)
            stack += element.children


def read_worldbody(sections: list[XmlNode], builder: MjcfBuilder) -> None:
    """The world's own geometry, and every tree below it."""
    for section in sections:
        stack: list[tuple[XmlNode, BodyScope | None]] = [(section, None)]
        while stack:
            element, scope = stack.pop()
            below = _read_world(element, builder) if scope is None else _read_body(element, scope, builder)
            stack.extend(reversed(below))


def _read_world(element: XmlNode, builder: MjcfBuilder) -> list[tuple[XmlNode, BodyScope | None]]:
    childclass = element.attributes.get("childclass")
    below = _read_content(element, BodyScope(WORLD, WORLD.name, childclass=childclass), builder)
    builder.keep(element, WORLD)
    return below


def _read_body(element: XmlNode, scope: BodyScope, builder: MjcfBuilder) -> list[tuple[XmlNode, BodyScope | None]]:
    stem = element.attributes.get("name") or scope.stem
    key = builder.own(element, "body", f"{scope.stem}_body")
    childclass = element.take("childclass")
    if childclass is not None:
        builder.note(key, notations.CHILDCLASS, childclass)
        builder.check_class(element, childclass)
    if scope.frame:
        builder.note(key, notations.frame_of(), scope.frame)
    _check_mocap(element, scope)
    pose = placed(builder.values(element, _PLACE, {}, key, always=bool(scope.frame))["pose"], scope)
    builder.vertices[key] = Body(_read_inertial(element, key, builder))
    builder.show(key)
    here = BodyScope(key, stem, childclass=childclass or scope.childclass)
    below = _read_content(element, here, builder, joined=(scope.body, pose))
    builder.keep(element, key)
    return below


def _check_mocap(element: XmlNode, scope: BodyScope) -> None:
    """A body that is moved from outside is a child of the world and has no joints."""
    if element.attributes.get("mocap") != "true":
        return
    jointed = any(child.tag in ("joint", "freejoint") for child in element.children)
    if jointed or scope.body != WORLD:
        raise refuse(codes.UNKNOWN_WORD, "a mocap body is a child of the world and has no joints", element.origin)


def _read_inertial(element: XmlNode, key: Id, builder: MjcfBuilder) -> Inertial | None:
    if builder.settings.inertia_from_geoms:
        return None
    found = element.detach("inertial")
    if not found:
        return None
    node = found[0]
    element.children[:0] = found[1:]
    inertial: Inertial = builder.values(node, _WEIGHT, {}, key, "inertial/")["inertial"]
    builder.keep(node, key, "inertial")
    return inertial


def _read_framed_inertial(node: XmlNode, scope: BodyScope, builder: MjcfBuilder, *, in_world: bool) -> Inertial | None:
    """The inertial of a body that stands in a <frame> of it."""
    if in_world:
        raise refuse(codes.UNKNOWN_WORD, "the world cannot have an inertial", node.origin)
    if builder.settings.inertia_from_geoms:
        return None
    builder.note(scope.body, notations.frame_of("inertial/"), scope.frame)
    groups = (seen_from(INERTIAL, scope.pose),)
    inertial: Inertial = builder.values(node, groups, {}, scope.body, "inertial/", always=True)["inertial"]
    builder.keep(node, scope.body, "inertial")
    return inertial


def _read_content(
    element: XmlNode, here: BodyScope, builder: MjcfBuilder, joined: tuple[Id, Pose] | None = None
) -> list[tuple[XmlNode, BodyScope | None]]:
    """Joints, geoms, sites, cameras and lights, also those in frames. Returns the bodies inside, with their spots."""
    below: list[tuple[XmlNode, BodyScope | None]] = []
    joints: list[tuple[XmlNode, BodyScope]] = []
    content: list[tuple[XmlNode, BodyScope]] = []
    left: list[XmlNode] = []
    framed = "frame" in [child.tag for child in element.children]
    for child, scope in _unframed(element, here, builder) if framed else [(child, here) for child in element.children]:
        if child.tag == "body":
            below.append((child, scope))
        elif child.tag in ("joint", "freejoint"):
            joints.append((child, scope))
        elif child.tag in _READERS:
            content.append((child, scope))
        elif child.tag == "inertial" and scope.frame:
            builder.vertices[here.body] = Body(_read_framed_inertial(child, scope, builder, in_world=joined is None))
        else:
            left.append(child)
    element.children = left
    if joined is None and joints:
        raise refuse(codes.UNKNOWN_WORD, "the world cannot have joints", joints[0][0].origin)
    if joined is not None:
        read_joints(joints, here.body, *joined, builder)
    for child, scope in content:
        _READERS[child.tag](child, scope, builder)
    return below


def _unframed(element: XmlNode, here: BodyScope, builder: MjcfBuilder) -> list[tuple[XmlNode, BodyScope]]:
    """The children of a body, and of the frames in it, in order, each with its scope. Frames are noted at the body."""
    found: list[tuple[XmlNode, BodyScope]] = []
    stack = [(child, here) for child in reversed(element.children)]
    count = 0
    while stack:
        child, scope = stack.pop()
        if child.tag != "frame":
            found.append((child, scope))
            continue
        count += 1
        inner = _read_frame(child, scope, count, builder)
        stack.extend((grandchild, inner) for grandchild in reversed(child.children))
    return found


def _read_frame(element: XmlNode, scope: BodyScope, number: int, builder: MjcfBuilder) -> BodyScope:
    """A <frame>: noted with its attributes as they are, behind the number of the frame around it."""
    builder.note(scope.body, notations.frame(number), notations.MjcfFrame(scope.frame or "0", element.attributes))
    try:
        pose = POSE.read(element.attributes, builder.settings)
    except BadAttribute as error:
        raise builder.bad(element, error) from error
    if "childclass" in element.attributes:
        builder.check_class(element, element.attributes["childclass"])
    return BodyScope(scope.body, scope.stem, str(number), compose(scope.pose, pose), element.attributes.get("childclass", scope.childclass))
