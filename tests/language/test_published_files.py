"""The 53 files that the language's authors publish: each is a robot, a graph, or refused with a code that names the construct."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal, Report

FOLDER = Path(__file__).parents[3] / "shared/corpora/himeko_lang/himeko_lang_core"
KINEMATICS = "examples/kinematics"
ROBOTS = {
    f"{KINEMATICS}/robotics/anthropomorphic_arm_import": 7,
    f"{KINEMATICS}/robotics/anthropomorphic_arm_import_comm": 7,
    f"{KINEMATICS}/robotics/diff_drive_robot_4wh": 5,
    f"{KINEMATICS}/robotics/diff_drive_robot_4wh_camera": 6,
    f"{KINEMATICS}/robotics/diff_drive_robot_4wh_camera_scanner": 7,
    f"{KINEMATICS}/robotics/industrial/kamu_fanuc": 8,
    f"{KINEMATICS}/simple_kinematics": 3,
    f"{KINEMATICS}/very_simple_kinematics_with_primitives": 3,
}
"""How many bodies they have."""
REFUSED = {
    "examples/agriculture/chicken_camera": (77, "HX060", "unexpected '}'; expected the end of the text"),
    "examples/fuzzy/fuzzy_signature_example": (1, "HX040", "the imported file 'fuzzy_signature.himeko' was not found"),
    f"{KINEMATICS}/robotics/anthropomorphic_arm": (33, "HX062", "'base_link' is a body, and data holds data and relations"),
    f"{KINEMATICS}/very_simple_kinematics": (2, "HX040", "the imported file 'robot_primitives.himeko' was not found"),
    "examples/queries/himeko_simple_query": (15, "HX061", "'Result' has the type 'Table', which is not known"),
    "robotics/communication_graphs/talker_subscriber": (1, "HX040", "the imported file 'meta_topic.himeko' was not found"),
}
"""Line, code and message. One has a brace too many, three import files that are not there, one uses a type that nothing defines."""
FILES = sorted(FOLDER.rglob("*.h[iy]m*ko"))
pytestmark = pytest.mark.skipif(not FILES, reason="the authors' files are not here")


def test_there_are_53_of_them() -> None:
    names = {str(path.relative_to(FOLDER).with_suffix("")) for path in FILES}
    assert len(FILES) == len(names) == 53
    assert names > {*ROBOTS, *REFUSED}


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
@pytest.mark.unread("HX061")
def test_each_is_read_and_comes_back_or_is_refused(path: Path) -> None:
    name = str(path.relative_to(FOLDER).with_suffix(""))
    if name in REFUSED:
        with pytest.raises(Refusal) as caught:
            hx.load(path)
        found = caught.value.diagnostic
        line = None if found.origin is None else found.origin.line
        assert (line, found.code.id, found.message) == REFUSED[name]
        return
    mechanism = hx.load(path, report=Report()).mechanism
    kinds = [key.kind for key in (*mechanism.graph.vertices, *mechanism.graph.edges)]
    assert kinds.count("body") == ROBOTS.get(name, 0)
    assert name in ROBOTS or {*kinds} <= {"datum", "relation", "nest"}
    text = hx.dumps(mechanism, "hymeko")
    again = hx.loads(text, "hymeko").mechanism
    assert again == mechanism
    assert hx.dumps(again, "hymeko") == text


@pytest.mark.full
@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("suffix", [".urdf", ".xml", ".usda", ".sdf", ".xacro"])
@pytest.mark.unread
def test_every_robot_is_the_same_in_five_formats(tmp_path: Path, name: str, suffix: str) -> None:
    path, target = (FOLDER / f"{name}.himeko"), tmp_path / f"robot{suffix}"
    hx.convert(path, target)
    assert str(hx.verify(path, target).verdict).startswith("same")
