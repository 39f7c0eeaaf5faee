"""The links that urdf-usd-converter writes as plain Xforms, because they have neither mass nor shapes nor motion.

It nests prims as the URDF nests links, leaves out the fixed joints above such links, and leads joints that begin at one past
it to the nearest rigid body. All of that is undone here. Its ``creator`` in the stage's custom data tells its files from others.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from hymeko_x.frontends.usd.bodies import BODY, body_at
from hymeko_x.frontends.usd.joints import End, ReadJoint
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Body
from hymeko_x.ir.values import IDENTITY, compose, inverse

if TYPE_CHECKING:
    from hymeko_x.frontends.usd.draft import Draft
    from hymeko_x.frontends.usd.prims import Prim
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.values import Pose

_CREATOR = "URDF USD Converter"
_LINKS = "Geometry"
FIXED_SUFFIX = "_fixed"


def read_bare_links(prims: list[Prim], draft: Draft) -> list[Prim]:
    """Add the links that are plain Xforms as bodies without mass; returns their prims."""
    stage = draft.scene.stage
    creator = stage.GetRootLayer().customLayerData.get("creator", "")
    default = stage.GetDefaultPrim()
    if not str(creator).startswith(_CREATOR) or not default:
        return []
    above = f"{default.GetPath()}/{_LINKS}/"
    bare = [prim for prim in prims if prim.path.startswith(above) and _is_bare_link(prim, above)]
    for prim in bare:
        key = draft.own(prim, "body")
        draft.bodies[prim.path] = key
        draft.vertices[key] = Body()
        draft.take(prim, "@type", *(name for name in prim.properties if name.startswith("xformOp")))
    return bare


def _is_bare_link(prim: Prim, above: str) -> bool:
    """Whether an Xform is a link: bodies are not bare, a mesh of several parts, which is referred to, is none.

    A root called ``world`` is the world, to which the converter joins what hangs there.
    """
    is_world = prim.path == f"{above}world"
    return prim.kind == "Xform" and not is_world and not prim.has_api(BODY) and not prim.composed.HasAuthoredReferences()


def hang_bare_links(bare: list[Prim], joints: list[ReadJoint], draft: Draft) -> list[ReadJoint]:
    """The joints, with each bare link between the bodies where its prim stands."""
    if not bare:
        return joints
    prims = {key: draft.prim_at(path) for path, key in draft.bodies.items()}
    links = {draft.bodies[prim.path] for prim in bare}
    moved = [_from_bare_link(joint, links, prims, draft) for joint in joints]
    return [*moved, *(_fixed_above(prim, draft) for prim in bare)]


def _from_bare_link(joint: ReadJoint, links: set[Id], prims: dict[Id, Prim], draft: Draft) -> ReadJoint:
    """The joint from the bare link right above its child, if there is one; seen from the world both frames are the same."""
    first, second = joint.ends
    above = body_at(prims[second.body].parent, draft) if second.body in prims else None
    if above is None or above[1] not in links:
        return joint
    start = draft.places.of(prims[first.body]).pose if first.body in prims else IDENTITY
    pose = compose(inverse(draft.places.of(above[0]).pose), compose(start, first.pose))
    return replace(joint, ends=(End(above[1], pose), second))


def _fixed_above(prim: Prim, draft: Draft) -> ReadJoint:
    """The fixed joint above a bare link; a bare root stands on the world, as its other roots do."""
    body = draft.bodies[prim.path]
    start: Pose = IDENTITY
    parent = WORLD
    above = body_at(prim.parent, draft)
    if above is not None:
        start, parent = draft.places.of(above[0]).pose, above[1]
    pose = compose(inverse(start), draft.places.of(prim).pose)
    key = draft.own(prim, "joint", body.name + FIXED_SUFFIX)
    return ReadJoint(prim, key, (), (End(parent, pose), End(body, IDENTITY)), is_enabled=True, is_excluded=False)
