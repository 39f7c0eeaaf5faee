"""URDF text has everything that its profile allows, and every mechanism can be rewritten so that it fits into the profile."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from hymeko_x.backends.urdf import write
from hymeko_x.compare.diff import Tolerance, diff
from hymeko_x.diagnostics import Report
from hymeko_x.frontends.urdf import read
from hymeko_x.ir import parts
from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.mechanism import Id, Mechanism, joint_edge
from hymeko_x.ir.values import pose
from hymeko_x.rewrite import Options, choose, legalize
from hymeko_x.source import Source
from hymeko_x.testing import mechanisms, urdf_mechanisms
from hymeko_x.testing.values import VECTORS
from tests.urdf.samples import dump, load, reported


@given(urdf_mechanisms())
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@pytest.mark.unread("HX028", "HX045")
def test_what_urdf_has_a_word_for_comes_back_exactly(mechanism: Mechanism) -> None:
    text = dump(mechanism)
    assert diff(mechanism, load(text)) == ()
    assert load(text) == mechanism
    assert dump(load(text)) == text


@given(VECTORS, st.tuples(*[st.floats(-1.0, 1.0)] * 4).filter(lambda q: max(map(abs, q)) > 1e-2))
def test_a_rotation_that_was_not_written_as_rpy_comes_back_to_the_last_bits(
    xyz: tuple[float, float, float], quat: tuple[float, float, float, float]
) -> None:
    a, b = Id("body", "a"), Id("body", "b")
    edges = {Id("joint", "j"): joint_edge(parts.Joint(), a, b, replace(pose(xyz, quat), written=None))}
    mechanism = Mechanism("r", Hypergraph({a: parts.Body(), b: parts.Body()}, edges))
    assert diff(mechanism, load(dump(mechanism)), Tolerance(absolute=2e-14)) == ()


@given(mechanisms(), st.sampled_from([None, "fixed", "free"]))
@settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@pytest.mark.unread  # generated or damaged input: any
def test_every_mechanism_can_be_written_after_legalising_and_the_text_is_well_formed(mechanism: Mechanism, base: str | None) -> None:
    own_words = replace(mechanism, extras={})  # the generated ones are not XML
    legal = legalize(choose(own_words, Options(base=base), Report()), "urdf", Report())  # type: ignore[arg-type]
    text = write(legal, Options(), Report()).main
    assert not [message for message in reported(text) if "HX005" in message]
    result = read(Source("r.urdf", text), Report()).mechanism
    assert {key for key, _ in legal.vertices(parts.Body)} == {key for key, _ in result.vertices(parts.Body)}
    assert legalize(legal, "urdf", Report()).graph == legal.graph
