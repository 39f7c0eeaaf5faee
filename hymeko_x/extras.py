"""Libraries that only some users need: the extra of the distribution that brings a library which is not installed."""

from __future__ import annotations

from traceback import extract_tb
from types import MappingProxyType
from typing import TYPE_CHECKING

from hymeko_x import codes, formats
from hymeko_x.diagnostics import refuse

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.diagnostics import Refusal

OF_ROOMS: Mapping[str, str] = MappingProxyType(
    {room: room for room in ("corpus", "draw", "dynamics", "mcp", "testing", "verify")} | {"server": "lsp"}
)
"""Rooms all of whose libraries come with one extra."""
OF_LIBRARIES: Mapping[str, str] = MappingProxyType(
    {
        **dict.fromkeys(("PIL", "collada", "networkx", "numpy", "scipy", "trimesh"), "meshes"),
        **dict.fromkeys(("filelock", "fsspec", "matplotlib", "pebble", "platformdirs", "polars", "rich"), "corpus"),
        **{library: extra for row in formats.FORMATS for library, extra in row.libraries.items()},
        **dict.fromkeys(("casadi", "sympy"), "dynamics"),
        "argcomplete": "completion",
        "coacd": "convex",
        "hypothesis": "testing",
        **dict.fromkeys(("imageio_ffmpeg", "resvg_py"), "draw"),
        "ray": "ray",
        "viser": "view",
        **dict.fromkeys(("lsprotocol", "pygls"), "lsp"),
        **dict.fromkeys(("anyio", "mcp"), "mcp"),
    }
)

PURPOSES: Mapping[str, str] = MappingProxyType(
    {
        "completion": "completion",
        "convex": "cutting meshes into convex parts",
        "corpus": "the catalogue of robots",
        "draw": "drawing",
        "dynamics": "computing equations",
        "lsp": "the language server",
        "mcp": "the server of tools",
        "meshes": "converting the meshes of this robot",
        "verify": "the verifier",
        "view": "the viewer",
    }
)
"""What an extra is for, where its libraries do not belong to one format."""


def install_command(extra: str) -> str:
    """The command that installs an extra."""
    return f"pip install 'hymeko-x[{extra}]'"


def missing_library(error: ModuleNotFoundError) -> Refusal | None:
    """The refusal HX011 with the command that installs the library; None where the missing module is no optional library."""
    library = (error.name or "").partition(".")[0]
    extra = OF_LIBRARIES.get(library)
    if extra is None:
        return None
    for frame in extract_tb(error.__traceback__):
        _, inside, path = frame.filename.replace("\\", "/").rpartition("/hymeko_x/")
        if inside:
            extra = OF_ROOMS.get(path.partition("/")[0], extra)
    return refuse(
        codes.LIBRARY_MISSING,
        f"{PURPOSES.get(extra, 'this')} needs the library {library}, which is not installed",
        hint=install_command(extra),
    )
