"""How long HyMeKo text is: letters without white space and comments, against URDF and MJCF as their authors wrote them, and
against the USD text that hymeko-x writes of the same URDF (without what it carries, and without the arrays of meshes).

python -m benchmarks.size
"""

from __future__ import annotations

import re
import statistics
import sys
from typing import TYPE_CHECKING

import hymeko_x as hx
from benchmarks.robots import robots
from benchmarks.yardstick import verdict
from hymeko_x import formats
from hymeko_x.backends.hymeko import write
from hymeko_x.diagnostics import Report
from hymeko_x.disk import open_source
from hymeko_x.frontends import mjcf, urdf
from hymeko_x.language.grammar import TOKENS
from hymeko_x.rewrite import Options

if TYPE_CHECKING:
    from pathlib import Path

BOUNDS = {"urdf": 0.35, "mjcf": 0.75}
"""HyMeKo against each format, median over the development files."""

USDA_BOUND = 0.15

_READERS = {"urdf": urdf.read, "mjcf": mjcf.read}
_XML_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
_INCLUDE = re.compile(r'<include\s+file="([^"]*)"')


def letters(text: str) -> int:
    """Characters that are no white space."""
    return len("".join(text.split()))


def ratio(robot: Path, form: str) -> float:
    """The letters of the robot's HyMeKo text for one letter of its source; included files count as well."""
    text = _printed(robot, form)
    plain = TOKENS.sub(lambda token: "" if token[0].startswith(("#", "//", "/*")) else token[0], text)
    return letters(plain) / _source_letters(robot)


def _printed(robot: Path, form: str) -> str:
    """The HyMeKo text of a robot, with the names of its files as its author wrote them."""
    return write(_READERS[form](open_source(str(robot)), Report()).mechanism, Options(), Report()).main.decode()


_MESH_ARRAY = re.compile(
    r"^[ \t]*(?:uniform )?\w+\[\] (?:points|normals|faceVertexCounts|faceVertexIndices|indices|primvars:\S+) = "
    r"(?:\[[^\]]*\]|None)(?: \([^)]*\))?",
    re.MULTILINE,
)


def usda_ratio(robot: Path) -> float:
    """The letters of a URDF's HyMeKo text for one letter of its USD text, in which no array of a mesh is counted."""
    stage = _MESH_ARRAY.sub("", hx.dumps(hx.load(robot).mechanism, "usd"))
    return _code(_printed(robot, "urdf"), "hymeko") / _code(stage, "usd")


def _code(text: str, form: str) -> int:
    return sum(map(letters, formats.loaded(formats.by_name(form).tokens)(text)))


def _source_letters(robot: Path) -> int:
    text = _XML_COMMENT.sub("", robot.read_text("utf-8", "replace"))
    included = (robot.parent / name for name in _INCLUDE.findall(text))
    return letters(text) + sum(_source_letters(path) for path in included if path.is_file())


def main() -> int:
    """Every development file of both formats; the bounds are on the medians."""
    good = True
    for form, bound in BOUNDS.items():
        ratios = []
        for robot in robots(form):
            ratios.append(ratio(robot, form))
            print(f"{ratios[-1]:6.3f}  {robot.name}")
        good &= verdict(f"letters of HyMeKo / {form}, median of {len(ratios)}", statistics.median(ratios), bound, at_least=False)
    ratios = []
    for robot in robots("urdf"):
        ratios.append(usda_ratio(robot))
        print(f"{ratios[-1]:6.3f}  {robot.name}")
    name = f"letters of HyMeKo / usda of urdf, median of {len(ratios)}"
    return 0 if verdict(name, statistics.median(ratios), USDA_BOUND, at_least=False) and good else 1


if __name__ == "__main__":
    sys.exit(main())
