"""Stages from strangers: damaged, endless, huge. A diagnostic or success, in bounded time, never a traceback."""

from __future__ import annotations

import random
import time

import pytest

from hymeko_x import codes
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.frontends import usd
from hymeko_x.ir.parts import Body
from hymeko_x.source import Source
from tests.usd.stages import HEADER, Texts, written
from tests.usd.test_read import body, robot
from tests.usd.test_usd_write import arm


def outcome(data: bytes, name: str = "robot.usdc", files: dict[str, str | bytes] | None = None) -> str:
    """What becomes of a file: the code with which it is refused, or that it was read."""
    try:
        usd.read(Source(name, data, Texts(files or {})), Report())
    except Refusal as refusal:
        return "a path of ours is reported" if "/tmp" in refusal.diagnostic.message else refusal.diagnostic.code.id
    return "read"


@pytest.mark.parametrize("part", [0.0, 0.1, 0.5, 0.9, 0.999])
@pytest.mark.parametrize("format", ["usd", "usdc", "usdz"])
def test_a_stage_that_ends_too_early_is_refused(format: str, part: float) -> None:
    data = written(arm(), format)
    assert outcome(data[: int(len(data) * part)], f"robot.{format}".replace(".usd", ".usda", format == "usd")) == codes.CANNOT_READ.id


@pytest.mark.unread
def test_a_stage_with_flipped_bits_is_read_or_refused() -> None:
    whole, dice = written(arm(), "usdc"), random.Random(0)
    for _ in range(25):
        data = bytearray(whole)
        for _ in range(4):
            data[dice.randrange(len(data))] ^= 1 << dice.randrange(8)
        assert outcome(bytes(data)) in ("read", codes.CANNOT_READ.id)


@pytest.mark.unread("HX040", "HX045", "HX056")
def test_a_layer_that_is_its_own_sublayer_or_payload_ends() -> None:
    text = HEADER.replace("(\n", "(\n    subLayers = [@robot.usda@]\n", 1) + 'def "robot" (\n    payload = @robot.usda@</robot>\n)\n{\n}\n'
    assert outcome(text.encode(), "robot.usda", {"robot.usda": text}) in ("read", codes.CANNOT_READ.id)


def test_a_missing_payload_is_a_warning() -> None:
    report = Report()
    text = robot(body("a"), 'def "b" (\n    payload = @../../../../../../../../../../etc/passwd@\n)\n{\n}\n')
    mechanism = usd.read(Source("robot.usda", text.encode()), report).mechanism
    assert [item.code for item in report] == [codes.ASSET_NOT_FOUND]
    assert [key.name for key, _ in mechanism.vertices(Body)] == ["a"]


@pytest.mark.full
def test_a_hundred_thousand_prims_are_read_in_bounded_time() -> None:
    group = "".join(f'    def Xform "p{number}"\n    {{\n        int count = {number}\n    }}\n' for number in range(100_000))
    start = time.process_time()
    mechanism = usd.read(Source("robot.usda", robot(body("a"), group).encode()), Report()).mechanism
    assert [key.name for key, _ in mechanism.vertices(Body)] == ["a"]
    assert sum(len(found) for found in mechanism.extras.values()) >= 100_000
    assert time.process_time() - start < 300.0


@pytest.mark.unread
@pytest.mark.parametrize(
    "line",
    [
        "float inputs:diffuseColor = 0.5",
        "color3f inputs:diffuseColor = (1, 0, 0)\n color3f inputs:opacity = (1, 1, 1)",
        "token inputs:metallic = 'a'",
    ],
)
def test_an_input_of_another_type_is_no_colour(line: str) -> None:
    material = f"""
    def Material "paint"
    {{
        token outputs:surface.connect = </robot/paint/s.outputs:surface>
        def Shader "s"
        {{
            uniform token info:id = "UsdPreviewSurface"
            {line}
            token outputs:surface
        }}
    }}
"""
    assert outcome(robot(body("a", "") + material).encode(), "robot.usda") == "read"


CUBE = """
 def Cube "c" (prepend apiSchemas = ["PhysicsCollisionAPI"])
 {{
  double size = {}
 }}
"""


def findings(text: str) -> list[str]:
    """The diagnostics of a stage, with their codes."""
    report = Report()
    usd.read(Source("robot.usda", text.encode(), Texts({})), report)
    return [f"{found.code.id} {found.message}" for found in report]


@pytest.mark.unread
@pytest.mark.parametrize(("size", "what"), [("nan", "number"), ("inf", "size")])
def test_a_size_that_is_no_number_does_not_count(size: str, what: str) -> None:
    """A cube without a size has one of 2, and with it a mass."""
    text = robot(body("a", CUBE.format(size)))
    assert findings(text) == [f"HX020 'size' is {size}, which is no {what}; it is not used"]
    found, usual = (
        usd.read(Source("r.usda", each.encode(), Texts({})), Report()).mechanism for each in (text, robot(body("a", CUBE.format(2))))
    )
    assert [part for _, part in found.vertices(Body)] == [part for _, part in usual.vertices(Body)]


@pytest.mark.unread
@pytest.mark.parametrize(
    ("ops", "flaw"),
    [
        ("double3 xformOp:scale = (1, 2, 1)", "is sheared"),
        ("double3 xformOp:scale = (1, nan, 1)", "has a transform with numbers that are not finite"),
        ("double3 xformOp:scale = (0, 0, 0)", "is scaled to nothing"),
        ("double3 xformOp:scale = (2, 2, 2)", ""),
    ],
)
def test_a_transform_that_is_no_pose_with_a_scale_is_reported(ops: str, flaw: str) -> None:
    turned = CUBE.format('1\n float xformOp:rotateZ = 45\n uniform token[] xformOpOrder = ["xformOp:rotateZ"]')
    group = f'def Xform "g"\n{{\n{ops}\nuniform token[] xformOpOrder = ["xformOp:scale"]\n{turned}\n}}'
    found = findings(robot(body("a", group)))
    assert [text.partition("HX104 /robot/a/g/c ")[2][: len(flaw)] for text in found] == ([flaw] if flaw else [])


@pytest.mark.unread
@pytest.mark.parametrize("shape", [CUBE.format(1e154), CUBE.format(1e154).replace("Cube", "Sphere").replace("size", "radius")])
def test_a_shape_beyond_measure_gives_no_mass(shape: str) -> None:
    found = usd.read(Source("r.usda", robot(body("a", shape)).encode(), Texts({})), Report()).mechanism
    assert [part.inertial for _, part in found.vertices(Body)] == [None]
