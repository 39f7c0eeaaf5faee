"""The part of the silence test for files: what can be changed in a mesh or an image that a conversion hands on without a word.

A change is one of a robot's own files, or of how the text uses it. Each is converted to every format, and must be seen in the main file,
in the files beside it (by the points and pixels that they hold), in the ledger or in a diagnostic.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

from hymeko_x import formats, pipeline
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.rewrite import Options
from hymeko_x.source import PackageFiles, Source
from tests.assets.test_originals import png
from tests.robots import MemoryFiles


class Robot(NamedTuple):
    """A text with its files."""

    name: str
    text: str
    files: Mapping[str, bytes]


FIRST, SECOND = "f 1/1/1 3/2/1 2/3/1\n", "f 1/1/2 2/2/2 4/3/2\n"
OBJ = """mtllib part.mtl
v 0 0 0
v 0.1 0 0
v 0 0.2 0
v 0 0 0.3
v 0.5 0.5 0.5
vt 0 0
vt 1 0
vt 0 1
vn 0 0 -1
vn 0 -0.6 0.8
usemtl red
f 1/1/1 3/2/1 2/3/1
f 1/1/2 2/2/2 4/3/2
usemtl blue
f 1/1/2 4/2/2 3/3/2
f 2/1/2 3/2/2 4/3/1
"""
MTL = "newmtl red\nKd 1 0 0\nmap_Kd skin.png\nnewmtl blue\nKd 0 0 1\n"
URDF = """<robot name="r"><link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="part.obj" scale="1 2 3"/></geometry></visual>
<collision><geometry><mesh filename="hull.stl"/></geometry></collision>
<visual><geometry><mesh filename="sheet.obj"/></geometry>
<material name="m"><color rgba="1 1 0 1"/><texture filename="paper.png"/></material></visual>
</link></robot>"""
SHEET = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.25\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n"
STL = """solid hull
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 0 1 0
vertex 1 0 0
endloop
endfacet
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 0 1
endloop
endfacet
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 0 0 1
vertex 0 1 0
endloop
endfacet
facet normal 0 0 1
outer loop
vertex 1 0 0
vertex 0 1 0
vertex 0 0 1
endloop
endfacet
endsolid hull
"""
MJCF = """<mujoco model="r"><asset><texture name="t" type="2d" file="skin.png"/><material name="m" texture="t" rgba="1 1 1 0.5"/>
<texture name="spare" type="2d" file="paper.png"/>
<mesh name="part" file="part.obj" scale="1 2 3"/><mesh name="hull" file="hull.obj"/><mesh name="sheet" file="sheet.obj"/></asset>
<worldbody><body><freejoint/><geom type="mesh" mesh="part" material="m"/><geom type="mesh" mesh="hull" pos="1 0 0"/></body></worldbody>
</mujoco>"""


def robots() -> Iterator[Robot]:
    """A robot in each format that refers to files."""
    shared = {"part.obj": OBJ.encode(), "part.mtl": MTL.encode(), "skin.png": png(10), "paper.png": png(100), "sheet.obj": SHEET.encode()}
    yield Robot("robot.urdf", URDF, {**shared, "hull.stl": STL.encode()})
    yield Robot("robot.xml", MJCF, {**shared, "hull.obj": OBJ.replace("0.3", "0.4").encode()})


def _replaced(name: str, old: str, new: str) -> Callable[[Robot], Robot]:
    def change(robot: Robot) -> Robot:
        text = robot.files[name].decode()
        assert old in text, (name, old)
        return robot._replace(files={**robot.files, name: text.replace(old, new, 1).encode()})

    return change


def _image(name: str, data: bytes) -> Callable[[Robot], Robot]:
    return lambda robot: robot._replace(files={**robot.files, name: data})


def _without(name: str) -> Callable[[Robot], Robot]:
    return lambda robot: robot._replace(files={key: data for key, data in robot.files.items() if key != name})


def _text(old: str, new: str) -> Callable[[Robot], Robot]:
    return lambda robot: robot._replace(text=robot.text.replace(old, new, 1))


FILES = {
    "a point is moved": _replaced("part.obj", "v 0 0 0.3", "v 0 0 0.31"),
    "a point of no triangle is moved": _replaced("part.obj", "v 0.5 0.5 0.5", "v 0.5 0.5 0.6"),
    "a point of no triangle is gone": _replaced("part.obj", "v 0.5 0.5 0.5\n", ""),
    "a triangle is gone": _replaced("part.obj", "f 2/1/2 3/2/2 4/3/1\n", ""),
    "a triangle is turned": _replaced("part.obj", "f 2/1/2 3/2/2 4/3/1", "f 2/1/2 4/3/1 3/2/2"),
    "two triangles are exchanged": _replaced("part.obj", f"{FIRST}{SECOND}", f"{SECOND}{FIRST}"),
    "a texture coordinate is moved": _replaced("part.obj", "vt 0 1", "vt 0 0.5"),
    "a corner has another texture coordinate": _replaced("part.obj", "f 1/1/1 3/2/1 2/3/1", "f 1/3/1 3/2/1 2/3/1"),
    "a normal is turned": _replaced("part.obj", "vn 0 -0.6 0.8", "vn 0 -0.8 0.6"),
    "a corner has another normal": _replaced("part.obj", "f 1/1/2 2/2/2 4/3/2", "f 1/1/1 2/2/2 4/3/2"),
    "the image of a material of the sheet is gone": _without("paper.png"),
    "a pixel of the sheet's image is another one": _image("paper.png", png(101)),
    "a texture coordinate of the sheet is moved": _replaced("sheet.obj", "vt 1 1", "vt 1 0.5"),
    "a pixel is another one": _image("skin.png", png(11)),
    "the image is gone": _without("skin.png"),
    "the mesh is gone": _without("part.obj"),
    "an unused mesh is gone, or one on a sheet": _without("sheet.obj"),
    "the scale is another one": _text('scale="1 2 3"', 'scale="1 2 3.5"'),
    "the scale is gone": _text(' scale="1 2 3"', ""),
}
OF_URDF = {
    "a colour of a material of the file": _replaced("part.mtl", "Kd 0 0 1", "Kd 0 0.5 1"),
    "the image of a material of the file": _replaced("part.mtl", "map_Kd skin.png\n", ""),
    "the materials of the file are gone": _without("part.mtl"),
    "a triangle shows another material": _replaced("part.obj", "usemtl blue\nf 1/1/2 4/2/2 3/3/2", "f 1/1/2 4/2/2 3/3/2\nusemtl blue"),
    "a corner of the hull is moved": _replaced("hull.stl", "vertex 0 0 1", "vertex 0 0 1.1"),
    "the colour is another one": _text('rgba="1 1 0 1"', 'rgba="1 0 0 1"'),
    "the image is another one": _text("paper.png", "skin.png"),
}
OF_MJCF = {
    "a point of the hull is moved": _replaced("hull.obj", "v 0 0 0.4", "v 0 0 0.45"),
    "a triangle of the hull is gone": _replaced("hull.obj", "f 2/1/2 3/2/2 4/3/1\n", ""),
    "the colour is another one": _text("1 1 1 0.5", "1 1 1 0.6"),
    "the texture is another one": _text('texture="t" rgba', 'texture="spare" rgba'),
}
OF_NO_GEOM = frozenset(
    {
        "the image of a material of the sheet is gone",
        "a pixel of the sheet's image is another one",
        "a texture coordinate of the sheet is moved",
        "an unused mesh is gone, or one on a sheet",
    }
)
"""Changes of files that no geom of the model uses."""
OF_NO_TRIANGLE = frozenset({"a point of no triangle is moved", "a point of no triangle is gone"})
"""Changes of points that nothing of a URDF robot has: its programs read triangles."""


def may_be_silent(robot: Robot, target: str) -> frozenset[str]:
    """The changes that need not be seen: the ledger names the mesh or the image as lost, or it is no content of the source's format."""
    if robot.name.endswith(".urdf"):
        return OF_NO_TRIANGLE if target in ("mjcf", "usd") else frozenset()
    return frozenset() if target in ("mjcf", "hymeko") else OF_NO_GEOM


def lost_whole(robot: Robot, target: str) -> tuple[str, ...]:
    """The elements of which the ledger must say that they are lost, where changes of them are not seen."""
    return () if robot.name.endswith(".urdf") else ("mesh 'sheet' dropped", "texture 'spare' dropped")


def changed(robot: Robot) -> Iterator[tuple[str, Robot]]:
    """Every change of a robot, with its name."""
    own = OF_URDF if robot.name.endswith(".urdf") else OF_MJCF
    yield from ((name, change(robot)) for name, change in {**FILES, **own}.items())


def shown(robot: Robot, target: str) -> tuple[object, ...]:
    """All that a user sees of a conversion: the text, the files by their content, the ledger and the diagnostics."""
    files, report = MemoryFiles(dict(robot.files)), Report()
    row = formats.by_name(target)
    try:
        format = formats.of_input(robot.name, robot.text.encode())
        source = Source(robot.name, robot.text.encode(), files)
        result = pipeline.convert(pipeline.read(source, format, report), row, Options(), files, report, pipeline.OutputPlace(assets="copy"))
    except Refusal as refusal:
        return ("refused", refusal.diagnostic.message)
    package = result.package
    contents = PackageFiles(package, files)
    beside = sorted((name, contents.read(name)) for name in (*package.files, *package.copies))
    reported = [(item.code.id, item.message) for item in report]
    return package.main, tuple(beside), tuple(map(str, result.losses or ())), tuple(reported)
