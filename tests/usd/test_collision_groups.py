"""Collision groups: which bodies they keep apart, and when the groups themselves stay."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path
from typing import Any

import mujoco
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from msgspec.structs import replace
from pxr import Sdf, Usd, UsdPhysics

import hymeko_x as hx
from hymeko_x.compare.diff import diff
from hymeko_x.corpus import catalog
from hymeko_x.diagnostics import Report
from hymeko_x.frontends.usd import contacts
from hymeko_x.ir.mechanism import WORLD, Mechanism
from hymeko_x.ir.parts import Contact
from tests.conftest import RealRobots
from tests.usd.stages import again, opened, read_file, read_text, written
from tests.usd.test_real_stages import lost_properties

HEADER = '#usda 1.0\n(\ndefaultPrim = "r"\nmetersPerUnit = 1\nkilogramsPerUnit = 1\nupAxis = "Z"\n)\ndef Xform "r"\n{\n'
BODY = """def Xform "{name}" (apiSchemas = ["PhysicsRigidBodyAPI"])
{{
{inside}
}}
"""
COLLIDER = 'def Cube "{name}" (apiSchemas = ["PhysicsCollisionAPI"])\n{{\ndouble size = 1\n}}'
FLOOR = COLLIDER.format(name="floor")


def group(name: str, members: str, filtered: str = "", more: str = "") -> str:
    """A group with the prims of these names, which does not collide with the groups of those names."""
    lists = (("collection:colliders:includes", members), ("physics:filteredGroups", filtered))
    written = [f"rel {rel} = [{', '.join(f'</r/{target}>' for target in names.split())}]" for rel, names in lists if names]
    return f'def PhysicsCollisionGroup "{name}"\n{{\n' + "\n".join((*written, more)) + "\n}\n"


def stage(*groups: str, bodies: str = "abc", colliders: int = 1, more: str = FLOOR) -> str:
    inside = "\n".join(COLLIDER.format(name=f"box{number}" if number else "box") for number in range(colliders))
    return (
        HEADER + "".join(BODY.format(name=name, inside=inside) for name in bodies.split() if name) + more + "\n" + "".join(groups) + "}\n"
    )


def apart(mechanism: Mechanism) -> set[str]:
    """The pairs of bodies that do not touch, by their names; the world is w."""
    named = [["w" if arc.target == WORLD else arc.target.name for arc in arcs] for _, _, arcs in mechanism.edges(Contact)]
    return {"".join(sorted(pair)) for pair in named}


INVERTED = "bool physics:invertFilteredGroups = true"
MERGED = 'string physics:mergeGroup = "m"'


@pytest.mark.parametrize(
    ("groups", "pairs"),
    [
        ([group("g", "a b c", "g")], {"ab", "ac", "bc"}),
        ([group("g", "a"), group("h", "b c", "g")], {"ab", "ac"}),
        ([group("g", "a", "h"), group("h", "b/box floor")], {"ab", "aw"}),
        ([group("g", "a", "g", INVERTED)], {"ab", "ac", "aw"}),
        ([group("g", "a b", "h", INVERTED), group("h", "c")], {"ab", "aw", "bw"}),
        ([group("g", "a", "h", MERGED), group("k", "b", "", MERGED), group("h", "c")], {"ac", "bc"}),
        ([group("g", "a b c")], set()),
        ([group("g", "a b c", "nowhere")], set()),
        ([group("g", "", "g")], set()),
    ],
)
def test_bodies_are_apart_as_the_groups_say(groups: list[str], pairs: set[str], tmp_path: Path) -> None:
    source = stage(*groups, bodies="a b c")
    mechanism = read_text(source)
    assert apart(mechanism) == pairs
    result = opened(written(mechanism), tmp_path)
    assert lost_properties(opened(source.encode(), tmp_path, "source.usda"), result) == []
    assert not any(prim.HasRelationship("physics:filteredPairs") for prim in result.Traverse())
    assert groups_of(result) == groups_of(opened(source.encode(), tmp_path, "again.usda"))
    assert diff(mechanism, again(mechanism)) == ()


GROUPS = st.lists(
    st.tuples(
        st.sampled_from(["a", "b", "a c", "c d", ""]), st.sets(st.sampled_from("0123")), st.booleans(), st.sampled_from(["", "m", "n"])
    ),
    min_size=4,
    max_size=4,
)


@settings(max_examples=max(10, settings.default.max_examples // 3), deadline=None)
@given(GROUPS)
@example([("a", set(), False, "m"), ("a", set(), True, ""), ("b", {"0", "1", "3"}, True, "m"), ("a", set(), False, "")])
def test_groups_touch_as_the_table_of_openusd_says(drawn: list[tuple[str, set[str], bool, str]]) -> None:
    """Pairs of bodies that are both in some group; the table has no entries for other bodies.

    The table is that of the same groups with those of one merge name in a row: of others OpenUSD reads entries of the wrong pairs.
    """
    written = [
        group(
            f"g{number}",
            members,
            " ".join(f"g{other}" for other in sorted(others)),
            f"bool physics:invertFilteredGroups = {str(inverted).lower()}" + (f'\nstring physics:mergeGroup = "{merge}"' if merge else ""),
        )
        for number, (members, others, inverted, merge) in enumerate(drawn)
    ]
    in_a_row = [text for _, text in sorted(zip(drawn, written, strict=True), key=lambda pair: pair[0][3])]
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.ImportFromString(stage(*in_a_row, bodies="a b c d", more=""))
    table = UsdPhysics.CollisionGroup.ComputeCollisionGroupTable(Usd.Stage.Open(layer))
    groups = {body: [f"/r/g{number}" for number, (members, *_) in enumerate(drawn) if body in members] for body in "abcd"}
    known = [body for body in "abcd" if groups[body]]
    expected = {
        one + other
        for one, other in combinations(known, 2)
        if not all(table.IsCollisionEnabled(first, second) for first in groups[one] for second in groups[other])
    }
    found = apart(read_text(stage(*written, bodies="a b c d", more="")))
    assert {pair for pair in found if set(pair) <= set(known)} == expected


def groups_of(stage: Any) -> dict[str, list[str]]:
    """The groups and what they filter."""
    found = [UsdPhysics.CollisionGroup(prim) for prim in stage.Traverse() if prim.IsA(UsdPhysics.CollisionGroup)]
    return {str(item.GetPath()): list(map(str, item.GetFilteredGroupsRel().GetTargets())) for item in found}


def test_mujoco_excludes_what_the_groups_exclude(tmp_path: Path) -> None:
    source = tmp_path / "source.usda"
    source.write_text(stage(group("g", "a", "h"), group("h", "b floor"), bodies="a b c"))
    hx.convert(source, tmp_path / "out.xml")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out.xml"))
    bodies = [(int(signature) >> 16, int(signature) & 0xFFFF) for signature in model.exclude_signature]
    assert sorted("".join(sorted(model.body(body).name or "w" for body in pair)) for pair in bodies) == ["ab", "aworld"]


def test_a_pair_that_is_filtered_and_in_groups_is_one_exclusion(tmp_path: Path) -> None:
    pair = BODY.format(name="d", inside=COLLIDER.format(name="box") + "\nrel physics:filteredPairs = </r/a>")
    source = stage(group("g", "a d", "g"), bodies="a b", more=pair.replace('API"]', 'API", "PhysicsFilteredPairsAPI"]', 1))
    mechanism = read_text(source)
    assert [len(arcs) for _, _, arcs in mechanism.edges(Contact)] == [2]
    assert lost_properties(opened(source.encode(), tmp_path, "source.usda"), opened(written(mechanism), tmp_path)) == []
    assert diff(mechanism, again(mechanism)) == ()


def test_groups_that_contradict_the_exclusions_that_are_left_are_written_in_pairs(tmp_path: Path) -> None:
    mechanism = read_text(stage(group("g", "a b c", "g"), bodies="a b c", more=""))
    gone = next(key for key, _, _ in mechanism.edges(Contact))
    edited = mechanism.replace(without=[gone])
    result = opened(written(edited), tmp_path)
    assert groups_of(result) == {}
    assert apart(again(edited)) == apart(edited) == {"ac", "bc"}
    more = replace(mechanism, name="other")
    assert groups_of(opened(written(more), tmp_path, "other.usda")) == {"/r/g": ["/r/g"]}


def test_groups_of_some_colliders_of_a_body_are_kept_and_reported(tmp_path: Path) -> None:
    report = Report()
    source = stage(group("g", "a/box b", "g"), bodies="a b", colliders=2, more="")
    mechanism = read_text(source, report)
    assert apart(mechanism) == set()
    assert [item.message for item in report] == [
        "collision groups separate only some colliders of body 'a' and body 'b'; that is kept as written"
    ]
    assert groups_of(opened(written(mechanism), tmp_path)) == {"/r/g": ["/r/g"]}


@pytest.mark.full
@pytest.mark.unread("HX104")
def test_groups_of_thousands_of_bodies_are_kept_and_reported(tmp_path: Path) -> None:
    names = [f"b{number}" for number in range(2_000)]
    report = Report()
    mechanism = read_text(stage(group("g", " ".join(names), "g"), bodies=" ".join(names), more=""), report)
    assert apart(mechanism) == set()
    assert [item.message for item in report] == [
        f"collision groups with more than {contacts.MOST_PAIRS} pairs of bodies are kept as written; no other format represents them"
    ]
    assert groups_of(opened(written(mechanism), tmp_path)) == {"/r/g": ["/r/g"]}


def test_very_many_groups_are_kept_and_reported() -> None:
    report = Report()
    mechanism = read_text(stage(*(group(f"g{number}", "a b", "g0") for number in range(600)), bodies="a b", more=""), report)
    assert apart(mechanism) == set()
    assert [item.message for item in report] == ["collision groups with 600 groups are kept as written; no other format represents them"]


@pytest.mark.corpus
def test_a_real_stage_with_groups_keeps_them_and_says_what_they_exclude(real_robot: RealRobots, tmp_path: Path) -> None:
    package = next(package for package in catalog.load() if package.name == "newton")
    path = next(real_robot.package(package).rglob("assets/boxes_fourbar.usda"))
    mechanism = read_file(path)
    assert len(apart(mechanism)) == 6
    stage = opened(written(mechanism), tmp_path)
    assert groups_of(stage) == {"/boxes_fourbar/Collisions": ["/boxes_fourbar/Collisions"]}
    assert diff(mechanism, again(mechanism)) == ()
