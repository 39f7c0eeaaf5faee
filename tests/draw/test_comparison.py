"""The page about two robots: whole, right, and text where a robot has markup in its names."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from base64 import b64decode
from pathlib import Path
from xml.sax.saxutils import quoteattr

import html5lib
import pytest

from hymeko_x import api
from hymeko_x.cli import exits, main

ROOT = Path(__file__).parents[2]
ARM = """<robot name="arm">
  <material name="red"><color rgba="0.8 0.2 0.1 1"/></material>
  <link name="base"><visual><geometry><cylinder radius="0.1" length="0.2"/></geometry></visual></link>
  <link name="fore"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><origin xyz="0.3 0 0"/><geometry><box size="0.6 0.08 0.08"/></geometry><material name="red"/></visual></link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="fore"/><origin xyz="0 0 0.14"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"""
HOSTILE = (
    "<script>alert(1)</script>",
    '"><img src=x onerror=alert(1)>',
    "\u202egnorw\u2066",
    "`a` | @all [x](http://x.y) ``",
    "&lt;ל&#x41;",
)
FIXED = '<joint name={} type="fixed"><parent link="base"/><child link={}/><origin xyz="{} 0 0"/></joint>'
QUICK = ("--no-meshes", "--samples", "3", "--size", "160x120")
SVG = "{http://www.w3.org/2000/svg}"
XHTML = "{http://www.w3.org/1999/xhtml}"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "arm.urdf").write_text(ARM)
    (tmp_path / "arm.xml").write_text(api.dumps(api.loads(ARM, "urdf").mechanism, "mjcf"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def page_of(path: Path) -> tuple[str, html5lib.treebuilders.base.TreeBuilder]:
    """The text of a page and its tree; a fault of its markup is an error."""
    text = path.read_text("utf-8")
    return text, html5lib.HTMLParser(strict=True).parse(text)


def test_a_page_has_verdict_checks_pictures_losses_and_trees(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", "arm.urdf", "arm.xml", "-o", "page.html", *QUICK]) == exits.DONE
    assert capsys.readouterr().out.startswith("same as far as mjcf can say\n  mjcf cannot say velocity limits: 1 (joint 'turn')\n")
    text, tree = page_of(folder / "page.html")
    assert tree.find(f".//{XHTML}h1").text == "arm.urdf and arm.xml"
    assert [found.text for found in tree.iter(f"{XHTML}h2")] == ["Pictures", "Checks", "What B does not have as A has it", "Trees"]
    rows = ["".join(row.itertext()) for row in tree.iter(f"{XHTML}tr")]
    assert "okforward kinematics, position01e-09m" in rows
    lines = ["".join(item.itertext()) for item in tree.iter(f"{XHTML}li")]
    assert "mjcf cannot represent velocity limits: 1 (joint 'turn')" in lines
    assert "dropped: velocity limit of 1 joint, 1 rad/s: 'turn'" in lines
    assert len([*tree.iter(f"{SVG}svg")]) == 2
    pictures = [image.attrib["src"] for image in tree.iter(f"{XHTML}img")]
    assert [b64decode(data.removeprefix("data:image/png;base64,"))[:4] for data in pictures] == [b"\x89PNG"] * 3
    assert "the pictures are equal" in text
    assert not re.search(r"<script|https?://(?!www\.w3\.org/2000/svg)", text), "nothing runs, and nothing comes from elsewhere"


def test_a_planted_error_is_named_and_seen(folder: Path) -> None:
    (folder / "wrong.urdf").write_text(ARM.replace("0 0 0.14", "0.1 0 0.14"))
    assert main(["report", "arm.urdf", "wrong.urdf", "-o", "page.html", *QUICK]) == exits.DIFFERENT
    text, tree = page_of(folder / "page.html")
    rows = ["".join(row.itertext()) for row in tree.iter(f"{XHTML}tr")]
    wrong = "FAILforward kinematics, position0.11e-09mbody 'fore' in the zero pose[0 0 0.14] and [0.1 0 0.14]"
    assert wrong in rows
    found = re.search(r"difference: ([\d.]+) % of the pixels differ", text)
    assert found is not None
    assert float(found[1]) > 1.0


def test_markdown_has_its_pictures_beside_it(folder: Path) -> None:
    assert main(["report", "arm.urdf", "arm.xml", "-o", "page.md", *QUICK]) == exits.DONE
    text = (folder / "page.md").read_text("utf-8")
    assert text.startswith("### ⚠️ `arm.urdf` and `arm.xml`: same as far as mjcf can say\n")
    assert "| ![a](<page-a.png>) | ![b](<page-b.png>) | ![difference](<page-difference.png>) |" in text
    assert "- `dropped: velocity limit of 1 joint, 1 rad/s: 'turn'`\n" in text
    assert {path.name for path in folder.glob("page*")} == {"page.md", "page-a.png", "page-b.png", "page-difference.png"}


def test_hostile_names_are_text(folder: Path) -> None:
    tips = "".join(f"<link name={quoteattr(name)}/>{FIXED.format(quoteattr(name), quoteattr(name), 0.1)}" for name in HOSTILE)
    Path("a.urdf").write_text(ARM.replace("</robot>", f"{tips}</robot>"), "utf-8")
    Path("b.urdf").write_text(ARM.replace("</robot>", f"{tips.replace('0.1 0 0', '0.2 0 0')}</robot>"), "utf-8")
    for suffix in ("html", "md"):
        assert main(["report", "a.urdf", "b.urdf", "-o", f"page.{suffix}", *QUICK]) == exits.DIFFERENT
    text, tree = page_of(folder / "page.html")
    assert not [*tree.iter(f"{XHTML}script")]
    assert all(image.attrib["src"].startswith("data:image/png;base64,") for image in tree.iter(f"{XHTML}img"))
    read = "".join(tree.itertext())
    for name in HOSTILE:
        assert name.replace("\u202e", r"\u202e").replace("\u2066", r"\u2066") in read, "the whole name can be read"
    page = (folder / "page.md").read_text("utf-8")
    assert not re.search("[\u200b-\u200f\u2028-\u202e\u2066-\u2069]", text + page)
    for line in page.splitlines():
        outside = re.sub(r"(?<!`)(`+)(?!`).*?(?<!`)\1(?!`)", "", line)
        assert not re.search(r"<script|<img|@|http|onerror|gnorw", outside), line


def test_a_machine_that_cannot_draw_says_so_in_place_of_the_pictures(folder: Path) -> None:
    environment = {**os.environ, "MUJOCO_GL": "disable", "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "hymeko_x", "report", "arm.urdf", "arm.xml", *QUICK]
    for suffix in ("html", "md"):
        done = subprocess.run([*command, "-o", f"page.{suffix}"], cwd=folder, env=environment, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")
        text = (folder / f"page.{suffix}").read_text("utf-8")
        assert "There are no pictures" in text
        assert "HX502: MuJoCo cannot draw through disable on this machine" in text
    assert not [*page_of(folder / "page.html")[1].iter(f"{XHTML}img")]


def test_what_makes_no_page_is_a_usage_error(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for words, reason in (
        (("arm.urdf", "arm.xml", "-o", "page.pdf"), "the suffix of the output is one of .html, .md, not '.pdf'"),
        (("-", "arm.xml", "-o", "page.html"), "the robots are files: the formats' own engines read them as well"),
    ):
        assert main(["report", *words]) == exits.USAGE
        assert reason in capsys.readouterr().err
