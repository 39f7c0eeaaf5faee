"""What went wrong without a word, typed as a user types it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from struct import pack

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hymeko_x as hx
from hymeko_x import codes, formats
from hymeko_x.cli import exits, main
from hymeko_x.diagnostics import Refusal, Report, Severity, Stopped
from hymeko_x.ir.mechanism import Id
from hymeko_x.ir.parts import Body
from hymeko_x.source import NoFiles
from hymeko_x.validation import Profile, validate

LUMPED = """quarter_vehicle {
  spring { spring_constant = 50000.0 }
  damping { damping_const = 1000.0 }
  wheel { mass = 50.0 }
  road : motion {}
  @suspension { + road, - wheel, + damping, - spring }
}
"""
PENDULUM = """pendulum : robot {
  base {}
  rod { mass 1 shape { capsule 0.02 fromto [0 0 0 0 0 -1] } }
  @hinge { + base - rod axis=Y }
}
"""
GRAPH = "g : graph { a {} b {} @e { + a - b } }"


def hymeko_x(command: str, folder: Path, stdin: bytes = b"") -> tuple[int, str]:
    """The exit code of a command line of the shell, and everything that it prints."""
    program = f'hymeko-x() {{ {sys.executable} -m hymeko_x "$@"; }}\n{command}'
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])}
    run = subprocess.run(["bash", "-c", program], cwd=folder, input=stdin, capture_output=True, env=environment, check=False)
    return run.returncode, (run.stdout + run.stderr).decode()


# ---- check -----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", [GRAPH, LUMPED])
def test_check_passes_graphs_and_lumped_systems_that_are_in_order(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.hymeko"
    path.write_text(text)
    assert main(["check", str(path)]) == exits.DONE
    assert capsys.readouterr().out == "nothing is wrong\n"


@pytest.mark.unread("HX005", "HX010")
def test_check_fails_on_a_file_that_is_cut_off(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.urdf"
    path.write_text('<robot name="r"><link name="a"/><link name="b"')
    assert main(["check", str(path)]) == exits.FAIL_ON
    printed = capsys.readouterr()
    assert "error[HX010]: not well-formed" in printed.err
    assert "passed" not in printed.out


LINK = '<robot name="r"><link name="a">{}</link></robot>'
SHAPES = {role: f'<{role}><geometry><sphere radius="1"/></geometry></{role}>' for role in ("visual", "collision")}
INERTIAL = '<inertial><origin xyz="{}"/><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
WHOLE = {**SHAPES, "inertial": INERTIAL.format("0 0 0")}


def found(text: str, *profiles: Profile) -> list[str]:
    """The codes of what `check` finds, errors only."""
    report = Report()
    validate(hx.loads(text, "urdf").mechanism, NoFiles(), report, profiles)
    return [diagnostic.code.id for diagnostic in report if diagnostic.severity is Severity.ERROR]


@pytest.mark.parametrize(("missing", "code"), [("visual", "HX317"), ("collision", "HX318"), ("inertial", "HX314")])
def test_complete_demands_visual_collision_and_inertial_of_every_link(missing: str, code: str) -> None:
    assert found(LINK.format("".join(WHOLE.values())), Profile.COMPLETE) == []
    rest = LINK.format("".join(text for name, text in WHOLE.items() if name != missing))
    assert found(rest, Profile.COMPLETE) == [code]
    assert found(rest, Profile.KINEMATICS, Profile.SIMULATION, Profile.DISPLAY) == []


@pytest.mark.parametrize(("centre", "expected"), [("0 0 0", []), ("1 1 1", []), ("0 0 20", ["HX320"])])
def test_check_warns_of_a_centre_of_mass_far_outside_of_the_shapes(centre: str, expected: list[str]) -> None:
    report = Report()
    text = LINK.format("".join(SHAPES.values()) + INERTIAL.format(centre))
    validate(hx.loads(text, "urdf").mechanism, NoFiles(), report)
    assert [diagnostic.code.id for diagnostic in report] == expected


@pytest.mark.parametrize(("scale", "expected"), [("", ["HX319"]), ('scale="0.001 0.001 0.001"', [])])
def test_check_warns_of_a_mesh_in_millimetres(scale: str, expected: list[str], tmp_path: Path) -> None:
    corners = [(0.0, 0.0, 0.0, 300.0, 0.0, 0.0, 0.0, 80.0, 10.0)] * 1200
    faces = b"".join(pack("<12fH", 0.0, 0.0, 1.0, *corner, 0) for corner in corners)
    (tmp_path / "part.stl").write_bytes(bytes(80) + pack("<I", len(corners)) + faces)
    path = tmp_path / "r.urdf"
    path.write_text(LINK.format(f'<visual><geometry><mesh filename="part.stl" {scale}/></geometry></visual>'))
    robot, report = hx.load(path), Report()
    validate(robot.mechanism, robot.files, report)
    assert [diagnostic.code.id for diagnostic in report] == expected
    assert [diagnostic.message for diagnostic in report] == ["the mesh 'part.stl' of body 'a' is 300 m large"] * len(expected)


# ---- writing ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("target", [row.name for row in formats.FORMATS if row.backend and not row.is_exact])
def test_a_lumped_system_that_cannot_be_written_says_so(target: str) -> None:
    with pytest.raises(Stopped) as caught:
        hx.dumps(hx.loads(LUMPED, "hymeko"), target)
    assert str(caught.value) == (
        f"error[HX065]: 'quarter_vehicle' has no bodies, and {target} can represent nothing of it: "
        "1 spring, 1 damper, 1 mass, 1 port; port 'road' moves as an input gives it, and joints have no such motion\n"
        "  hint: hymeko represents graphs and lumped systems"
    )


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("convert a.hymeko a.urdf --layout layered", "--layout is for usd, usdc, usdz, and the output is urdf"),
        ("convert a.hymeko a.xml --nested", "--nested is for usd, usdc, usdz, and the output is mjcf"),
        ("convert a.hymeko a.usda --split", "--split is for xacro, and the output is usd"),
        ("convert a.hymeko a.urdf --arg a:=1", "--arg is for formats that take arguments, and a.hymeko is hymeko"),
    ],
)
def test_options_that_change_nothing_are_refused(words: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "a.hymeko").write_text(PENDULUM)
    assert hymeko_x(f"hymeko-x {words}", tmp_path) == (exits.USAGE, f"hymeko-x convert: {message}\n")
    assert [path.name for path in tmp_path.iterdir()] == ["a.hymeko"]


@pytest.mark.parametrize(
    ("base", "joint", "message"),
    [
        ("fixed", "<freejoint name='root'/>", "body 'palm' is not fixed: joint 'root' lets it float"),
        ("free", "", "body 'palm' does not float: joint 'palm' fixes it to the world"),
    ],
)
@pytest.mark.parametrize("target", ["xml", "urdf", "usda", "sdf"])
def test_a_base_that_is_not_what_is_asked_for_is_reported(
    base: str, joint: str, message: str, target: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = f"<mujoco><worldbody><body name='palm'>{joint}<geom size='.1'/></body></worldbody></mujoco>"
    (tmp_path / "a.xml").write_text(text)
    assert main(["convert", str(tmp_path / "a.xml"), str(tmp_path / f"b.{target}"), "--base", base]) == 0
    assert f"warning[HX101]: {message}\n" in capsys.readouterr().err


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="only Linux has a device that is always full")
@pytest.mark.parametrize("command", ["import a.hymeko > /dev/full", "import a.hymeko -o /dev/full", "info a.hymeko > /dev/full"])
def test_a_full_device_is_one_diagnostic(command: str, tmp_path: Path) -> None:
    (tmp_path / "a.hymeko").write_text(PENDULUM)
    code, printed = hymeko_x(f"hymeko-x {command}", tmp_path)
    assert code == exits.FAILED
    assert [line for line in printed.splitlines() if "error[HX002]" in line and "No space left on device" in line] == printed.splitlines()


# ---- reading ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("text", ["hello world", '{"links": []}', "name: arm\nlinks: 3\n", "a,b\n1,2\n", "", "#!/bin/sh\necho\n", "x = {}"])
def test_unknown_content_is_no_format_and_never_parsed_as_hymeko(text: str, tmp_path: Path) -> None:
    code, printed = hymeko_x("hymeko-x info -", tmp_path, text.encode())
    assert code == exits.FAILED
    assert printed.startswith("<stdin>: error[HX003]: neither suffix nor content of '<stdin>' belongs to a format\n")


@pytest.mark.parametrize(
    "text",
    [PENDULUM, LUMPED, GRAPH, f"// arm\n# of mine\n/* here */\n{GRAPH}", "[head]\ng {}", 'g import "x.hymeko"\n a {}', "`a b` : graph {}"],
)
def test_hymeko_text_needs_no_suffix(text: str) -> None:
    assert formats.of_input("<stdin>", text.encode()) is formats.HYMEKO


# ---- bodies ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("target", ["mjcf", "urdf", "sdf", "xacro"])
def test_a_pendulum_swings_because_its_centre_of_mass_is_that_of_its_shapes(target: str) -> None:
    """The centre of mass comes with the tensor: 1 kg at 0.5 m below the hinge, and m/12 l^2 about it for the middle of a thin rod."""
    rod = hx.loads(hx.dumps(hx.loads(PENDULUM, "hymeko"), target), target).mechanism.vertex(Id("body", "rod"), Body).inertial
    assert rod is not None
    assert rod.com == pytest.approx((0.0, 0.0, -0.5))
    assert rod.tensor is not None
    assert rod.tensor[0] == rod.tensor[1] == pytest.approx(1 / 12, rel=0.06)


@pytest.mark.unread("HX101")
def test_a_centre_of_mass_that_the_shapes_give_is_no_loss(tmp_path: Path) -> None:
    (tmp_path / "p.hymeko").write_text(PENDULUM)
    losses = hx.convert(tmp_path / "p.hymeko", tmp_path / "p.urdf").losses or ()
    assert [str(loss) for loss in losses if "inertial" in loss.field] == []


def test_a_centre_of_mass_that_is_given_stays() -> None:
    text = PENDULUM.replace("mass 1", "mass 1 com [0 0 -0.2]")
    rod = hx.loads(hx.dumps(hx.loads(text, "hymeko"), "urdf"), "urdf").mechanism.vertex(Id("body", "rod"), Body).inertial
    assert rod is not None
    assert rod.com == (0.0, 0.0, -0.2)


def test_the_verifier_sees_the_same_pendulum(tmp_path: Path) -> None:
    (tmp_path / "a.hymeko").write_text(PENDULUM)
    code, printed = hymeko_x("hymeko-x convert a.hymeko a.xml -q && hymeko-x verify a.hymeko a.xml", tmp_path)
    assert (code, printed.splitlines()[0]) == (exits.DONE, "same"), printed


# ---- graphs ----------------------------------------------------------------------------------------------------------------

NAMES = st.sampled_from("abcdef")
FIELDS = st.builds("{} {}".format, NAMES.map(lambda name: f"w{name}"), st.integers(0, 9))


def _vertices(within: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    """A vertex with fields, or with what is within it."""
    return st.builds(
        "v{} {{ {} }}".format, NAMES, st.lists(FIELDS | within, max_size=3, unique_by=lambda text: text.split()[0]).map(" ".join)
    )


EDGES = st.builds("@e{} {{ + va ~ vb }}".format, NAMES)
NESTED = st.recursive(_vertices(FIELDS) | EDGES, lambda within: _vertices(within | EDGES), max_leaves=8)


@settings(max_examples=40, deadline=None)
@given(parts=st.lists(NESTED, min_size=1, max_size=4, unique_by=lambda text: text.split()[0]))
def test_nested_graphs_come_back_from_their_text(parts: list[str]) -> None:
    missing = [f"v{name} {{}}" for name in "ab" if not any(part.startswith(f"v{name} ") for part in parts)]
    text = f"g : graph {{ {' '.join([*missing, *parts])} }}"
    graph = hx.loads(text, "hymeko").mechanism
    printed = hx.dumps(graph, "hymeko")
    again = hx.loads(printed, "hymeko").mechanism
    assert (again.graph, again.extras, hx.dumps(again, "hymeko")) == (graph.graph, graph.extras, printed)
    assert "".join(printed.split()).count("@e") == text.count("@e")


def test_nested_vertices_and_edges_of_a_graph_are_kept_without_a_warning() -> None:
    report = Report()
    graph = hx.loads("g : graph { a { x 1 b {} @e { + a } c { y 2 } } }", "hymeko", report=report).mechanism
    assert [str(diagnostic) for diagnostic in report] == []
    assert hx.dumps(graph, "hymeko") == "g : graph { a : datum { x 1 b @e { + a } c { y 2 } } }\n"


@pytest.mark.parametrize("text", ["b { y = a.z }", "b { y = -a }", "@e { [a.z] + a }", "@e { [a] + a }", "@e { + a.x }"])
def test_references_are_refused_where_they_lead_nowhere_and_never_become_text(text: str) -> None:
    with pytest.raises(Refusal) as caught:
        hx.loads(f"g : graph {{ a {{ x 1 }} {text} }}", "hymeko")
    assert caught.value.diagnostic.code in (codes.BAD_VALUE, codes.UNDEFINED_REFERENCE)
