"""Numbers that rewriting computed are short; numbers of the source keep their digits."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

import hymeko_x as hx
from hymeko_x.ir.mechanism import Id, shape_edge
from hymeko_x.ir.parts import Body, Box, Inertial, Role, Sensor, Shape
from hymeko_x.ir.values import Pose
from hymeko_x.rewrite.decimals import shorten_computed
from tests.pace import assert_at_most
from tests.robots import body, chain, hinge

if TYPE_CHECKING:
    from collections.abc import Callable

AUTHORED = 0.12345678901234567


def test_numbers_of_changed_elements_are_short_and_those_of_the_source_stay() -> None:
    source = chain(hinge())
    given = source.replace(vertices={body("b0"): Body(Inertial(AUTHORED, (0.0, 0.0, 0.1)))})
    computed = Inertial(AUTHORED, (2.2e-17, 0.1 + 0.2, AUTHORED), (0.02, 0.03, 0.04, -4.9e-20, 0.0, 0.0))
    rewritten = given.replace(vertices={body("b0"): Body(computed)})
    assert shorten_computed(rewritten, given).vertex(body("b0"), Body) == Body(
        Inertial(AUTHORED, (0.0, 0.3, AUTHORED), (0.02, 0.03, 0.04, 0.0, 0.0, 0.0))
    )


def test_a_mechanism_without_computed_numbers_is_the_same_object() -> None:
    source = chain(hinge())
    other = source.replace(vertices={body("b0"): Body()})
    assert shorten_computed(source, source) is source
    assert shorten_computed(other, source) is other


def test_a_version_with_many_dots_is_no_number() -> None:
    firmware = Sensor("imu", parameters=(("firmware", "1.2.3.4.5.6.7.8.9.10"),))
    source = chain(hinge())
    given = source.replace(vertices={Id("sensor", "imu"): firmware})
    rewritten = given.replace(vertices={body("b0"): Body(Inertial(0.1 + 0.2))})
    assert shorten_computed(rewritten, given).vertex(body("b0"), Body) == Body(Inertial(0.3))


def test_ten_times_as_many_computed_numbers_take_ten_times_as_long() -> None:
    def shortening(count: int) -> Callable[[], object]:
        numbers = [0.1 + number / 3 for number in range(count)]
        source = chain(hinge())
        given = source.replace(vertices={body(f"g{i}"): Body(Inertial(x)) for i, x in enumerate(numbers)})
        computed = given.replace(vertices={body(f"g{i}"): Body(Inertial(x + 1)) for i, x in enumerate(numbers)})
        return lambda: shorten_computed(computed, given)

    assert_at_most(2.0, shortening(10_000), shortening(1_000), count=10)


def test_poses_of_new_elements_are_clean() -> None:
    source = chain(hinge())
    pose = Pose((0.30000000000000004, 1e-17, 0.0), (math.sqrt(0.5), 0.0, 4.3e-17, math.sqrt(0.5)))
    new = source.replace(edges={Id("shape", "new"): shape_edge(Shape(Box((0.1, 0.1, 0.1)), Role.VISUAL), body("b0"), pose)})
    view = shorten_computed(new, source).shapes[body("b0")][0]
    assert view.pose == Pose((0.3, 0.0, 0.0), (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)))


def test_a_file_from_mjcf_has_no_noise_in_urdf() -> None:
    text = """<mujoco model="arm"><compiler angle="radian"/><worldbody><body name="a" pos="0 0 0.1"><freejoint/>
      <geom type="capsule" fromto="0.1 0 0.2 0.3 0 0.2" size="0.02"/>
      <body name="b" pos="0.3 0 0" quat="0.7071067811865476 0 0.7071067811865475 0"><joint axis="0 0 1" pos="0.1 0.2 0"/>
      <inertial pos="0 0 0" mass="1" quat="0.5 0.5 -0.5 0.5" diaginertia="0.3 0.2 0.1"/></body></body></worldbody></mujoco>"""
    urdf = hx.dumps(hx.loads(text.encode(), "mjcf"), "urdf")
    assert 'length="0.2"' in urdf
    assert '<origin xyz="0 0 0" rpy="1.5707963267948966 -1.5707963267948966 0"/>' in urdf
    assert not re.search(r"e-1\d|\d00000000\d|99999999", urdf)


def test_ends_of_a_capsule_have_no_rotation_and_a_rotation_about_y_is_a_pitch_alone() -> None:
    geom = '<geom type="capsule" size="0.1" fromto="0.5 0 0.25 1 0 0.5" mass="1"/>'
    mjcf = f'<mujoco><worldbody><body name="a">{geom}</body></worldbody></mujoco>'
    urdf = hx.dumps(hx.loads(mjcf.encode(), "mjcf"), "urdf")
    found = re.findall(r'<collision>\s*<origin xyz="([^"]*)" rpy="([^"]*)"/>\s*<geometry>\s*<(\w+)', urdf)
    assert [(place, solid) for place, _, solid in found] == [("0.75 0 0.375", "cylinder"), ("0.5 0 0.25", "sphere"), ("1 0 0.5", "sphere")]
    roll, pitch, yaw = map(float, found[0][1].split())
    assert (roll, yaw) == (0.0, 0.0)
    assert math.isclose(abs(math.tan(pitch)), 2.0, rel_tol=1e-12)
    assert [rpy for _, rpy, solid in found if solid == "sphere"] == ["0 0 0", "0 0 0"]
