"""Laws over formats: what is legal stays as it is, and a verdict depends on the robot and not on how it is written."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

import hymeko_x as hx
from hymeko_x.compare.diff import diff
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.rewrite import Options, choose, legalize
from hymeko_x.testing import mechanisms

SOME = settings(max_examples=max(5, settings.default.max_examples // 5), deadline=None, suppress_health_check=list(HealthCheck))
FEW = settings(max_examples=max(5, settings.default.max_examples // 20), deadline=None, suppress_health_check=list(HealthCheck))


OPTIONS = st.builds(
    Options,
    st.sampled_from([None, "fixed", "free"]),
    st.sampled_from([None, "none", "motor", "position", "velocity"]),
    st.sampled_from([None, "single", "layered"]),
    st.sampled_from([None, True, False]),
    split=st.booleans(),
)


@pytest.mark.parametrize("format", ["mjcf", "urdf", "usd", "xacro"])
@SOME
@given(mechanism=mechanisms(), options=OPTIONS)
@pytest.mark.unread("HX101", "HX102", "HX103", "HX104")
def test_what_is_legal_stays_as_it_is(format: str, mechanism: Mechanism, options: Options) -> None:
    try:
        legal = legalize(choose(mechanism, options, Report()), format, Report())
    except Refusal:
        assume(False)
    assert diff(legal, legalize(legal, format, Report())) == ()


ROBOT = """<robot name="r"><link name="base"><inertial><mass value="2"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<link name="tip"><inertial><origin xyz="0.1 0 0"/><mass value="{mass}"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<joint name="j" type="revolute"><parent link="base"/><child link="tip"/><origin xyz="0 0 {height}" rpy="{roll} 0 0"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
_VALUES = st.fixed_dictionaries({"mass": st.floats(0.1, 10), "height": st.floats(-2, 2), "roll": st.floats(-3, 3)})


@FEW
@given(values=_VALUES, field=st.sampled_from(["mass", "height", "roll"]), change=st.floats(0.01, 0.5))
def test_verify_says_same_for_equal_and_different_for_changed(
    values: dict[str, float], field: str, change: float, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("verify")
    one, other, changed = (folder / name for name in ("one.urdf", "other.urdf", "changed.urdf"))
    one.write_text(ROBOT.format(**values))
    other.write_text(" ".join(ROBOT.format(**{name: f"{value:.17e}" for name, value in values.items()}).split("\n")))
    changed.write_text(ROBOT.format(**{**values, field: values[field] + change}))
    assert hx.verify(one, other, samples=5).is_same
    assert hx.verify(one, changed, samples=5).verdict == "different"
