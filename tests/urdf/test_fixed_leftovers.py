"""What exporters write into fixed joints, where it means nothing, stays at the joints that have it."""

from __future__ import annotations

import hymeko_x as hx

LIMIT = '<limit lower="0" upper="0" effort="3" velocity="4"/>'


def joint(child: str, inner: str) -> str:
    return f'<joint name="to_{child}" type="fixed"><parent link="base"/><child link="{child}"/>{inner}</joint><link name="{child}"/>'


def written(**inner: str) -> str:
    robot = hx.loads(
        f'<robot name="r"><link name="base"/>{"".join(joint(child, text) for child, text in inner.items())}</robot>', "urdf"
    ).mechanism
    return hx.dumps(robot, "urdf")


def test_a_fixed_joint_gets_no_limit_of_another_one() -> None:
    assert written(a=LIMIT, b=LIMIT, c="").count("<limit") == 2
    assert written(a=LIMIT, b=LIMIT, c="").index('name="to_c"') > written(a=LIMIT, b=LIMIT, c="").rindex("<limit")


def test_what_all_fixed_joints_have_comes_back() -> None:
    assert written(a=LIMIT, b=LIMIT, c=LIMIT.replace("3", "5")).count("<limit") == 3
    assert 'effort="5"' in written(a=LIMIT, b=LIMIT, c=LIMIT.replace("3", "5"))
