"""Tendons in verdicts: of stages in any units, of paths that lead nowhere, of springs at rest, and of real robots."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import mujoco
import pytest
from pxr import Sdf, Usd

import hymeko_x as hx
from hymeko_x.corpus import catalog
from hymeko_x.verify import model_of, verify
from hymeko_x.verify.model import CYLINDER, JOINT, PULLEY, RELAXED, SIDE, SITE, SpringRange, Step, Tendon
from tests.usd.stages import HEADER

Write = Callable[[str, str], Path]

STAGE = (
    HEADER.replace("metersPerUnit = 1", "metersPerUnit = 0.01")
    + """def Xform "robot"
{
    def Xform "arm" (prepend apiSchemas = ["PhysicsRigidBodyAPI"])
    {
        double3 xformOp:translate = (0, 0, 100)
        uniform token[] xformOpOrder = ["xformOp:translate"]
        def Cylinder "drum"
        {
            uniform token axis = "X"
            double radius = 5
        }
        def Xform "tip" (prepend apiSchemas = ["MjcSiteAPI"])
        {
            double3 xformOp:translate = (0, 20, 0)
            uniform token[] xformOpOrder = ["xformOp:translate"]
        }
    }
    def Sphere "hook" (prepend apiSchemas = ["MjcSiteAPI"])
    {
    }
    def PhysicsRevoluteJoint "turn"
    {
        rel physics:body1 = </robot/arm>
        point3f physics:localPos0 = (0, 0, 100)
    }
    def MjcTendon "cable"
    {
        rel mjc:path = [</robot/hook>, </robot/arm/drum>, </robot/arm/tip>]
        int[] mjc:path:indices = [0, 1, 2, 0, 2]
        int[] mjc:path:segments = [0, 0, 0, 1, 1]
        double[] mjc:path:divisors = [1, 4]
        rel mjc:sideSites = </robot/arm/tip>
        int[] mjc:sideSites:indices = [-1, 0, -1, -1, -1]
        double mjc:range:max = 200
        double mjc:stiffness = 3
        double mjc:frictionloss = 7
        double[] mjc:springlength = [50, 60]
    }
    def MjcTendon "sum" (displayName = "Σ")
    {
        token mjc:type = "fixed"
        rel mjc:path = </robot/turn>
        double[] mjc:path:coef = [250]
        token mjc:limited = "false"
        double mjc:range:max = 1
        double mjc:actuatorfrcrange:min = -2
    }
}
"""
)


def near(point: tuple[float, float, float]) -> tuple[float, float, float]:
    return tuple(round(number, 9) + 0.0 for number in point)  # type: ignore[return-value]


def test_a_tendon_of_a_stage_is_read_in_its_units(written: Write) -> None:
    cable, total = model_of(written("usd", STAGE)).tendons
    assert [(step.kind, step.on, step.number, step.point and near(step.point)) for step in cable.path] == [
        (SITE, 0, 0.0, (0.0, 0.0, 0.0)),
        (CYLINDER, 1, 0.05, (0.0, 0.0, 0.0)),
        (SIDE, 1, 0.0, (0.0, 0.2, 0.0)),
        (SITE, 1, 0.0, (0.0, 0.2, 0.0)),
        (PULLEY, -1, 4.0, None),
        (SITE, 0, 0.0, (0.0, 0.0, 0.0)),
        (SITE, 1, 0.0, (0.0, 0.2, 0.0)),
    ]
    assert cable.path[1].axis == (1.0, 0.0, 0.0)
    assert (cable.mechanics, cable.limits, cable.force) == ((3.0, 0.0, 0.07, 0.0), (0.0, 2.0), None)
    assert cable.spring == SpringRange((0.5, 0.6), at_rest=False)
    assert total == Tendon("Σ", (Step(JOINT, 0, 2.5),), force=(-0.02, 0.0))


@pytest.mark.parametrize(
    ("given", "instead", "why"),
    [
        ("[0, 1, 2, 0, 2]", "[0, 1, 2, 0, 3]", "has 3 targets and other indices"),
        ("[1, 4]", "[1]", "has 5 steps, 5 segments, and 1 divisors"),
        ("[-1, 0, -1, -1, -1]", "[-1, 0]", "has 5 steps, 1 sites beside them, and 2 indices of these"),
        ("</robot/arm/drum>", "</robot/arm/gone>", "leads to /robot/arm/gone, where nothing is"),
        ("sideSites = </robot/arm/tip>", "sideSites = </robot/gone>", "has a site beside it that is not there"),
        ("[250]", "[250, 3]", "has 1 joints and 2 coefficients"),
        ("path = </robot/turn>", "path = </robot/arm>", "leads to /robot/arm, which is no joint that one coordinate moves"),
    ],
)
def test_an_invalid_path_is_reported_and_missing(given: str, instead: str, why: str, written: Write) -> None:
    assert given in STAGE
    whole, broken = written("usd", STAGE), written("usd", STAGE.replace(given, instead))
    (note,) = model_of(broken).notes
    assert note.endswith(f"is left out: its path {why}")
    (failed,) = verify(whole, broken, samples=2).failed
    assert (failed.quantity, failed.at.endswith("is missing")) == ("tendons", True)


def test_a_scene_may_say_that_ranges_alone_are_no_limits(written: Write) -> None:
    scene = 'def PhysicsScene "scene"\n    {\n        bool mjc:compiler:autoLimits = 0\n    }\n    def MjcTendon "cable"'
    cable, _ = model_of(written("usd", STAGE.replace('def MjcTendon "cable"', scene))).tendons
    assert cable.limits is None


MJCF = """<mujoco><worldbody><site name="hook" pos="0 0 1"/><body name="arm"><joint name="turn" springref="30" stiffness="1"/>
  <geom size=".1"/><site name="tip" pos="0 1 0"/></body></worldbody>
  <tendon><spatial name="cable" stiffness="3" SPRING><site site="hook"/><site site="tip"/></spatial></tendon></mujoco>"""


def test_a_spring_without_lengths_is_one_with_that_at_rest(written: Write, tmp_path: Path) -> None:
    silent = written("mjcf", MJCF.replace("SPRING", ""))
    length = float(mujoco.MjModel.from_xml_path(str(silent)).tendon_lengthspring[0, 0])
    stated = written("mjcf", MJCF.replace("SPRING", f'springlength="{length!r}"'))
    other = written("mjcf", MJCF.replace("SPRING", f'springlength="{length + 1e-6!r}"'))
    stage = tmp_path / "silent.usda"
    hx.convert(silent, stage)
    assert model_of(stage).tendons[0].spring == RELAXED
    for first in (silent, stated, stage):
        assert verify(first, silent, samples=2).is_same
        assert verify(first, stated, samples=2).is_same
        assert [check.quantity for check in verify(first, other, samples=2).failed] == ["tendons, spring lengths"]


def test_curves_of_tendons_are_compared_where_both_sides_know_them(written: Write, tmp_path: Path) -> None:
    straight, curved = written("mjcf", MJCF.replace("SPRING", "")), written("mjcf", MJCF.replace('"3" SPRING', '"3 .5"'))
    assert [check.quantity for check in verify(straight, curved, samples=2).failed] == ["nonlinear damping and stiffness of tendons"]
    stage = tmp_path / "curved.usda"
    hx.convert(curved, stage)
    assert "nonlinear damping and stiffness of tendons: 1 were not compared, first tendon 'cable'" in verify(curved, stage).not_compared


def test_tendons_without_names_are_compared_in_their_order(written: Write) -> None:
    first = MJCF.replace(' name="cable"', "").replace("SPRING", "")
    assert verify(written("mjcf", first), written("mjcf", first), samples=2).verdict == "same"
    other = first.replace('stiffness="3"', 'stiffness="4"')
    (failed,) = verify(written("mjcf", first), written("mjcf", other), samples=2).failed
    assert (failed.quantity, failed.at) == ("tendons, stiffness", "a tendon without a name")


# ---- real robots -----------------------------------------------------------------------------------------------------------------

FEW = ("rodent.xml", "pulley_fixed_site_wrap.xml", "manipulate_pen_touch_sensors.xml", "stacker.xml", "panda_free_base.xml")
FILES = catalog.development_files("mjcf")


@pytest.mark.corpus
@pytest.mark.parametrize("robot", [file for file in FILES if Path(file.path).name in FEW], ids=lambda file: file.id, indirect=True)
def test_tendons_of_a_real_robot_are_the_same_in_a_stage_until_one_number_changes(robot: Path, tmp_path: Path) -> None:
    stage = tmp_path / "robot.usda"
    hx.convert(robot, stage)
    model = model_of(robot)
    same = verify(model, stage, samples=2, meshes=False)
    assert same.is_same
    assert "tendons" in {check.quantity for check in same.checks}
    name, wanted = change_one(stage)
    failed = verify(model, stage, samples=2, meshes=False).failed
    known = any(tendon.name for tendon in model.tendons)
    at = f"tendon '{name}'" if known else "a tendon without a name"
    assert [(check.quantity, check.at.endswith(at)) for check in failed] == [(wanted, True)]


def change_one(stage: Path) -> tuple[str, str]:
    """One coefficient or limit in a stage grows by a thousandth: the name of its tendon, and the check that must see it."""
    layer = Sdf.Layer.FindOrOpen(str(stage))
    found = Usd.Stage.Open(layer)
    prims = [prim for prim in found.Traverse() if prim.GetTypeName() == "MjcTendon"]
    known = (("mjc:path:coef", "tendons, coefficients"), ("mjc:range:max", "tendons, limits"))
    prim, word, check = next((prim, word, check) for word, check in known for prim in prims if prim.GetAttribute(word))
    value = prim.GetAttribute(word).Get()
    prim.GetAttribute(word).Set(value * 1.001 if isinstance(value, float) else [value[0] * 1.001, *list(value)[1:]])
    layer.Save()
    return prim.GetDisplayName() or prim.GetName(), check
