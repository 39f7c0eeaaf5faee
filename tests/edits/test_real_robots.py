"""Edits of real robots come home one at a time: the robot is the edited one or a note says what is not, and few lines change."""

from __future__ import annotations

import itertools
import random
import re
from difflib import SequenceMatcher
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import pytest
from msgspec.structs import replace

from hymeko_x import disk, formats, pipeline
from hymeko_x.compare.diff import Tolerance, diff
from hymeko_x.compare.relevance import relevant
from hymeko_x.corpus.catalog import development_files
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.edits.text import EditedFiles, with_new_files
from hymeko_x.edits.unnamed import with_same_numbers
from hymeko_x.edits.updating import update
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.parts import Body
from hymeko_x.memory import remembering
from hymeko_x.residue.align import align
from hymeko_x.rewrite import Options
from hymeko_x.rewrite.inertia import LEAST
from hymeko_x.source import PackageFiles, Source
from tests.edits.kinds import APPLIED, KINDS, SHARING, VALUES
from tests.edits.test_copying import SUFFIXES
from tests.residue.edits import applied

if TYPE_CHECKING:
    from hymeko_x.compare.diff import Difference
    from hymeko_x.corpus.catalog import DevelopmentFile
    from hymeko_x.edits.updating import Updated
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.source import Package
    from tests.conftest import RealRobots

SINGLE = Tolerance(1e-9, 1e-6)
"""By how much numbers that a stage stores in single precision differ."""
NAMELESS = re.compile(r"world_body.*|.*#\d+")
"""Names that bodies of MJCF without one get, with their numbers."""
MORE = "more edits did not arrive"
"""How a note ends that lists some of many."""
GAINS = "follow from masses"
"""What a note says of gains that the conversion computes."""
LISTED = ("mesh", "material", "texture", "layer", "subset")
"""What a file may list without a use."""
SUFFIX = {**SUFFIXES, "sdf": ".sdf"}


class Converted(NamedTuple):
    """A robot, and its conversion into another format."""

    source: Source
    format: Format
    there: Format
    place: pipeline.OutputPlace
    package: Package

    def edited(self, text: str) -> Source:
        """The converted file with another text."""
        name = str(Path(self.source.name).with_name(f"there{SUFFIX[self.there.name]}"))
        return Source(name, text.encode(), PackageFiles(self.package, self.source.files))

    def converted_again(self, original: Source) -> Mechanism:
        """What the format has of an original."""
        mechanism = pipeline.read(original, self.format, Report())
        package = pipeline.write(mechanism, self.there, Options(), original.files, Report(), self.place)
        return pipeline.read_back(package, self.there, PackageFiles(package, original.files))

    def with_edits(self, found: Updated) -> Source:
        """The original with its edits."""
        data = found.changed.get(self.source.name, self.source.data)
        return with_new_files(replace(self.source, data=data, files=EditedFiles(self.source.files, found.changed)), found.beside)


def converted(robot: Path, target: str) -> Converted:
    """The robot in the target's format, or in another one where it is in that already."""
    source = disk.open_source(str(robot))
    format = formats.of_input(source.name, source.data)
    there = formats.by_name("usd" if target == format.name else target)
    place = pipeline.OutputPlace(str(robot.parent), "reference")
    mechanism = pipeline.read(source, format, Report())
    return Converted(source, format, there, place, pipeline.write(mechanism, there, Options(), source.files, Report(), place))


def unreported(image: Mechanism, edited: Mechanism, told: str) -> list[str]:
    """What the edited robot has otherwise than the original with its edits, and no note tells of.

    Assets that a file lists without a use do not count, nor texts of the whole: classes, which are grouped anew.
    """
    numbered = with_same_numbers(edited, image, {key for key, _ in image.vertices(Body) if NAMELESS.fullmatch(key.name)})
    aligned = align(image, numbered)[1]
    rest = relevant(diff(aligned, numbered, SINGLE), aligned, numbered, SINGLE)
    named = [edit for edit in rest if edit.element.kind not in LISTED and edit.element != ROOT]
    others = [edit for edit in named if not (_is_given_weight(edit) or _is_least_weight(edit) or _is_default_colour(edit))]
    return [str(edit) for edit in others if not _is_told(edit, told)]


def _is_told(edit: Difference, told: str) -> bool:
    """Whether a note names the element, or the value under another number of the element; of gains that follow from masses it names two."""
    is_gain = edit.element.kind == "actuator" and edit.field.startswith("parameters") and GAINS in told
    return is_gain or edit.element.name.partition("/")[0] in told or f"{edit.field}: {edit.before} -> {edit.after}" in told


def _is_given_weight(edit: Difference) -> bool:
    """Whether a weight is given to a body, of which the edited file has it as that of a shape."""
    return edit.field in ("mass", "density") or (edit.field == "inertial" and edit.after == "none")


def _is_least_weight(edit: Difference) -> bool:
    """Whether a body has the mass that an engine demands in one of the files alone: what is fixed to it has one there."""
    texts = (edit.before or "", edit.after or "")
    return edit.field == "inertial" and "none" in texts and any(f"mass {LEAST!r}," in text for text in texts)


def _is_default_colour(edit: Difference) -> bool:
    """Whether a shape without a colour has that of MuJoCo's shapes without one, as where a class has another one."""
    return (edit.field, edit.before, edit.after) == ("rgba", "[0.5 0.5 0.5 1]", "none")


def changed_lines(found: Updated) -> int:
    """How many lines of the original are other ones."""
    lines = [line for line in found.diff.splitlines() if line[:3] not in ("+++", "---")]
    return max(sum(line[:1] == sign for line in lines) for sign in "+-")


def needed_lines(robot: Converted, found: Updated, there: Mechanism, told: str) -> int:
    """How many lines of the original are other ones; of several places without which the edit does not arrive the longest counts.

    A mass needs two places in MJCF with ``inertiafromgeom="true"``, with which MuJoCo passes over every stated inertial.
    """
    name = robot.source.name
    if set(found.changed) != {name}:
        return changed_lines(found)
    old, new = (texts[name].decode().splitlines(keepends=True) for texts in (found.before, found.changed))
    places = [place for place in SequenceMatcher(None, old, new, autojunk=False).get_opcodes() if place[0] != "equal"]
    if len(places) < 2:
        return changed_lines(found)
    needed, spare = [0], 0
    for _, start, end, after, until in places:
        text = "".join([*new[:after], *old[start:end], *new[until:]]).encode()
        lines = max(end - start, until - after)
        if _arrives(robot, robot.with_edits(replace(found, changed={name: text})), there, told):
            spare += lines
        else:
            needed.append(lines)
    return max(needed) + spare


def _arrives(robot: Converted, original: Source, there: Mechanism, told: str) -> bool:
    """Whether the original is converted to what was edited."""
    try:
        return unreported(robot.converted_again(original), there, told) == []
    except Refusal:
        return False


def judged(robot: Converted, what: str, edited: Source) -> int | None:
    """How many lines an edit changes in the original; None where an element is printed anew, or a reader refuses the edit.

    The original is then converted to what was edited, as far as no note says otherwise, and there is nothing more to update.
    """
    report = Report()
    try:
        there = pipeline.read(edited, robot.there, Report())
        found = update(robot.source, robot.format, edited, robot.there, Options(), report)
    except Refusal:
        return None
    told = "\n".join(diagnostic.message for diagnostic in report if diagnostic.code.id == "HX118")
    assert found.edits or told, what
    if MORE in told:  # what an engine computes from all others, such as masses that it scales to a sum
        return None
    after = robot.with_edits(found)
    assert unreported(robot.converted_again(after), there, told) == [], what
    again = update(after, robot.format, edited, robot.there, Options(), Report())
    assert [str(edit) for edit in again.edits] == [], what
    return None if any(diagnostic.code.id == "HX108" for diagnostic in report) else needed_lines(robot, found, there, told)


@remembering()
def judge(path: Path, target: str, number: int) -> None:
    """So many edits, each by itself; half of those of one value change one line at most, or one at each place that they need."""
    robot = converted(path, target)
    target = robot.there.name
    chance, few = random.Random(path.name), list[int]()
    for kind in itertools.islice(itertools.cycle(sorted(KINDS[target])), number):
        value, place = round(chance.uniform(0.001, 2.0), 4), chance.randrange(1000)
        text, (what,) = APPLIED.get(target, applied)(robot.package.main.decode(), [partial(KINDS[target][kind], value=value, place=place)])
        lines = None if what == "nothing" else judged(robot, f"{kind}: {what}", robot.edited(text))
        if lines is not None and kind in VALUES and target not in SHARING:
            few.append(lines)
    assert sorted(few)[len(few) // 2 :][:1] in ([], [0], [1])


FEW = {
    "example_robot_data/double_pendulum_continuous.urdf": ("mjcf", "sdf"),
    "pybullet/vision60.urdf": ("usd",),
    "dm_control/arm.xml": ("urdf", "usd"),
    "mani_skill/cartpole.xml": ("sdf",),
}
"""Robots of few meshes, and formats that they are converted to."""
PAIRS = [
    pytest.param(file, target, id=f"{file.id}-{target}")
    for format in ("urdf", "mjcf")
    for file in development_files(format)
    for target in FEW.get(file.id, ())
]


@pytest.mark.corpus
@pytest.mark.parametrize(("file", "target"), PAIRS)
def test_edits_of_few_robots_come_home(file: DevelopmentFile, target: str, real_robot: RealRobots) -> None:
    judge(real_robot(file), target, 5)


@pytest.mark.full
@pytest.mark.robots("urdf", "mjcf")
@pytest.mark.parametrize("target", KINDS)
def test_each_kind_of_edit_of_every_robot_comes_home(robot: Path, target: str) -> None:
    judge(robot, target, len(KINDS[target]))


@pytest.mark.full
@pytest.mark.hours
@pytest.mark.robots("urdf", "mjcf")
@pytest.mark.parametrize("target", KINDS)
def test_twenty_edits_of_every_robot_come_home(robot: Path, target: str) -> None:
    judge(robot, target, 20)
