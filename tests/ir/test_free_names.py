"""Free names: the first one that suits, or a number behind the last one."""

from __future__ import annotations

import pytest

from hymeko_x.ir.names import first_free_name, free_name


@pytest.mark.parametrize(
    ("taken", "free"),
    [((), "arm"), (("leg",), "arm"), (("arm",), "arm_2"), (("arm", "arm_2", "arm_3"), "arm_4"), (("arm", "arm_3"), "arm_2")],
)
def test_a_name_that_is_taken_gets_the_first_free_number(taken: tuple[str, ...], free: str) -> None:
    assert free_name("arm", taken.__contains__, "_") == free


@pytest.mark.parametrize(
    ("taken", "free"),
    [((), "hip"), (("knee",), "hip"), (("hip",), "knee"), (("hip", "knee"), "knee2"), (("hip", "knee", "knee2"), "knee3")],
)
def test_the_first_of_several_names_that_is_free_counts_and_only_the_last_one_gets_a_number(taken: tuple[str, ...], free: str) -> None:
    assert first_free_name(["hip", "knee"], taken, "") == free
