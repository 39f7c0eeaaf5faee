"""Laws over formats: renaming and reordering change nothing else, and what a backend loses is in the ledger."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hymeko_x import formats, pipeline
from hymeko_x.diagnostics import Report
from hymeko_x.ir import parts
from hymeko_x.ir.diff import diff
from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.legalize import Options
from hymeko_x.ir.mechanism import ROOT, Extra, Id, Mechanism
from hymeko_x.ir.rename import rename
from hymeko_x.ir.residue.align import aligned
from hymeko_x.source import NoFiles, Source
from hymeko_x.testing import TREES, mechanisms, urdf_mechanisms

FEW = settings(max_examples=settings.default.max_examples // 10, deadline=None, suppress_health_check=list(HealthCheck))
EXACT = ("hymeko", "urdf")


def through(mechanism: Mechanism, format: str) -> Mechanism:
    """What comes back from a format."""
    found = formats.by_name(format)
    package = pipeline.write(mechanism, found, Options(), NoFiles(), Report(), pipeline.Place(assets="reference"))
    return pipeline.read(Source(f"r.{format}", package.main), found, Report())


def turned(mechanism: Mechanism) -> Mechanism:
    """The same mechanism, said in another order. Shapes, whose ids tell their place on a body, stay in theirs."""
    graph = mechanism.graph
    vertices = dict(reversed(graph.vertices.items()))
    shapes = {key: edge for key, edge in graph.edges.items() if key.kind == "shape"}
    edges = {key: edge for key, edge in reversed(graph.edges.items()) if key not in shapes} | shapes
    return replace(mechanism, graph=Hypergraph(vertices, edges), layout=tuple(reversed(mechanism.layout)))


@pytest.mark.parametrize("format", [*EXACT, "mjcf"])
@FEW
@given(mechanism=urdf_mechanisms())
def test_the_order_of_elements_does_not_matter(format: str, mechanism: Mechanism) -> None:
    there, turned_there = (_meshes_by_content(through(robot, format)) for robot in (mechanism, turned(mechanism)))
    assert diff(there, turned_there) == ()


def _meshes_by_content(mechanism: Mechanism) -> Mechanism:
    """Meshes of one file are numbered as they come; here they are called by what they are."""
    return rename(mechanism, {key: Id(key.kind, f"{mesh.uri} {mesh.scale}") for key, mesh in mechanism.vertices(parts.Mesh)})


@pytest.mark.parametrize("format", [*EXACT, "mjcf"])
@FEW
@given(mechanism=urdf_mechanisms())
def test_converting_what_was_renamed_is_renaming_what_was_converted(format: str, mechanism: Mechanism) -> None:
    names = {key: Id(key.kind, f"new name of {key.name}") for key, _ in mechanism.vertices(parts.Body)}
    names |= {key: Id(key.kind, f"new name of {key.name}") for key in mechanism.joints}
    before, after = (rename(robot, names) for robot in (mechanism, through(mechanism, format)))
    renamed = frozenset(names.values())
    assert diff(_named_by_place(through(before, format), renamed), _named_by_place(after, renamed)) == ()


def _named_by_place(mechanism: Mechanism, renamed: frozenset[Id]) -> Mechanism:
    """What takes its name from a body or joint (shapes, mimics, bases, the dofs of a joint that has several), by its place instead."""
    derived = {key: Id(key.kind, str(number)) for number, key in enumerate(key for key in mechanism.graph.edges if key not in renamed)}
    extras = {key: found for key, found in mechanism.extras.items() if key != ROOT or not _has_classes(found)}
    found = rename(replace(mechanism, extras=extras), derived)
    edges = {key: replace(edge, data=_without_dof_names(edge.data)) for key, edge in found.graph.edges.items()}
    return replace(found, graph=Hypergraph(found.graph.vertices, edges))


def _has_classes(extras: tuple[Extra, ...]) -> bool:
    """Whether these are MJCF's default classes, which the writer calls after what shares them."""
    return all(extra.format == "mjcf" for extra in extras)


def _without_dof_names(part: parts.EdgePart) -> parts.EdgePart:
    return replace(part, dofs=tuple(replace(dof, name=None) for dof in part.dofs)) if isinstance(part, parts.Joint) else part


@pytest.mark.parametrize("format", [*EXACT, "mjcf"])
@FEW
@given(mechanism=mechanisms(TREES))
def test_a_second_way_through_a_format_changes_nothing_more(format: str, mechanism: Mechanism) -> None:
    once = through(mechanism, format)
    assert diff(once, through(once, format)) == ()


@pytest.mark.parametrize("format", [*EXACT, "mjcf"])
@FEW
@given(mechanism=urdf_mechanisms(), data=st.data())
def test_what_is_taken_out_of_the_result_is_in_the_ledger(format: str, mechanism: Mechanism, data: st.DataObject) -> None:
    """A backend that loses a body, planted here, cannot hide."""
    found = formats.by_name(format)
    place = pipeline.Place(assets="reference")
    victim = data.draw(st.sampled_from([key for key, _ in mechanism.vertices(parts.Body)]))
    package = pipeline.write(_without(mechanism, victim), found, Options(), NoFiles(), Report(), place)
    image = pipeline.read_back(package, found, NoFiles())
    bridge, crossed = aligned(image, mechanism)
    losses = pipeline.ledger(mechanism, crossed, bridge, found)
    assert str(victim) in {loss.element for loss in losses}


def _without(mechanism: Mechanism, victim: Id) -> Mechanism:
    """The mechanism without a body and everything that hangs on it."""
    graph = mechanism.graph
    gone = {victim}
    while more := {key for key, edge in graph.edges.items() if key not in gone and any(arc.target in gone for arc in edge.arcs)}:
        gone |= more
    vertices = {key: part for key, part in graph.vertices.items() if key not in gone}
    edges = {key: edge for key, edge in graph.edges.items() if key not in gone}
    return replace(mechanism, graph=Hypergraph(vertices, edges), layout=tuple(key for key in mechanism.layout if key not in gone))
