"""An engine that asks for more memory than any robot needs refuses its file, and the process goes on."""

from __future__ import annotations

import gc
import mmap
import sys
from pathlib import Path

import mujoco
import pytest

import hymeko_x as hx
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.frontends.mjcf.complete import complete
from hymeko_x.source import NoFiles
from hymeko_x.verify.readers import bounded, mjcf
from hymeko_x.verify.readers.bounded import BoundedMemory, bounded_memory
from hymeko_x.verify.readers.lookup import Lookup

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such bound")

GREEDY = '<mujoco><size nuser_body="200000000"/><worldbody><body name="b"><geom size=".1" mass="0"/></body></worldbody></mujoco>'
"""A model for which MuJoCo asks for 3.2 GB."""


def limit() -> tuple[int, int]:
    import resource

    return resource.getrlimit(resource.RLIMIT_DATA)


def take_from_system(size: int) -> None:
    """Take so many bytes for a moment. What earlier tests left in the heap is not used for it, as it could be for a bytearray."""
    mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE).close()


@pytest.fixture
def less(monkeypatch: pytest.MonkeyPatch) -> None:
    gc.collect()  # what earlier tests left would count as used, and could be freed within the bound
    monkeypatch.setattr(bounded, "MOST_BYTES", 2**28)


@pytest.mark.usefixtures("less")
def test_verify_reports_that_mujoco_may_not_take_so_much(tmp_path: Path) -> None:
    file = tmp_path / "greedy.xml"
    file.write_text(GREEDY)
    before = limit()
    with pytest.raises(Refusal, match=r"HX302.*MuJoCo refuses greedy\.xml: .*\n  hint: .* more than 0\.27 GB of memory"):
        mjcf.read(file, Lookup())
    assert limit() == before
    mujoco.MjModel.from_xml_string(GREEDY.replace("200000000", "3"))


@pytest.mark.usefixtures("less")
def test_inertias_that_mujoco_cannot_compute_for_want_of_memory_are_left_out() -> None:
    robot, report = hx.loads(GREEDY.replace("200000000", "3"), "mjcf").mechanism, Report()
    with bounded_memory:
        assert complete(robot, lambda: (robot, GREEDY.encode()), NoFiles(), report) == robot
    assert [str(found)[:21] for found in report] == ["error[HX302]: MuJoCo "]


@pytest.mark.usefixtures("less")
def test_the_bound_holds_until_the_last_engine_has_ended() -> None:
    bound, before = BoundedMemory(), limit()
    with bound:
        first = limit()
        assert first != before
        with bound:
            assert limit() == first
        assert limit() == first
        with pytest.raises(OSError, match="Cannot allocate memory"):
            take_from_system(2**29)
    assert limit() == before
    take_from_system(2**29)
