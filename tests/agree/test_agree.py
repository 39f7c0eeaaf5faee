"""`hymeko-x agree`: files that are one robot are compared, and each planted fault is found at its line."""

from __future__ import annotations

import json
import os
import re
import subprocess
import time
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.cli import exits, main

ARM = """<robot name="arm">
  <link name="base">
    <inertial><origin xyz="0 0 0.05"/><mass value="2.5"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.012"/></inertial>
  </link>
  <link name="upper">
    <inertial><origin xyz="0.1 0 0"/><mass value="1.25"/><inertia ixx="0.002" ixy="0" ixz="0" iyy="0.004" iyz="0" izz="0.004"/></inertial>
    <collision><origin xyz="0.1 0 0"/><geometry><box size="0.2 0.05 0.05"/></geometry></collision>
  </link>
  <link name="fore">
    <inertial><origin xyz="0.08 0 0"/><mass value="0.75"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.002"/></inertial>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/>
    <child link="upper"/>
    <origin xyz="0 0 0.1"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="1.25" effort="30" velocity="2"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/>
    <child link="fore"/>
    <origin xyz="0.2 0 0"/>
    <axis xyz="0 0 1"/>
    <limit lower="-2" upper="2.5" effort="12" velocity="3"/>
  </joint>
</robot>
"""

CONFIG = '[[robot]]\nname = "arm"\nfiles = ["arm.urdf", "{other}"]\n'


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "arm.urdf").write_text(ARM)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def pair(other: str) -> Path:
    """The arm in another file, and the configuration that names both."""
    path = Path(other)
    hx.convert("arm.urdf", path, base="fixed") if path.suffix != ".urdf" else path.write_text(ARM)
    Path("hymeko.toml").write_text(CONFIG.format(other=other))
    return path


def agree(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str]:
    code = main(["agree", *words])
    return code, capsys.readouterr().out


def disagreements(capsys: pytest.CaptureFixture[str], *words: str) -> list[dict[str, object]]:
    code, out = agree(capsys, "--format", "json", *words)
    found = [one for robot in json.loads(out)["robots"] for one in robot["disagreements"]]
    assert code == (exits.DIFFERENT if any(one["allowed"] is None for one in found) else exits.DONE)
    return found


# ---- 25 planted faults -----------------------------------------------------------------------------------------------------

FAULTS = {  # by format: what is planted, as a pattern and its replacement
    "twin.urdf": {
        "1 mm": (r'xyz="0.2 0 0"', 'xyz="0.201 0 0"'),
        "1 g": (r'mass value="0.75"', 'mass value="0.751"'),
        "sign": (r'axis xyz="0 0 1"', 'axis xyz="0 0 -1"'),
        "limit": (r'upper="2.5"', 'upper="2.4"'),
        "name": (r"elbow", "elbo"),
    },
    "arm.xml": {
        "1 mm": (r'pos="0.2 0 0"', 'pos="0.201 0 0"'),
        "1 g": (r'mass="0.75"', 'mass="0.751"'),
        "sign": (r'name="elbow"( axis="[^"]*")?', 'name="elbow" axis="0 0 -1"'),
        "limit": (r'range="-2 2.5"', 'range="-2 2.4"'),
        "name": (r"elbow", "elbo"),
    },
    "arm.hymeko": {
        "1 mm": (r"\[0\.2( 0 0)?\]", "[0.201 0 0]"),
        "1 g": (r"mass 0.75", "mass 0.751"),
        "sign": (r"(@elbow[^\n]*\{)", r"\1 axis=-Z"),
        "limit": (r"limit \[-2 2.5\]", "limit [-2 2.4]"),
        "name": (r"elbow", "elbo"),
    },
    "arm.sdf": {
        "1 mm": (r"(<joint name=.elbow.*?<pose[^>]*>|<pose relative_to=.upper.>)0\.2 ", r"\g<1>0.201 "),
        "1 g": (r"<mass>0.75</mass>", "<mass>0.751</mass>"),
        "sign": (r"<xyz>0 0 1</xyz>", "<xyz>0 0 -1</xyz>"),
        "limit": (r"<upper>2.5</upper>", "<upper>2.4</upper>"),
        "name": (r"elbow", "elbo"),
    },
    "arm.usda": {
        "1 mm": (r"localPos0 = \(0\.2, ", "localPos0 = (0.201, "),
        "1 g": (r"physics:mass = 0\.75\b", "physics:mass = 0.751"),
        "sign": (
            r'(Joint "elbow".*?physics:localRot)0 = \([^)]*\)(.*?physics:localRot)1 = \([^)]*\)',
            r"\g<1>0 = (0, 1, 0, 0)\g<2>1 = (0, 1, 0, 0)",
        ),
        "limit": (r"upperLimit = 143\.2\d*", "upperLimit = 137.5"),
        "name": (r"elbow", "elbo"),
    },
}
SEEN_AS = {
    "1 mm": ("forward kinematics, position", "fore"),
    "1 g": ("mass", "fore"),
    "sign": ("forward kinematics, rotation", "fore"),
    "limit": ("position limits", "elbow"),
    "name": ("joints", "elbow"),
}
CASES = [(file, fault) for file, faults in FAULTS.items() for fault in faults]


@pytest.mark.parametrize(("file", "fault"), CASES, ids=lambda word: str(word))
def test_a_planted_fault_is_found_with_file_and_line(file: str, fault: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    if file.endswith(".sdf"):
        pytest.importorskip("pydrake")
    path = pair(file)
    assert disagreements(capsys) == [], "the unchanged robot differs"
    before = path.read_text()
    path.write_text(re.sub(*FAULTS[file][fault], before, flags=re.DOTALL))
    lines = [
        number for number, (old, new) in enumerate(zip(before.splitlines(), path.read_text().splitlines(), strict=True), 1) if old != new
    ]
    assert lines, "nothing was planted"
    found = disagreements(capsys)
    quantity, name = SEEN_AS[fault]
    hits = [one for one in found if one["quantity"] == quantity]
    assert len(hits) == 1, found
    (first, second) = hits[0]["places"]
    assert first["file"] == "arm.urdf"
    assert second["file"] == file
    assert re.search(rf"name=.({name}|elbow)\b", ARM.splitlines()[first["line"] - 1])
    assert re.search(f"{name}|elbo", path.read_text().splitlines()[second["line"] - 1])
    assert min(abs(second["line"] - line) for line in lines) <= (20 if file.endswith(".usda") else 8), (second, lines)


@pytest.mark.unread("HX040")
def test_a_file_that_its_engine_refuses_has_the_line_of_what_the_engine_names(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("pydrake")
    path = pair("arm.sdf")
    path.write_text(path.read_text().replace('<joint name="elbow"', '<joint name="elbo"'))
    code, out = agree(capsys)
    assert code == exits.DIFFERENT
    place = re.search(r"arm\.urdf:(\d+) and arm\.sdf:(\d+): libsdformat refuses the file: .* name\[elbow\] .* link with name\[fore\]", out)
    assert place, out
    assert ARM.splitlines()[int(place[1]) - 1].strip() == '<joint name="elbow" type="revolute">'
    assert path.read_text().splitlines()[int(place[2]) - 1].strip() == '<link name="fore">'


# ---- what is known -----------------------------------------------------------------------------------------------------------


def plant(path: Path) -> None:
    path.write_text(path.read_text().replace('mass="0.75"', 'mass="0.751"').replace('range="-2 2.5"', 'range="-2 2.4"'))


def test_a_known_difference_has_a_reason_and_an_end(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plant(pair("arm.xml"))
    allow = '[[robot.allow]]\nwhat = "mass"\nat = "fore"\nreason = "weighed anew"\nuntil = {until}\n'
    config = Path("hymeko.toml").read_text()
    Path("hymeko.toml").write_text(config + allow.format(until="2999-01-01"))
    found = disagreements(capsys)
    assert [(one["quantity"], one["allowed"]) for one in found] == [
        ("position limits", None),
        ("mass", {"reason": "weighed anew", "until": "2999-01-01"}),
    ]
    Path("hymeko.toml").write_text(config + allow.format(until="2020-01-01"))
    code, out = agree(capsys)
    assert code == exits.DIFFERENT
    assert "mass of body 'fore': 0.75 and 0.751 kg (0.001 kg off)" in out
    assert "note: the allowance of 'mass' ended on 2020-01-01: weighed anew" in out


def test_an_allowance_for_one_body_hides_no_other(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = pair("arm.xml")
    path.write_text(path.read_text().replace('mass="0.75"', 'mass="0.9"').replace('mass="1.25"', 'mass="1.251"'))
    Path("hymeko.toml").write_text(
        Path("hymeko.toml").read_text() + '[[robot.allow]]\nwhat = "mass"\nat = "fore"\nreason = "r"\nuntil = 2999-01-01\n'
    )
    assert [(one["element"], one["allowed"] is None) for one in disagreements(capsys)] == [("body 'upper'", True), ("body 'fore'", False)]


def test_tolerances_are_in_the_unit_of_their_quantity(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plant(pair("arm.xml"))
    Path("hymeko.toml").write_text('tolerances = {"mass" = 0.002, "position limits" = 0.05}\n' + Path("hymeko.toml").read_text())
    assert [one["quantity"] for one in disagreements(capsys)] == ["position limits"]
    Path("hymeko.toml").write_text(Path("hymeko.toml").read_text().replace("0.05", "0.2"))
    assert disagreements(capsys) == []


def test_an_allowance_that_nothing_needs_is_noted(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pair("arm.xml")
    Path("hymeko.toml").write_text(
        Path("hymeko.toml").read_text() + '[[robot.allow]]\nwhat = "mass"\nreason = "weighed"\nuntil = 2999-01-01\n'
    )
    assert agree(capsys) == (
        exits.DONE,
        "arm: 2 files agree\n"
        "  note: arm.xml: mjcf cannot say velocity limits: 2 (joint 'shoulder', joint 'elbow')\n"
        "  note: the allowance of 'mass' is not needed any more: weighed\n",
    )


def test_differences_of_a_baseline_are_known(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = pair("arm.xml")
    path.write_text(path.read_text().replace('mass="0.75"', 'mass="0.751"'))
    assert agree(capsys, "--report", "known.json")[0] == exits.DIFFERENT
    assert agree(capsys, "--baseline", "known.json")[0] == exits.DONE
    path.write_text(path.read_text().replace('range="-2 2.5"', 'range="-2 2.4"'))
    assert [one["quantity"] for one in disagreements(capsys, "--baseline", "known.json")] == ["position limits"]


@pytest.mark.parametrize(
    ("config", "message"),
    [
        ("", "Object missing required field `robot`"),
        ("[[robot]]\nname = 1\n", "Expected `str`, got `int` - at `$.robot[0].name`"),
        ('[[robot]]\nname = "a"\nfiles = ["arm.urdf"]\n', "robot 'a' has 1 file; two or more can be compared"),
        (
            '[[robot]]\nname = "a"\nfiles = ["a", "b"]\ntolerances = {mas = 1.0}\n',
            "there is no quantity 'mas'\n  hint: did you mean 'mass'?",
        ),
        ('[[robot]]\nname = "a"\nfiles = ["a", "b"]\nfilse = []\n', "Object contains unknown field `filse`"),
        ("robot = [", "hymeko.toml: error[HX304]"),
    ],
)
def test_a_wrong_configuration_is_one_diagnostic(config: str, message: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("hymeko.toml").write_text(config)
    assert main(["agree"]) == exits.FAILED
    printed = capsys.readouterr().err
    assert message in printed
    assert "HX304" in printed


# ---- what has changed --------------------------------------------------------------------------------------------------------


def git(*words: str) -> None:
    identity = {"GIT_AUTHOR_NAME": "a", "GIT_AUTHOR_EMAIL": "a@b", "GIT_COMMITTER_NAME": "a", "GIT_COMMITTER_EMAIL": "a@b"}
    subprocess.run(["git", *words], check=True, capture_output=True, env={**os.environ, **identity})


def test_only_robots_are_compared_whose_files_includes_or_meshes_have_changed(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pair("arm.xml")
    Path("part.xml").write_text('<mujocoinclude><body name="b"><geom size="1" mass="1"/></body></mujocoinclude>')
    for name in ("one", "two"):
        Path(f"{name}.xml").write_text('<mujoco><worldbody><include file="part.xml"/></worldbody></mujoco>')
    robots = "".join(
        f'[[robot]]\nname = "{name}"\nfiles = {files}\n'
        for name, files in (("arm", ["arm.urdf", "arm.xml"]), ("b", ["one.xml", "two.xml"]))
    )
    Path("hymeko.toml").write_text(robots.replace("'", '"'))
    git("init", "-q")
    git("add", ".")
    git("commit", "-qm", "first")
    assert agree(capsys, "--changed-since", "HEAD") == (exits.DONE, "")
    Path("part.xml").write_text(Path("part.xml").read_text().replace('mass="1"', 'mass="2"'))
    assert agree(capsys, "--changed-since", "HEAD") == (exits.DONE, "b: 2 files agree\n")
    assert main(["agree", "--changed-since", "nowhere"]) == exits.FAILED
    assert "git says: " in capsys.readouterr().err


# ---- for other programs ------------------------------------------------------------------------------------------------------


def test_reports_are_what_other_programs_read(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plant(pair("arm.xml"))
    words = [word for name in ("a.sarif", "a.xml", "a.md", "a.json") for word in ("--report", name)]
    code, annotations = agree(capsys, "--format", "github", *words)
    assert code == exits.DIFFERENT
    assert annotations.splitlines()[1].startswith("::error file=arm.xml,line=")
    results = json.loads(Path("a.sarif").read_text())["runs"][0]["results"]
    assert [one["ruleId"] for one in results] == ["position-limits", "mass"]
    assert results[1]["locations"][0]["physicalLocation"]["artifactLocation"] == {"uri": "arm.xml"}
    suite = ET.parse("a.xml").getroot()
    assert (suite.get("tests"), suite.get("failures")) == ("1", "1")
    assert "mass of body 'fore'" in (suite.findtext("testcase/failure") or "")
    assert "| arm | arm.urdf, arm.xml | 2 disagreements |" in Path("a.md").read_text()


def test_three_robots_take_seconds(folder: Path) -> None:
    for number in range(3):
        Path(f"r{number}.urdf").write_text(ARM)
        hx.convert(f"r{number}.urdf", f"r{number}.xml", base="fixed")
    Path("hymeko.toml").write_text("".join(f'[[robot]]\nname = "r{n}"\nfiles = ["r{n}.urdf", "r{n}.xml"]\n' for n in range(3)))
    start = time.monotonic()
    assert main(["agree", "-q"]) == exits.DONE
    assert time.monotonic() - start < 10


BY_JOINTS = """[[robot]]
name = "arm"
files = ["arm.urdf", "other.urdf"]
match = "joints"
rename = { "my_*" = "*" }
ignore = ["damping", "visual*"]
"""


def test_other_names_and_links_are_compared_by_joints(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    other = re.sub(r'joint name="', 'joint name="my_', ARM).replace('link name="fore"', 'link name="lower"').replace("base", "foot")
    other = other.replace('link="fore"', 'link="lower"').replace('effort="12"', 'effort="13"')
    (folder / "other.urdf").write_text(other.replace('<limit lower="-2"', '<dynamics damping="0.1"/><limit lower="-2"'))
    Path("hymeko.toml").write_text(BY_JOINTS)
    assert main(["agree"]) == exits.DIFFERENT
    line = next(n for n, text in enumerate(ARM.splitlines(), 1) if 'joint name="elbow"' in text)
    message = f"arm.urdf:{line} and other.urdf:{line}: effort limits of joint 'elbow': [-12 12] and [-13 13] N m or N (1 N m or N off)"
    assert capsys.readouterr().out.splitlines() == ["arm: 2 files differ: 1 disagreement", f"  {message}"]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('ignore = ["colour"]', "no quantity is called 'colour'"),
        ('rename = { "a" = "b" }', "joints are renamed with match"),
        ('match = "joints"\nrename = { "*" = "**" }', "may have one * each"),
    ],
)
def test_joints_in_the_configuration_are_checked(folder: Path, line: str, message: str, capsys: pytest.CaptureFixture[str]) -> None:
    Path("hymeko.toml").write_text(f'[[robot]]\nname = "arm"\nfiles = ["arm.urdf", "b.urdf"]\n{line}\n')
    assert main(["agree"]) == exits.FAILED
    assert message in capsys.readouterr().err
