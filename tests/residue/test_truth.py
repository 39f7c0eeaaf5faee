"""What a file says natively is in the robot that is read from it: written in the same format again, its engine sees the same robot."""

from __future__ import annotations

import re
from itertools import product
from pathlib import Path
from typing import Any

import mujoco
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import hymeko_x as hx
from hymeko_x import formats, pipeline
from hymeko_x.compare.diff import Tolerance
from hymeko_x.corpus.catalog import development_files
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.ir.parts import Actuator, DofKind
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Source
from hymeko_x.testing import mechanisms
from tests.mjcf.mjmodels import differences
from tests.residue.exactness import unequal
from tests.residue.samples import MJCF, URDF
from tests.residue.test_real_robots import SUFFIXES
from tests.test_pipeline_laws import PLAIN, ROUGHLY

KEEPING = (None, "beside", "inside")
BASES = (None, "fixed", "free")
ACTUATORS = (None, "none", "motor", "position", "velocity")
GRIPPER = """<robot name="gripper"><link name="palm"><inertial><mass value="0.8"/>
<inertia ixx="0.001" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.0015"/></inertial></link>
<link name="left"><inertial><mass value="0.1"/><inertia ixx="1e-05" ixy="0" ixz="0" iyy="1e-05" iyz="0" izz="2e-06"/></inertial></link>
<joint name="close" type="prismatic"><parent link="palm"/><child link="left"/><axis xyz="-1 0 0"/>
<limit lower="0" upper="0.045" effort="20" velocity="0.1"/></joint></robot>"""


def is_floating(robot: Mechanism) -> bool:
    return any(dof.kind is DofKind.FREE for view in robot.joints.values() for dof in view.joint.dofs)


# ---- what options ask for ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("keep", KEEPING)
def test_what_was_asked_for_is_the_robot_s_own_from_then_on(keep: Any, tmp_path: Path) -> None:
    (tmp_path / "gripper.urdf").write_text(GRIPPER)
    hx.convert(tmp_path / "gripper.urdf", tmp_path / "ga.xml", actuators="position", base="free", keep=keep)
    hx.convert(tmp_path / "ga.xml", tmp_path / "gb.xml", keep=keep)
    for name in ("ga.xml", "gb.xml"):
        robot = hx.load(tmp_path / name).mechanism
        assert is_floating(robot), name
        assert [actuator.kind for _, actuator in robot.vertices(Actuator)] == ["position"], name
    a, b = (mujoco.MjModel.from_xml_path(str(tmp_path / name)) for name in ("ga.xml", "gb.xml"))
    assert differences(a, b) == []


@pytest.mark.parametrize("keep", ["beside", "inside"])
def test_what_was_asked_for_comes_home(keep: Any, tmp_path: Path) -> None:
    (tmp_path / "gripper.urdf").write_text(GRIPPER)
    hx.convert(tmp_path / "gripper.urdf", tmp_path / "ga.xml", actuators="motor", base="free", keep=keep)
    hx.convert(tmp_path / "ga.xml", tmp_path / "home.urdf", keep=keep)
    home = hx.load(tmp_path / "home.urdf").mechanism
    assert is_floating(home)
    assert [actuator.kind for _, actuator in home.vertices(Actuator)] == ["motor"]
    assert [dof.limits.velocity for view in home.joints.values() for dof in view.joint.dofs if dof.kind is DofKind.SLIDE] == [0.1]


# ---- every robot ---------------------------------------------------------------------------------------------------------------


def faults(a: Mechanism, b: Mechanism, format: str) -> list[str]:
    """In what two robots differ, but for where their files are; in single precision for a format that has no other."""
    found = [fault for fault in hx.diff(a, b, ROUGHLY.get(format, Tolerance())) if fault.field != "uri"]
    gone = {_without_folders(fault.before) for fault in found if fault.after is None}
    new = {_without_folders(fault.after) for fault in found if fault.before is None}
    moved = {text for text in gone & new if text is not None}
    return [str(fault) for fault in found if _without_folders(fault.before or fault.after) not in moved]


def _without_folders(text: str | None) -> str | None:
    """An element of MJCF without the folders of its files."""
    return None if text is None else re.sub(r' (mesh|texture|asset)dir="[^"]*"', "", text)


def native(data: bytes, format: str) -> Mechanism:
    return pipeline.reader(formats.by_name(format))(Source("<text>", data, NoFiles()), Report()).mechanism


def again(data: bytes, format: str, keep: Any) -> bytes:
    """The file converted within its format, as `convert` does."""
    row = formats.by_name(format)
    robot, passed = pipeline.read_for(row, Source("<text>", data, NoFiles()), row, Report(), lenient=True)
    return pipeline.convert(robot, row, Options(keep=keep, lenient=True), NoFiles(), Report(), passed=passed).package.main


@pytest.mark.parametrize("format", ["urdf", pytest.param("xacro", marks=pytest.mark.full), "mjcf", "usd"])
@settings(max_examples=10, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.data(), st.sampled_from(BASES), st.sampled_from(ACTUATORS), st.sampled_from([None, "inside"]))
@pytest.mark.unread  # generated or damaged input: any
def test_a_second_conversion_within_a_format_gives_the_same_robot(
    format: str, data: st.DataObject, base: Any, actuators: Any, keep: Any
) -> None:
    robot = data.draw(mechanisms(PLAIN) if format == "usd" else mechanisms())
    try:
        text = hx.dumps(robot, format, base=base, actuators=actuators, keep=keep, lenient=True).encode()
    except Refusal:  # extras that are no XML
        return
    first = native(text, format)
    assert faults(first, native(again(text, format, keep), format), format) == []
    loaded = hx.dumps(hx.loads(text, format, lenient=True), format, keep=keep, lenient=True).encode()
    assert faults(first, native(loaded, format), format) == []


@pytest.mark.parametrize(("text", "own"), [(URDF, "urdf"), (MJCF, "mjcf")])
@pytest.mark.parametrize("keep", [None, "inside"])
def test_within_one_format_nothing_is_kept_but_what_was_kept_goes_along(text: str, own: str, keep: Any, tmp_path: Path) -> None:
    source = tmp_path / f"a{SUFFIXES[own]}"
    source.write_text(text)
    for number, suffix in enumerate((SUFFIXES[own], SUFFIXES["mjcf" if own == "urdf" else "urdf"])):
        first, second = tmp_path / f"{number}b{suffix}", tmp_path / f"{number}c{suffix}"
        hx.convert(source, first, keep="beside")
        hx.convert(first, second, keep="beside")
        kept = [Path(f"{path}.keep.hymeko") for path in (first, second)]
        assert [path.exists() for path in kept] == [number == 1] * 2
        if number:
            assert kept[0].read_text() == kept[1].read_text()
            assert unequal(hx.load(source).mechanism, hx.load(second).mechanism) == []


# ---- real robots -----------------------------------------------------------------------------------------------------------------

CHOICES = ((None, None), ("free", "position"), ("fixed", "none"), ("free", "motor"), (None, "velocity"))
TARGETS = {**SUFFIXES, "sdf": ".sdf", "hymeko": ".hymeko"}
EVERY = 398
WAYS = [
    (file, target, *CHOICES[(number + place) % len(CHOICES)])
    for number, (file, (place, target)) in enumerate(
        product((file for format in SUFFIXES for file in development_files(format)), enumerate(TARGETS))
    )
]


def assert_same_again(robot: Path, target: str, base: Any, actuators: Any, folder: Path) -> None:
    for keep in KEEPING:
        first, second = (folder / f"{name}{keep}" / f"robot{TARGETS[target]}" for name in "ab")
        for path in (first, second):
            path.parent.mkdir()
        hx.convert(robot, first, to_format=target, base=base, actuators=actuators, keep=keep, assets="reference")
        hx.convert(first, second, to_format=target, keep=keep, assets="reference")
        if target == "mjcf":
            assert differences(*(mujoco.MjModel.from_xml_path(str(path)) for path in (first, second))) == []
        else:
            verdict = hx.verify(first, second, samples=5, meshes=False)
            assert [f"{check.quantity} at {check.at}" for check in verdict.failed] == [], verdict.reason
        before, after = (hx.load(path, target, ignore_kept=True).mechanism for path in (first, second))
        assert faults(before, after, target) == []


def _id(value: object) -> str:
    return str(getattr(value, "id", value))


@pytest.mark.corpus
@pytest.mark.parametrize(("robot", "target", "base", "actuators"), WAYS[::EVERY], ids=_id, indirect=["robot"])
def test_a_real_robot_is_the_same_after_a_second_conversion(robot: Path, target: str, base: Any, actuators: Any, tmp_path: Path) -> None:
    assert_same_again(robot, target, base, actuators, tmp_path)


@pytest.mark.full
@pytest.mark.corpus
@pytest.mark.parametrize(
    ("robot", "target", "base", "actuators"), [way for way in WAYS if way not in WAYS[::EVERY]], ids=_id, indirect=["robot"]
)
def test_every_real_robot_is_the_same_after_a_second_conversion(
    robot: Path, target: str, base: Any, actuators: Any, tmp_path: Path
) -> None:
    assert_same_again(robot, target, base, actuators, tmp_path)


HUMANOID = next(file for file in development_files("urdf") if file.path.endswith("g1_29dof_with_hand_rev_1_0.urdf"))


@pytest.mark.full
@pytest.mark.corpus
@pytest.mark.parametrize("robot", [HUMANOID], ids=_id, indirect=True)
def test_the_humanoid_of_the_demo_keeps_its_actuators_and_its_free_base(robot: Path, tmp_path: Path) -> None:
    (tmp_path / "b").mkdir()
    first, second = tmp_path / "g1.xml", tmp_path / "b" / "g1.xml"
    hx.convert(robot, first, target="mujoco", base="free", actuators="position")
    assert hx.convert(first, second).losses == ()
    a, b = (mujoco.MjModel.from_xml_path(str(path)) for path in (first, second))
    assert (a.nu, a.nq - a.nv, b.nu, b.nq - b.nv) == (43, 1, 43, 1)
    assert differences(a, b) == []


TWO_COLOURS = """mtllib two.mtl
v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1
usemtl red\nf 1 2 3\nf 1 2 4
usemtl blue\nf 1 3 4\nf 2 3 4
"""


@pytest.mark.parametrize("keep", ["beside", "inside"])
@pytest.mark.parametrize("number", [1, 5])
def test_what_is_kept_of_a_mesh_in_several_parts_holds_in_another_folder(keep: Any, number: int, tmp_path: Path) -> None:
    """MJCF names the folder of many meshes in <compiler>, and only there."""
    names = [f"two{place}.obj" for place in range(number)]
    for name in names:
        (tmp_path / name).write_text(TWO_COLOURS)
    (tmp_path / "two.mtl").write_text("newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n")
    visuals = "".join(f'<visual><geometry><mesh filename="{name}"/></geometry></visual>' for name in names)
    (tmp_path / "r.urdf").write_text(f'<robot name="r"><link name="a">{visuals}</link></robot>')
    first, second = tmp_path / "a" / "r.xml", tmp_path / "b" / "c" / "r.xml"
    for path in (first, second):
        path.parent.mkdir(parents=True)
    hx.convert(tmp_path / "r.urdf", first, keep=keep, assets="reference")
    hx.convert(first, second, keep=keep, assets="reference")
    assert first.read_text().count("<mesh ") == second.read_text().count("<mesh ") == 2 * number
    compilers = [path.read_text().partition("<compiler")[2].partition("/>")[0] for path in (first, second)]
    assert ["meshdir" in compiler for compiler in compilers] == [number > 1, False]
    a, b = (hx.load(path).mechanism for path in (first, second))
    assert [part.uri for _, part in b.assets()] == [part.uri for _, part in a.assets()] == names
    assert faults(a, b, "mjcf") == []
