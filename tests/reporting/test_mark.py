"""A file that was converted begins with a comment that names the program and the source; reading it back, it is not there."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx

ARM = """arm : robot {
  base { mass 1 inertia [0.1 0.1 0.1] }
  tip { mass 1 inertia [0.1 0.1 0.1] }
  @j : revolute { limit [-1 1] + base - tip }
}
"""
TEXTS = {
    "urdf": '<?xml version="1.0"?>\n<!-- {} -->\n<robot',
    "xml": "<!-- {} -->\n<mujoco",
    "sdf": '<?xml version="1.0"?>\n<!-- {} -->\n<sdf',
    "xacro": '<?xml version="1.0"?>\n<!-- {} -->\n<robot',
    "usda": "#usda 1.0\n# {}\n",
}


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    path = tmp_path / "arm.hymeko"
    path.write_text(ARM)
    return path


def first_comment(path: Path) -> str:
    return next(line for line in path.read_text().splitlines() if "made by" in line)


@pytest.mark.parametrize("suffix", TEXTS)
def test_a_file_begins_with_what_made_it(suffix: str, arm: Path) -> None:
    output = arm.with_suffix(f".{suffix}")
    hx.convert(arm, output, base="fixed")
    mark = f"made by hymeko-x {hx.__version__} from arm.hymeko"
    assert output.read_text().startswith(TEXTS[suffix].format(mark))


@pytest.mark.parametrize("suffix", TEXTS)
def test_comments_do_not_pile_up(suffix: str, arm: Path) -> None:
    there, back, again = arm.with_suffix(f".{suffix}"), arm.with_name("back.hymeko"), arm.with_name(f"again.{suffix}")
    hx.convert(arm, there, base="fixed")
    hx.convert(there, back)
    hx.convert(back, again)
    assert back.read_text().startswith(f"// made by hymeko-x {hx.__version__} from {there.name}\n")
    assert again.read_text().count("made by") == 1
    assert "from back.hymeko" in first_comment(again)


@pytest.mark.parametrize("suffix", TEXTS)
def test_update_and_diff_do_not_see_it(suffix: str, arm: Path) -> None:
    output, bare = arm.with_suffix(f".{suffix}"), arm.with_name(f"bare.{suffix}")
    hx.convert(arm, output)
    assert hx.update(arm, output, dry_run=True).edits == ()
    bare.write_text("".join(line for line in output.read_text().splitlines(keepends=True) if "made by" not in line))
    assert hx.load(output).mechanism == hx.load(bare).mechanism


def test_a_copy_within_one_format_is_the_source_to_the_byte(arm: Path) -> None:
    hx.convert(arm, arm.with_name("copy.hymeko"))
    assert arm.with_name("copy.hymeko").read_text() == ARM


def test_a_comment_of_the_author_stays(arm: Path) -> None:
    arm.write_text(f"// made by hand\n{ARM}")
    hx.convert(arm, arm.with_suffix(".urdf"))
    assert "<!-- made by hand -->" in arm.with_suffix(".urdf").read_text()


def test_a_name_that_no_comment_holds_is_left_out(tmp_path: Path) -> None:
    (tmp_path / "a--b.hymeko").write_text(ARM)
    hx.convert(tmp_path / "a--b.hymeko", tmp_path / "a.urdf")
    assert first_comment(tmp_path / "a.urdf") == f"<!-- made by hymeko-x {hx.__version__} -->"
