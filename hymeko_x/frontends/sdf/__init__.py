"""The SDF frontend. Everything in a file becomes typed parts of a mechanism, or an extra, or a diagnostic with its origin.

Source: SDF 1.0 to 1.12 as libsdformat reads it; docs/mapping/sdf.md has the mapping.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes, formats
from hymeko_x.diagnostics import refuse
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.frontends.sdf.builder import SdfBuilder, SdfModel, TextsUnread
from hymeko_x.frontends.sdf.checks import check_models, check_numbers
from hymeko_x.frontends.sdf.gearboxes import read_gearboxes
from hymeko_x.frontends.sdf.include import expand_includes
from hymeko_x.frontends.sdf.joints import read_joint
from hymeko_x.frontends.sdf.links import read_link
from hymeko_x.frontends.sdf.models import (
    attach_models,
    break_cycles,
    close_cycles,
    collect_models,
    hold_bases,
    mount_frames,
    name_from_outside,
    note_model,
    place_content,
    place_model,
    register_content,
    with_world_link_as_world,
)
from hymeko_x.frontends.sdf.old import modernised
from hymeko_x.frontends.sdf.sensors import read_light
from hymeko_x.ir.mechanism import ROOT, WORLD
from hymeko_x.source import Reading
from hymeko_x.xml.parse import parse
from hymeko_x.xml.unread import extras_around

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.source import Source
    from hymeko_x.xml.tree import XmlNode


def read(source: Source, report: Report) -> Reading:
    """The mechanism that an SDF file describes, and the residue that it contains.

    Raises: Refusal with HX004 (not XML), HX006 (the root is not <sdf>), HX007 (too large), HX008 (entities).
    """
    document = modernised(parse(source, report), report)
    root = document.root
    _check_root(root)
    residue = [node.take_whole_text() for node in root.take_children(words.RESIDUE)]
    version = _read_version(root, report)
    included = expand_includes(root, source, document.data, words.minor(version), report)
    builder = SdfBuilder(report=report, unread=TextsUnread(root, included.texts, report), versions=included.versions)
    builder.note(ROOT, notations.VERSION, version)
    world = _take_world(root, report)
    name = _read_models(root, world, source, builder)
    for child in root.children:
        if child.taken:
            check_numbers(builder.unread.close(child), builder)
    mechanism = builder.finish(name, extras_around(document, words.FORMAT), source.name, version)
    return Reading(with_world_link_as_world(mechanism), "".join(residue))


def _check_root(root: XmlNode) -> None:
    if root.tag != "sdf":
        raise refuse(codes.WRONG_ROOT, f"the root element is <{root.tag}>, not <sdf>", root.origin, hint=formats.root_hint(root.tag))


def _read_version(root: XmlNode, report: Report) -> str:
    version = root.take("version")
    if version in words.VERSIONS:
        return version
    found = "has no version" if version is None else f"has version '{version}', known are {words.VERSIONS[0]} to {words.VERSIONS[-1]}"
    report.error(codes.UNKNOWN_WORD, f"<sdf> {found}; read as {words.DEFAULT_VERSION}", root.origin)
    return words.DEFAULT_VERSION


def _take_world(root: XmlNode, report: Report) -> XmlNode | None:
    """The first <world>; others stay as they are written."""
    world = root.take_child("world")
    if root.has("world"):
        report.warn(codes.REPEATED, "the file has several worlds; the first one is read, the others are kept as written", root.origin)
    return world


def _read_models(root: XmlNode, world: XmlNode | None, source: Source, builder: SdfBuilder) -> str:
    """Everything in the world, or in the model of the file. Returns the name of the mechanism."""
    place = root if world is None else world
    shared = check_models(place, builder.report)
    tops = list(place.take_children("model"))
    named = None if world is None else world.take("name") or "default"
    if named is not None:
        builder.note(ROOT, notations.WORLD, named)
    is_alone = len(tops) == 1
    around = SdfModel(place, words.WORLD_SCOPE if is_alone else "", WORLD)
    if len(tops) != 1:
        builder.note(ROOT, notations.SEVERAL, True)
    models = collect_models(tops, builder, is_alone=is_alone)
    scenes = [*models, *([around] if world is not None else [])]
    builder.layout += [model.frame for model in models if model.around is None and model.frame in builder.vertices]
    for model in scenes:
        register_content(model, builder)
    if is_alone and world is not None:
        name_from_outside(models[0], builder)
    for model in scenes:
        place_content(model, builder)
    for model in reversed(models):
        place_model(model, builder)
    break_cycles(builder)
    note_model(models, builder)
    attach_models(models, builder)
    _read_content(scenes, builder)
    mount_frames(scenes, builder)
    close_cycles(scenes, builder)
    read_gearboxes(builder)
    hold_bases(models, builder, in_world=world is not None)
    for node in place.take_children("light"):
        read_light(node, WORLD, around, builder)
    for node in shared:
        if node.owner is not None:
            builder.note(node.owner, notations.SHARED, True)
    if not models:
        _report_no_model(root, world, builder.report)
    own = tops[0].take("name") if is_alone else named
    return own or source.stem


def _report_no_model(root: XmlNode, world: XmlNode | None, report: Report) -> None:
    """A scene without models is odd; a file without anything is wrong, and libsdformat refuses it."""
    is_scene = world is not None or any(child.tag in ("light", "actor") for child in root.children)
    tell = report.warn if is_scene else report.error
    tell(codes.MISSING_PART, "the file has no model; the result has no bodies", root.origin)


def _read_content(models: list[SdfModel], builder: SdfBuilder) -> None:
    """Links of all models first: a joint may lead into another model."""
    for model in models:
        for node in model.node.children:
            if node.tag == "link" and node.owner is not None:
                read_link(node, model, builder)
    for model in models:
        for node in model.node.children:
            if node.tag == "joint" and node.owner is not None:
                read_joint(node, model, builder)
