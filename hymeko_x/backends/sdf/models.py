"""The SDF document: the world, models in models, and the order of what is in them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.sdf.joints import gearbox_tag, joint_tag
from hymeko_x.backends.sdf.links import link_tag
from hymeko_x.backends.sdf.sensors import light_tag
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.formats.sdf.values import TRUTH
from hymeko_x.ir.mechanism import ROOT, WORLD, Id
from hymeko_x.ir.parts import Body, Frame, Joint, Light, Loop
from hymeko_x.xml.printing import Tag, put_back

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.backends.sdf.sheet import SdfSheet
    from hymeko_x.ir.mechanism import Mechanism


def document(sheet: SdfSheet) -> Tag:
    """The root element with everything in it. Raises: Refusal with HX104."""
    root = Tag("sdf", {"version": sheet.version})
    put_back(root, [extra for extra in sheet.extras(ROOT) if extra.path.startswith("@")], {})
    sheet.declared = {name: uri for name, uri in root.attributes.items() if name.startswith("xmlns")}
    lights = [view for view in sheet.mechanism.mounts.get(WORLD, ()) if isinstance(sheet.mechanism.graph.vertices.get(view.mounted), Light)]
    world = sheet.mechanism.notation(ROOT, notations.WORLD) or ("default" if lights and not sheet.from_sdf else None)
    place = root if world is None else root.add("world", name=world)
    _add_models(place, sheet)
    place.children += [light_tag(view, "" if sheet.has_several_models else words.WORLD_SCOPE, WORLD, sheet) for view in lights]
    _put_back_at_root(root, sheet)
    return root


def _put_back_at_root(root: Tag, sheet: SdfSheet) -> None:
    own = [extra for extra in sheet.extras(ROOT) if not extra.path.startswith("@")]
    put_back(root, [extra for extra in own if extra.path not in words.AROUND], sheet.declared)


def _add_models(place: Tag, sheet: SdfSheet) -> None:
    """Add every model, and what stands beside them in the world. Not recursive: each is filled on its own, and put into that around it."""
    members = _members(sheet)
    in_world = place.name == "world"
    is_alone = not sheet.has_several_models
    tags = {scope: Tag("model", {"name": sheet.model_name(scope)}) for scope in members if scope}
    tags[words.WORLD_SCOPE] = place
    tags[""] = Tag("model", {"name": sheet.mechanism.name}) if is_alone else place
    if is_alone and (members or sheet.from_sdf or not in_world):
        members.setdefault("", {})
        place.children.append(tags[""])
    for scope, keys in members.items():
        tag = tags[scope]
        if tag is not place:
            _begin(tag, scope, sheet)
        for key in keys:
            inner = _scope_of_model(key)
            if inner is None:
                tag.children.append(_member_tag(key, scope, WORLD if tag is place else None, sheet))
            else:
                tag.children.append(tags[inner])
    for scope, tag in tags.items():
        if tag is not place and scope:
            sheet.put_back(tag, sheet.places.model_frame(scope))


def _begin(tag: Tag, scope: str, sheet: SdfSheet) -> None:
    """Whether a model stands, and where it is."""
    key = sheet.places.model_frame(scope) if scope else ROOT
    outer = words.scope_around(scope)
    around = sheet.places.model_frame(outer) if outer or not _is_top(scope, sheet) else WORLD
    text = sheet.text(TRUTH, sheet.says_static(scope, key), False, sheet.written(key).get("static"))
    if text is not None:
        tag.add("static").children.append(text)
    sheet.add_model_pose(tag, key, outer if scope else words.WORLD_SCOPE, around, scope)


def _is_top(scope: str, sheet: SdfSheet) -> bool:
    """Whether nothing but the world is around a model."""
    if not scope:
        return True
    return words.SCOPE not in scope.removesuffix(words.SCOPE) and sheet.has_several_models


def _member_tag(key: Id, scope: str, world: Id | None, sheet: SdfSheet) -> Tag:
    if key.kind == "body":
        return link_tag(key, scope, sheet)
    if key.kind == "frame":
        return _frame_tag(key, scope, world, sheet)
    if key.kind == "coupling":
        return gearbox_tag(key, scope, sheet)
    return joint_tag(key, scope, sheet)


def _frame_tag(key: Id, scope: str, world: Id | None, sheet: SdfSheet) -> Tag:
    """The <frame> of a frame, attached to its link, or as its author attached it."""
    tag = Tag("frame", {"name": sheet.name(key, scope)})
    body = sheet.places.mounts.get(key, (WORLD, None))[0]
    model = world or sheet.places.model_frame(scope)
    own = sheet.mechanism.notation(key, notations.ATTACHED)
    base: Id | None = model
    named = sheet.places.find(scope, own) if own else None
    if own is not None and (named is not None or not own):
        tag.attributes["attached_to"] = own
        base = named or model
    elif body != WORLD and (own is not None or not sheet.from_sdf or body != sheet.places.body_of(model)):
        tag.attributes["attached_to"] = sheet.places.name(body, scope)
        base = body
    sheet.add_pose(tag, key, scope, base or model)
    sheet.put_back(tag, key)
    return tag


# ---- order --------------------------------------------------------------------------------------------------------------------


def _members(sheet: SdfSheet) -> dict[str, dict[Id, None]]:
    """What each model contains, in order: the author's, else links, joints and frames; a model in it is given by its frame."""
    mechanism = sheet.mechanism
    found: dict[str, dict[Id, None]] = {}
    for key in _closures_last(dict.fromkeys([*(key for key in mechanism.layout if _is_member(key, sheet)), *_all(sheet)]), mechanism):
        inner = _scope_of_model(key)
        scope = words.split_scope(key.name if inner is None else inner.removesuffix(words.SCOPE))[0]
        if not scope and mechanism.notation(key, notations.IN_WORLD):
            scope = words.WORLD_SCOPE
        _enter(found, scope)
        found[scope][key] = None
        if inner is not None:
            found.setdefault(inner, {})
    return found


def _closures_last(order: Iterable[Id], mechanism: Mechanism) -> Iterable[Id]:
    """The elements in order, but each closure behind the joint above its link: the first joint that leads to a link is that of the tree."""
    waiting: dict[Id, list[Id]] = {}
    members = tuple(order)
    coming = {key for key in members if key.kind == "joint"}
    for key in members:
        edge = mechanism.graph.edges.get(key)
        above = mechanism.parent_joint.get(edge.arcs[-1].target) if edge is not None and key.kind == "loop" else None
        if above is not None and above.id in coming:
            waiting.setdefault(above.id, []).append(key)
            continue
        coming.discard(key)
        yield key
        yield from waiting.get(key, ())


def _enter(found: dict[str, dict[Id, None]], scope: str) -> None:
    """Make the lists of a scope and of those around it, each in that around it."""
    missing = []
    while scope not in found:
        found[scope] = {}
        missing.append(scope)
        if not scope or scope == words.WORLD_SCOPE:
            return
        scope = words.scope_around(scope)
    for inner in missing:
        outer = words.split_scope(inner.removesuffix(words.SCOPE))[0]
        frame = Id("frame", inner + words.MODEL_FRAME)
        if inner and inner != words.WORLD_SCOPE:
            found[outer].setdefault(frame)


def _all(sheet: SdfSheet) -> Iterable[Id]:
    mechanism = sheet.mechanism
    yield from mechanism.depth_first()
    yield from (key for key, _ in mechanism.vertices(Body))
    yield from (joint.id for body in mechanism.depth_first() if (joint := mechanism.parent_joint.get(body)) and not sheet.is_implied(joint))
    yield from (key for key, _, _ in mechanism.edges(Joint) if _is_member(key, sheet))
    yield from (key for key, _, _ in mechanism.edges(Loop))
    yield from sheet.gears
    yield from (key for key, _ in mechanism.vertices(Frame))


def _is_member(key: Id, sheet: SdfSheet) -> bool:
    """Whether an element is written as a child of a model."""
    if key.kind in ("body", "frame"):
        return key in sheet.mechanism.graph.vertices
    if key.kind == "joint":
        view = sheet.mechanism.joints.get(key)
        return view is not None and not sheet.is_implied(view)
    return (key.kind == "loop" and key in sheet.mechanism.graph.edges) or key in sheet.gears


def _scope_of_model(key: Id) -> str | None:
    """The scope of the model that a frame is, or None."""
    if key.kind != "frame":
        return None
    scope, own = words.split_scope(key.name)
    return scope if own == words.MODEL_FRAME and scope else None
