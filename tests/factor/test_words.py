"""What several elements are, found in the words of their names."""

from __future__ import annotations

from hymeko_x.factor.words import by_meaning, common_words, distinguishing_words, meaning, telling_words


def test_a_set_is_called_after_the_words_that_names_share() -> None:
    assert common_words(["left_hip_joint", "right_hip_joint"]) == "hip_joint"
    assert common_words(["a1", "a2"]) == ""


def test_sides_kinds_and_numbers_tell_nothing_of_what_an_element_is() -> None:
    assert meaning(["left_hip_pitch_joint", "right_hip_roll_joint"]) == "hip"
    assert meaning(["FL_calf_joint", "RR_calf_joint"]) == "calf"
    assert meaning(["joint1", "joint2"]) == ""
    names = ["panda_joint1", "panda_joint2", "panda_finger_joint1", "panda_finger_joint2"]
    assert distinguishing_words(names) == [[], [], ["finger"], ["finger"]]


def test_names_without_a_common_meaning_are_grouped_by_those_that_they_have() -> None:
    names = ["left_shoulder_pitch", "left_shoulder_roll", "left_elbow", "right_shoulder_pitch", "right_elbow", "torso"]
    names.append("right_shoulder_roll")
    split = [telling_words(name) for name in names]
    assert by_meaning(split, 3) == [("shoulder", [0, 1, 3, 6])]
    assert by_meaning(split, 2) == [("shoulder", [0, 1, 3, 6]), ("elbow", [2, 4])]
    assert by_meaning([telling_words(name) for name in ("joint1", "joint2", "joint3")], 3) == []
