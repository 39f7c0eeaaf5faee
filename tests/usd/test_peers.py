"""Other people's programs: we read what they write, and they read what we write. `make peers` installs them.

Robots are compared without meshes, which change neither names nor motion and take most of the time.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Literal

import pytest
from lxml import etree
from msgspec.structs import replace

import hymeko_x as hx
from hymeko_x.corpus import cache, catalog
from hymeko_x.ir.kinematics import dof_number
from hymeko_x.ir.mechanism import Mechanism, RobotArc
from hymeko_x.ir.parts import Joint, Shape, Tendon
from hymeko_x.verify import model_of, verify
from peers import CYBERWAVE, MUJOCO_USD_CONVERTER, NEWTON, SCIKIT_ROBOT, URDF_USD_CONVERTER, VALIDATOR, Peer

pytestmark = [pytest.mark.peers, pytest.mark.slow, pytest.mark.corpus]


def names(text: str) -> list[str]:
    return text.split()


URDF = names(
    "Acrobot_no_collision alex_psyonic_hands anymal_c baxter_arm cartpole dclaw_gripper_glb g1 "
    "g1_simplified_upper_body icub lbr_iiwa_14_r820 minitaur panda pr2 puma560_robot quadruped r2d2 romeo "
    "simple_humanoid tiago_dual upkie xarm7"
)
MJCF = names(
    "prismaversal_3dof_joint arm stacker four_bar_linkage panda_free_base rope_ball bimanual_viperx_transfer_cube "
    "ant hopper walker2d_v5 adroit_pen cartpole yam go1 01_humanoids pulley_fixed_site_wrap tendon finger "
    "manipulator car"
)
SINGLE = 2.0**-23
CALLED_OTHERWISE = {("scikit-robot", "lbr_iiwa_14_r820"), ("cyberwave-robot-format", "lbr_iiwa_14_r820"), ("scikit-robot", "xarm7")}
"""Robots whose names the converter changed to what a prim may be called, without keeping the original; a link `world` made a body."""
REFUSED = {("urdf-usd-converter", "alex_psyonic_hands")}
"""Robots that the converter does not accept: a mimic of a joint that comes later."""


def files_of(format: str, names: list[str]) -> list[Path]:
    root = cache.cache_root(os.environ)
    found = {Path(file.path).stem: file for file in catalog.development_files(format)}
    return [cache.fetch(found[name].package, root) / found[name].path for name in names]


def without_meshes(path: Path, folder: Path) -> Path:
    tree = etree.parse(str(path), etree.XMLParser(recover=True, remove_comments=True))
    for mesh in list(tree.iter("mesh")):
        shape = mesh.getparent().getparent()
        if shape is not None and shape.getparent() is not None:
            shape.getparent().remove(shape)
    copy = folder / path.name
    copy.write_bytes(etree.tostring(tree))
    return copy


def need(peer: Peer) -> None:
    if not peer.is_installed():
        pytest.skip(f"{peer.name} is not installed; run `make peers`")


@pytest.mark.parametrize("peer", [URDF_USD_CONVERTER, CYBERWAVE, SCIKIT_ROBOT], ids=lambda peer: peer.name)
def test_the_robot_that_a_converter_was_given_is_read_from_what_it_wrote(peer: Peer, tmp_path: Path) -> None:
    """Every link, every joint that moves and their motion; fixed joints that a converter left out have no names."""
    need(peer)
    sources = [without_meshes(path, tmp_path) for path in files_of("urdf", URDF)]
    answers = peer.run([{"source": str(path), "folder": str(tmp_path / path.stem)} for path in sources])
    assert {path.stem for path, answer in zip(sources, answers, strict=True) if "error" in answer} == {
        name for who, name in REFUSED if who == peer.name
    }
    found = {path: answer["stage"] for path, answer in zip(sources, answers, strict=True) if "stage" in answer}
    assert {path.stem: wrong for path, stage in found.items() if (wrong := differences(path, stage, peer.name))} == {}


def test_the_robot_that_mujocos_converter_was_given_is_read_from_what_it_wrote(tmp_path: Path) -> None:
    need(MUJOCO_USD_CONVERTER)
    sources = files_of("mjcf", MJCF)
    answers = MUJOCO_USD_CONVERTER.run([{"source": str(path), "folder": str(tmp_path / path.stem)} for path in sources])
    assert [answer["error"] for answer in answers if "error" in answer] == []
    pairs = zip(sources, answers, strict=True)
    assert {path.stem: wrong for path, answer in pairs if (wrong := differences(path, answer["stage"], "mujoco-usd-converter"))} == {}


WITH_TENDONS = names("tendon pulley_fixed_site_wrap arm21 stacker panda_free_base coupled_half_cheetah manipulator pendula quadruped")


def test_mujocos_converter_writes_the_tendons_that_we_read_from_its_source(tmp_path: Path) -> None:
    need(MUJOCO_USD_CONVERTER)
    sources = files_of("mjcf", WITH_TENDONS)
    answers = MUJOCO_USD_CONVERTER.run([{"source": str(path), "folder": str(tmp_path / path.stem)} for path in sources])
    for path, answer in zip(sources, answers, strict=True):
        expected = tendons_of(hx.load(path).mechanism)
        assert expected
        assert tendons_of(hx.load(answer["stage"]).mechanism) == expected, path.stem


def test_newton_leads_cables_through_our_stages_as_through_the_source(tmp_path: Path) -> None:
    need(NEWTON)
    sources = files_of("mjcf", names("tendon pulley_fixed_site_wrap arm21 stacker"))
    stages = [tmp_path / f"{path.stem}.usda" for path in sources]
    for source, stage in zip(sources, stages, strict=True):
        hx.dump(hx.load(source), stage)
    answers = NEWTON.run([{"source": str(path), "tendons": True} for path in (*sources, *stages)])
    assert [answer["error"] for answer in answers if "error" in answer] == []
    assert [answer["tendons"] for answer in answers[: len(sources)]] == [answer["tendons"] for answer in answers[len(sources) :]]
    assert all(len(answer["tendons"]) > 1 for answer in answers)


def tendons_of(mechanism: Mechanism) -> list[tuple[object, ...]]:
    """Tendons in order, their steps by the names of what they lead through; what is MuJoCo's default counts as absent."""
    found = []
    for _, tendon, arcs in mechanism.edges(Tendon):
        steps = [(step_name(mechanism, arc), arc.role if arc.target.kind == "tendon" else "", arc.weight) for arc in arcs]
        parameters = {name: value for name, value in tendon.parameters if (name, value) not in DEFAULTS}
        is_seen = tendon.kind == "spatial"
        looks = (tendon.width or 0.003, tendon.rgba or (0.5, 0.5, 0.5, 1.0)) if is_seen else ()
        found.append((replace(tendon, width=None, rgba=None, parameters=()), looks, parameters, steps))
    return found


DEFAULTS = (("group", 0.0), ("margin", 0.0), ("springlength", -1.0))


def step_name(mechanism: Mechanism, arc: RobotArc) -> str:
    edge = mechanism.graph.edges.get(arc.target)
    if edge is not None and isinstance(edge.data, Shape):
        return edge.data.name or ""
    if edge is not None and isinstance(edge.data, Joint):
        return edge.data.dofs[dof_number(edge.data, arc.role) or 0].name or arc.target.name
    return "" if arc.target.kind == "tendon" else arc.target.name


def differences(source: Path, stage: str, peer: str) -> list[str]:
    """Names and motion that are not those of the source, as its reference reader sees it, to single precision."""
    model = replace(model_of(hx.load(stage).mechanism), precision=SINGLE)
    verdict = verify(source, model, samples=10, meshes=False)
    assert verdict.checks, verdict.reason
    wrong = []
    for check in verdict.failed:
        names = check.quantity in ("bodies", "joints") and (peer, source.stem) not in CALLED_OTHERWISE
        lost_fixed = check.quantity == "joints" and peer == URDF_USD_CONVERTER.name and "has no counterpart" not in check.at
        moves = check.quantity.startswith("forward kinematics") and check.worst > 1e-6
        if (names and not lost_fixed) or moves:
            wrong.append(f"{check.quantity}: {check.worst} at {check.at}")
    return wrong


# ---- Newton ----------------------------------------------------------------------------------------------------------------------

LIMITS_BY_MAGIC = {"anymal_c", "quadruped", "minitaur", "r2d2", "centauro"}
"""Newton's URDF reader takes [0, 0] for no limit, and the limits of a continuous joint for limits."""
TENSORS_OF_NO_BODY = {"tiago_dual", "anymal_c", "anymal-kinova", "icub"}
"""Tensors that are not positive: Newton's URDF reader keeps them, its USD reader puts others in their place."""
TOTAL_MASS = {"half_cheetah", "coupled_half_cheetah"}
"""MuJoCo scales masses to `settotalmass`, and so do we; Newton's MJCF reader does not."""


@pytest.mark.parametrize("format", ["urdf", "mjcf"])
def test_newton_builds_the_same_model_from_our_usd_as_from_the_source(format: str, tmp_path: Path) -> None:
    """Bodies, masses, joints, their types, frames, axes and limits; see docs/mapping/usd.md for the rest."""
    need(NEWTON)
    sources = files_of(format, NEWTON_ROBOTS[format])
    if format == "urdf":
        sources = [without_meshes(path, tmp_path) for path in sources]
    jobs = []
    for path in sources:
        out = tmp_path / f"{path.stem}.usda"
        hx.dump(hx.load(path), out)
        jobs += [{"source": str(path)}, {"source": str(out)}]
    answers = NEWTON.run(jobs)
    assert [answer["error"] for answer in answers if "error" in answer] == []
    wrong = {}
    for number, path in enumerate(sources):
        found = compare_models(answers[2 * number], answers[2 * number + 1])
        found -= {"lower", "upper"} if path.stem in LIMITS_BY_MAGIC else set()
        found -= {"tensor"} if path.stem in TENSORS_OF_NO_BODY else set()
        found -= {"mass", "tensor"} if path.stem in TOTAL_MASS else set()
        if found:
            wrong[path.stem] = sorted(found)
    assert wrong == {}


NEWTON_ROBOTS = {
    "urdf": names(
        "Acrobot_no_collision alex_psyonic_hands g1_29dof_with_hand_rev_1_0 anymal_c panda_slider_mobile "
        "allegro_hand_right_glb g1 quadruped minitaur minitaur_rainbow_dash_v1 r2d2 hand puma560_robot cartpole "
        "tiago_dual anymal-kinova centauro double_pendulum double_pendulum_simple icub pr2 simple_humanoid "
        "talos_full_v2_box tiago_pro"
    ),
    "mjcf": names(
        "arm stacker rope_ball cartpole yam soccer_ball finger hopper nv_ant humanoid go1 01_humanoids 10_humanoids "
        "prismaversal_3dof_joint walker2d_v5 acrobot manipulator single_spherical_pendulum_position half_cheetah "
        "coupled_half_cheetah"
    ),
}


def compare_models(source: dict, ours: dict) -> set[str]:
    """What differs between two answers of the driver; names are the last steps of labels, as prims may be called."""
    found = set()
    if len(source["joints"]) != len(ours["joints"]) or len(source["bodies"]) != len(ours["bodies"]):
        found.add("counts")
    bodies = {plain(body["name"]): body for body in ours["bodies"]}
    for body in source["bodies"]:
        other = bodies.get(plain(body["name"]))
        if other is None:
            found.add(f"body {body['name']}")
            continue
        scale = max(map(abs, body["tensor"])) or 1.0
        found |= {"mass"} if not near(body["mass"], other["mass"]) else set()
        found |= {"com"} if not all(map(near, body["com"], other["com"])) else set()
        found |= {"tensor"} if max(abs(a - b) for a, b in zip(body["tensor"], other["tensor"], strict=True)) > 1e-4 * scale else set()
    joints = {plain(ours["bodies"][joint["child"]]["name"]): joint for joint in ours["joints"]}
    for joint in source["joints"]:
        other = joints.get(plain(source["bodies"][joint["child"]]["name"]))
        found |= {f"joint {joint['name']}"} if other is None else compare_joints(joint, other)
    return found


def compare_joints(joint: dict, other: dict) -> set[str]:
    if joint["type"] != other["type"] or len(joint["axes"]) != len(other["axes"]):
        return {"type"}
    if joint["type"] == "FREE":
        return set()
    pairs = {name: zip(joint[name], other[name], strict=True) for name in ("lower", "upper", "velocity", "effort")}
    found = {name for name, values in pairs.items() if not all(near(a, b) or is_no_effort(name, a, b) for a, b in values)}
    return found | ({"frame"} if not all(map(near, place(joint), place(other))) else set())


def is_no_effort(name: str, a: float | None, b: float | None) -> bool:
    """An effort limit of 0 is none in USD, where MuJoCo's schema takes an empty range for no limit."""
    return name == "effort" and a == 0.0 and b is None


def place(joint: dict) -> list[float]:
    """Where the child stands in its parent at zero, and its axes there: position, rotation and axes as numbers."""
    import numpy as np
    from scipy.spatial.transform import Rotation

    above, below = (Rotation.from_quat(joint[side][3:]) for side in ("above", "below"))
    turn = above * below.inv()
    at = np.array(joint["above"][:3]) - turn.apply(joint["below"][:3])
    axes = [below.apply(axis) for axis in joint["axes"]]
    return [*at.tolist(), *turn.as_matrix().ravel().tolist(), *np.ravel(axes).tolist()]


def plain(label: str) -> str:
    import re

    return re.sub(r"\W", "_", label.rsplit("/", 1)[-1]).lstrip("_")


def near(a: float | None, b: float | None) -> bool:
    if a is None or b is None:
        return a is b
    return abs(a - b) <= 2e-5 * max(1.0, abs(a), abs(b))


# ---- validators ------------------------------------------------------------------------------------------------------------------


VALIDATED = ["Acrobot_no_collision", "quadruped", "hand", "puma560_robot", "racecar"]
"""The one before the last has meshes of thousands of triangles, the last one meshes in several looks."""


@pytest.mark.parametrize("layout", ["single", "layered"])
def test_the_asset_validator_finds_no_failure(layout: Literal["single", "layered"], tmp_path: Path) -> None:
    """Its rules include those of usdchecker. Warnings are about the source's own meshes."""
    need(VALIDATOR)
    jobs = []
    for path in [*files_of("urdf", VALIDATED), *files_of("mjcf", ["yam", "car"])]:
        for suffix in (".usda", ".usdc", ".usdz"):
            stage = tmp_path / f"{path.stem}{suffix}"
            hx.convert(path, stage, layout=layout)
            jobs.append({"stage": str(stage)})
    answers = VALIDATOR.run(jobs)
    assert [answer["error"] for answer in answers if "error" in answer] == []
    assert [issue for answer in answers for issue in answer["issues"] if "WARNING" not in issue] == []


@pytest.mark.parametrize("target", ["newton", "isaac"])
def test_the_asset_validator_finds_no_failure_in_a_stage_for_a_target(target: str, tmp_path: Path) -> None:
    need(VALIDATOR)
    jobs = []
    for path in [*files_of("urdf", [*VALIDATED, "Pendulum"]), *files_of("mjcf", ["yam", "car", "tendon"])]:
        (tmp_path / path.stem).mkdir()
        stage = tmp_path / path.stem / "robot.usda"
        hx.convert(path, stage, target=target)
        jobs.append({"stage": str(stage)})
    answers = VALIDATOR.run(jobs)
    assert [answer["error"] for answer in answers if "error" in answer] == []
    assert [issue for answer in answers for issue in answer["issues"] if "WARNING" not in issue] == []
