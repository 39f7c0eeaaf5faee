"""Edits of a text that imports robots: those of what stands in it are placed there, those of what it imports become overrides."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx

URDF = """<robot name="arm">
  <link name="base"><visual><geometry><box size="0.2 0.2 0.1"/></geometry></visual></link>
  <link name="link7"><inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <joint name="j1" type="revolute">
    <parent link="base"/><child link="link7"/><origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="20" velocity="3"/>
  </joint>
</robot>
"""
MJCF = """<mujoco model="arm">
  <worldbody>
    <body name="base">
      <geom type="box" size="0.1 0.1 0.05"/>
      <body name="link7" pos="0 0 0.3">
        <inertial pos="0 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>
        <joint name="j1" axis="0 1 0" range="-57.29577951308232 57.29577951308232" actuatorfrcrange="-20 20"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""
CELL = """// a cell
import "arm.urdf" as panda

cell : robot {
  arm : panda { [0 0 0.5] + table }
  table {
    mass 20.0      // heavy
    inertia [1 1 2]
    shape { box [1 1 0.1] }
  }
  @stand : fixed { + world - table }
}
"""
AFTER_ARM = "  arm : panda { [0 0 0.5] + table }\n"


def updated(folder: Path, cell: str, *changes: tuple[str, str]) -> tuple[str, list[str], list[str]]:
    """The text after these changes of its conversion to URDF, the edits, and what has no place. A second update finds nothing."""
    (folder / "arm.urdf").write_text(URDF)
    (folder / "arm.xml").write_text(MJCF)
    (folder / "cell.hymeko").write_text(cell)
    hx.convert(folder / "cell.hymeko", folder / "there.urdf")
    text = (folder / "there.urdf").read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (folder / "there.urdf").write_text(text)
    found = hx.update(folder / "cell.hymeko", folder / "there.urdf")
    again = hx.update(folder / "cell.hymeko", folder / "there.urdf", dry_run=True)
    assert (again.edits, again.changed) == ((), {})
    missing = [row.message for row in found.report if row.code.id == "HX118"]
    assert (folder / "arm.urdf").read_text() == URDF
    return (folder / "cell.hymeko").read_text(), [str(edit) for edit in found.edits], missing


@pytest.mark.parametrize("file", ["arm.urdf", "arm.xml"])
@pytest.mark.parametrize(
    ("change", "override"),
    [
        (('mass value="1"', 'mass value="0.5"'), "  arm.link7 { mass 0.5 }\n"),
        (('effort="20"', 'effort="30"'), "  @arm.j1 { effort 30 }\n"),
    ],
)
@pytest.mark.unread("HX101", "HX102")
def test_an_edit_of_what_is_imported_is_an_override(file: str, change: tuple[str, str], override: str, tmp_path: Path) -> None:
    cell = CELL.replace("arm.urdf", file)
    text, _, missing = updated(tmp_path, cell, change)
    assert (text, missing) == (cell.replace(AFTER_ARM, AFTER_ARM + override), [])


def test_an_override_that_is_there_gets_the_new_value(tmp_path: Path) -> None:
    cell = CELL.replace("  @stand", "  arm.link7 { mass 1.10 } // measured\n  @stand")
    assert updated(tmp_path, cell, ('mass value="1.1"', 'mass value="1.2"'))[0] == cell.replace("1.10", "1.2")


def test_what_stands_in_the_text_is_edited_there(tmp_path: Path) -> None:
    changes = ('xyz="0 0 0.5"', 'xyz="0 0.25 0.5"'), ('mass value="20"', 'mass value="25"')
    text, edits, missing = updated(tmp_path, CELL, *changes)
    assert (text, missing) == (CELL.replace("[0 0 0.5]", "[0 0.25 0.5]").replace("20.0", "25"), [])
    assert len(edits) == 2


def test_what_is_added_stands_on_what_is_imported(tmp_path: Path) -> None:
    pen = '<link name="pen"/><joint name="hold" type="fixed"><parent link="arm_link7"/><child link="pen"/></joint></robot>'
    text, _, missing = updated(tmp_path, CELL, ("</robot>", pen))
    assert ("  @hold : fixed { + arm_link7 - pen }\n" in text, missing) == (True, [])


@pytest.mark.unread("HX118")
def test_what_has_no_place_is_one_diagnostic_and_the_rest_arrives(tmp_path: Path) -> None:
    changes = ('size="0.2 0.2 0.1"', 'size="0.3 0.2 0.1"'), ('mass value="20"', 'mass value="25"')
    text, edits, missing = updated(tmp_path, CELL, *changes)
    assert missing == ["edits have no place in the text, which imports what they change: shape 'arm_base/visual'"]
    assert (text, len(edits)) == (CELL.replace("20.0", "25"), 1)


@pytest.mark.unread("HX118")
def test_a_name_of_another_file_stays(tmp_path: Path) -> None:
    text, edits, missing = updated(tmp_path, CELL, ('"arm_link7"', '"hand"'))
    assert (text, edits, missing) == (CELL, [], ["the edit did not arrive: body 'arm_link7' is called 'hand'"])
