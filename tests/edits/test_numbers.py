"""Contacts and closures without names keep what they have when another one is removed or named."""

from __future__ import annotations

import json
from pathlib import Path

import hymeko_x as hx

THREE = """<mujoco model="three">
  <worldbody>
    <body name="a"><freejoint/><geom name="ga" size="0.1"/></body>
    <body name="b"><freejoint/><geom name="gb" size="0.1"/></body>
    <body name="c"><freejoint/><geom name="gc" size="0.1"/><geom name="gd" size="0.2"/></body>
  </worldbody>
  <equality>
    <weld body1="a" body2="b"/>
    <weld body1="b" body2="c" solref="0.01 1"/>
    <weld body1="c" body2="a" solref="0.03 1"/>
  </equality>
  <contact>
    <pair geom1="ga" geom2="gb" condim="1"/>
    <pair geom1="ga" geom2="gc" condim="3"/>
    <pair geom1="gb" geom2="gc" condim="4"/>
    <pair geom1="gd" geom2="ga" condim="6"/>
  </contact>
</mujoco>
"""


def updated(folder: Path, edges: list[tuple[str, str | None]]) -> tuple[str, list[str]]:
    """The text and what was edited after edges of its JSON were renamed, or removed; a second update finds nothing."""
    original, there = folder / "three.xml", folder / "three.json"
    original.write_text(THREE)
    hx.convert(original, there)
    document = json.loads(there.read_text())
    for old, new in edges:
        number = next(number for number, edge in enumerate(document["edges"]) if edge["id"] == old)
        place = next(place for place, row in enumerate(document["layout"]) if row[1] == old)
        if new is None:
            del document["edges"][number], document["layout"][place]
        else:
            document["edges"][number] |= {"id": new, "notations": []}
            document["layout"][place][1] = new
    there.write_text(json.dumps(document))
    found = hx.update(original, there)
    assert [row.message for row in found.report if row.code.id == "HX118"] == []
    again = hx.update(original, there)
    assert ([str(edit) for edit in again.edits], list(again.report)) == ([], [])
    return original.read_text(), [str(edit).partition(" contact(")[0].partition(" loop(")[0] for edit in found.edits]


def test_a_contact_that_is_removed_leaves_those_behind_it_as_they_are(tmp_path: Path) -> None:
    text, edits = updated(tmp_path, [("pair#2", None)])
    assert edits == ["contact 'pair#2': removed"]
    assert text == THREE.replace('    <pair geom1="ga" geom2="gc" condim="3"/>\n', "")


def test_a_closure_that_is_named_leaves_the_one_behind_it_without_a_name(tmp_path: Path) -> None:
    text, edits = updated(tmp_path, [("weld", "grip")])
    assert edits == ["loop 'weld' name: 'weld' -> 'grip'"]
    assert text == THREE.replace('<weld body1="a"', '<weld name="grip" body1="a"')
