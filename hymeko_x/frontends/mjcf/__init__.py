"""MJCF in. Everything in a file becomes typed parts of a mechanism, or an extra, or a diagnostic with its place.

Source: MJCF of MuJoCo 4.0; docs/mapping/mjcf.md lists what becomes what.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from hymeko_x import codes, formats
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf import RESIDUE
from hymeko_x.formats.mjcf.classes import Classes
from hymeko_x.formats.mjcf.tree import COMMENT, parse
from hymeko_x.formats.mjcf.words import EXPANDED_BY_MUJOCO, KEPT_SECTIONS, settings_of
from hymeko_x.frontends.mjcf.actuators import read_actuators
from hymeko_x.frontends.mjcf.assets import read_assets
from hymeko_x.frontends.mjcf.bodies import read_worldbody, reserve_names
from hymeko_x.frontends.mjcf.builder import MjcfBuilder
from hymeko_x.frontends.mjcf.check import check_references, check_words
from hymeko_x.frontends.mjcf.contacts import read_contacts
from hymeko_x.frontends.mjcf.equalities import read_equalities
from hymeko_x.frontends.mjcf.expand import expand_by_mujoco, expand_includes
from hymeko_x.frontends.mjcf.sensors import read_sensors
from hymeko_x.frontends.mjcf.tendons import read_tendons
from hymeko_x.ir.mechanism import ROOT, WORLD, Id
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import World
from hymeko_x.source import Reading, with_prefix

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.diagnostics import Report
    from hymeko_x.formats.mjcf.codec import Settings
    from hymeko_x.source import Source
    from hymeko_x.xml.tree import XmlNode


_CARRIER = re.compile(rf".*{RESIDUE}\d*", re.DOTALL)


def read(source: Source, report: Report) -> Reading:
    """The mechanism that an MJCF file describes, and the residue that it contains.

    Raises: Refusal for what MuJoCo refuses as well, with file and line.
    """
    root = parse(source, report)
    _check_root(root)
    residue = "".join(_take_residue(root))
    root = expand_includes(root, source, report)
    words = check_words(root)
    if words.tags & EXPANDED_BY_MUJOCO:
        root = expand_by_mujoco(root, source, report)
        words = check_words(root)
    _warn_of_ignored(root, report)
    builder = MjcfBuilder(report, _settings(root), Classes(root_sections(root, "default")), source.name, source.files)
    builder.vertices[WORLD] = World()
    name = _read_name(root, source, builder)
    builder.named |= {name: Id(*name) for name in words.names if name[0] in ("hfield", "flex")}
    _keep_sections(root, builder)
    reserve_names(root, builder)
    read_assets(root.detach("asset"), builder)
    read_worldbody(root.detach("worldbody"), builder)
    read_contacts(root.detach("contact"), builder)
    read_tendons(root.detach("tendon"), builder)
    read_equalities(root.detach("equality"), builder)
    read_actuators(root.detach("actuator"), builder)
    read_sensors(root.detach("sensor"), builder)
    check_references(words.references, builder)
    builder.keep_rest(root)
    return Reading(builder.finish(name), residue)


def _settings(root: XmlNode) -> Settings:
    """The settings of all <compiler> elements together; a later one wins."""
    compilers = [child for child in root.children if child.tag == "compiler"]
    for compiler in compilers:
        if compiler.attributes.get("coordinate") == "global":
            message = '<compiler coordinate="global"> was removed in MuJoCo 2.3.4'
            hint = "load and save the file once with MuJoCo 2.3.3, which rewrites it in local coordinates"
            raise refuse(codes.UNKNOWN_WORD, message, compiler.origin, hint=hint)
    return settings_of([compiler.attributes for compiler in compilers])


def _keep_sections(root: XmlNode, builder: MjcfBuilder) -> None:
    """Keep comments and the sections that the IR cannot represent, in order; others refer to them."""
    for child in root.detach(COMMENT, *KEPT_SECTIONS):
        builder.keep_at_root(child)
        child.release()


def _take_residue(root: XmlNode) -> Iterator[str]:
    """The texts that hold a residue, out of their sections. Where robots were joined, each begins with what their names begin with."""
    for section in root_sections(root, "custom"):
        own = [text for text in section.children if text.tag == "text" and _CARRIER.fullmatch(text.attributes.get("name", ""))]
        if not own:
            continue
        texts: dict[str, str] = {}
        for text in own:
            prefix = text.attributes["name"].partition(RESIDUE)[0]
            texts[prefix] = texts.get(prefix, "") + text.attributes.get("data", "")
        yield from (with_prefix(text, prefix) for prefix, text in texts.items())
        section.children = [child for child in section.children if child not in own]
        if not section.children:
            root.children.remove(section)


def root_sections(root: XmlNode, tag: str) -> list[XmlNode]:
    """The sections of this name, which stay in the tree."""
    return [child for child in root.children if child.tag == tag]


def _check_root(root: XmlNode) -> None:
    if root.tag == "mujoco":
        return
    hint = "it is a part that other files include, and no model of its own" if root.tag == "mujocoinclude" else formats.root_hint(root.tag)
    raise refuse(codes.WRONG_ROOT, f"the root element is <{root.tag}>, not <mujoco>", root.origin, hint=hint)


def _warn_of_ignored(root: XmlNode, report: Report) -> None:
    for child in root_sections(root, "body"):
        message = "a <body> outside of <worldbody> is ignored by MuJoCo; it is kept as an extra"
        report.warn(codes.UNKNOWN_WORD, message, child.origin)


def _read_name(root: XmlNode, source: Source, builder: MjcfBuilder) -> str:
    name = root.take("model")
    if name:
        return name
    builder.note(ROOT, UNNAMED, True)
    return source.stem
