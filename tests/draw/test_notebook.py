"""A robot in a notebook: a picture and the tree, or the tree alone; names are text."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from base64 import b64decode
from pathlib import Path

import html5lib

from hymeko_x import api, codes
from hymeko_x.diagnostics import refuse
from hymeko_x.draw import notebook
from hymeko_x.robot import Robot

NAME = "<script>alert('a')</script>\"\u202e"
ARM = """<robot name="NAME"><link name="base"><visual><geometry><box size="1 1 1"/></geometry></visual></link></robot>"""


def images(html: str) -> list[tuple[str, str]]:
    """The words and the addresses of the images of a piece of a page, which is whole."""
    tree = html5lib.HTMLParser(strict=True).parseFragment(html)
    found = [*tree.iter("{http://www.w3.org/1999/xhtml}img")]
    assert {node.tag.rpartition("}")[2] for node in tree.iter() if isinstance(node.tag, str)} <= {"DOCUMENT_FRAGMENT", "div", "img"}
    return [(image.attrib["alt"], image.attrib["src"]) for image in found]


def robot() -> Robot:
    return Robot(api.loads(ARM.replace("NAME", NAME.replace("<", "&lt;").replace('"', "&quot;")), "urdf").mechanism)


def test_a_notebook_shows_picture_and_tree() -> None:
    *pictures, tree = images(robot()._repr_html_())
    seen = NAME.replace("\u202e", r"\u202e")
    assert [words for words, _ in pictures] in ([seen], [])  # no picture where this machine cannot draw
    assert all(b64decode(data.removeprefix("data:image/png;base64,")).startswith(b"\x89PNG") for _, data in pictures)
    assert tree[0] == f"tree of {seen}"
    svg = b64decode(tree[1].removeprefix("data:image/svg+xml;base64,")).decode()
    assert "<script" not in svg
    assert ">base<" in svg


def test_the_tree_is_shown_where_nothing_can_be_drawn(monkeypatch) -> None:  # type: ignore[no-untyped-def]
    def cannot(*_: object) -> None:
        raise refuse(codes.CANNOT_DRAW, "no way")

    monkeypatch.setattr(notebook, "open_studio", cannot)
    ((words, data),) = images(robot()._repr_html_())
    assert words.startswith("tree of ")
    assert data.startswith("data:image/svg+xml;base64,")


def test_a_robot_has_its_tree_with_the_core_alone(tmp_path: Path) -> None:
    program = """
import sys
from importlib.abc import MetaPathFinder
class OnlyTheCore(MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ("numpy", "mujoco", "PIL", "trimesh", "scipy", "viser"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
sys.meta_path.insert(0, OnlyTheCore())
import hymeko_x
print(hymeko_x.load("arm.urdf")._repr_html_())
"""
    (tmp_path / "arm.urdf").write_text(ARM.replace("NAME", "arm"))
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])}
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert re.findall("data:image/[a-z+]+", done.stdout) == ["data:image/svg+xml"]
