"""The collector of cyclic garbage rests while a robot is read or written."""

from __future__ import annotations

import gc

import pytest

import hymeko_x as hx
from hymeko_x.collector import uncollected
from hymeko_x.diagnostics import Refusal


def test_it_rests_inside_and_runs_again_outside() -> None:
    assert gc.isenabled()
    with uncollected():
        assert not gc.isenabled()
        with uncollected():
            assert not gc.isenabled()
        assert not gc.isenabled()
    assert gc.isenabled()


def test_it_runs_again_after_a_refusal() -> None:
    with pytest.raises(Refusal):
        hx.loads("<sdf/>", "mjcf")
    assert gc.isenabled()


def test_who_switched_it_off_finds_it_off() -> None:
    gc.disable()
    try:
        hx.dumps(hx.loads('<robot name="r"><link name="l"/></robot>', "urdf"), "mjcf")
        assert not gc.isenabled()
    finally:
        gc.enable()
