"""<equality>: closures of loops, and joints that follow joints."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf.codec import BadAttribute, numbers_of
from hymeko_x.formats.mjcf.notations import attribute
from hymeko_x.formats.mjcf.words import shifted
from hymeko_x.frontends.mjcf.contacts import find_end
from hymeko_x.frontends.mjcf.mounts import take_parameters
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Coupling, Joint, Loop
from hymeko_x.ir.tendons import moves_along_one
from hymeko_x.ir.values import IDENTITY, Pose, compose, inverse, pose

if TYPE_CHECKING:
    from hymeko_x.frontends.mjcf.builder import MjcfBuilder
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.xml.tree import XmlNode


def read_equalities(sections: list[XmlNode], builder: MjcfBuilder) -> None:
    """Closures and couplings in order; those of tendons and flexes are kept as extras."""
    placed: dict[Id, Pose] = {}
    for section in sections:
        for element in section.children:
            if element.tag in ("connect", "weld"):
                _read_loop(element, builder, placed)
            elif element.tag == "joint" and "joint2" in element.attributes:
                _read_coupling(element, builder)
            else:
                _check_held(element, builder)
                builder.keep_at_root(element, "equality")


def _check_held(element: XmlNode, builder: MjcfBuilder) -> None:
    """A joint that an equality holds in place moves along one coordinate."""
    name = element.attributes.get("joint1")
    if name is None:
        return
    joint = builder.find(element, "joint", name)
    if not moves_along_one(Arc(joint, 0, None, builder.roles.get(joint, {}).get(name, "")), builder.edges):
        raise refuse(codes.UNKNOWN_WORD, f"<joint> holds '{name}', expected a hinge or a slide", element.origin)


# ---- couplings -----------------------------------------------------------------------------------------------------------------


def _read_coupling(element: XmlNode, builder: MjcfBuilder) -> None:
    """Source: MuJoCo, equality/joint: q1 - ref1 = c0 + c1 (q2 - ref2) + ..."""
    follower, follower_role, follower_ref = _dof(element, "joint1", builder)
    leader, leader_role, leader_ref = _dof(element, "joint2", builder)
    for joint, role in ((follower, follower_role), (leader, leader_role)):
        if not moves_along_one(Arc(joint, 0, None, role), builder.edges):
            raise refuse(codes.UNKNOWN_WORD, f"<joint> couples '{role or joint.name}', expected hinges and slides", element.origin)
    if (follower, follower_role) == (leader, leader_role):
        raise refuse(codes.REPEATED, f"<joint> couples '{follower_role or follower.name}' to itself", element.origin)
    key = builder.own(element, "coupling", follower.name)
    builder.base(element, key, tag="joint@equality")
    try:
        found = numbers_of(element.attributes, "polycoef", 1, 5)
        written = (0.0, 1.0) if found is None else found if len(found) > 1 else (found[0], 1.0)
        coefficients = shifted(written, -leader_ref)
    except BadAttribute as error:
        raise builder.bad(element, error) from error
    except OverflowError as error:
        raise builder.bad(element, BadAttribute("polycoef", "numbers that stay finite at the reference")) from error
    text = element.take("polycoef")
    coefficients[0] += follower_ref
    while len(coefficients) > 2 and coefficients[-1] == 0.0:
        coefficients.pop()
    if text is not None and (follower_ref or leader_ref):
        builder.note(key, attribute("polycoef"), text)
    active = element.take("active") != "false"
    arcs: tuple[RobotArc, ...] = (
        Arc(follower, 1, (1.0,), follower_role),
        Arc(leader, -1, tuple(coefficients), leader_role),
    )
    builder.edges[key] = Edge(Coupling(active), arcs)
    builder.keep(element, key)
    builder.show(key)


def _dof(element: XmlNode, attribute: str, builder: MjcfBuilder) -> tuple[Id, str, float]:
    """The joint, the role that names the dof in it, and the dof's reference coordinate."""
    name = element.take(attribute) or ""
    joint = builder.find(element, "joint", name)
    role = builder.roles.get(joint, {}).get(name, "")
    data = builder.edges[joint].data
    assert isinstance(data, Joint)
    dof = next((dof for dof in data.dofs if role and dof.name == role), data.dofs[0])
    return joint, role, dof.ref


# ---- closures ------------------------------------------------------------------------------------------------------------------


def _read_loop(element: XmlNode, builder: MjcfBuilder, placed: dict[Id, Pose]) -> None:
    key = builder.own(element, "loop", element.tag)
    base = builder.base(element, key)
    active = element.take("active") != "false"
    if "site1" in element.attributes:
        arcs: tuple[RobotArc, ...] = tuple(Arc(find_end(element, "site", name, builder)) for name in ("site1", "site2"))
    else:
        arcs = _body_arcs(element, key, builder, placed)
    builder.edges[key] = Edge(Loop(element.tag, (), active, take_parameters(element, base)), arcs)
    builder.keep(element, key)
    builder.show(key)


def _body_arcs(element: XmlNode, key: Id, builder: MjcfBuilder, placed: dict[Id, Pose]) -> tuple[RobotArc, ...]:
    """Both bodies with the closure's frame in each, where the bodies are at the reference configuration unless relpose is given."""
    first = find_end(element, "body", "body1", builder)
    second = find_end(element, "body", "body2", builder) if "body2" in element.attributes else WORLD
    if first == second:
        raise refuse(codes.REPEATED, f"<{element.tag}> joins '{first.name}' to itself", element.origin)
    try:
        anchor = numbers_of(element.attributes, "anchor", 3, 3) or (0.0, 0.0, 0.0)
        relative = numbers_of(element.attributes, "relpose", 7, 7)
    except BadAttribute as error:
        raise builder.bad(element, error) from error
    for name in ("anchor", "relpose"):
        if (text := element.take(name)) is not None:
            builder.note(key, attribute(name), text)
    at = Pose((anchor[0], anchor[1], anchor[2]))
    between = compose(inverse(_in_world(first, builder, placed)), _in_world(second, builder, placed))
    if element.tag == "connect":
        return Arc(first, 0, at), Arc(second, 0, compose(inverse(between), at))
    if relative is not None and any(relative[3:]):  # its position is where the anchor goes, as MuJoCo computes it
        return Arc(first, 0, pose((relative[0], relative[1], relative[2]), relative[3:])), Arc(second, 0, at)  # type: ignore[arg-type]
    return Arc(first, 0, compose(between, at)), Arc(second, 0, at)


def _in_world(body: Id, builder: MjcfBuilder, placed: dict[Id, Pose]) -> Pose:
    """Where a body is at the reference configuration; filled in for all bodies at first use."""
    if not placed:
        placed[WORLD] = IDENTITY
        for edge in builder.edges.values():
            if isinstance(edge.data, Joint):
                parent, child = edge.arcs
                at = parent.weight if isinstance(parent.weight, Pose) else IDENTITY
                placed[child.target] = compose(placed[parent.target], at)
    return placed[body]
