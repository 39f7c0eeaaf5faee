"""How the format of a file is recognised."""

from __future__ import annotations

import importlib

import pytest

from hymeko_x import codes, formats
from hymeko_x.diagnostics import Refusal

ROBOT = b"<robot name='r'/>"


@pytest.mark.parametrize(
    ("name", "data", "expected"),
    [
        ("a.urdf", ROBOT, "urdf"),
        ("dir.d/A.URDF", ROBOT, "urdf"),
        ("a.urdf", b"<robot xmlns:xacro='http://ros.org/wiki/xacro' name='r'/>", "urdf"),
        ("a.urdf", b"not XML at all", "urdf"),
        ("a.hymeko", b"r {}", "hymeko"),
        ("a.himeko", b"<robot/>", "hymeko"),
        ("a.mjcf", b"", "mjcf"),
        ("a.xml", b"<mujoco/>", "mjcf"),
        ("a.xml", b"\xef\xbb\xbf<?xml version='1.0'?>\n<!-- <mujoco> -->\n<robot/>", "urdf"),
        ("a.xml", b"<!-- <robot> --> <mujocoinclude/>", "mjcf"),
        ("a.xml", b"<?xml version='1.0'?><!DOCTYPE robot [ <!ENTITY x 'y>'> ]><robot name='r'>", "urdf"),
        ("a.xml", "<?xml version='1.0'?>\n<robot/>".encode("utf-16"), "urdf"),
        ("a.xml", b"broken", "mjcf"),
        ("<stdin>", ROBOT, "urdf"),
        ("<stdin>", b"\n  robot {}", "hymeko"),
        ("robot", b"<x:mujoco xmlns:x='u'/>", "mjcf"),
        ("robot.txt", b"robot {}", "hymeko"),
    ],
)
def test_a_format_is_known_by_suffix_and_then_by_content(name: str, data: bytes, expected: str) -> None:
    assert formats.of_input(name, data).name == expected


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("a.xml", b"<html/>", "the root element <html> belongs to no format"),
        ("<stdin>", b"<svg>", "the root element <svg> belongs to no format"),
        ("a.stl", b"solid", "neither suffix nor content of 'a.stl' belongs to a format"),
        ("<stdin>", b"", "neither suffix nor content of '<stdin>' belongs to a format"),
        ("a", b"\x7fELF\0\0", "neither suffix nor content of 'a' belongs to a format"),
    ],
)
def test_a_file_of_no_format_is_refused(name: str, data: bytes, message: str) -> None:
    with pytest.raises(Refusal) as refusal:
        formats.of_input(name, data)
    assert refusal.value.diagnostic.code == codes.UNKNOWN_FORMAT
    assert refusal.value.diagnostic.message == message


def test_the_format_of_an_output_is_that_of_its_suffix() -> None:
    names = {"a.urdf": "urdf", "b/A.XML": "mjcf", "a.mjcf": "mjcf", "x.hymeko": "hymeko"}
    assert {path: formats.of_output(path).name for path in names} == names
    with pytest.raises(Refusal, match="the suffix of 'robot.step' belongs to no format"):
        formats.of_output("robot.step")


def test_of_the_kinds_of_usd_the_suffix_chooses() -> None:
    named = {
        ("a.usdc", "usd"): "usdc",
        ("a.usda", "usdc"): "usd",
        ("a.usd", "usdc"): "usdc",
        ("a.usd", "usd"): "usd",
        ("a.xml", "usdz"): "usdz",
    }
    assert {key: formats.of_output(*key).name for key in named} == named
    assert formats.of_output("a.urdf", "xacro") is formats.XACRO


def test_a_format_that_does_not_exist_is_refused_with_those_that_do() -> None:
    assert formats.by_name("URDF") is formats.URDF
    with pytest.raises(Refusal, match="there is no format 'step'\n  hint: known: hymeko, urdf, "):
        formats.by_name("step")


def test_an_endless_comment_does_not_take_endless_time() -> None:
    assert formats.xml_root(b"<!--" + b"-" * 2**20) is None
    assert formats.xml_root(b"<?xml?>" * 10_000 + b"<a/>") == "a"


@pytest.mark.parametrize("format", formats.FORMATS, ids=lambda format: format.name)
def test_every_reader_and_writer_in_the_table_exists(format: formats.Format) -> None:
    if format.frontend:
        assert callable(importlib.import_module(format.frontend).read)
    if format.backend:
        assert callable(importlib.import_module(format.backend).write)
