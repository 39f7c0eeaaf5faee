"""Frames that are added in another format, and those that stay when what was on them is removed."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx

ARM = """<?xml version="1.0"?>
<sdf version="1.9">
  <model name="arm">
    <link name="base"><inertial><mass>1</mass></inertial></link>
    <link name="upper"><pose>0 0 1 0 0 0</pose><inertial><mass>1</mass></inertial></link>
    <joint name="shoulder" type="revolute"><parent>base</parent><child>upper</child><axis><xyz>0 1 0</xyz></axis></joint>
  </model>
</sdf>
"""
ROD = """    <link name="rod"><pose>0 0 1.5 0 0 0</pose><inertial><mass>1</mass></inertial></link>
    <joint name="elbow" type="revolute"><parent>upper</parent><child>rod</child><axis><xyz>0 1 0</xyz></axis></joint>
"""
CLOSURE = '    <joint name="closure" type="ball"><pose>0 0 0.2 0 0 0</pose><parent>base</parent><child>rod</child></joint>\n'


def updated(folder: Path, text: str, *change: str) -> str:
    """The text of a model after one change of its MJCF; a second update finds nothing."""
    original, there = folder / "arm.sdf", folder / "arm.xml"
    original.write_text(text)
    hx.convert(original, there)
    assert change[0] in there.read_text()
    there.write_text(there.read_text().replace(*change))
    hx.update(original, there)
    again = hx.update(original, there)
    assert ([str(edit) for edit in again.edits], [row.message for row in again.report]) == ([], [])
    return original.read_text()


@pytest.mark.unread("HX101", "HX105")
def test_a_site_on_a_link_of_a_model_is_a_frame_attached_to_that_link(tmp_path: Path) -> None:
    text = updated(tmp_path, ARM, '<joint name="shoulder"', '<site name="tip" pos="0 0 0.5"/><joint name="shoulder"')
    frame = '    <frame name="tip" attached_to="upper">\n      <pose>0 0 0.5 0 0 0</pose>\n    </frame>\n'
    assert text == ARM.replace("  </model>", f"{frame}  </model>")


@pytest.mark.unread("HX101", "HX105")
def test_the_sites_of_a_closure_that_was_removed_are_frames(tmp_path: Path) -> None:
    open_chain = ARM.replace("  </model>", f"{ROD}  </model>")
    closed = open_chain.replace("  </model>", f"{CLOSURE}  </model>")
    (tmp_path / "closed.sdf").write_text(closed)
    hx.convert(tmp_path / "closed.sdf", tmp_path / "closed.xml")
    there = (tmp_path / "closed.xml").read_text()
    part = there[there.index("  <equality>") : there.index("  </equality>\n") + len("  </equality>\n")]
    text = updated(tmp_path, closed, part, "")
    assert '<joint name="closure"' not in text
    assert text.count("<frame name=") == 2
