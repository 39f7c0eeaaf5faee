"""Bodies without names come home as themselves: what is removed or renamed is the one, and not another one that gets its number."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import trimesh
from pxr import Usd

import hymeko_x as hx

BALLS = """<mujoco model="r">
  <worldbody>
    <body pos="1 0 0">
      <freejoint/>
      <geom size="0.1"/>
    </body>
    <body pos="2 0 0">
      <freejoint/>
      <geom size="0.1"/>
    </body>
    <body pos="3 0 0">
      <freejoint/>
      <geom size="0.1"/>
    </body>
    <body pos="4 0 0">
      <freejoint/>
      <geom size="0.1"/>
    </body>
  </worldbody>
</mujoco>
"""
SECOND = '    <body pos="2 0 0">\n      <freejoint/>\n      <geom size="0.1"/>\n    </body>\n'


def converted(folder: Path) -> tuple[Path, Path, str]:
    """The original, what it was converted into, and the text of that."""
    original, there = folder / "r.xml", folder / "r.urdf"
    original.write_text(BALLS)
    hx.convert(original, there)
    return original, there, there.read_text()


@pytest.mark.unread("HX101")
def test_a_body_that_is_removed_is_removed_once(tmp_path: Path) -> None:
    original, there, text = converted(tmp_path)
    (name,) = re.findall(r'<joint name="([^"]*)" type="floating">\s*<origin xyz="2 0 0"', text)
    for tag in ("link", "joint"):
        text = re.sub(rf'<{tag} name="{name}".*?</{tag}>', "", text, flags=re.DOTALL)
    there.write_text(text)
    edits = [str(edit).partition(":")[0] for edit in hx.update(original, there).edits]
    assert original.read_text() == BALLS.replace(SECOND, "")
    assert edits == [f"body '{name}'", f"joint '{name}'", f"shape '{name}/shape'"]
    again = hx.update(original, there)
    assert (again.edits, [str(row) for row in again.report]) == ((), [])


@pytest.mark.unread("HX101")
def test_a_body_that_is_renamed_gets_the_name_and_no_other_one_does(tmp_path: Path) -> None:
    original, there, text = converted(tmp_path)
    (name,) = re.findall(r'<joint name="([^"]*)" type="floating">\s*<origin xyz="2 0 0"', text)
    there.write_text(text.replace(f'link name="{name}"', 'link name="ball"').replace(f'link="{name}"', 'link="ball"'))
    hx.update(original, there)
    named = BALLS.replace('<body pos="2 0 0">', '<body name="ball" pos="2 0 0">')
    assert original.read_text() == named
    assert hx.update(original, there).edits == ()
    assert original.read_text() == named


@pytest.mark.unread("HX101", "HX105", "HX201", "HX204")
@pytest.mark.parametrize("gone", ["one", "two", "three"])
def test_other_meshes_stay_when_the_shape_of_one_is_removed(gone: str, tmp_path: Path) -> None:
    """A stage names its meshes after their shapes, by numbers in their order."""
    links = []
    for size, name in enumerate(("one", "two", "three"), start=1):
        trimesh.creation.box((size, 1, 1)).export(tmp_path / f"{name}.stl")
        links.append(f'<link name="{name}"><visual><geometry><mesh filename="{name}.stl"/></geometry></visual></link>\n')
    joints = [f'<joint name="j{name}" type="fixed"><parent link="one"/><child link="{name}"/></joint>\n' for name in ("two", "three")]
    text = f'<robot name="r">\n{"".join(links)}{"".join(joints)}</robot>\n'
    original, there = tmp_path / "r.urdf", tmp_path / "r.usda"
    original.write_text(text)
    hx.convert(original, there)
    stage = Usd.Stage.Open(str(there))
    prim = next(prim for prim in stage.Traverse() if prim.GetName() == "visual" and prim.GetParent().GetName() == gone)
    stage.RemovePrim(prim.GetPath())
    stage.Save()
    report = hx.update(original, there).report
    assert [str(row) for row in report if row.code.id == "HX118"] == []
    visual = f'<visual><geometry><mesh filename="{gone}.stl"/></geometry></visual>'
    assert original.read_text() in (
        text.replace(visual, ""),
        text.replace(f'<link name="{gone}">{visual}</link>', f'<link name="{gone}"/>'),
    )
