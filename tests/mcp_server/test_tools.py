"""The tools for language models, through the protocol: each one answers, stays in its folder, and says no more than a model can read."""

from __future__ import annotations

import json
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path

import anyio
import pytest
from mcp import Client, StdioServerParameters
from mcp.types import CallToolResult, TextContent

from hymeko_x.mcp import run
from hymeko_x.mcp.tools import NAMES, make_server

ROBOT = """<robot name="r"><link name="base"/>
<link name="tip"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><box size="1 1 1"/></geometry></visual></link>
<joint name="j" type="revolute"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
WITH_MESH = ROBOT.replace('<box size="1 1 1"/>', '<mesh filename="{}"/>')
POINTS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The folder of the tools, with a robot, and a secret beside it."""
    inside = tmp_path / "inside"
    inside.mkdir()
    (inside / "arm.urdf").write_text(ROBOT)
    (tmp_path / "secret.urdf").write_text(ROBOT.replace('name="r"', 'name="secret"'))
    (tmp_path / "secret.obj").write_text(POINTS)
    return inside


def calls(folder: Path, body: Callable[[Client], Awaitable[None]]) -> None:
    """Run a conversation with the server of a folder in memory."""

    async def talk() -> None:
        async with Client(make_server(folder)) as client:
            await body(client)

    anyio.run(talk)


def text_of(result: CallToolResult) -> str:
    (content,) = result.content
    assert isinstance(content, TextContent)
    return content.text


def answer(folder: Path, tool: str, *, fails: bool = False, **arguments: object) -> str:
    """What a tool answers."""
    found: list[CallToolResult] = []

    async def ask(client: Client) -> None:
        found.append(await client.call_tool(tool, arguments))

    calls(folder, ask)
    assert bool(found[0].is_error) == fails, text_of(found[0])
    return text_of(found[0])


def test_every_tool_is_listed_with_a_description(folder: Path) -> None:
    async def ask(client: Client) -> None:
        tools = (await client.list_tools()).tools
        assert [tool.name for tool in tools] == list(NAMES)
        assert all(tool.description and tool.annotations for tool in tools)
        assert {tool.name for tool in tools if not tool.annotations.read_only_hint} == {"convert", "graph"}  # type: ignore[union-attr]

    calls(folder, ask)


def test_convert(folder: Path) -> None:
    answered = answer(folder, "convert", source="arm.urdf", output="arm.xml", keep=True)
    assert answered.startswith("exit 0: done\nwrote arm.xml (2 bodies, 1 joint)")
    assert (folder / "arm.xml").read_text().startswith("<!-- made by hymeko-x")
    assert "HX003" in answer(folder, "convert", fails=True, source="arm.urdf", output="arm.step")


def test_check(folder: Path) -> None:
    answered = answer(folder, "check", path="arm.urdf", profile="complete", links=2, joints=2)
    assert answered.startswith("exit 3: the check failed\n")
    assert "HX316" in answered or "HX317" in answered
    assert "joints" in answered


def test_verify(folder: Path) -> None:
    answer(folder, "convert", source="arm.urdf", output="arm.hymeko")
    assert answer(folder, "verify", a="arm.urdf", b="arm.hymeko", samples=5).startswith("exit 0: done\nsame")
    (folder / "other.urdf").write_text(ROBOT.replace('mass value="1"', 'mass value="2"'))
    assert answer(folder, "verify", a="arm.urdf", b="other.urdf").startswith("exit 4: a difference was found\ndifferent")


def test_diff(folder: Path) -> None:
    (folder / "other.urdf").write_text(ROBOT.replace('upper="1"', 'upper="2"'))
    answered = answer(folder, "diff", a="arm.urdf", b="other.urdf")
    assert answered == "exit 4: a difference was found\njoint 'j' dofs[0].limits.upper: 1 -> 2"


def test_info(folder: Path) -> None:
    answered = answer(folder, "info", path="arm.urdf")
    assert json.loads(answered.partition("\n")[2])["bodies"] == 2


def test_dh(folder: Path) -> None:
    assert "tip" in answer(folder, "dh", path="arm.urdf", convention="modified", tip="tip")


def test_explain(folder: Path) -> None:
    assert "HX040: a reference leads nowhere" in answer(folder, "explain", code="HX040")
    assert "there is no code" in answer(folder, "explain", fails=True, code="--help")


def test_graph(folder: Path) -> None:
    assert answer(folder, "graph", path="arm.urdf", output="arm.dot") == "exit 0: done"
    assert "tip" in (folder / "arm.dot").read_text()


# ---- the folder --------------------------------------------------------------------------------------------------------------

OUTSIDE = ("../secret.urdf", "inside/../../secret.urdf", "/etc/passwd", "~/secret.urdf", "C:\\secret.urdf", "..\\secret.urdf", "", "a\0b")
READING = (
    ("convert", "source", {"output": "out.urdf"}),
    ("check", "path", {}),
    ("verify", "a", {"b": "arm.urdf"}),
    ("verify", "b", {"a": "arm.urdf"}),
    ("diff", "a", {"b": "arm.urdf"}),
    ("diff", "b", {"a": "arm.urdf"}),
    ("info", "path", {}),
    ("dh", "path", {}),
    ("graph", "path", {"output": "out.svg"}),
)


@pytest.mark.parametrize(("tool", "argument", "others"), READING, ids=lambda value: str(value)[:8])
def test_a_path_that_leads_out_is_refused(tool: str, argument: str, others: dict[str, str], folder: Path) -> None:
    (folder / "link.urdf").symlink_to(folder.parent / "secret.urdf")
    (folder / "up").symlink_to(folder.parent)

    async def ask(client: Client) -> None:
        for path in (*OUTSIDE, "link.urdf", "up/secret.urdf"):
            result = await client.call_tool(tool, {argument: path, **others})
            assert result.is_error
            assert "error[HX001]" in text_of(result), (path, text_of(result))
            assert "secret'" not in text_of(result).replace(path, "")

    calls(folder, ask)


def test_an_output_that_leads_out_is_refused(folder: Path) -> None:
    (folder / "up").symlink_to(folder.parent)
    (folder / "sub").mkdir()
    (folder / "sub/meshes").symlink_to(folder.parent)

    async def ask(client: Client) -> None:
        for tool, first in (("convert", "source"), ("graph", "path")):
            for path in ("../out.svg", "/tmp/out.svg", "up/out.svg", "nowhere/out.svg", "sub/out.svg"):
                result = await client.call_tool(tool, {first: "arm.urdf", "output": path})
                assert result.is_error
                assert "error[HX002]" in text_of(result), (path, text_of(result))

    calls(folder, ask)
    assert sorted(path.name for path in folder.parent.iterdir()) == ["inside", "secret.obj", "secret.urdf"]


@pytest.mark.parametrize("mesh", ["../secret.obj", "{}/secret.obj", "file://{}/secret.obj", "linked.obj"])
def test_a_robot_that_refers_to_a_file_outside_is_not_opened_by_an_engine(mesh: str, folder: Path) -> None:
    (folder / "linked.obj").symlink_to(folder.parent / "secret.obj")
    (folder / "bad.urdf").write_text(WITH_MESH.format(mesh.format(folder.parent)))
    for tool, paths in (("verify", {"a": "bad.urdf", "b": "arm.urdf"}), ("dh", {"path": "bad.urdf"})):
        assert "to which reading is confined" in answer(folder, tool, fails=True, **paths)
    answer(folder, "convert", source="bad.urdf", output="out.xml")
    assert not [path for path in folder.rglob("*.obj") if path.name != "linked.obj"]


def test_an_include_outside_is_not_read(folder: Path) -> None:
    (folder.parent / "secret.xml").write_text("<mujoco><worldbody><body name='secret'/></worldbody></mujoco>")
    (folder / "arm.xml").write_text("<mujoco><include file='../secret.xml'/><worldbody><body name='b'/></worldbody></mujoco>")
    for tool, paths in (("info", {"path": "arm.xml"}), ("verify", {"a": "arm.xml", "b": "arm.xml"})):
        answered = answer(folder, tool, fails=True, **paths)
        assert "'secret'" not in answered
        assert "HX053" in answered or "HX001" in answered, answered


def test_a_module_in_the_folder_is_not_imported(folder: Path) -> None:
    (folder / "lxml.py").write_text("raise SystemExit('imported')")
    (folder / "hymeko_x").mkdir()
    assert "exit 0" in answer(folder, "info", path="arm.urdf")


def test_what_comes_back_is_bounded(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "MOST_CHARACTERS", 100)
    answered = answer(folder, "info", path="arm.urdf")
    assert len(answered) < 250
    assert "... cut off: " in answered


def test_a_verb_that_takes_too_long_is_ended(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "MOST_SECONDS", 0.01)
    assert answer(folder, "info", fails=True, path="arm.urdf").endswith("exit None: stopped after 0.01 s")


def test_it_speaks_on_standard_input_and_output(folder: Path) -> None:
    async def talk() -> None:
        server = StdioServerParameters(command=sys.executable, args=["-m", "hymeko_x", "mcp", "."], cwd=folder, env=run._environment())
        async with Client(server) as client:
            assert "exit 0" in text_of(await client.call_tool("info", {"path": "arm.urdf"}))

    anyio.run(talk)
