"""The tools: each is a verb of the command line whose paths lie in the folder. Their docstrings are what a model reads."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from mcp.server import MCPServer
from mcp.server.mcpserver.exceptions import ToolError
from mcp.types import ToolAnnotations
from msgspec import Struct

from hymeko_x.diagnostics import Refusal
from hymeko_x.mcp.folder import Folder
from hymeko_x.mcp.run import run

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

INSTRUCTIONS = """Robot models (URDF, xacro, MJCF, USD, SDF, HyMeKo text, JSON): convert, verify, compare, inspect.
Paths are relative to the one folder that the tools may use. The first line of each answer is the exit code; messages have codes such as
HX040, which `explain` explains. After a conversion call `verify` with both files: it asks the engines of the formats, not the converter."""


class Tools(Struct, frozen=True):
    """The tools of one folder."""

    folder: Folder

    async def convert(self, source: str, output: str, target: str = "", keep: bool = False) -> str:
        """Convert a robot file into the format of the output's suffix (.urdf .xml .usda .sdf .xacro .hymeko .json), with its meshes.

        The answer lists what got lost. `target` names a program that the output is for (mujoco, ros2, newton, ...); `keep` writes what
        the format cannot represent into a file beside the output, from which it comes back.
        """
        words = [self.folder.input(source), self.folder.output(output)]
        return await self._run("convert", *words, *([f"--for={target}"] if target else []), *(["--keep"] if keep else []))

    async def check(
        self,
        path: str,
        profile: Literal["usual", "kinematics", "simulation", "display", "complete"] = "usual",
        links: int | None = None,
        joints: int | None = None,
    ) -> str:
        """Check whether a robot is complete and plausible; the diagnostics have codes, lines and hints.

        `complete` are the six checks of a generated robot (every link with visual, collision and inertia); `links` and `joints` are how
        many there should be.
        """
        counts = [f"--{name}={count}" for name, count in (("links", links), ("joints", joints)) if count is not None]
        profiles = [] if profile == "usual" else [f"--profile={profile}"]
        return await self._run("check", self.folder.input(path), *profiles, *counts)

    async def verify(self, a: str, b: str, samples: int = 100) -> str:
        """Tell whether two files are the same robot, by the formats' own engines: kinematics, inertias, limits, shapes, dynamics."""
        return await self._run("verify", self.folder.input(a), self.folder.input(b), f"--samples={samples}")

    async def diff(self, a: str, b: str) -> str:
        """List what differs between two robots, element by element and field by field; the formats may differ."""
        return await self._run("diff", self.folder.input(a), self.folder.input(b))

    async def info(self, path: str) -> str:
        """Tell what is in a robot file, as JSON: format, bodies, mass in kg, joints by kind, degrees of freedom, bases, sensors."""
        return await self._run("info", self.folder.input(path), "--json")

    async def dh(self, path: str, convention: Literal["standard", "modified", "hayati"] = "standard", tip: str = "") -> str:
        """Compute the Denavit-Hartenberg table of every chain, or of the one to the body `tip`. Angles in rad, lengths in m."""
        tips = [f"--tip={tip}"] if tip else []
        return await self._run("dh", self.folder.input(path), f"--convention={convention}", *tips)

    async def explain(self, code: str) -> str:
        """Explain the code of a message, such as HX040."""
        return await self._run("explain", "--", code, is_confined=False)

    async def graph(self, path: str, output: str, view: Literal["usual", "tree", "incidence"] = "usual", fold: bool = False) -> str:
        """Draw the hypergraph of a robot into a file: .svg, or text for Graphviz (.dot), Mermaid (.mmd) or D2 (.d2)."""
        views = [] if view == "usual" else [f"--view={view}"]
        words = [self.folder.input(path), f"--output={self.folder.output(output)}"]
        return await self._run("graph", *words, *views, *(["--fold"] if fold else []))

    async def _run(self, verb: str, *words: str, is_confined: bool = True) -> str:
        """Run a verb in the folder. Raises: ToolError when it has no answer."""
        answer = await run([verb, *(["--confine=."] if is_confined else []), *words], self.folder.root)
        if answer.is_failure:
            raise ToolError(answer.text)
        return answer.text


WRITING = ("convert", "graph")
NAMES = ("convert", "check", "verify", "diff", "info", "dh", "explain", "graph")


def make_server(root: Path) -> MCPServer:
    """The server of the tools for one folder."""
    server = MCPServer("hymeko-x", instructions=INSTRUCTIONS, log_level="WARNING")
    tools = Tools(Folder(root.resolve()))
    for name in NAMES:
        hints = ToolAnnotations(read_only_hint=name not in WRITING, open_world_hint=False)
        server.add_tool(_guarded(getattr(tools, name)), name=name, annotations=hints, structured_output=False)
    return server


def _guarded(tool: Callable[..., object]) -> Callable[..., object]:
    """The tool, whose refusals are answers that a model can read."""
    from functools import wraps

    @wraps(tool)
    async def guarded(**arguments: object) -> object:
        try:
            return await tool(**arguments)  # type: ignore[misc]
        except Refusal as refusal:
            raise ToolError(str(refusal)) from refusal

    return guarded
