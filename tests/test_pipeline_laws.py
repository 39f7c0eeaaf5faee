"""Laws over formats: renaming and reordering change nothing else, and what a backend loses is in the ledger."""

from __future__ import annotations

import re

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from hymeko_x import formats, pipeline
from hymeko_x.compare.diff import Tolerance, diff
from hymeko_x.compare.ledger import losses_between
from hymeko_x.diagnostics import Report
from hymeko_x.ir import parts
from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.mechanism import ROOT, Extra, Id, Mechanism
from hymeko_x.ir.names import rename
from hymeko_x.residue.align import align
from hymeko_x.residue.realign import alignment_differences
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Source
from hymeko_x.testing import TREES, mechanisms, urdf_mechanisms

FEW = settings(max_examples=settings.default.max_examples // 10, deadline=None, suppress_health_check=list(HealthCheck))
FORMATS = ("hymeko", "urdf", "mjcf", "usd")
EVERY = (*FORMATS, "xacro")
PLAIN = replace(TREES, dof_kinds=(parts.DofKind.HINGE, parts.DofKind.SLIDE, parts.DofKind.BALL))
"""Trees without joints that float and turn at once, which USD says in other words."""
_HEAD = re.compile(r'^(\w+(?: \w+)?) "[^"]*"')
"""The name of the prim in an extra of USD, which follows the name of its element."""
ROUGHLY = {"usd": Tolerance(1e-6, 1e-6, by_vector=True)}
"""USD has the frames of joints in single precision, that of the largest number of each, and a rotation is rounded anew each time."""


def through(mechanism: Mechanism, format: str) -> Mechanism:
    """What comes back from a format."""
    found = formats.by_name(format)
    package = pipeline.write(mechanism, found, Options(), NoFiles(), Report(), pipeline.OutputPlace(assets="reference"))
    return pipeline.read(Source(f"r.{format}", package.main), found, Report())


def turned(mechanism: Mechanism) -> Mechanism:
    """The same mechanism in another order. Shapes, whose ids tell their place on a body, stay in theirs."""
    graph = mechanism.graph
    vertices = dict(reversed(graph.vertices.items()))
    shapes = {key: edge for key, edge in graph.edges.items() if key.kind == "shape"}
    edges = {key: edge for key, edge in reversed(graph.edges.items()) if key not in shapes} | shapes
    return replace(mechanism, graph=Hypergraph(vertices, edges), layout=tuple(reversed(mechanism.layout)))


@pytest.mark.parametrize("format", EVERY)
@FEW
@given(mechanism=urdf_mechanisms())
@pytest.mark.unread  # generated or damaged input: any
def test_the_order_of_elements_does_not_matter(format: str, mechanism: Mechanism) -> None:
    there, turned_there = (_without_numbers(through(robot, format)) for robot in (mechanism, turned(mechanism)))
    assert differences(there, turned_there) == []


def differences(a: Mechanism, b: Mechanism, format: str = "") -> list[str]:
    """What is not the same, in words; no more exactly than a format that says numbers in single precision."""
    return list(map(str, diff(a, b, ROUGHLY.get(format, Tolerance()))))


def _without_numbers(mechanism: Mechanism) -> Mechanism:
    """Meshes of one file, and in USD shapes, are numbered as they come; here they are called by what and where they are."""
    names = {key: Id(key.kind, f"{mesh.uri} {mesh.scale}") for key, mesh in mechanism.vertices(parts.Mesh)}
    shapes = [(body, place, view.id) for body, views in mechanism.shapes.items() for place, view in enumerate(views)]
    return rename(mechanism, names | {key: Id("shape", f"{body} {place}") for body, place, key in shapes})


@pytest.mark.parametrize("format", EVERY)
@FEW
@given(mechanism=urdf_mechanisms())
@pytest.mark.unread  # generated or damaged input: any
def test_converting_what_was_renamed_is_renaming_what_was_converted(format: str, mechanism: Mechanism) -> None:
    names = {key: Id(key.kind, f"new name of {key.name}") for key, _ in mechanism.vertices(parts.Body)}
    names |= {key: Id(key.kind, f"new name of {key.name}") for key in mechanism.joints}
    before, after = (rename(robot, names) for robot in (mechanism, through(mechanism, format)))
    renamed = frozenset(names.values())
    assert differences(_named_by_place(through(before, format), renamed), _named_by_place(after, renamed)) == []


def _named_by_place(mechanism: Mechanism, renamed: frozenset[Id]) -> Mechanism:
    """What takes its name from a body or joint (shapes, mimics, bases, the dofs of a joint that has several), by its place instead."""
    derived = {key: Id(key.kind, str(number)) for number, key in enumerate(key for key in mechanism.graph.edges if key not in renamed)}
    extras = {key: _headless(found) for key, found in mechanism.extras.items() if key != ROOT or not _has_classes(found)}
    found = rename(replace(mechanism, extras=extras), derived)
    edges = {key: replace(edge, data=_without_dof_names(edge.data)) for key, edge in found.graph.edges.items()}
    return replace(found, graph=Hypergraph(found.graph.vertices, edges))


def _headless(extras: tuple[Extra, ...]) -> tuple[Extra, ...]:
    return tuple(replace(extra, text=_HEAD.sub(r"\1", extra.text)) if extra.format == "usd" else extra for extra in extras)


def _has_classes(extras: tuple[Extra, ...]) -> bool:
    """Whether these are MJCF's default classes, which the writer calls after what shares them."""
    return all(extra.format == "mjcf" for extra in extras)


def _without_dof_names(part: parts.EdgePart) -> parts.EdgePart:
    return replace(part, dofs=tuple(replace(dof, name=None) for dof in part.dofs)) if isinstance(part, parts.Joint) else part


@pytest.mark.parametrize("format", FORMATS)
@FEW
@given(data=st.data())
@pytest.mark.unread  # generated or damaged input: any
def test_a_second_way_through_a_format_changes_nothing_more(format: str, data: st.DataObject) -> None:
    mechanism = data.draw(mechanisms(PLAIN if format == "usd" else TREES))
    assume(any(True for _ in mechanism.vertices(parts.Body)))  # what was written without a body is read as an error
    once = through(mechanism, format)
    assert differences(once, through(once, format), format) == []


@pytest.mark.parametrize("format", FORMATS)
@FEW
@given(mechanism=urdf_mechanisms(), data=st.data())
@pytest.mark.unread  # generated or damaged input: any
def test_what_is_taken_out_of_the_result_is_in_the_ledger(format: str, mechanism: Mechanism, data: st.DataObject) -> None:
    """A backend that loses a body, planted here, cannot hide."""
    found = formats.by_name(format)
    place = pipeline.OutputPlace(assets="reference")
    victim = data.draw(st.sampled_from([key for key, _ in mechanism.vertices(parts.Body)]))
    package = pipeline.write(_without(mechanism, victim), found, Options(), NoFiles(), Report(), place)
    image = pipeline.read_back(package, found, NoFiles())
    alignment, aligned = align(image, mechanism)
    losses = losses_between(mechanism, aligned, alignment_differences(alignment), found)
    assert str(victim) in {loss.element for loss in losses}


def _without(mechanism: Mechanism, victim: Id) -> Mechanism:
    """The mechanism without a body and everything below it."""
    graph = mechanism.graph
    gone = {victim}
    while more := {key for key, edge in graph.edges.items() if key not in gone and any(arc.target in gone for arc in edge.arcs)}:
        gone |= more
    vertices = {key: part for key, part in graph.vertices.items() if key not in gone}
    edges = {key: edge for key, edge in graph.edges.items() if key not in gone}
    return replace(mechanism, graph=Hypergraph(vertices, edges), layout=tuple(key for key in mechanism.layout if key not in gone))
