"""<model>: the tree of models, the names and places of everything in them, and which bases stand, float or are open."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.formats.sdf.gearboxes import GEARBOX
from hymeko_x.formats.sdf.values import TRUTH
from hymeko_x.frontends.sdf.builder import SdfModel
from hymeko_x.ir.mechanism import ROOT, WORLD, Id, joint_edge, mount_edge
from hymeko_x.ir.names import free_name, rename
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Body, Dof, DofKind, Frame, Joint, Loop, World
from hymeko_x.ir.values import IDENTITY, compose, inverse

if TYPE_CHECKING:
    from hymeko_x.frontends.sdf.builder import SdfBuilder
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.ir.values import Pose
    from hymeko_x.xml.tree import XmlNode


# ---- names and places ----------------------------------------------------------------------------------------------------------


def collect_models(tops: list[XmlNode], builder: SdfBuilder, *, is_alone: bool) -> list[SdfModel]:
    """All models, those around others first. One that is alone gives its name to the mechanism, and no scope to its content."""
    found: list[SdfModel] = []
    stack: list[tuple[XmlNode, SdfModel | None]] = [(node, None) for node in reversed(tops)]
    while stack:
        node, around = stack.pop()
        model = _alone(node, builder) if is_alone and around is None else _in_scope(node, around, builder)
        found.append(model)
        nested = [child for child in node.children if child.tag == "model"]
        for child in nested:
            child.taken = True
        stack += [(child, model) for child in reversed(nested)]
    return found


def _alone(node: XmlNode, builder: SdfBuilder) -> SdfModel:
    frame = Id("frame", words.MODEL_FRAME)
    builder.named[words.MODEL_FRAME] = frame
    return SdfModel(node, "", frame, is_static=_is_static(node, None, ROOT, builder))


def _in_scope(node: XmlNode, around: SdfModel | None, builder: SdfBuilder) -> SdfModel:
    outer = "" if around is None else around.scope
    name = node.take("name") or "model"
    free = free_name(outer + name, lambda name: name + words.SCOPE + words.MODEL_FRAME in builder.named)
    if free != outer + name:
        builder.warn(codes.DUPLICATE_NAME, node, f"there are two models called '{name}'; this one is '{free}'")
    scope = free + words.SCOPE
    node.owner = frame = builder.fresh("frame", scope + words.MODEL_FRAME, node.origin)
    if free != outer + name:
        builder.written.setdefault(frame, {})["@name"] = name
    builder.vertices[frame] = Frame()
    builder.named.setdefault(outer + name, frame)
    builder.named[scope + words.MODEL_FRAME] = frame
    return SdfModel(node, scope, frame, around, _is_static(node, around, frame, builder))


def _is_static(node: XmlNode, around: SdfModel | None, key: Id, builder: SdfBuilder) -> bool:
    own: bool = builder.child_value(node, "static", TRUTH, False, key, "static")
    if own:
        builder.written.setdefault(key, {}).setdefault("static", "true")
    return own or (around is not None and around.is_static)


def register_content(model: SdfModel, builder: SdfBuilder) -> None:
    """Give ids to the links, frames and joints of a model; references may lead to any of them."""
    kinds = (("link", "body"), ("frame", "frame"), ("joint", "joint"))
    for tag, kind in kinds:
        for node in model.node.take_children(tag):
            name = words.scoped(model.scope, node.attributes.get("name", ""))
            is_gearbox = kind == "joint" and node.attributes.get("type") == GEARBOX
            key = builder.own(node, "coupling" if is_gearbox else kind, model.scope)
            builder.named.setdefault(name, key)
            if model.frame == WORLD:
                builder.note(key, notations.IN_WORLD, True)
            if kind == "joint" and not is_gearbox:
                builder.joints.setdefault(name, key)
            elif kind == "body":
                builder.vertices[key] = Body()
            elif kind == "frame":
                builder.vertices[key] = Frame()
    inner = [child for child in model.node.children if child.tag != "model" or model.frame != WORLD]  # those of the world stand there first
    builder.layout += [child.owner for child in inner if child.owner is not None]


def name_from_outside(model: SdfModel, builder: SdfBuilder) -> None:
    """The world's own frames and joints name the content of its only model with that model's name before it."""
    name = model.node.attributes.get("name", "")
    outside = f"{words.WORLD_SCOPE}{name}"
    known = [(inner, key) for inner, key in builder.named.items() if inner[:1] != words.WORLD_SCOPE]
    inside = {f"{outside}{words.SCOPE}{inner}": key for inner, key in known}
    builder.named |= {outside: model.frame, **inside}


def place_content(model: SdfModel, builder: SdfBuilder) -> None:
    """Put the links and frames of a model into the frame graph; joints are given in their children."""
    for node in model.node.children:
        if node.owner is None or node.tag not in ("link", "frame", "joint"):
            continue
        default = model.frame
        if node.tag == "frame":
            default = _attachment(node, model, builder)
        elif node.tag == "joint":
            default = _child_end(node, model, builder)
        pose, name = builder.pose(node, node.owner)
        builder.frames.put(node.owner, builder.base_of(node, model.scope, name, default), pose)


def _attachment(node: XmlNode, model: SdfModel, builder: SdfBuilder) -> Id:
    """What a frame is attached to; it is given in that."""
    assert node.owner is not None
    name = node.take("attached_to")
    if name == "":
        builder.note(node.owner, notations.ATTACHED, name)
    if not name:
        builder.attached[node.owner] = model.frame
        return model.frame
    builder.note(node.owner, notations.ATTACHED, name)
    found = builder.find(model.scope, name)
    if found is None:
        message = f"{node.subject} is attached to '{name}', which is not defined; the model is used"
        builder.error(codes.UNDEFINED_REFERENCE, node, message)
    builder.attached[node.owner] = found or model.frame
    return found or model.frame


def _child_end(node: XmlNode, model: SdfModel, builder: SdfBuilder) -> Id:
    child = node.child("child")
    found = None if child is None else builder.find(model.scope, (child.text or "").strip())
    return found or model.frame


def place_model(model: SdfModel, builder: SdfBuilder) -> None:
    """Put the frame of a model into the frame graph; what it contains must be there already.

    The model's pose is that of its placement frame where it names one.
    """
    around = WORLD if model.around is None else model.around.frame
    scope = words.WORLD_SCOPE if model.around is None and not model.scope else "" if model.around is None else model.around.scope
    key = model.frame if model.frame in builder.vertices else ROOT
    pose, name = builder.pose(model.node, key)
    base = builder.base_of(model.node, scope, name, around)
    placed = model.node.attributes.get("placement_frame")
    if placed:
        pose = compose(pose, _back_from_placement(placed, model, builder))
    builder.frames.put(model.frame, base, pose)


def _back_from_placement(name: str, model: SdfModel, builder: SdfBuilder) -> Pose:
    found = builder.find(model.scope, name)
    inside = None if found is None else builder.frames.inside(found, model.frame)
    if inside is None:
        message = f"{model.node.subject}: the placement frame '{name}' is not defined in the model; the model's own frame is used"
        builder.error(codes.UNDEFINED_REFERENCE, model.node, message)
        return IDENTITY
    return inverse(inside)


def note_model(models: list[SdfModel], builder: SdfBuilder) -> None:
    """Keep where the frame of the only model is, which is no element."""
    for model in models:
        pose = builder.frames.in_world(model.frame)
        if model.frame not in builder.vertices and pose != IDENTITY:
            builder.note(ROOT, notations.MODEL, pose)


def break_cycles(builder: SdfBuilder) -> None:
    """Frames that are given in each other have no place: one of them is put into the world, which is reported."""
    for frame in builder.frames.cycles():
        message = f"{frame} is given in a frame that is given in {frame}; it is placed at the origin"
        builder.report.error(codes.CYCLE, message, builder.origins.get(frame), element=str(frame))
        builder.frames.put(frame, WORLD, IDENTITY)


# ---- frames on bodies ------------------------------------------------------------------------------------------------------------


def body_of(frame: Id, builder: SdfBuilder) -> Id | None:
    """The body (or the world) that a link, frame or model moves with; None where frames are attached to each other in a circle."""
    path: dict[Id, None] = {}
    while frame.kind not in ("body", "world") and frame not in builder.moves_with and frame not in path:
        path[frame] = None
        if frame not in builder.attached:
            break
        frame = builder.attached[frame]
    found = frame if frame.kind in ("body", "world") else builder.moves_with.get(frame)
    builder.moves_with |= dict.fromkeys(path, found)
    return found


def attach_models(models: list[SdfModel], builder: SdfBuilder) -> None:
    """A model moves with its canonical link: the named one, else its first link, else that of its first nested model."""
    for model in models:
        name = model.node.attributes.get("canonical_link")
        found = builder.find(model.scope, name) if name else None
        if name and found is None:
            message = f"{model.node.subject}: the canonical link '{name}' is not defined; the first link is used"
            builder.error(codes.UNDEFINED_REFERENCE, model.node, message)
        if found is None:
            found = next(
                (child.owner for tag in ("link", "model") for child in model.node.children if child.tag == tag and child.owner), None
            )
        builder.attached[model.frame] = WORLD if found is None else found
    for model in models:
        for node in model.node.children:
            if node.tag == "joint" and node.owner is not None:  # a frame on a joint moves with the joint's child
                builder.attached[node.owner] = _child_end(node, model, builder)


def mount_frames(models: list[SdfModel], builder: SdfBuilder) -> None:
    """Every frame, and every model that has one of its own, becomes a frame on its body."""
    keys = [key for model in models for key in (model.frame, *(node.owner for node in model.node.children if node.tag == "frame"))]
    frames = [key for key in keys if key is not None and key != WORLD and key in builder.vertices]
    lost = [key for key in frames if body_of(key, builder) is None]
    if lost:
        those = str(lost[0]) if len(lost) == 1 else f"{lost[0]} and {len(lost) - 1} more frames"
        message = f"{those}: attached in a circle, to no link; attached to the world instead"
        builder.report.error(codes.CYCLE, message, builder.origins.get(lost[0]), element=str(lost[0]))
    for key in frames:
        mount_frame(key, builder)


def mount_frame(key: Id, builder: SdfBuilder) -> None:
    """Put a frame on the body that it is attached to; one that is attached in a circle on the world."""
    body = body_of(key, builder) or WORLD
    if body == WORLD:
        builder.vertices.setdefault(WORLD, World())
    builder.edges[builder.names.take("mount", key.name)] = mount_edge(body, key, builder.frames.relative(key, body))


# ---- bases -----------------------------------------------------------------------------------------------------------------------


def hold_bases(models: list[SdfModel], builder: SdfBuilder, *, in_world: bool) -> None:
    """Bodies of static models stand; other bodies without a parent joint float, or are open where nothing says where they are."""
    children = {edge.arcs[1].target for edge in builder.edges.values() if isinstance(edge.data, Joint)}
    links = [(model, node.owner) for model in models for node in model.node.children if node.tag == "link" and node.owner]
    roots = [(model, body) for model, body in links if body not in children]
    for model, body in roots:
        pose = builder.frames.in_world(body)
        if not model.is_static and len(roots) == 1 and pose == IDENTITY and not in_world:
            return
        _hold(body, pose, Joint() if model.is_static else Joint((Dof(DofKind.FREE),)), builder)


def _hold(body: Id, pose: Pose, joint: Joint, builder: SdfBuilder) -> None:
    word = "free" if joint.dofs else "static"
    key = builder.names.take("joint", f"{body.name}_{word}")
    builder.vertices.setdefault(WORLD, World())
    builder.edges[key] = joint_edge(joint, WORLD, body, replace(pose, written=None))
    builder.note(key, notations.IMPLIED, True)
    builder.note(key, UNNAMED, True)
    builder.origins[key] = builder.origins[body]


def close_cycles(models: list[SdfModel], builder: SdfBuilder) -> None:
    """Joints that lead to a link which another joint holds close a loop.

    So does the joint above the first link of a cycle of which no link is a root, so that the tree starts there.
    """
    above: dict[Id, tuple[Id, Id]] = {}
    closing: list[Id] = []
    for key, edge in builder.edges.items():
        if not isinstance(edge.data, Joint):
            continue
        if edge.arcs[1].target in above:
            closing.append(key)
        above.setdefault(edge.arcs[1].target, (key, edge.arcs[0].target))
    done: set[Id] = {WORLD}
    for start in above:
        path: dict[Id, None] = {}
        body = start
        while body not in done and body in above and body not in path:
            path[body] = None
            body = above[body][1]
        if body in path:
            members = list(path)
            cycle = set(members[members.index(body) :])
            closing.append(above[next(key for key in builder.vertices if key in cycle)][0])
        done.update(path)
    owners = {node.owner: node for model in models for node in model.node.children if node.tag == "joint"} if closing else {}
    loops = {joint: _make_loop(joint, owners[joint], builder) for joint in closing}
    builder.layout = [loops.get(key, key) for key in builder.layout] if loops else builder.layout


def _make_loop(joint: Id, node: XmlNode, builder: SdfBuilder) -> Id:
    """The loop that the joint is instead."""
    edge = builder.edges.pop(joint)
    assert isinstance(edge.data, Joint)
    dofs = edge.data.dofs
    kind = "joint" if dofs else "weld"
    if len(dofs) == 1 and dofs[0].kind is DofKind.BALL:
        kind, dofs = "connect", dofs if dofs[0].damping else ()
    node.owner = key = builder.fresh("loop", joint.name, node.origin)
    arcs = tuple([replace(arc, sign=0) for arc in edge.arcs])
    builder.edges[key] = replace(edge, data=Loop(kind, dofs), arcs=arcs)
    for table in (builder.notations, builder.written):
        if joint in table:
            table[key] = table.pop(joint)
    return key


# ---- the world -----------------------------------------------------------------------------------------------------------------


def with_world_link_as_world(mechanism: Mechanism) -> Mechanism:
    """The link that the writer makes for what is on the world is the world again."""
    link = Id("body", words.WORLD_LINK)
    above = mechanism.parent_joint.get(link) if link in mechanism.graph.vertices else None
    if above is None or above.parent != WORLD or above.joint.dofs or mechanism.children.get(link) or above.parent_pose != above.child_pose:
        return mechanism
    return rename(mechanism.replace(without=[above.id]), {link: WORLD})
