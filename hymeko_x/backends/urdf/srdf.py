"""SRDF, which stands beside a URDF file for MoveIt: groups, named poses, and pairs of links that never touch."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.formats import urdf as words
from hymeko_x.formats.urdf import srdf
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.mechanism import ROOT, WORLD, Extra, Id, end_of, numbers_weight
from hymeko_x.ir.parts import Body, Contact, PoseSet, Stance
from hymeko_x.rewrite.roots import without
from hymeko_x.xml.parse import parse_text
from hymeko_x.xml.printing import Tag, render
from hymeko_x.xml.text import attributes_text, escaped

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.ir.mechanism import JointView, Mechanism
    from hymeko_x.rewrite.context import Options
    from hymeko_x.source import Files, Package
    from hymeko_x.xml.tree import XmlNode


def srdf_beside(printed: Mechanism, _package: Package, _files: Files, options: Options) -> Mapping[str, bytes]:
    """The SRDF file of a robot that was printed as URDF, by its name; none where there is nothing to write."""
    text = srdf_text(printed, {})
    return {f"{options.beside}{srdf.SUFFIX}": text} if text else {}


def srdf_text(printed: Mechanism, names: Mapping[Id, Id]) -> bytes:
    """The SRDF of a robot, empty where there is nothing to write. ``names`` are the new ids of links and joints that its extras name."""
    tags: list[Tag] = [*_extras(printed, names), *_poses(printed), *_exclusions(printed)]
    if not tags:
        return b""
    places = {name: place for place, name in enumerate(srdf.ORDER)}
    tags.sort(key=lambda tag: places.get(tag.name, len(places)))
    root = Tag("robot", {"name": printed.name}, tags)
    return "\n".join(['<?xml version="1.0"?>', *render(root), ""]).encode()


def _extras(printed: Mechanism, names: Mapping[Id, Id]) -> Iterator[Tag]:
    for extra in printed.extras.get(ROOT, ()):
        if extra.format == words.FORMAT and extra.path == srdf.PATH:
            top = parse_text(extra.text)
            for node in top.walk():
                for attribute, kind in srdf.REFERENCES.get(node.tag, {}).items():
                    new = names.get(Id(kind, node.attributes.get(attribute, "")))
                    node.attributes |= {} if new is None else {attribute: new.name}
            yield tag_of(top)


def tag_of(node: XmlNode) -> Tag:
    """A node with everything in it as a tag. Not recursive."""
    top = Tag(node.tag, dict(node.attributes))
    stack = [(node, top)]
    while stack:
        source, tag = stack.pop()
        if source.text and source.text.strip():
            tag.children.append(escaped(source.text.strip()))
        for child in source.children:
            if child.is_element:
                stack.append((child, tag.add(child.tag, **child.attributes)))
    return top


def as_virtual_joint(mechanism: Mechanism, held: JointView) -> Mechanism:
    """The mechanism with the free joint of its base as a virtual joint of the SRDF alone."""
    attributes = {"name": held.id.name, "type": "floating", "parent_frame": WORLD.name, "child_link": held.child.name}
    extra = Extra(words.FORMAT, srdf.PATH, f"<virtual_joint{attributes_text(attributes)}/>")
    opened = without(mechanism, [held.id])
    return replace(opened, extras={**opened.extras, ROOT: (*opened.extras.get(ROOT, ()), extra)})


def _poses(printed: Mechanism) -> Iterator[Tag]:
    """The named poses: of each joint with one coordinate its value in rad or m."""
    for _, _, arcs in printed.edges(Stance):
        key = end_of(arcs, 1)
        part = printed.part(key, PoseSet)
        if key is None or part is None:
            continue
        tag = Tag("group_state", {"name": key.name, "group": part.group or srdf.ALL})
        for arc in arcs:
            view = printed.joints.get(arc.target)
            numbers = numbers_weight(arc)
            if arc.sign == 0 and view is not None and len(view.joint.dofs) == len(numbers) == 1:
                tag.add("joint", name=arc.target.name, value=numbers_text(numbers))
        yield tag


def _exclusions(printed: Mechanism) -> Iterator[Tag]:
    for _, contact, arcs in printed.edges(Contact):
        links = [arc.target.name for arc in arcs if isinstance(printed.graph.vertices.get(arc.target), Body)]
        if contact.kind == "exclude" and len(links) == len(arcs) == 2:
            reason = dict(contact.parameters).get(srdf.REASON)
            more = {srdf.REASON: reason} if isinstance(reason, str) else {}
            yield Tag("disable_collisions", {"link1": links[0], "link2": links[1], **more})
