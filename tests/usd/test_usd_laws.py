"""Whatever a mechanism says, legalizing makes it a stage that USD's own rules have nothing against, with all of its bodies."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace
from pxr import Usd, UsdPhysics

from hymeko_x import formats, pipeline
from hymeko_x.diagnostics import Report
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.rewrite import Options, choose, legalize
from hymeko_x.rewrite.networks import robot_of_network
from hymeko_x.source import NoFiles
from hymeko_x.testing import mechanisms
from tests.usd.test_rules import complaints

SOME = settings(max_examples=max(10, settings.default.max_examples // 8), deadline=None, suppress_health_check=list(HealthCheck))
OPTIONS = st.builds(Options, st.sampled_from([None, "fixed", "free"]), nested=st.sampled_from([None, True]))

REPORTED_ALL_THE_SAME = ("ColliderPlaneDynamic", "JointNoEnabledRigidBody")
"""A plane that collides on a body, and a loop that joins the world with itself, are kept as they are: no engine does anything with them."""


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("laws") / "r.usda"


@SOME
@given(mechanism=mechanisms(), options=OPTIONS)
@pytest.mark.unread("HX009", "HX065", "HX102", "HX104", "HX201")
def test_every_legal_mechanism_is_a_stage_that_the_rules_have_nothing_against(mechanism: Mechanism, options: Options, stage: Path) -> None:
    own_words = replace(mechanism, extras={})  # the generated ones are not USD
    robot = robot_of_network(own_words, formats.by_name("usd"), Report())
    legal = legalize(choose(robot, options, Report()), "usd", Report())
    package = pipeline.write(
        own_words, formats.by_name("usd"), replace(options, lenient=True), NoFiles(), Report(), pipeline.OutputPlace(assets="reference")
    )
    stage.write_bytes(package.main)
    assert [complaint for complaint in complaints(stage) if not any(name in complaint for name in REPORTED_ALL_THE_SAME)] == []
    opened = Usd.Stage.Open(str(stage))
    bodies = [prim for prim in opened.Traverse() if prim.HasAPI(UsdPhysics.RigidBodyAPI)]
    assert len(bodies) == sum(1 for _ in legal.vertices(parts.Body))
