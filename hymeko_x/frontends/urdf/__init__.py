"""The URDF frontend. Everything in a file becomes typed parts of a mechanism, or an extra, or a diagnostic with its origin.

Source: URDF 1.0 as urdfdom reads it; docs/mapping/urdf.md has the mapping.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes, formats
from hymeko_x.diagnostics import refuse
from hymeko_x.formats import urdf as words
from hymeko_x.formats.urdf.notations import VERSION
from hymeko_x.frontends.urdf.builder import UrdfBuilder
from hymeko_x.frontends.urdf.joints import read_joints
from hymeko_x.frontends.urdf.links import read_link
from hymeko_x.frontends.urdf.materials import finish_materials, read_robot_material
from hymeko_x.frontends.urdf.ros2_control import read_ros2_control
from hymeko_x.frontends.urdf.srdf import read_srdf
from hymeko_x.frontends.urdf.structure import check_structure
from hymeko_x.frontends.urdf.transmissions import read_transmission
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.source import Reading
from hymeko_x.xml.parse import parse
from hymeko_x.xml.unread import Unread, extras_around

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.source import Source
    from hymeko_x.xml.tree import XmlNode


def read(source: Source, report: Report) -> Reading:
    """The mechanism that a URDF file describes, and the residue that it contains.

    Raises: Refusal with HX004 (not XML), HX006 (the root is not <robot>), HX007 (too large), HX008 (entities).
    """
    document = parse(source, report)
    root = document.root
    _check_root(root)
    builder = UrdfBuilder(report, Unread(root, document.data, words.FORMAT, report))
    name = _read_name(root, source, builder)
    residue = [node.take_whole_text() for node in root.take_children(words.RESIDUE)]
    _read_version(root, builder)
    for node in root.take_children("material"):
        read_robot_material(root, node, builder)
    for node in root.take_children("link"):
        read_link(node, builder)
    read_joints(root, builder)
    for node in root.take_children("transmission"):
        read_transmission(node, builder)
    read_ros2_control(root, builder)
    finish_materials(builder)
    check_structure(root, builder, is_whole=source.is_whole("".join(residue)))
    _check_templates(root, builder)
    builder.add_extras(ROOT, *read_srdf(source, builder))
    return Reading(builder.finish(name, extras_around(document, words.FORMAT), source.name), "".join(residue))


def _check_root(root: XmlNode) -> None:
    if root.tag == "robot":
        return
    message = f"the root element is <{root.tag}>, not <robot>"
    raise refuse(codes.WRONG_ROOT, message, root.origin, hint=formats.root_hint(root.tag))


def _read_name(root: XmlNode, source: Source, builder: UrdfBuilder) -> str:
    name = root.take("name")
    if name:
        return name
    builder.report.warn(codes.BAD_NAME, f"the robot has no name; it is called '{source.stem}' after its file", root.origin)
    return source.stem


def _read_version(root: XmlNode, builder: UrdfBuilder) -> None:
    version = root.attributes.get("version")
    if version is None:
        return
    if version not in words.VERSIONS:
        message = f"<robot version> is '{version}', known are {', '.join(words.VERSIONS)}; read as 1.0, and the text is kept as written"
        builder.report.warn(codes.UNKNOWN_WORD, message, root.origin)
        return
    if version == "1.0":
        root.take("version")
        builder.follow(ROOT, VERSION, follows=True)
    builder.version = version


def _check_templates(root: XmlNode, builder: UrdfBuilder) -> None:
    """Report once that the file was meant for xacro: templates in names, or xacro's elements."""
    name = next((key.name for key in (*builder.vertices, *builder.edges) if "${" in key.name or "$(" in key.name), None)
    tag = next((node.tag for node in root.children if node.tag.startswith("xacro:")), None)
    if name is None and tag is None:
        return
    hint = "if this is a xacro file, read it with --from xacro"
    if tag is not None:
        message = f"<{tag}> is text for xacro; what it stands for is missing, and the text is kept as it is"
        builder.report.error(codes.LEFTOVER_TEMPLATE, message, root.origin, hint=hint)
    else:
        builder.report.warn(codes.LEFTOVER_TEMPLATE, f"the name '{name}' is text for xacro; it is kept as it is", root.origin, hint=hint)
