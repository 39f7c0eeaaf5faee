"""SRDF beside a URDF file of the same name: pairs of links that never touch and named poses become parts, everything else extras."""

from __future__ import annotations

import posixpath
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.formats import urdf as words
from hymeko_x.formats.urdf import srdf
from hymeko_x.formats.urdf.notations import VIRTUAL
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import WORLD, Extra, joint_edge
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Contact, Dof, DofKind, Joint, PoseSet, Stance, World
from hymeko_x.ir.values import Z
from hymeko_x.source import Source
from hymeko_x.xml.parse import parse
from hymeko_x.xml.printing import markup
from hymeko_x.xml.tree import read_numbers

if TYPE_CHECKING:
    from hymeko_x.frontends.urdf.builder import UrdfBuilder
    from hymeko_x.ir.mechanism import RobotArc
    from hymeko_x.xml.tree import XmlNode


def read_srdf(source: Source, builder: UrdfBuilder) -> list[Extra]:
    """Add what the SRDF file beside a URDF file says, and return its other elements as extras; nothing where there is none."""
    name = f"{posixpath.splitext(posixpath.basename(source.name.replace(chr(92), '/')))[0]}{srdf.SUFFIX}"
    path = source.files.find(name)
    if path is None:
        return []
    found = Report()
    try:
        root = parse(Source(path, source.files.read(path)), found).root
        problem = next(iter(map(str, found.errors())), "")
    except (OSError, Refusal) as error:
        problem = str(error)
    if not problem and root.tag != "robot":
        problem = f"its root element is <{root.tag}>, not <robot>"
    if problem:
        builder.report.warn(codes.READ_BESIDE, f"'{name}' beside the robot cannot be read, and is left out: {problem}")
        return []
    builder.report.note(codes.READ_BESIDE, f"'{name}' beside the robot is read with it: its exclusions, poses and groups")
    nodes = [node for node in root.children if node.is_element]
    floating = next((node for node in nodes if _floats(node, builder)), None)
    if floating is not None:
        _add_virtual_joint(floating, builder)
    return [extra for node in nodes if node is not floating for extra in _read(node, builder)]


def _read(node: XmlNode, builder: UrdfBuilder) -> list[Extra]:
    read = {"disable_collisions": _read_exclusion, "group_state": _read_pose}.get(node.tag)
    if read is not None and read(node, builder):
        return []
    return [Extra(words.FORMAT, srdf.PATH, markup(node))]


def _read_exclusion(node: XmlNode, builder: UrdfBuilder) -> bool:
    """Two links that never touch; whether both are there."""
    links = [builder.links.get(node.attributes.get(name, "")) for name in ("link1", "link2")]
    arcs: tuple[RobotArc, ...] = tuple([Arc(link, 0) for link in links if link is not None])
    if len(arcs) < 2 or not {"link1", "link2", srdf.REASON}.issuperset(node.attributes):
        return False
    reason = node.attributes.get(srdf.REASON)
    key = builder.fresh("contact", "_".join(link.name for link in links if link is not None), node.origin)
    builder.note(key, UNNAMED, True)
    builder.edges[key] = Edge(Contact("exclude", ((srdf.REASON, reason),) if reason is not None else ()), arcs)
    return True


def _read_pose(node: XmlNode, builder: UrdfBuilder) -> bool:
    """A named pose of a group; whether each of its joints is there with numbers."""
    values: list[RobotArc] = []
    for child in node.children:
        joint = builder.joints.get(child.attributes.get("name", ""))
        numbers = read_numbers(child.attributes.get("value", ""))
        if child.tag != "joint" or joint is None or not numbers:
            return False
        values.append(Arc(joint, 0, numbers))
    key = builder.fresh("pose", node.attributes.get("name", ""), node.origin)
    builder.vertices[key] = PoseSet(node.attributes.get("group"))
    builder.edges[builder.names.take("stance", key.name)] = Edge(Stance(), (Arc(key, 1), *values))
    return True


def _floats(node: XmlNode, builder: UrdfBuilder) -> bool:
    """Whether it is a floating joint from the world to a link: then the robot floats. Others are only frames of a planner."""
    given = node.attributes
    is_known = given.get("child_link") in builder.links and given.get("name") not in builder.joints
    return node.tag == "virtual_joint" and is_known and (given.get("type"), given.get("parent_frame")) == ("floating", WORLD.name)


def _add_virtual_joint(node: XmlNode, builder: UrdfBuilder) -> None:
    key = builder.fresh("joint", node.attributes.get("name", ""), node.origin)
    builder.vertices.setdefault(WORLD, World())
    builder.edges[key] = joint_edge(Joint((Dof(DofKind.FREE, Z),)), WORLD, builder.links[node.attributes["child_link"]])
    builder.note(key, VIRTUAL, True)
