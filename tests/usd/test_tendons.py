"""MjcTendon prims: cables and combinations of joints, in and out, with what acts on them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pxr import Usd, UsdGeom

import hymeko_x as hx
from hymeko_x import formats, pipeline
from hymeko_x.compare.diff import diff
from hymeko_x.corpus import catalog
from hymeko_x.diagnostics import Report
from hymeko_x.formats.mjcf import words as mjcf_words
from hymeko_x.formats.usd import tendons as usd_tendons
from hymeko_x.ir.graph import Arc, Edge, Hypergraph
from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc, joint_edge, mount_edge, shape_edge
from hymeko_x.ir.parts import Body, Cylinder, Dof, DofKind, Frame, Joint, Limits, Role, Shape, Sphere, Tendon
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Source
from tests.usd.stages import again, opened, read_text, written
from tests.usd.test_real_stages import lost_properties

ROBOT = """<mujoco model="cables"><compiler angle="radian"/><default><tendon solimplimit=".9 .99"/></default>
<worldbody><site name="top" pos="0 0 1"/><geom name="post" type="sphere" size=".1" pos="0 .3 .5" contype="0" conaffinity="0"/>
  <body name="a" pos="0 0 .5"><joint name="turn" axis="0 1 0" range="-1 1"/><joint name="lift" type="slide" axis="0 0 1" springref=".1"/>
    <geom name="drum" type="cylinder" size=".05 .2" euler="1.2 0 0" pos="0 .1 0" mass="1"/><site name="s" pos=".2 0 .1"/>
    <site name="beside" pos="0 .1 .2"/>
    <body name="b" pos=".4 0 0"><joint name="bend" axis="1 0 0"/>
      <geom type="box" size=".1 .1 .1" mass="2"/><site name="t" pos="0 .2 0"/></body>
  </body></worldbody>
<tendon>
  <spatial name="cable" range=".1 2" stiffness="3" damping=".5" frictionloss=".25" width=".01" rgba="1 0 0 .5" springlength=".3 .4"
    solimplimit=".8"><site site="top"/><geom geom="drum" sidesite="beside"/><site site="s"/><pulley divisor="2"/><site site="s"/>
    <geom geom="post"/><site site="t"/><pulley divisor="4"/><site site="top"/><site site="t"/></spatial>
  <spatial name="led" limited="false" range="0 1" margin=".01" group="2" actuatorfrcrange="-5 5"><pulley divisor="3"/>
    <site site="s"/><site site="t"/></spatial>
  <fixed name="sum" armature=".1" stiffness="2" solreflimit=".03"><joint joint="turn" coef=".5"/><joint joint="bend" coef="-2"/>
    <joint joint="lift" coef="1e-3"/></fixed>
</tendon>
<actuator><motor name="pull" tendon="cable" gear="-3" ctrlrange="-1 1"/><position name="hold" tendon="sum" kp="20" kv="2"/>
  <velocity name="wind" tendon="led" kv="4"/><muscle name="flex" tendon="cable" timeconst=".02 .05" force="7" lengthrange=".1 2"/>
  <position name="damped" tendon="sum" dampratio=".7" timeconst=".1" kp="3"/></actuator></mujoco>"""
OF_TENDONS = (
    *("type", "num", "limited", "actfrclimited", "actfrcrange", "margin", "stiffness", "damping", "armature", "frictionloss"),
    *("solref_lim", "solimp_lim", "solref_fri", "solimp_fri", "lengthspring", "length0", "group"),
)
OF_ACTUATORS = (
    *("trntype", "dyntype", "gaintype", "biastype", "ctrllimited", "ctrlrange", "gear", "dynprm", "gainprm", "biasprm"),
    "lengthrange",
)


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    path = tmp_path / "cables.xml"
    path.write_text(ROBOT)
    return path


def through_usd(source: Path, folder: Path, suffix: str = ".usda") -> Path:
    """The MJCF of a stage that carries no residue."""
    stage, result = folder / f"{source.stem}_pure{suffix}", folder / f"{source.stem}_back.xml"
    hx.convert(source, stage)
    hx.convert(stage, result)
    return result


def model_of(path: Path) -> Any:
    return mujoco.MjModel.from_xml_path(str(path))


def different(a: Any, b: Any) -> list[str]:
    """What two models have different of their tendons: their numbers, lengths, and moment arms at random configurations."""
    wrong = [
        name for name in OF_TENDONS if not np.allclose(getattr(a, f"tendon_{name}"), getattr(b, f"tendon_{name}"), rtol=1e-6, atol=1e-9)
    ]
    bound = a.tendon_limited.astype(bool)
    wrong += ["range"] if not np.allclose(a.tendon_range[bound], b.tendon_range[bound], rtol=1e-6) else []
    visible = a.tendon_type == mujoco.mjtTendon.mjTENDON_SPATIAL
    wrong += [
        name for name in ("rgba", "width") if not np.allclose(getattr(a, f"tendon_{name}")[visible], getattr(b, f"tendon_{name}")[visible])
    ]
    for seed in range(20):
        (lengths, arms), (others, other_arms) = moved(a, a, seed), moved(b, a, seed)
        wrong += [f"lengths {seed}"] if np.abs(lengths - others).max(initial=0.0) > 1e-6 else []
        wrong += [f"moment arms {seed}"] if np.abs(arms - other_arms).max(initial=0.0) > 1e-6 else []
    return wrong


def moved(model: Any, first: Any, seed: int) -> tuple[Any, Any]:
    """Lengths, and how they change with each named hinge and slide of the first model, where that one has random coordinates."""
    random, data = np.random.default_rng(seed), mujoco.MjData(model)
    scalar = [j for j in range(first.njnt) if first.jnt_type[j] in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE)]
    same = {j: model.joint(first.joint(j).name).id if first.joint(j).name else j for j in scalar}
    for j in scalar:
        data.qpos[model.jnt_qposadr[same[j]]] = random.uniform(-1, 1)
    mujoco.mj_forward(model, data)
    lengths = data.ten_length.copy()
    arms = []
    for j in scalar:
        speed = np.zeros(model.nv)
        speed[model.jnt_dofadr[same[j]]] = 1.0
        data.qvel[:] = speed
        mujoco.mj_forward(model, data)
        arms.append(data.ten_velocity.copy())
    return lengths, np.array(arms)


# ---- out -------------------------------------------------------------------------------------------------------------------------


def test_a_tendon_is_written_as_mujocos_schema_names_it(robot: Path, tmp_path: Path) -> None:
    stage = tmp_path / "cables.usda"
    hx.convert(robot, stage, keep="inside")
    found = Usd.Stage.Open(str(stage))
    assert authored(found.GetPrimAtPath("/cables/tendons/cable")) == {
        "mjc:type": "spatial",
        "mjc:path": ["top", "drum", "s", "post", "t"],
        "mjc:path:indices": [0, 1, 2, 2, 3, 4, 0, 4],
        "mjc:path:segments": [0, 0, 0, 1, 1, 1, 2, 2],
        "mjc:path:divisors": [1.0, 2.0, 4.0],
        "mjc:sideSites": ["beside"],
        "mjc:sideSites:indices": [-1, 0, -1, -1, -1, -1, -1, -1],
        "mjc:limited": "true",
        "mjc:range:min": 0.1,
        "mjc:range:max": 2.0,
        "mjc:stiffness": 3.0,
        "mjc:damping": 0.5,
        "mjc:frictionloss": 0.25,
        "mjc:width": 0.01,
        "mjc:rgba": [1.0, 0.0, 0.0, 0.5],
        "mjc:springlength": [0.3, 0.4],
        "mjc:solimplimit": [0.8, 0.99, 0.001, 0.5, 2.0],
    }
    led = authored(found.GetPrimAtPath("/cables/tendons/led"))
    assert (led["mjc:path:segments"], led["mjc:path:divisors"]) == ([1, 1], [1.0, 3.0])
    assert authored(found.GetPrimAtPath("/cables/tendons/sum")) == {
        "mjc:type": "fixed",
        "mjc:path": ["turn", "bend", "lift"],
        "mjc:path:indices": [0, 1, 2],
        "mjc:path:coef": [0.5, -2.0, 0.001],
        "mjc:armature": 0.1,
        "mjc:stiffness": 2.0,
        "mjc:solimplimit": [0.9, 0.99, 0.001, 0.5, 2.0],
        "mjc:solreflimit": [0.03, 1.0],
    }


def test_a_site_of_a_cable_is_an_invisible_ball_and_others_have_no_geometry(robot: Path, tmp_path: Path) -> None:
    robot.write_text(ROBOT.replace('<site name="t"', '<site name="alone" size=".02"/><site name="t" size=".03"'))
    stage = tmp_path / "cables.usda"
    hx.convert(robot, stage, keep="inside")
    opened_stage = Usd.Stage.Open(str(stage))
    sites = [prim for prim in opened_stage.Traverse() if "MjcSiteAPI" in prim.GetPrimTypeInfo().GetAppliedAPISchemas()]
    assert {prim.GetName(): (str(prim.GetTypeName()), UsdGeom.Imageable(prim).ComputePurpose()) for prim in sites} == {
        **dict.fromkeys(("top", "s", "beside", "t"), ("Sphere", "guide")),
        "alone": ("Xform", "default"),
    }
    assert {prim.GetName(): prim.GetAttribute("radius").Get() for prim in sites if prim.IsA(UsdGeom.Sphere)} == {
        **dict.fromkeys(("top", "s", "beside"), 0.005),
        "t": 0.03,
    }


def authored(prim: Any) -> dict[str, object]:
    """What a prim says, by its names; targets by what people call them."""
    found: dict[str, object] = {}
    for attribute in prim.GetAuthoredAttributes():
        value = attribute.Get()
        found[attribute.GetName()] = list(value) if hasattr(value, "__len__") and not isinstance(value, str) else value
    for relationship in prim.GetAuthoredRelationships():
        targets = [prim.GetStage().GetPrimAtPath(path) for path in relationship.GetTargets()]
        found[relationship.GetName()] = [target.GetDisplayName() or target.GetName() for target in targets]
    return found


# ---- MJCF, USD, MJCF -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", [".usda", ".usdc"])
def test_tendons_and_what_acts_on_them_come_back_from_a_stage_without_residue(suffix: str, robot: Path, tmp_path: Path) -> None:
    source, result = model_of(robot), model_of(through_usd(robot, tmp_path, suffix))
    assert [result.tendon(i).name for i in range(3)] == ["cable", "led", "sum"]
    assert different(source, result) == []
    assert [
        name for name in OF_ACTUATORS if not np.allclose(getattr(source, f"actuator_{name}"), getattr(result, f"actuator_{name}"))
    ] == []
    assert source.actuator_trnid[:, 0].tolist() == result.actuator_trnid[:, 0].tolist() == [0, 2, 1, 0, 2]


def test_tendons_come_back_exactly_from_a_stage(robot: Path, tmp_path: Path) -> None:
    stage, result = tmp_path / "cables.usda", tmp_path / "back.xml"
    hx.convert(robot, stage, keep="inside")
    hx.convert(stage, result, keep="inside")
    assert diff(hx.load(robot).mechanism, hx.load(result).mechanism) == ()
    assert hx.verify(robot, stage).is_same
    assert hx.verify(robot, result).is_same
    assert different(model_of(robot), model_of(result)) == []


FEW = ("tendon.xml", "pulley_fixed_site_wrap.xml", "arm21.xml", "stacker.xml")
MORE = ("dog.xml", "rodent.xml", "quadruped.xml", "panda_free_base.xml", "coupled_half_cheetah.xml", "pendula.xml", "manipulator.xml")
FILES = catalog.development_files("mjcf")


@pytest.mark.corpus
@pytest.mark.parametrize("robot", [file for file in FILES if Path(file.path).name in FEW], ids=lambda file: file.id, indirect=True)
def test_tendons_of_a_real_robot_come_back_from_a_stage_without_residue(robot: Path, tmp_path: Path) -> None:
    assert different(model_of(robot), model_of(through_usd(robot, tmp_path))) == []


@pytest.mark.full
@pytest.mark.corpus
@pytest.mark.parametrize("robot", [file for file in FILES if Path(file.path).name in MORE], ids=lambda file: file.id, indirect=True)
def test_tendons_of_every_real_robot_come_back_from_a_stage_without_residue(robot: Path, tmp_path: Path) -> None:
    assert different(model_of(robot), model_of(through_usd(robot, tmp_path))) == []


# ---- in --------------------------------------------------------------------------------------------------------------------------

STAGE = """#usda 1.0
(defaultPrim = "r"; metersPerUnit = {metres}; kilogramsPerUnit = {kilograms}; upAxis = "Z")
def Xform "r" {{
  def Xform "a" (apiSchemas = ["PhysicsRigidBodyAPI"]) {{
    def Sphere "ball" {{ double radius = 0.1 }}
    def Cube "box" {{ double size = 1 }}
    def Xform "s" (apiSchemas = ["MjcSiteAPI"]) {{}}
    def Xform "t" (apiSchemas = ["MjcSiteAPI"]) {{}}
  }}
  def Xform "b" (apiSchemas = ["PhysicsRigidBodyAPI"]) {{ def Xform "u" (apiSchemas = ["MjcSiteAPI"]) {{}} }}
  def PhysicsRevoluteJoint "j" {{ rel physics:body0 = </r/a>; rel physics:body1 = </r/b> }}
  def PhysicsPrismaticJoint "k" {{ rel physics:body1 = </r/a> }}
  def MjcTendon "cord" {{ {tendon} }}
  {more}
}}
"""
S, T, U = (Arc(Id("frame", name)) for name in "stu")
BALL = Arc(Id("shape", "ball"), 0, None, "wrap")
CORD = Id("tendon", "cord")


def stage(tendon: str, *, more: str = "", metres: float = 1, kilograms: float = 1) -> str:
    """The text of a stage, in which each statement has a line of its own, as USD wants it."""
    text = STAGE.format(tendon=tendon.strip("; "), more=more, metres=metres, kilograms=kilograms)
    return text.replace("; ", "\n").replace("{ ", "{\n").replace(" }", "\n}")


def pulley(divisor: float) -> RobotArc:
    return Arc(CORD, 0, (divisor,), "pulley")


@pytest.mark.parametrize(
    ("tendon", "arcs"),
    [
        ("rel mjc:path = [</r/a/s>, </r/a/ball>, </r/b/u>]", (S, BALL, U)),
        ("rel mjc:path = [</r/a/s>, </r/a/t>]; int[] mjc:path:indices = [1, 0, 1]", (T, S, T)),
        (
            "rel mjc:path = [</r/a/s>, </r/a/t>]; int[] mjc:path:indices = [0, 1, 0, 1]; int[] mjc:path:segments = [0, 0, 2, 2]; "
            "double[] mjc:path:divisors = [3, 5, 4]",
            (pulley(3.0), S, T, pulley(4.0), S, T),
        ),
        (
            "rel mjc:path = [</r/a/s>, </r/a/ball>, </r/b/u>]; rel mjc:sideSites = </r/a/t>; int[] mjc:sideSites:indices = [-1, 0, -1]",
            (S, BALL, Arc(Id("frame", "t"), 0, None, "side"), U),
        ),
        (
            'token mjc:type = "fixed"; rel mjc:path = [</r/j>, </r/k>]; double[] mjc:path:coef = [2, -1]',
            (Arc(Id("joint", "j"), 1, (2.0,)), Arc(Id("joint", "k"), 1, (-1.0,))),
        ),
        ('token mjc:type = "fixed"; rel mjc:path = </r/k>', (Arc(Id("joint", "k"), 1, (1.0,)),)),
    ],
)
def test_a_path_is_read_as_the_schema_says(tendon: str, arcs: tuple[RobotArc, ...]) -> None:
    mechanism = read_text(stage(tendon))
    assert mechanism.graph.edges[CORD].arcs == arcs
    assert diff(mechanism, again(mechanism)) == ()


@pytest.mark.parametrize(
    ("tendon", "why"),
    [
        ("", "is empty"),
        ("rel mjc:path = </r/a/s>", "has less than two steps"),
        ("rel mjc:path = [</r/a/s>, </r/a/box>, </r/b/u>]", "wraps around a geom that is neither a sphere nor a cylinder"),
        ("rel mjc:path = [</r/a/s>, </r/b>]", "leads to '/r/b', which is neither a site nor a shape nor a joint"),
        ("rel mjc:path = [</r/a/s>, </r/j>]", "leads through joint 'j', which is no step of a cable"),
        ("rel mjc:path = [</r/a/s>, </r/a/t>]; int[] mjc:path:indices = [0, 2]", "has 2 targets and the index 2"),
        ("rel mjc:path = [</r/a/s>, </r/a/t>]; int[] mjc:path:segments = [0]", "has 2 steps and 1 mjc:path:segments"),
        ("rel mjc:path = [</r/a/s>, </r/a/t>]; int[] mjc:path:segments = [0, 1]", "has no divisor for segment 1"),
        ("rel mjc:path = [</r/a/s>, </r/a/t>]; double[] mjc:path:divisors = [inf]", "has mjc:path:divisors that are not finite"),
        ("rel mjc:path = [</r/a/s>, </r/a/t>]; double[] mjc:path:divisors = [0]", "leads through tendon '', which is no step of a cable"),
        (
            "rel mjc:path = [</r/a/s>, </r/a/t>]; int[] mjc:path:segments = [1, 0]; double[] mjc:path:divisors = [1, 2]",
            "goes back to an earlier segment",
        ),
        (
            "rel mjc:path = [</r/a/s>, </r/a/ball>, </r/b/u>]; int[] mjc:sideSites:indices = [-1, 0, -1]",
            "has no site 0 beside it",
        ),
        (
            "rel mjc:path = [</r/a/s>, </r/a/ball>, </r/b/u>]; rel mjc:sideSites = </r/a>; int[] mjc:sideSites:indices = [-1, 0, -1]",
            "has '/r/a' beside it, which is no site",
        ),
        ('token mjc:type = "fixed"; rel mjc:path = </r/j>; double[] mjc:path:coef = [1, 2]', "has 1 joints and 2 coefficients"),
        ('token mjc:type = "other"; rel mjc:path = </r/j>', "is neither fixed nor spatial"),
    ],
)
@pytest.mark.unread("HX040")
def test_a_tendon_without_a_valid_path_is_reported_and_kept(tendon: str, why: str, tmp_path: Path) -> None:
    report = Report()
    source = stage(f"{tendon}; double mjc:stiffness = 3")
    mechanism = read_text(source, report)
    assert [item.message for item in report] == [f"the path of tendon '/r/cord' {why}; it is kept as written"]
    assert not any(mechanism.edges(Tendon))
    assert lost_properties(opened(source.encode(), tmp_path, "source.usda"), opened(written(mechanism), tmp_path)) == []


PATH = "rel mjc:path = [</r/a/s>, </r/a/t>]; "
RANGE = "double mjc:range:min = 0.5; double mjc:range:max = 2; "
STRICT = 'def PhysicsScene "scene" (apiSchemas = ["MjcSceneAPI"]) { bool mjc:compiler:autoLimits = false }'


@pytest.mark.parametrize(
    ("more", "scene", "limits"),
    [
        (RANGE, "", Limits(0.5, 2.0)),
        (RANGE, STRICT, Limits()),
        (RANGE + 'token mjc:limited = "true"', STRICT, Limits(0.5, 2.0)),
        (RANGE + 'token mjc:limited = "auto"', "", Limits(0.5, 2.0)),
        (RANGE + 'token mjc:limited = "false"', "", Limits()),
        ("double mjc:range:min = 3; double mjc:range:max = 2", "", Limits()),
        ('string mjc:range:max = "2"', "", Limits()),
    ],
)
def test_a_range_is_a_limit_where_it_holds(more: str, scene: str, limits: Limits, tmp_path: Path) -> None:
    source = stage(PATH + more, more=scene)
    mechanism = read_text(source)
    assert mechanism.graph.edges[CORD].data == Tendon("spatial", limits)
    assert lost_properties(opened(source.encode(), tmp_path, "source.usda"), opened(written(mechanism), tmp_path)) == []
    assert diff(mechanism, again(mechanism)) == ()


def test_lengths_forces_and_masses_of_a_tendon_are_in_the_units_of_the_stage() -> None:
    numbers = (
        "double mjc:stiffness = 2; double mjc:damping = 3; double mjc:frictionloss = 5; double mjc:armature = 7; double mjc:width = 11; "
        "double mjc:margin = 13; double[] mjc:springlength = [-1, 17]; double mjc:actuatorfrcrange:min = -19; "
        "double mjc:actuatorfrcrange:max = 23; "
    )
    mechanism = read_text(stage(PATH + numbers + RANGE, metres=0.5, kilograms=4))
    parameters = (("springlength", (-1.0, 8.5)), ("margin", 6.5), ("actuatorfrcrange", (-38.0, 46.0)))
    assert mechanism.graph.edges[CORD].data == Tendon("spatial", Limits(0.25, 1.0), 12.0, 8.0, 10.0, 28.0, 5.5, None, parameters)
    fixed = 'token mjc:type = "fixed"; rel mjc:path = [</r/j>, </r/k>]; double[] mjc:path:coef = [2, 2]'
    weights = [arc.weight for arc in read_text(stage(fixed, metres=0.5)).graph.edges[CORD].arcs]
    assert weights == [(1.0,), (2.0,)]  # an angle becomes a length, a length stays one


def test_what_the_schema_says_of_a_tendon_is_typed_in_the_order_of_mjcf() -> None:
    names = {usd_tendons.SPRING, usd_tendons.MARGIN, usd_tendons.GROUP, usd_tendons.FORCE_RANGE, usd_tendons.FORCE_LIMITED}
    assert set(mjcf_words.TENDON_PARAMETERS) == names | set(usd_tendons.VECTORS)


def test_a_motor_on_a_joint_that_is_no_prim_is_no_motor_on_its_body(tmp_path: Path) -> None:
    path = tmp_path / "floating.xml"
    path.write_text(
        '<mujoco><worldbody><body name="a"><freejoint name="f"/><geom size="1"/></body></worldbody>'
        '<actuator><motor name="push" joint="f" gear="1 0 0 0 0 0"/></actuator></mujoco>'
    )
    back = through_usd(path, tmp_path)
    assert model_of(back).nu == 0


# ---- any path --------------------------------------------------------------------------------------------------------------------

SITES = [Id("frame", f"s{number}") for number in range(3)]
ROUND = [Id("shape", "drum"), Id("shape", "ball")]
JOINTS = [("j", ""), ("x", "x"), ("x", "y")]


@st.composite
def cables(draw: st.DrawFn) -> tuple[RobotArc, ...]:
    """Any path that MuJoCo takes: sites, shapes between them with or without a site beside them, pulleys."""
    key = Id("tendon", "t")
    arcs: list[RobotArc] = [Arc(key, 0, (draw(st.sampled_from([2.0, 3.5])),), "pulley")] if draw(st.booleans()) else []
    for part in range(draw(st.integers(1, 3))):
        arcs += [Arc(key, 0, (draw(st.floats(0.1, 9)),), "pulley")] if part else []
        arcs.append(Arc(draw(st.sampled_from(SITES))))
        for _ in range(draw(st.integers(1, 3))):
            if draw(st.booleans()):
                arcs.append(Arc(draw(st.sampled_from(ROUND)), 0, None, "wrap"))
                arcs += [Arc(draw(st.sampled_from(SITES)), 0, None, "side")] if draw(st.booleans()) else []
            arcs.append(Arc(draw(st.sampled_from(SITES))))
    return tuple(arcs)


COMBINATIONS = st.lists(st.sampled_from(JOINTS), min_size=1, unique=True).flatmap(
    lambda joints: st.tuples(*(st.floats(-5, 5).map(lambda x, j=joint: Arc(Id("joint", j[0]), 1, (x,), j[1])) for joint in joints))
)
POSITIVE = st.floats(0, 100, allow_subnormal=False)


@st.composite
def tendons(draw: st.DrawFn) -> Edge[Id, Any, Any]:
    kind = draw(st.sampled_from(["fixed", "spatial"]))
    arcs = draw(COMBINATIONS if kind == "fixed" else cables())
    low = draw(POSITIVE)
    limits = draw(st.sampled_from([Limits(), Limits(low, low + 1.0)]))
    parameters = tuple(
        item
        for item in (
            ("springlength", draw(st.just(-1.0) | POSITIVE)),
            ("margin", draw(POSITIVE)),
            ("solimplimit", (0.8, draw(st.floats(0.5, 0.6)))),
            ("actuatorfrclimited", draw(st.sampled_from(["true", "false"]))),
            ("actuatorfrcrange", (-1.0 - draw(POSITIVE), 1.0)),
            ("group", float(draw(st.integers(0, 5)))),
        )
        if draw(st.booleans())
    )
    armature = 0.0 if any(arc.role == "wrap" for arc in arcs) else draw(POSITIVE)
    return Edge(Tendon(kind, limits, draw(POSITIVE), draw(POSITIVE), draw(POSITIVE), armature, draw(POSITIVE), None, parameters), arcs)


def robot_with(tendon: Edge[Id, Any, Any]) -> Mechanism:
    a, b, c = (Id("body", name) for name in "abc")
    two = Joint((Dof(DofKind.HINGE, (1.0, 0.0, 0.0), name="x"), Dof(DofKind.SLIDE, (0.0, 1.0, 0.0), name="y")))
    edges: dict[Id, Any] = {Id("joint", "j"): joint_edge(Joint((Dof(),)), a, b), Id("joint", "x"): joint_edge(two, b, c)}
    edges[ROUND[0]] = shape_edge(Shape(Cylinder(0.1, 0.5), Role.VISUAL, "drum"), b)
    edges[ROUND[1]] = shape_edge(Shape(Sphere(0.1), Role.BOTH, "ball"), c)
    edges |= {Id("mount", key.name): mount_edge(body, key) for key, body in zip(SITES, (a, b, c), strict=True)}
    vertices: dict[Id, Any] = dict.fromkeys((a, b, c), Body()) | dict.fromkeys(SITES, Frame())
    return Mechanism("r", Hypergraph(vertices, {**edges, Id("tendon", "t"): tendon}))


@settings(deadline=None)
@given(tendons())
def test_any_tendon_comes_back_from_what_is_written_of_it(tendon: Edge[Id, Any, Any]) -> None:
    mechanism = robot_with(tendon)
    main = pipeline.convert(mechanism, formats.by_name("usd"), Options(), NoFiles(), Report()).package.main
    found = pipeline.read(Source("r.usda", main, NoFiles()), formats.USD, Report())
    assert found.graph.edges[Id("tendon", "t")] == tendon
