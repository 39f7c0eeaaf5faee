"""Elements that got other names: poses, axes and frames that name them follow."""

from __future__ import annotations

import pytest

import hymeko_x as hx

NESTED = """<sdf version="1.9"><model name="m"><link name="a"/><link name="b"><pose relative_to="j">0 0 1 0 0 0</pose></link>
<joint name="j" type="revolute"><pose relative_to="a">1 0 0 0 0 0</pose><parent>a</parent><child>f</child>
<axis><xyz expressed_in="a">0 0 1</xyz></axis></joint>
<frame name="f" attached_to="b"><pose>0 2 0 0 0 0</pose></frame>
<model name="inner"><pose relative_to="b">0 0 3 0 0 0</pose><link name="c"/><link name="d"><pose relative_to="c">0 1 0 0 0 0</pose></link>
<joint name="k" type="fixed"><parent>c</parent><child>d</child></joint></model>
<joint name="l" type="fixed"><parent>b</parent><child>inner::c</child></joint>
</model></sdf>"""


def places(robot: hx.Robot, names: list[str]) -> list[tuple[float, ...]]:
    return [robot.bodies[name].world_pose({}).xyz for name in names]


def test_references_follow_new_names() -> None:
    before = hx.loads(NESTED, "sdf")
    with before.edit() as e:
        for name, new in (("a", "base"), ("b", "shank"), ("inner::c", "inner::foot")):
            e.rename(e.bodies[name], new)
        e.rename(e.joints["j"], "knee")
    text = hx.dumps(e.robot, "sdf")
    for part in (
        '<pose relative_to="knee">',
        '<pose relative_to="base">',
        'expressed_in="base"',
        'attached_to="shank"',
        'relative_to="foot"',
    ):
        assert part in text
    assert "<child>f</child>" in text
    after = hx.loads(text, "sdf")
    assert places(after, ["base", "shank", "inner::foot", "inner::d"]) == places(before, ["a", "b", "inner::c", "inner::d"])
    assert after.frames["f"].world_pose().xyz == before.frames["f"].world_pose().xyz
    assert hx.dumps(after, "sdf") == text


def test_references_in_a_part_get_its_prefix() -> None:
    part = hx.loads(NESTED, "sdf")
    whole = part.attach(part, at="b", prefix="left_")
    after = hx.loads(hx.dumps(whole, "sdf"), "sdf")
    names = [*part.bodies]
    assert places(after, [f"left_{name}" for name in names]) == [
        pytest.approx([a + b for a, b in zip(one, (1, 0, 1), strict=True)]) for one in places(part, names)
    ]


def test_a_frame_that_is_gone_is_not_named() -> None:
    with hx.loads(NESTED, "sdf").edit() as e:
        e.remove(e.bodies["inner::d"])
        e.remove(e.frames["f"])
    after = hx.loads(hx.dumps(e.robot, "sdf"), "sdf")
    assert [*after.bodies] == ["a", "b", "inner::c"]
    assert after.bodies["b"].world_pose().xyz == (1, 0, 1)
