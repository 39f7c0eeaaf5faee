"""What is written as xacro expands to what is written as URDF, to the letter but for `2e-06`, which Python prints so."""

from __future__ import annotations

import contextlib
import io
import re
import statistics
from pathlib import Path
from xml.dom import minidom

import pytest
import xacro
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lxml import etree
from msgspec.structs import replace

import hymeko_x as hx
from hymeko_x import disk, formats, pipeline
from hymeko_x.backends import urdf
from hymeko_x.backends import xacro as backend
from hymeko_x.cli import main
from hymeko_x.compare.diff import diff
from hymeko_x.diagnostics import Report
from hymeko_x.frontends.xacro import read
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.rewrite import Options, choose, legalize
from hymeko_x.source import Source
from hymeko_x.testing import mechanisms, urdf_mechanisms
from tests.conftest import RealRobots
from tests.urdf.samples import load, robot


def library(text: bytes) -> minidom.Document:
    """What xacro itself makes of a file, without a warning; not as text, in which minidom loses line breaks of attributes."""
    xacro.init_stacks("robot.xacro")
    with contextlib.redirect_stderr(io.StringIO()) as printed:
        document = xacro.parse(text.decode())
        xacro.process_doc(document)
    assert printed.getvalue() == ""
    return document


def elements(document: minidom.Document) -> object:
    """The elements in their order, each with its attributes in none, and with its words."""

    def of(node: minidom.Node) -> object:
        if not isinstance(node, minidom.Element):
            return node.data.strip() if isinstance(node, minidom.Text) else ""
        attributes = sorted((name, plain(name, text)) for name, text in node.attributes.items() if name != "xmlns:xacro")
        return node.tagName, attributes, [kid for child in node.childNodes if (kid := of(child))]

    return of(document.documentElement)


def plain(name: str, text: str) -> str:
    """The text of an attribute, of numbers without the zero that Python prints in a small exponent."""
    return text if name in ("name", "link", "joint", "filename") else re.sub(r"(?<=\de-)0(?=[1-9](?!\S))", "", text)


def check(mechanism: Mechanism) -> str:
    """The xacro of a mechanism, which expands to its URDF."""
    text = backend.write(mechanism, Options(), Report()).main
    assert elements(library(text)) == elements(minidom.parseString(urdf.write(mechanism, Options(), Report()).main))
    return text.decode()


def characters(text: bytes) -> int:
    """How many characters count: no comments, no white space."""
    return len(re.sub(rb"\s+|<!--.*?-->", b"", text, flags=re.DOTALL).decode())


LEG = """<link name="{0}_hip"><inertial><mass value="1.5"/>
<inertia ixx="0.0125" ixy="{1}2.5e-05" ixz="0" iyy="1e-05" iyz="0" izz="0.1"/></inertial>
<visual><geometry><mesh filename="package://p/hip.stl"/></geometry><material name="black"/></visual></link>
<joint name="{0}_hip_joint" type="revolute"><origin xyz="0 {1}0.125 0" rpy="{1}1.5707963267948966 0 0"/><parent link="base"/>
<child link="{0}_hip"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="40" velocity="10"/></joint>
<transmission name="{0}_t"><type>simple</type><joint name="{0}_hip_joint"><hardwareInterface>e</hardwareInterface></joint></transmission>"""
PAIR = robot('<!-- the base -->\n<link name="base"/>' + LEG.format("left", "") + LEG.format("right", "-"))


@pytest.mark.unread("HX040")
def test_left_and_right_are_calls_of_one_macro() -> None:
    text = check(load(PAIR))
    calls = re.findall(r"<xacro:.*/>", text)
    assert calls == ['<xacro:hip_to_t prefix="left" side="1"/>', '<xacro:hip_to_t prefix="right" side="-1"/>']
    assert 'xyz="0 ${side*0.125} 0" rpy="${side*pi/2} 0 0"' in text
    assert 'ixy="${side*2.5e-05}"' in text


@pytest.mark.unread("HX040")
def test_comments_stay_and_headings_go() -> None:
    back = read(Source("r.xacro", backend.write(load(PAIR), Options(), Report()).main), Report()).mechanism
    assert diff(load(PAIR), back) == ()
    assert [extra.text for extras in back.extras.values() for extra in extras if extra.format == "comment"] == ["the base"]


ODD = (
    "1e-05",
    "1e5",
    "0.10",
    "+1",
    "007",
    "true",
    "False",
    "inf",
    "nan",
    "1_0",
    "'a'",
    "'",
    '"',
    "''",
    "${x}",
    "$(find x)",
    "$${x}",
    "$$",
    "a$",
)


@pytest.mark.parametrize(
    "text", [*ODD, "", " ", "a b", "<&>", "${", "$", "a\nb", "\t", "^|a", "a:=b", "１", "0x1", "1.", ".5", "-0", "None", "__import__('os')"]
)
@pytest.mark.unread("HX005", "HX010")
def test_every_text_comes_back_as_a_text_that_varies_and_one_that_does_not(text: str) -> None:
    element = etree.Element("x", a=text, b="the same in all of them, and long enough")
    quoted = etree.tostring(element).decode()
    names = ("one", "two", "three", "four", "five")
    gazebo = "".join(f'<gazebo reference="{name}"><sensor><fixed>{quoted}</fixed></sensor></gazebo>' for name in names)
    varied = "".join(
        f'<gazebo><plugin of="{name}" long="words that are always the same">{quoted}</plugin></gazebo>'
        for name in (*names, text)
        for quoted in (etree.tostring(etree.Element("y", v=name)).decode(),)
    )
    written = check(load(robot('<link name="one"/>' + gazebo + varied.replace("\n", "&#10;"))))
    assert "<xacro:macro" in written


@given(urdf_mechanisms())
@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_whatever_urdf_can_say_expands_to_it(mechanism: Mechanism) -> None:
    check(mechanism)


@given(mechanisms(), st.builds(Options, st.sampled_from([None, "fixed", "free"]), st.sampled_from([None, "motor", "position"])))
@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@pytest.mark.unread("HX101", "HX102", "HX104")
def test_every_legal_mechanism_expands_to_its_urdf(mechanism: Mechanism, options: Options) -> None:
    check(legalize(choose(replace(mechanism, extras={}), options, Report()), "xacro", Report()))


@pytest.mark.parametrize("declared", ["", ' xmlns:xacro="http://ros.org/wiki/xacro"'])
@pytest.mark.unread("HX040")
def test_the_ledger_of_a_conversion_to_xacro_is_empty(declared: str) -> None:
    mechanism = load(PAIR.replace("<robot", f"<robot{declared}"))
    assert pipeline.convert(mechanism, formats.by_name("xacro"), Options(), Source("", b"").files, Report()).losses == ()


@pytest.mark.robots("urdf", every=4)
@pytest.mark.unread("HX005", "HX028", "HX040", "HX046")
def test_the_xacro_of_a_real_robot_expands_to_its_urdf(robot: Path) -> None:
    check(load(robot.read_bytes()))


@pytest.mark.robots("xacro", every=3)
@pytest.mark.unread("HX052")
def test_xacro_through_a_mechanism_and_back_is_the_expansion_of_the_source(robot: Path) -> None:
    source = disk.open_source(str(robot))
    mechanism = read(source, Report()).mechanism
    text = check(mechanism)
    assert diff(mechanism, read(Source("again.xacro", text.encode()), Report()).mechanism) == ()


@pytest.mark.robots("xacro", every=3)
@pytest.mark.unread("HX052")
def test_macros_in_a_file_of_their_own_expand_to_the_same(robot: Path, tmp_path: Path) -> None:
    source = disk.open_source(str(robot))
    mechanism = read(source, Report()).mechanism
    options = Options(split=True)
    package = pipeline.write(mechanism, formats.by_name("xacro"), options, source.files, Report())
    (tmp_path / "robot.xacro").write_bytes(package.main)
    for name, data in package.files.items():
        (tmp_path / name).write_bytes(data)
    assert (b"<xacro:include" in package.main, b"<xacro:macro" in package.main) == (bool(package.files), False)
    written = pipeline.write(mechanism, formats.by_name("urdf"), Options(), source.files, Report()).main
    assert elements(xacro.process_file(str(tmp_path / "robot.xacro"))) == elements(minidom.parseString(written))


@pytest.mark.corpus
@pytest.mark.full
def test_xacro_is_shorter_than_urdf(real_robot: RealRobots) -> None:
    """Characters without white space and comments, over the development URDFs; and those with repeated limbs."""
    from hymeko_x.corpus import catalog

    ratios, limbs = [], []
    for file in catalog.development_files("urdf"):
        path = real_robot(file)
        mechanism = load(path.read_bytes())
        ours = characters(backend.write(mechanism, Options(), Report()).main)
        ratio = ours / characters(urdf.write(mechanism, Options(), Report()).main)
        ratios.append(ratio)
        if any(word in file.id for word in LIMBED):
            limbs.append(ratio)
    assert statistics.median(ratios) < 0.5
    assert statistics.median(limbs) < 0.4


LIMBED = (
    "anymal",
    "quadruped",
    "minitaur",
    "vision60",
    "office",
    "centauro",
    "allegro",
    "shadow",
    "dclaw",
    "iris",
    "racecar",
    "g1",
    "talos",
)
"""Legs, fingers, wheels or rotors several times."""


@pytest.mark.unread("HX040")
def test_macros_in_a_file_of_their_own(tmp_path: Path) -> None:
    """What they say may have a prefix that the robot declares."""
    pair = PAIR.replace('<robot name="r"', '<robot name="r" xmlns:sensor="http://sensor"').replace(
        "<visual>", '<sensor:skin kind="soft"/><visual>'
    )
    assert "xmlns:sensor" in pair
    (tmp_path / "in.urdf").write_text(pair)
    assert main(["convert", str(tmp_path / "in.urdf"), str(tmp_path / "out.xacro"), "--split", "--fail-on", "loss"]) == 0
    text, macros = ((tmp_path / name).read_text() for name in ("out.xacro", "r.macros.xacro"))
    assert '<xacro:include filename="r.macros.xacro"/>' in text
    assert ["<xacro:macro" in text, "<xacro:macro" in macros] == [False, True]
    assert diff(load(pair), hx.load(tmp_path / "out.xacro").mechanism) == ()
