"""Files that lead elsewhere, and names that mean something to somebody else."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from tests.hostile.case import Case

if TYPE_CHECKING:
    from pathlib import Path

SECRET = "../secret"
"""Lies beside the folder in which the case is run, and must never be read under --confine."""
ROBOT = '<robot name="r"><link name="a"/></robot>'
_MESH = '<robot name="r"><link name="a"><visual><geometry><mesh filename="{}"/></geometry></visual></link></robot>'
CONFINED = ("--confine", ".")


def _confined(title: str, name: str, text: str, code: int, *codes: str, prepare: object = None, seconds: float = 30.0) -> Case:
    return Case(title, {name: text}, ("info", name, *CONFINED), code, codes, seconds, prepare=prepare)  # type: ignore[arg-type]


def _mesh(title: str, uri: str, *codes: str, prepare: object = None) -> Case:
    words = ("convert", "r.urdf", "../out/m.xml", *CONFINED)
    return Case(title, {"r.urdf": _MESH.format(uri)}, words, 0, codes, 20.0, ("m.xml",), prepare)  # type: ignore[arg-type]


def _link(name: str, target: str) -> object:
    return lambda folder: os.symlink(target, folder / name)


def _fifo(folder: Path) -> None:
    os.mkfifo(folder / "a.stl")


def _fifo_input(folder: Path) -> None:
    os.mkfifo(folder / "r.urdf")


CONFINE = (
    _confined("MJCF that includes a file outside", "m.xml", f'<mujoco><include file="{SECRET}.xml"/></mujoco>', 1, "HX001"),
    _confined("MJCF that includes a system file", "m.xml", '<mujoco><include file="/etc/passwd"/></mujoco>', 1, "HX001"),
    _confined(
        "MJCF that includes a link that leads out",
        "m.xml",
        '<mujoco><include file="b.xml"/></mujoco>',
        1,
        "HX001",
        prepare=_link("b.xml", f"{SECRET}.xml"),
    ),
    _confined(
        "xacro that includes a file outside",
        "r.xacro",
        f'<robot xmlns:xacro="x"><xacro:include filename="{SECRET}.xacro"/></robot>',
        1,
        "HX053",
    ),
    _confined(
        "xacro that includes a system file", "r.xacro", '<robot xmlns:xacro="x"><xacro:include filename="/etc/passwd"/></robot>', 1, "HX053"
    ),
    _confined(
        "xacro that reads a yaml file outside", "r.xacro", '<robot xmlns:xacro="x" name="${xacro.load_yaml(\'/etc/passwd\')}"/>', 1, "HX053"
    ),
    _confined(
        "a stage that refers to a file outside",
        "s.usda",
        f'#usda 1.0\ndef Xform "r" (\n references = @{SECRET}.usda@\n prepend apiSchemas = ["PhysicsRigidBodyAPI"]\n) {{}}',
        1,
        "HX201",
    ),
    _confined(
        "a stage that refers to a system file",
        "s.usda",
        '#usda 1.0\n(\n subLayers = [@/etc/passwd@]\n)\ndef Xform "r" (prepend apiSchemas = ["PhysicsRigidBodyAPI"]) {}',
        1,
        "HX201",
    ),
    _confined("HyMeKo that imports a file outside", "r.hymeko", f'r import "{SECRET}.hymeko" as s\na : link {{}}', 1, "HX040"),
    Case("an input outside", {}, ("info", f"{SECRET}.urdf", *CONFINED), 1, ("HX001",)),
    Case(
        "an input that is a link that leads out",
        {},
        ("info", "r.urdf", *CONFINED),
        1,
        ("HX001",),
        prepare=_link("r.urdf", f"{SECRET}.urdf"),
    ),  # type: ignore[arg-type]
    _mesh("a mesh outside", f"{SECRET}.stl", "HX201"),
    _mesh("a mesh that is a system file", "/etc/passwd", "HX201"),
    _mesh("a mesh by the URL of a system file", "file:///etc/passwd", "HX201"),
    _mesh("a mesh in a package that leads out", "package://../secret.stl", "HX201"),
    _mesh("a mesh behind a link that leads out", "a.stl", "HX201", prepare=_link("a.stl", f"{SECRET}.stl")),
    _mesh("a mesh on the network", "http://localhost:1/a.stl", "HX201"),
    _mesh("a mesh that is a device", "/dev/zero", "HX201"),
    _mesh("a mesh that is a pipe", "a.stl", "HX201", prepare=_fifo),
    _mesh("a mesh that is a folder", ".", "HX201"),
    _mesh("a mesh with NUL in its name", "a&#0;.stl", "HX005", "HX201"),
)

DEVICES = (
    Case("an endless device as input", {}, ("info", "/dev/zero", "--from", "urdf"), 1, ("HX001",)),
    Case("a link to an endless device as input", {}, ("info", "r.urdf"), 1, ("HX001",), prepare=_link("r.urdf", "/dev/zero")),  # type: ignore[arg-type]
    Case("a pipe as input of confined reading", {}, ("info", "r.urdf", *CONFINED), 1, ("HX001",), prepare=_fifo_input),
    Case("a folder as input", {}, ("info", "."), 1, ("HX001",)),
    Case("a loop of links as input", {}, ("info", "r.urdf"), 1, ("HX001",), prepare=_link("r.urdf", "r.urdf")),  # type: ignore[arg-type]
    Case("a full device as output", {"r.urdf": ROBOT}, ("convert", "r.urdf", "/dev/full", "--to", "mjcf"), 1, ("HX002",)),
    Case("a folder as output", {"r.urdf": ROBOT}, ("convert", "r.urdf", "../out", "--to", "mjcf"), 0, leaves=("r.xml",)),
    Case("an output below a file", {"r.urdf": ROBOT}, ("convert", "r.urdf", "r.urdf/m.xml"), 1, ("HX002",)),
    Case("an output name that is too long", {"r.urdf": ROBOT}, ("convert", "r.urdf", "x" * 300 + ".xml"), 1, ("HX002",)),
)

_NAMES = {
    "a name that looks like an option": "--help.urdf",
    "a name that is a command": "; touch pwned;.urdf",
    "a name that a shell would expand": "$(touch pwned)`touch pwned`.urdf",
    "a name with a line break": "a\nb.urdf",
    "a name that is no text": os.fsdecode(b"\xff\xfe.urdf"),
    "a name with colours": "\x1b[31mred.urdf",
}
_ELEMENTS = '<robot name="{0}"><link name="{0}"><visual><geometry><mesh filename="{0}.stl"/></geometry></visual></link></robot>'


def _named(title: str, name: str) -> Case:
    safe = f"./{name}"
    return Case(title, {name: ROBOT}, ("convert", safe, "../out/m.xml"), 0, (), 20.0, ("m.xml",))


NAMES = (
    *(_named(title, name) for title, name in _NAMES.items()),
    *(
        Case(
            f"elements called {title}",
            {"r.urdf": _ELEMENTS.format(name)},
            ("convert", "r.urdf", "../out/m.xml"),
            0,
            ("HX201",),
            20.0,
            ("m.xml",),
        )
        for title, name in {
            "like commands": "$(touch pwned); touch pwned |",
            "like options": "--output=/tmp/pwned",
            "like paths": "../../../../tmp/pwned",
            "like system files": "/etc/passwd",
            "in right-to-left order": "\u202elru\u202c",
            "by a very long name": "x" * 5000,
        }.items()
    ),
    Case("an input with NUL in its name", {}, ("info", "no\0pe.urdf"), 1, ("HX001",)),
)

CASES = (*CONFINE, *DEVICES, *NAMES)
