"""A height field where a format has none, or holds it as the text of another one, is no difference between robots."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx

SCENE = """<mujoco model="m"><asset><hfield name="h" nrow="2" ncol="2" size="1 1 1 1" elevation="0 1 1 0"/></asset>
<worldbody><geom type="hfield" hfield="h"/><body name="b"><freejoint/><geom type="capsule" size=".1 .1"/></body></worldbody></mujoco>"""


@pytest.mark.parametrize("name", ["m.hymeko", "m.usda"])
def test_a_height_field_is_no_difference(name: str, tmp_path: Path) -> None:
    (tmp_path / "m.xml").write_text(SCENE, "utf-8")
    hx.convert(str(tmp_path / "m.xml"), str(tmp_path / name))
    verdict = hx.verify(str(tmp_path / "m.xml"), str(tmp_path / name), samples=5)
    assert verdict.is_same, verdict.failed
