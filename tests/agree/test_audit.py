"""docs/audit.md: robots of the catalogue from different hands, and the summary that its tables are."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from hymeko_x.agree import config
from hymeko_x.cli import exits, main
from hymeko_x.corpus import catalog
from hymeko_x.corpus.names import catalogued

ROOT = Path(__file__).parents[2]
AUDIT = ROOT / "corpus" / "audit.toml"


def test_every_file_of_the_audit_is_in_the_catalogue_and_on_the_page() -> None:
    names = {f"{package.name}/{name}" for package in catalog.load() for name in catalogued(package)}
    robots = config.load(str(AUDIT)).robot
    files = [file for robot in robots for file in robot.files]
    assert len(robots) >= 18
    assert set(files) <= names
    page = (ROOT / "docs" / "audit.md").read_text("utf-8")
    assert [file for file in files if f"`{file}`" not in page] == []
    assert f"{len(robots)} robots" in page
    assert f"{sum(len(robot.files) - 1 for robot in robots)} pairs of files" in page


@pytest.mark.full
@pytest.mark.corpus
def test_the_tables_of_the_page_are_what_the_command_prints(tmp_path: Path) -> None:
    page = tmp_path / "audit.md"
    written = (ROOT / "docs" / "audit.md").read_text("utf-8")
    page.write_text(re.sub(r"(### Franka Panda).*?(?=### Unitree)", "", written, flags=re.DOTALL), "utf-8")
    main(["corpus", "fetch"])
    assert main(["agree", str(AUDIT), "-q", "--summary", "--page", str(page)]) == exits.DIFFERENT
    assert page.read_text("utf-8") == written


LINK = '<link name="{}"><inertial><mass value="{}"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
ROBOT = (
    f'<robot name="r">{LINK.format("a", "{}")}{LINK.format("b", "{}")}{LINK.format("c", "{}")}'
    + "".join(f'<joint name="{name}" type="fixed"><parent link="a"/><child link="{name}"/></joint>' for name in "bc")
    + "</robot>"
)


def test_a_summary_has_the_largest_difference_of_each_quantity(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("one.urdf").write_text(ROBOT.format(1, 2, 3))
    Path("two.urdf").write_text(ROBOT.format(1.5, 2.25, 5))
    Path("hymeko.toml").write_text('[[robot]]\nname = "r|s"\nfiles = ["one.urdf", "two.urdf"]\n')
    Path("page.md").write_text("Before\n\n<!-- tables: written by `hymeko-x agree` -->\n<!-- end of tables -->\n\nbehind\n")
    assert main(["agree", "--summary", "--page", "page.md"]) == exits.DIFFERENT
    assert capsys.readouterr().out.splitlines() == [
        "r|s: 2 files differ: 3 disagreements",
        "  one.urdf:1 and two.urdf:1: mass of body 'c': 3 and 5 kg (2 kg off) (2 more)",
    ]
    page = Path("page.md").read_text()
    assert page.startswith("Before")
    assert page.endswith("behind\n")
    assert "### r\\|s" in page
    assert "| mass | 3 | body 'c': 3 and 5 kg (2 kg off) | 1 and 1 |" in page
    assert main(["agree", "--page", "one.urdf"]) == exits.USAGE
    assert "has no block" in capsys.readouterr().err
