"""Real robots: the expansion is that of the library, and what is written as URDF is the expansion."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path

import pytest
import xacro
from lxml import etree
from msgspec.structs import replace
from xacro import substitution_args

from hymeko_x import disk, formats, pipeline
from hymeko_x.backends import urdf
from hymeko_x.compare.diff import diff
from hymeko_x.corpus import catalog
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.frontends import urdf as urdf_in
from hymeko_x.frontends.xacro import read
from hymeko_x.frontends.xacro.expand import expand
from hymeko_x.rewrite import Options
from hymeko_x.xml.tree import read_numbers
from tests.conftest import RealRobots

RENAMED = {"abb_irb140": "abb_irb140_description", "ridgeback_description": "clearpath_ridgeback_description"}
"""Folders of packages of rtb_data that are not called after their package; those of KUKA lack its suffix `_support`."""

ZERO = (0.0, 0.0, 0.0)
DEFAULTS = {"xyz": ZERO, "rpy": ZERO, "scale": (1.0, 1.0, 1.0), "multiplier": (1.0,), "offset": (0.0,)}

INCOMPLETE = {
    "sick_lms1xx_mount.urdf.xacro": "the package 'lms1xx' was not found",
    "sick_s300_mount.urdf.xacro": "the package 'lms1xx' was not found",
    "kr210l150.xacro": "xacro: name 'deg' is not defined when evaluating expression '-185*deg'",
}
"""Files of rtb_data that no package path makes complete, and why."""


class Library:
    """xacro itself with a correct package path: the folders of one corpus package by their names, without any rule of ours."""

    def __init__(self, package: Path) -> None:
        self._folders = {folder.name: folder for folder in sorted(package.rglob("*")) if folder.is_dir()}

    def find(self, name: str) -> str:
        return str(self._folders[RENAMED.get(name, name if name in self._folders else name.removesuffix("_support"))])

    def expand(self, path: Path) -> bytes:
        with pytest.MonkeyPatch.context() as patch, contextlib.redirect_stderr(io.StringIO()):
            patch.setattr(substitution_args, "_eval_find", self.find)
            text: str = xacro.process_file(str(path)).toprettyxml(indent="  ")
        return text.encode()


def canonical(text: bytes) -> object:
    """The elements in their order with their attributes in none; comments too, except those before the root (xacro's banner)."""

    def of(element: etree._Element) -> object:
        name = element.tag if isinstance(element.tag, str) else "comment"
        return name, sorted(element.items()), " ".join((element.text or "").split()), [of(child) for child in element]

    return of(etree.fromstring(text))


def members(text: bytes) -> list[object]:
    """The top-level elements in their order; in each, the elements by their names and then in their order.

    Numbers are numbers, and defaults may be written or not.
    """

    def value(text: str) -> object:
        return read_numbers(text) or " ".join(text.split())

    def of(element: etree._Element) -> tuple[object, ...]:
        inside = (of(child) for child in sorted(element.iterchildren("*"), key=lambda child: str(child.tag)))
        written = sorted((name, value(text)) for name, text in element.items() if value(text) != DEFAULTS.get(name))
        return element.tag, written, value(element.text or ""), [child for child in inside if child != ("origin", [], "", [])]

    root = etree.fromstring(text)
    return [sorted(root.items()), *(of(element) for element in root.iterchildren("*"))]


@pytest.mark.robots("xacro", every=3)
@pytest.mark.unread("HX052")
def test_a_real_robot_expands_as_xacro_itself_does(robot: Path, corpus_root: Path) -> None:
    library = Library(corpus_root / "corpus" / robot.relative_to(corpus_root / "corpus").parts[0])
    assert canonical(expand(disk.open_source(str(robot)), Report()).text) == canonical(library.expand(robot))


@pytest.mark.robots("xacro", every=3)
@pytest.mark.unread("HX052")
def test_the_urdf_of_a_real_robot_is_its_expansion(robot: Path) -> None:
    """Element for element, as far as URDF has a meaning: the URDF backend has one order for what is in a link or joint."""
    source = disk.open_source(str(robot))
    mechanism = read(source, Report()).mechanism
    assert diff(mechanism, urdf_in.read(replace(source, data=expand(source, Report()).text), Report()).mechanism) == ()
    assert members(urdf.write(mechanism, Options(), Report()).main) == members(expand(source, Report()).text)


@pytest.mark.robots("xacro", every=3)
@pytest.mark.unread("HX052", "HX103", "HX201")
def test_a_real_robot_converts_to_hymeko_urdf_and_mjcf(robot: Path) -> None:
    source = disk.open_source(str(robot))
    mechanism = read(source, Report()).mechanism
    text = pipeline.convert(mechanism, formats.by_name("hymeko"), Options(), source.files, Report())
    assert text.losses == ()
    assert pipeline.convert(mechanism, formats.by_name("urdf"), Options(), source.files, Report()).losses == ()
    assert b"<mujoco" in pipeline.write(mechanism, formats.by_name("mjcf"), Options(), source.files, Report()).main


@pytest.mark.robots("xacro")
@pytest.mark.unread("HX052")
def test_every_element_of_a_real_robot_stands_where_its_file_says(robot: Path) -> None:
    """Each link and joint is written on its line: the line begins the tag, in whichever file it is."""
    mechanism = read(disk.open_source(str(robot)), Report()).mechanism
    for key, origin in mechanism.origins.items():
        if key.kind in ("body", "joint") and origin.line:
            line = Path(origin.file).read_text("utf-8").splitlines()[origin.line - 1]
            assert f"<{'link' if key.kind == 'body' else 'joint'}" in line, (key, origin)


@pytest.mark.full
@pytest.mark.corpus
def test_every_xacro_file_of_rtb_data_whose_packages_are_there_expands(real_robot: RealRobots) -> None:
    """The catalogue's package with the most xacro files: 36 robots, 21 libraries of macros and fragments, 3 incomplete ones."""
    package = real_robot.package(catalog.select(("rtb_data",))[0])
    library = Library(package)
    refused = {}
    links = []
    for path in sorted(package.rglob("*.xacro")):
        try:
            text = expand(disk.open_source(str(path)), Report()).text
        except Refusal as refusal:
            refused[path.name] = refusal.diagnostic.message
        else:
            assert canonical(text) == canonical(library.expand(path)), path
            links.append(text.count(b"<link "))
    assert refused == INCOMPLETE
    assert [len(links), sum(count >= 2 for count in links)] == [57, 36]
