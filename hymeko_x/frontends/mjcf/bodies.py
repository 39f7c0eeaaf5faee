"""<worldbody>: bodies with all that is in them, without recursion."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf import notations
from hymeko_x.formats.mjcf.codec import POSE, BadAttribute
from hymeko_x.formats.mjcf.places import INERTIAL, seen_from
from hymeko_x.formats.mjcf.words import kind_of
from hymeko_x.frontends.mjcf.geoms import read_geom
from hymeko_x.frontends.mjcf.joints import read_joints
from hymeko_x.frontends.mjcf.mounts import read_camera, read_light, read_site
from hymeko_x.frontends.mjcf.spot import Spot, placed
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Body
from hymeko_x.ir.values import compose

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.formats.mjcf.tree import Element
    from hymeko_x.frontends.mjcf.draft import Draft
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.parts import Inertial
    from hymeko_x.ir.values import Pose


_READERS: dict[str, Callable[[Element, Spot, Draft], None]] = {
    "geom": read_geom,
    "site": read_site,
    "camera": read_camera,
    "light": read_light,
}


_PLACE = (POSE,)
_WEIGHT = (INERTIAL,)


def reserve_names(root: Element, draft: Draft) -> None:
    """Names that authors gave come before those that we make up."""
    for section in root.children:
        stack = [section]
        while stack:
            element = stack.pop()
            name = element.attributes.get("name")
            kind = kind_of(element.tag, section.tag) if name else None
            if name and kind:
                draft.names.reserve(kind, name)
            stack += element.children


def read_worldbody(sections: list[Element], draft: Draft) -> None:
    """The world's own geometry, and every tree below it."""
    for section in sections:
        stack: list[tuple[Element, Spot | None]] = [(section, None)]
        while stack:
            element, spot = stack.pop()
            below = _read_world(element, draft) if spot is None else _read_body(element, spot, draft)
            stack.extend(reversed(below))


def _read_world(element: Element, draft: Draft) -> list[tuple[Element, Spot | None]]:
    childclass = element.attributes.get("childclass")
    below = _read_content(element, Spot(WORLD, WORLD.name, childclass=childclass), draft)
    draft.keep(element, WORLD)
    return below


def _read_body(element: Element, spot: Spot, draft: Draft) -> list[tuple[Element, Spot | None]]:
    stem = element.attributes.get("name") or spot.stem
    key = draft.own(element, "body", f"{spot.stem}_body")
    childclass = element.take("childclass")
    if childclass is not None:
        draft.note(key, notations.CHILDCLASS, childclass)
        draft.check_class(element, childclass)
    if spot.frame:
        draft.note(key, notations.frame_of(), spot.frame)
    _check_mocap(element, spot)
    pose = placed(draft.values(element, _PLACE, {}, key, always=bool(spot.frame))["pose"], spot)
    draft.vertices[key] = Body(_read_inertial(element, key, draft))
    draft.show(key)
    here = Spot(key, stem, childclass=childclass or spot.childclass)
    below = _read_content(element, here, draft, joined=(spot.body, pose))
    draft.keep(element, key)
    return below


def _check_mocap(element: Element, spot: Spot) -> None:
    """A body that is moved from outside hangs on the world and has no joints."""
    if element.attributes.get("mocap") != "true":
        return
    jointed = any(child.tag in ("joint", "freejoint") for child in element.children)
    if jointed or spot.body != WORLD:
        raise refuse(codes.UNKNOWN_WORD, "a mocap body is a child of the world and has no joints", element.origin)


def _read_inertial(element: Element, key: Id, draft: Draft) -> Inertial | None:
    if draft.settings.inertia_from_geoms:
        return None
    found = element.detach("inertial")
    if not found:
        return None
    node = found[0]
    element.children[:0] = found[1:]
    inertial: Inertial = draft.values(node, _WEIGHT, {}, key, "inertial/")["inertial"]
    draft.keep(node, key, "inertial")
    return inertial


def _read_framed_inertial(node: Element, spot: Spot, draft: Draft, *, in_world: bool) -> Inertial | None:
    """The inertial of a body that stands in a <frame> of it."""
    if in_world:
        raise refuse(codes.UNKNOWN_WORD, "the world cannot have an inertial", node.origin)
    if draft.settings.inertia_from_geoms:
        return None
    draft.note(spot.body, notations.frame_of("inertial/"), spot.frame)
    groups = (seen_from(INERTIAL, spot.pose),)
    inertial: Inertial = draft.values(node, groups, {}, spot.body, "inertial/", always=True)["inertial"]
    draft.keep(node, spot.body, "inertial")
    return inertial


def _read_content(element: Element, here: Spot, draft: Draft, joined: tuple[Id, Pose] | None = None) -> list[tuple[Element, Spot | None]]:
    """Joints, geoms, sites, cameras and lights, also those in frames. Returns the bodies inside, with their spots."""
    below: list[tuple[Element, Spot | None]] = []
    joints: list[tuple[Element, Spot]] = []
    content: list[tuple[Element, Spot]] = []
    left: list[Element] = []
    framed = "frame" in [child.tag for child in element.children]
    for child, spot in _unframed(element, here, draft) if framed else [(child, here) for child in element.children]:
        if child.tag == "body":
            below.append((child, spot))
        elif child.tag in ("joint", "freejoint"):
            joints.append((child, spot))
        elif child.tag in _READERS:
            content.append((child, spot))
        elif child.tag == "inertial" and spot.frame:
            draft.vertices[here.body] = Body(_read_framed_inertial(child, spot, draft, in_world=joined is None))
        else:
            left.append(child)
    element.children = left
    if joined is None and joints:
        raise refuse(codes.UNKNOWN_WORD, "the world cannot have joints", joints[0][0].origin)
    if joined is not None:
        read_joints(joints, here.body, *joined, draft)
    for child, spot in content:
        _READERS[child.tag](child, spot, draft)
    return below


def _unframed(element: Element, here: Spot, draft: Draft) -> list[tuple[Element, Spot]]:
    """The children of a body, and of the frames in it, in order, each with its spot. Frames are noted at the body."""
    found: list[tuple[Element, Spot]] = []
    stack = [(child, here) for child in reversed(element.children)]
    count = 0
    while stack:
        child, spot = stack.pop()
        if child.tag != "frame":
            found.append((child, spot))
            continue
        count += 1
        inner = _read_frame(child, spot, count, draft)
        stack.extend((grandchild, inner) for grandchild in reversed(child.children))
    return found


def _read_frame(element: Element, spot: Spot, number: int, draft: Draft) -> Spot:
    """A <frame>: noted with its attributes as they are, behind the number of the frame around it."""
    draft.note(spot.body, notations.frame(number), notations.Frame(spot.frame or "0", element.attributes))
    try:
        pose = POSE.read(element.attributes, draft.settings)
    except BadAttribute as error:
        raise draft.bad(element, error) from error
    if "childclass" in element.attributes:
        draft.check_class(element, element.attributes["childclass"])
    return Spot(spot.body, spot.stem, str(number), compose(spot.pose, pose), element.attributes.get("childclass", spot.childclass))
