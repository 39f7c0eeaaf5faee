"""Edits of robots whose original is a USD stage, in the author's own layer."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import hymeko_x as hx

if TYPE_CHECKING:
    from pathlib import Path

STAGE = """#usda 1.0
(
    defaultPrim = "arm"
    metersPerUnit = 1
    upAxis = "Z"
)

def Xform "arm"
{
    def Scope "RigidBodies"
    {
        def Xform "base" (
            prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]
        )
        {
            # Weighed.
            float physics:mass = 2
            float3 physics:diagonalInertia = (0.1, 0.1, 0.1)

            def Scope "collisions"
            {
                def Sphere "ball" (
                    prepend apiSchemas = ["PhysicsCollisionAPI"]
                )
                {
                    double radius = 0.1
                }
            }
        }

        def Xform "tip" (
            prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]
        )
        {
            float physics:mass = 1
            float3 physics:diagonalInertia = (0.1, 0.1, 0.1)
        }
    }

    def Scope "Joints"
    {
        def PhysicsJoint "wrist" (
            prepend apiSchemas = [
                "PhysicsLimitAPI:transX", "PhysicsLimitAPI:rotX", "PhysicsLimitAPI:rotY", "PhysicsLimitAPI:rotZ",
                "PhysicsDriveAPI:transY", "PhysicsDriveAPI:transZ"
            ]
        )
        {
            rel physics:body0 = </arm/RigidBodies/base>
            rel physics:body1 = </arm/RigidBodies/tip>
            float limit:transX:physics:low = 1
            float limit:transX:physics:high = -1
            float limit:rotX:physics:low = 1
            float limit:rotX:physics:high = -1
            float limit:rotY:physics:low = 1
            float limit:rotY:physics:high = -1
            float limit:rotZ:physics:low = 1
            float limit:rotZ:physics:high = -1
            float drive:transY:physics:maxForce = 20
            float drive:transZ:physics:maxForce = 30
        }
    }
}
"""
TOOL = """<link name="tool">
  <inertial><mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
</link>
<joint name="tool_mount" type="fixed"><parent link="tip"/><child link="tool"/></joint>
"""


PIN = """
        def PhysicsSphericalJoint "pin"
        {
            rel physics:body0 = </arm/RigidBodies/base>
            rel physics:body1 = </arm/RigidBodies/tip>
            bool physics:excludeFromArticulation = 1
            point3f physics:localPos0 = (0.1, 0.2, 0.3)
            point3f physics:localPos1 = (0.1, 0.2, 0.3)
        }
"""


def updated(folder: Path, name: str, old: str, new: str, stage: str = STAGE) -> tuple[list[str], list[str]]:
    """The lines that an edit of the converted stage takes out of the stage and puts in; there is nothing left to update."""
    original, there = folder / "arm.usda", folder / name
    original.write_text(stage)
    hx.convert(original, there)
    text = there.read_text()
    assert text.count(old) == 1
    there.write_text(text.replace(old, new))
    lines = hx.update(original, there).diff.splitlines()[2:]
    assert hx.update(original, there).edits == ()
    return [line[1:] for line in lines if line[0] == "-"], [line[1:] for line in lines if line[0] == "+"]


@pytest.mark.unread("HX101", "HX106", "HX114")
def test_a_body_with_several_dofs_gets_a_new_name_and_its_joint_keeps_its_own(tmp_path: Path) -> None:
    """MJCF calls such a joint after its body."""
    assert updated(tmp_path, "arm.xml", 'body name="tip"', 'body name="hand"') == ([], ['            displayName = "hand"'])


@pytest.mark.unread("HX101", "HX105", "HX114")
def test_a_shape_is_added_to_a_body_whose_shapes_are_in_a_scope(tmp_path: Path) -> None:
    link = '<link name="base">'
    pad = f'{link}<visual name="pad"><geometry><sphere radius="0.2"/></geometry></visual>'
    gone, new = updated(tmp_path, "arm.urdf", link, pad)
    assert gone == []
    assert new[0] == '            def Sphere "pad"'
    assert "                double radius = 0.2" in new


@pytest.mark.unread("HX101", "HX105", "HX114")
def test_a_joint_is_added_beside_the_others_where_these_are_among_the_bodies(tmp_path: Path) -> None:
    flat = STAGE.replace('    def Scope "Joints"\n    {\n', "").removesuffix("    }\n}\n") + "}\n"
    gone, new = updated(tmp_path, "arm.urdf", "</robot>", f"{TOOL}</robot>", flat)
    assert gone == []
    assert [line.strip() for line in new if "def " in line] == ['def Xform "tool" (', 'def PhysicsFixedJoint "tool_mount"']


@pytest.mark.unread("HX101", "HX105", "HX114")
def test_a_body_is_added_beside_the_others_and_its_joint_beside_theirs(tmp_path: Path) -> None:
    gone, new = updated(tmp_path, "arm.urdf", "</robot>", f"{TOOL}</robot>")
    assert gone == []
    assert new[:2] == ["", '        def Xform "tool" (']  # behind an empty line, as the body before it
    assert "            rel physics:body1 = </arm/RigidBodies/tool>" in new
    assert '        def PhysicsFixedJoint "tool_mount"' in new


@pytest.mark.unread("HX101", "HX106", "HX114")
def test_a_body_at_a_closure_gets_a_new_name(tmp_path: Path) -> None:
    """MJCF has frames at the ends of the closure that are called after their bodies, and keep their names in the edited file."""
    stage = STAGE.removesuffix("    }\n}\n") + PIN + "    }\n}\n"
    change = updated(tmp_path, "arm.xml", 'body name="tip"', 'body name="hand"', stage)
    assert 'site name="pin_tip"' in (tmp_path / "arm.xml").read_text()
    assert change == ([], ['            displayName = "hand"'])


ROD = """<mujoco model="rod">
  <worldbody>
    <body name="base">
      <geom name="ball" size="0.1" mass="2"/>
      <body name="rod" pos="0.3 0 0"><joint name="knee" axis="0 1 0"/><geom name="end" size="0.1" mass="1"/></body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"double3 xformOp:translate = (0.3, 0, 0)": "double3 xformOp:translate = (0.3, 0.5, 0)"}, ["[0.3 0.5 0]"]),
        ({"physics:localPos0 = (0.3, 0, 0)": "physics:localPos0 = (0.4, 0, 0)"}, []),
        ({"double3 xformOp:translate = (0.3": "double3 xformOp:translate = (0.4", "localPos0 = (0.3": "localPos0 = (0.4"}, []),
    ],
)
def test_a_body_that_is_moved_off_its_joint_is_reported(changes: dict[str, str], told: list[str], tmp_path: Path) -> None:
    """Only the frames of the joint count for where a body is, and they are the edit where both were moved, or they alone."""
    original, there = tmp_path / "rod.xml", tmp_path / "rod.usda"
    original.write_text(ROD)
    hx.convert(original, there)
    text = there.read_text()
    for old, new in changes.items():
        assert text.count(old) == 1
        text = text.replace(old, new)
    there.write_text(text)
    report = hx.update(original, there).report
    words = "the edit did not arrive: body 'rod' stands at {} with the quaternion [1 0 0 0], where its joint does not put it"
    assert [row.message for row in report if row.code.id == "HX118"] == [words.format(place) for place in told]
    assert original.read_text() == (ROD if told else ROD.replace("0.3 0 0", "0.4 0 0"))


@pytest.mark.unread("HX101", "HX106", "HX114")
def test_a_body_whose_mass_follows_from_its_shape_gets_a_new_name(tmp_path: Path) -> None:
    """Its mass is not in the text, and is another number in single precision, in which a print has it."""
    mass = "            float physics:mass = 1\n            float3 physics:diagonalInertia = (0.1, 0.1, 0.1)\n"
    bob = '            def Sphere "bob" (\n                prepend apiSchemas = ["PhysicsCollisionAPI"]\n            )\n'
    stage = STAGE.replace(mass, f"{bob}            {{\n                double radius = 0.1\n            }}\n")
    assert 'def Sphere "bob"' in stage
    assert updated(tmp_path, "arm.xml", 'body name="tip"', 'body name="hand"', stage) == ([], ['            displayName = "hand"'])
