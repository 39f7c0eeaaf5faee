"""Robots in JSON: exact both ways, described by a schema, and refused with the path of the fault."""

from __future__ import annotations

import json
import random
from collections import Counter
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import HealthCheck, given, settings
from msgspec.structs import replace

import hymeko_x as hx
from hymeko_x import formats
from hymeko_x.backends.json import write
from hymeko_x.cli import exits, main
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.formats.json.document import PARTS
from hymeko_x.formats.json.schema import json_schema
from hymeko_x.frontends.json import read
from hymeko_x.ir import parts
from hymeko_x.ir.fields import identical
from hymeko_x.ir.graph import Hypergraph
from hymeko_x.ir.ids import KINDS
from hymeko_x.ir.mechanism import Id, Mechanism
from hymeko_x.rewrite.context import Options
from hymeko_x.source import Source
from hymeko_x.testing import mechanisms
from tests.json_form.documents import FORM, MEANING, SOUND, TEXTS, Broken, broken, path_of, text_of

ROBOTS = sorted((Path(__file__).parents[2] / "corpus").glob("*/*.hymeko"))
SCHEMA = jsonschema.Draft202012Validator(json_schema())
SOME = settings(max_examples=50, deadline=None, suppress_health_check=list(HealthCheck))


def text(mechanism: Mechanism) -> bytes:
    return write(mechanism, Options(), Report()).main


def read_text(data: bytes) -> Mechanism:
    report = Report()
    found = read(Source("robot.json", data), report).mechanism
    assert not report.diagnostics
    return found


def check_exact(mechanism: Mechanism) -> bytes:
    """Every bit of the graph and of the side tables that describe the robot comes back; the text is canonical."""
    data = text(mechanism)
    back = read_text(data)
    assert back.name == mechanism.name
    assert identical(tuple(back.graph.vertices.items()), tuple(mechanism.graph.vertices.items()))
    assert identical(tuple(back.graph.edges.items()), tuple(mechanism.graph.edges.items()))
    assert identical(tuple(back.extras.items()), tuple(in_order(mechanism, mechanism.extras)))
    assert {key: [*notation.items()] for key, notation in back.notations.items()} == {
        key: [*notation.items()] for key, notation in mechanism.notations.items() if notation
    }
    assert back.stereotypes == {key: tuple(found) for key, found in mechanism.stereotypes.items() if found}
    assert back.layout == mechanism.layout
    assert text(back) == data
    return data


def in_order(mechanism: Mechanism, table: Any) -> list[Any]:
    """The entries of a side table, those of the whole first, then in the order of the elements."""
    order = {key: number for number, key in enumerate((*mechanism.graph.vertices, *mechanism.graph.edges))}
    return sorted(((key, found) for key, found in table.items() if found), key=lambda item: order.get(item[0], -1))


@SOME
@given(mechanisms())
def test_what_is_written_reads_back_to_the_last_bit(mechanism: Mechanism) -> None:
    check_exact(mechanism)


@settings(max_examples=10, deadline=None, suppress_health_check=list(HealthCheck))
@given(mechanisms())
def test_the_schema_accepts_what_is_written(mechanism: Mechanism) -> None:
    SCHEMA.validate(json.loads(text(mechanism)))


@pytest.mark.parametrize("path", ROBOTS, ids=lambda path: path.stem)
def test_our_robots_are_exact_and_valid(path: Path) -> None:
    SCHEMA.validate(json.loads(check_exact(hx.load(path).mechanism)))


@pytest.mark.robots("urdf", "mjcf", "usd", "xacro", "sdf", every=40)
@pytest.mark.unread("HX040")
def test_real_robots_are_exact(robot: Path) -> None:
    check_exact(hx.load(robot, lenient=True).mechanism)


@pytest.mark.full
@pytest.mark.robots("urdf", "mjcf", "usd", "xacro", "sdf")
def test_the_schema_accepts_every_real_robot(robot: Path) -> None:
    SCHEMA.validate(json.loads(text(hx.load(robot, lenient=True).mechanism)))


def test_numbers_that_json_does_not_have_are_objects() -> None:
    key = Id("actuator", "a")
    values = (("a", float("inf")), ("b", (float("-inf"), -0.0, 5e-324, 0.1)), ("c", "inf"), ("d", float("nan")), ("number", "inf"))
    robot = Mechanism("r", Hypergraph({key: parts.Actuator("motor", values)}), notations={key: {"number": "inf"}})
    data = check_exact(robot)
    assert b'["a",{"number":"inf"}],["b",[{"number":"-inf"},-0.0,5e-324,0.1]],["c","inf"],["d",{"number":"nan"}]' in data
    SCHEMA.validate(json.loads(data))


def test_every_part_has_a_type_of_object() -> None:
    assert {*PARTS.values()} == {*KINDS}


# ---- the schema --------------------------------------------------------------------------------------------------------------


def test_the_schema_is_one_of_draft_2020_12_with_the_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["schema"]) == exits.DONE
    found = json.loads(capsys.readouterr().out)
    assert found["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert found["$id"] == "urn:hymeko-x:mechanism:1"
    jsonschema.Draft202012Validator.check_schema(found)
    assert found == SCHEMA.schema


# ---- broken documents --------------------------------------------------------------------------------------------------------


def refused(data: bytes) -> str:
    """The one diagnostic."""
    with pytest.raises(Refusal) as refusal:
        read_text(data)
    (diagnostic,) = refusal.value.diagnostics
    return str(diagnostic)


def test_a_mechanism_without_an_element_of_its_layout_reads_back() -> None:
    eye, base = Id("camera", "eye"), Id("body", "base")
    whole = replace(read_text(text_of(SOUND)), layout=(eye, base))
    assert read_text(text(whole.with_graph(whole.graph.replace(without=[eye])))).layout == (base,)


def test_the_document_is_sound() -> None:
    SCHEMA.validate(SOUND)
    assert [key.name for key in read_text(text_of(SOUND)).joints] == ["elbow"]


@pytest.mark.parametrize("change", FORM, ids=lambda change: f"{change.path}={str(change.value)[:20]}")
def test_a_document_of_another_form_is_refused_by_reader_and_schema(change: Broken) -> None:
    root = broken(change)
    first, *_ = refused(text_of(root)).splitlines()
    assert first.startswith(f"robot.json: error[HX066]: {path_of(change)}: ")
    assert not SCHEMA.is_valid(root)


@pytest.mark.parametrize(("code", "change"), MEANING, ids=lambda value: str(value))
def test_a_document_that_describes_no_mechanism_is_refused(code: str, change: Broken) -> None:
    message = refused(text_of(broken(change)))
    assert message.startswith(f"robot.json: error[{code}]: $.")
    assert path_of(change) in message


@pytest.mark.parametrize(("data", "part"), TEXTS)
def test_bytes_that_are_no_json_are_refused(data: bytes, part: str) -> None:
    message = refused(data)
    assert "error[HX013]" in message
    assert part in message


def test_a_document_that_is_nested_too_deep_is_refused() -> None:
    message = refused(b'{"hymeko-x": 1, "name": ' + b"[" * 200_000)
    assert "error[HX007]: the values are nested too deep" in message


@pytest.mark.unread  # generated or damaged input: any
def test_random_changes_cost_one_diagnostic_or_none() -> None:
    """Whatever a document holds, it is converted, or refused with a reason that is not a bug of ours."""
    chance = random.Random(0)
    outcomes = Counter(_outcome(chance) for _ in range(300))
    assert outcomes["HX901"] == 0
    assert outcomes["converted"] > 20
    assert {"HX040", "HX062", "HX066"} < {*outcomes}


def _outcome(chance: random.Random) -> str:
    """What happens to the sound document with one change or two: it is converted, or a code."""
    root = json.loads(text_of(SOUND))
    for _ in range(chance.choice((1, 1, 2))):
        change_somewhere(root, chance)
    try:
        robot = hx.loads(text_of(root), "json", lenient=True).mechanism
        for target in ("urdf", "mjcf", "hymeko"):
            hx.dumps(robot, target, lenient=True)
    except Refusal as refusal:
        return refusal.diagnostic.code.id
    return "converted"


def change_somewhere(root: Any, chance: random.Random) -> None:
    """Another value somewhere in the document."""
    places = []
    todo = [root]
    while todo:
        value = todo.pop()
        for key in value if isinstance(value, dict) else range(len(value)):
            places.append((value, key))
            if isinstance(value[key], dict | list):
                todo.append(value[key])
    value, key = chance.choice(places)
    values = (0.0, -1.0, 1e308, "base", "", "world", "joint", None, [], {}, ["body", "tip"], {"number": "nan"}, value[key])
    value[key] = chance.choice(values)


# ---- as a format -------------------------------------------------------------------------------------------------------------


def test_json_of_other_programs_is_no_robot(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for content in ('{"name": "left-pad", "version": "1"}', "[]", "{}", '{"a": {"hymeko-x": 1}}', ""):
        Path("package.json").write_text(content)
        assert main(["info", "package.json"]) == exits.FAILED
        assert "neither suffix nor content of 'package.json' belongs to a format" in capsys.readouterr().err


def test_a_robot_goes_through_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = str(next(path for path in ROBOTS if path.stem == "scara_robot"))
    assert main(["convert", path, "arm.json"]) == exits.DONE
    assert main(["diff", path, "arm.json"]) == exits.DONE
    assert main(["convert", "arm.json", "arm.urdf"]) == exits.DONE
    assert main(["verify", "arm.json", "arm.urdf"]) == exits.DONE
    assert main(["info", "arm.json"]) == exits.DONE
    assert "format       json" in capsys.readouterr().out


@pytest.mark.parametrize("name", ["robot.json", "robot", "<stdin>", "robot.txt"])
def test_a_robot_is_known_by_its_root_key(name: str) -> None:
    assert formats.of_input(name, text_of(SOUND)).name == "json"
    assert formats.of_input(name, b'\xef\xbb\xbf {\n "$schema": "s", "hymeko-x": 1').name == "json"
