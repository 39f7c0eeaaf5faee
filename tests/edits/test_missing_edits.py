"""An edit that has no place in the original is reported, whatever else was edited."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx

LEG = """<mujoco model="r">
  <worldbody>
    <body name="leg">
      <geom name="shin" type="capsule" fromto="0 0 0 0 0 1" size="0.1"/>
      <body name="foot" pos="0 0 1">
        <joint name="ankle"/>
        <geom name="sole" size="0.1"/>
        <body name="toe">
          <geom size="0.1"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def updated(folder: Path, name: str, *changes: tuple[str, str]) -> tuple[list[str], list[str]]:
    """The edits, and the warnings, when a converted file was changed so."""
    (folder / "r.xml").write_text(LEG)
    hx.convert(folder / "r.xml", folder / name)
    text = (folder / name).read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (folder / name).write_text(text)
    found = hx.update(folder / "r.xml", folder / name, dry_run=True)
    return [str(edit) for edit in found.edits], [row.message for row in found.report if row.code.id == "HX118"]


@pytest.mark.parametrize(
    ("name", "old", "words"),
    [
        ("r.sdf", "toe_joint", "joint 'toe_joint' is called 'other'"),
        ("r.urdf", '"world"', "body 'world' is called 'other'"),
        ("r.urdf", '"shin"', "shape 'leg/visual' name: 'shin' -> 'other'"),
    ],
)
@pytest.mark.unread("HX023", "HX101")
def test_a_new_name_of_what_only_the_converted_file_has_is_reported(name: str, old: str, words: str, tmp_path: Path) -> None:
    new = '"other"' if old.startswith('"') else "other"
    edits, warnings = updated(tmp_path, name, (old, new))
    assert edits == []
    assert warnings[0] == f"the edit did not arrive: {words}"


@pytest.mark.unread("HX101")
def test_it_is_reported_beside_an_edit_that_arrives(tmp_path: Path) -> None:
    edits, warnings = updated(tmp_path, "r.urdf", ('"world"', '"other"'), ('"ankle"', '"heel"'))
    assert [edit for edit in edits if "heel" in edit]
    assert warnings == ["the edit did not arrive: body 'world' is called 'other'"]


def test_an_edit_that_arrives_is_not_reported(tmp_path: Path) -> None:
    assert updated(tmp_path, "r.urdf", ('"ankle"', '"heel"'), ('"toe"', '"tip"'))[1] == []
