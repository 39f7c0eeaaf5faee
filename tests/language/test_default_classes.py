"""A default class of MJCF is a stereotype of the text: it is written once, gives its fields to elements, and is a class again in MJCF."""

from __future__ import annotations

import mujoco
import pytest

import hymeko_x as hx
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import Id

MJCF = """<mujoco model="leg">
  <compiler angle="radian" autolimits="true"/>
  <default>
    <default class="leg">
      <joint damping="2" armature="0.01" axis="0 1 0"/>
      <general dyntype="none" biastype="affine" ctrlrange="-3 3" gainprm="50" biasprm="0 -50 -5"/>
      <default class="knee">
        <joint range="-2.75 -0.8125"/>
      </default>
      <default class="visual">
        <geom type="sphere" contype="0" conaffinity="0" group="2" material="grey"/>
      </default>
      <default class="foot">
        <geom size="0.0225" pos="0 0 -0.213" condim="6" friction="0.8 0.02 0.01"/>
      </default>
    </default>
  </default>
  <asset>
    <material name="grey" rgba="0.5 0.5 0.5 1"/>
  </asset>
  <worldbody>
    <body name="trunk" childclass="leg">
      <freejoint name="root"/>
      <geom class="visual" size="0.1"/>
      <geom class="visual" size="0.2" pos="0.5 0 0"/>
      <geom name="round" class="leg" size="0.25"/>
      <body name="thigh">
        <joint name="hip" range="-1 1"/>
        <geom class="foot"/>
        <body name="calf">
          <joint name="knee" class="knee"/>
          <geom class="foot"/>
          <geom class="foot" name="heel" pos="0.125 0 -0.213"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <general class="leg" name="hip_drive" joint="hip"/>
    <general class="leg" name="knee_drive" joint="knee" forcerange="-45 45" gainprm="75" biasprm="0 -75 -5"/>
  </actuator>
</mujoco>
"""
CLASSES = """\
  leg() : class {
    joint { damping 2 armature 0.01 axis [0 1 0] }
    general { dyntype=none biastype=affine ctrlrange [-3 3] gainprm 50 biasprm [0 -50 -5] }
    knee() { joint { range [-2.75 -0.8125] } }
    visual() { geom { type=sphere contype 0 conaffinity 0 group 2 material=grey } }
    foot() { geom { size 0.0225 pos [0 0 -0.213] condim 6 friction [0.8 0.02 0.01] } }
  }
"""


def _hymeko() -> str:
    return hx.dumps(hx.loads(MJCF.encode(), "mjcf"), "hymeko")


def _joint(robot: hx.Mechanism, name: str) -> parts.Dof:
    return robot.joints[Id("joint", name)].joint.dofs[0]


def test_a_default_class_is_written_once() -> None:
    text = _hymeko()
    assert CLASSES in text
    assert "mjcf {\n    default" not in text
    for line in (
        "@hip : leg { + trunk - thigh limit [-1rad 1rad] }",
        "@knee : knee { + thigh - calf }",
        "thigh { shape : foot {} }",
        "shape : foot { at [0.125 0 -0.213] name=heel }",
        "hip_drive : leg, actuator.general { - hip }",
        "knee_drive : leg, actuator.general { - knee forcerange [-45 45] gainprm 75 biasprm [0 -75 -5] }",
    ):
        assert line in text, line


def test_an_element_that_names_the_class_in_force_still_names_it() -> None:
    assert "name=round class=leg" in _hymeko()


def test_the_robot_comes_back_with_its_classes() -> None:
    robot = hx.loads(MJCF.encode(), "mjcf").mechanism
    back = hx.loads(hx.dumps(robot, "hymeko").encode(), "hymeko").mechanism
    assert back == robot
    assert back.stereotypes == robot.stereotypes
    again = hx.dumps(back, "mjcf")
    assert again == hx.dumps(robot, "mjcf")
    assert again.count("<default") == 5
    for name in ("damping=", "biastype=", "condim="):
        assert again.count(name) == 1


def test_a_value_changed_in_a_class_changes_it_for_every_element() -> None:
    text = _hymeko().replace("damping 2 armature", "damping 3 armature")
    robot = hx.loads(text.encode(), "hymeko").mechanism
    assert [_joint(robot, name).damping for name in ("hip", "knee")] == [3.0, 3.0]
    mjcf = hx.dumps(robot, "mjcf")
    assert mjcf.count("damping=") == 1
    model = mujoco.MjModel.from_xml_string(mjcf)
    assert model.dof_damping[6:].tolist() == [3.0, 3.0]


def test_a_new_element_of_a_class_has_what_the_class_gives() -> None:
    shin = "shin { mass 1 inertia [1 1 1] shape : foot {} }\n  @ankle : knee { + calf - shin }\n  hip_drive"
    robot = hx.loads(_hymeko().replace("hip_drive", shin, 1).encode(), "hymeko").mechanism
    assert _joint(robot, "ankle") == _joint(robot, "knee")
    model = mujoco.MjModel.from_xml_string(hx.dumps(robot, "mjcf"))
    assert model.geom("heel").friction.tolist() == model.geom_friction[-1].tolist() == [0.8, 0.02, 0.01]
    assert model.geom_condim[-1] == 6


@pytest.mark.parametrize("units", ["", "units { length mm }", "units { angle rad length cm }"])
def test_numbers_of_a_class_are_in_the_units_of_its_format(units: str) -> None:
    text = f"""r : robot {{ {units}
      mjcf {{ compiler {{ angle=radian }} }}
      a() : class {{ joint {{ range [-1 0.5] }} geom {{ type=box size [0.1 0.2 0.3] pos [1 2 3] quat [0 0 0 1] }} }}
      base {{}} arm {{ collision : a {{}} }} @turn : a {{ + base - arm }} @slide : a, prismatic {{ + arm - hand }} hand {{}} }}"""
    robot = hx.loads(text.encode(), "hymeko").mechanism
    limits = _joint(robot, "turn").limits
    assert (limits.lower, limits.upper) == (-1.0, 0.5)
    (view,) = robot.shapes[Id("body", "arm")]
    assert view.shape.geometry == parts.Box((0.2, 0.4, 0.6))
    assert view.pose.xyz == (1.0, 2.0, 3.0)
    assert view.pose.quat == (0.0, 0.0, 0.0, 1.0)


def test_a_nameless_class_is_called_main() -> None:
    mjcf = MJCF.replace("<default>\n", '<default>\n    <geom condim="1"/>\n', 1)
    text = hx.dumps(hx.loads(mjcf.encode(), "mjcf"), "hymeko")
    assert "  main() : class {\n    geom { condim 1 }\n    leg() {\n" in text
    robot = hx.loads(text.encode(), "hymeko").mechanism
    assert hx.dumps(robot, "mjcf") == hx.dumps(hx.loads(mjcf.encode(), "mjcf"), "mjcf")


def test_classes_with_a_comment_in_them_stay_a_section_of_their_format_and_are_types_all_the_same() -> None:
    mjcf = MJCF.replace('<default class="knee">', '<!-- bends --><default class="knee">')
    text = hx.dumps(hx.loads(mjcf.encode(), "mjcf"), "hymeko")
    assert "default(class=leg) {" in text
    assert "@knee : knee { + thigh - calf }" in text
    assert hx.loads(text.encode(), "hymeko").mechanism == hx.loads(mjcf.encode(), "mjcf").mechanism
