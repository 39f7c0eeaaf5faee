"""The catalogue of real robots in published packages: which wheels carry them, and which files the tests and the batch runs read.

The words are in `corpus/catalog.toml`; the wheel of hymeko-x carries a copy beside this file.
"""

from __future__ import annotations

import hashlib
import tomllib
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msgspec import Struct, field

from hymeko_x import codes
from hymeko_x.diagnostics import refuse

if TYPE_CHECKING:
    from collections.abc import Mapping

DATA_SUFFIXES = frozenset(
    (
        *(".urdf", ".xacro", ".xml", ".mjcf", ".sdf", ".srdf", ".usd", ".usda", ".usdc", ".usdz", ".world", ".config"),
        *(".stl", ".obj", ".mtl", ".dae", ".ply", ".glb", ".gltf", ".bin", ".msh", ".skn"),
        *(".png", ".jpg", ".jpeg", ".tga", ".tif", ".tiff", ".bmp", ".dds", ".exr"),
        *(".yaml", ".yml", ".json", ".txt", ".md", ".launch"),
    )
)
"""What is unpacked from a wheel: robot descriptions and what they refer to. Code and libraries stay in the archive."""

LICENCE_WORDS = ("licen", "copying", "copyright", "notice", "authors", "metadata")
"""A file without a known suffix is unpacked if its name begins with one of these (lower case)."""


class WheelPackage(Struct, frozen=True):
    """One published wheel that carries robots. ``only`` are path prefixes inside it; empty means everything.

    ``files`` are the development files by format, ``robots`` the others; ``arguments`` are xacro's, by path.
    """

    name: str
    version: str
    carries: str
    licence: str
    wheel: str
    bytes: int
    sha256: str
    only: tuple[str, ...]
    files: Mapping[str, tuple[str, ...]]
    robots: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    arguments: Mapping[str, Mapping[str, str]] = field(default_factory=dict)

    def listed(self) -> tuple[tuple[str, str], ...]:
        """Every robot of the package as (format, path), development files first."""
        return tuple((format, path) for lists in (self.files, self.robots) for format, paths in lists.items() for path in paths)

    @property
    def folder(self) -> str:
        """The name of its folder in the cache: another wheel, or other rules of unpacking, make another folder."""
        rules = "\n".join((self.sha256, *self.only, *sorted(DATA_SUFFIXES), *LICENCE_WORDS))
        return f"{self.name}-{self.version}-{hashlib.sha256(rules.encode()).hexdigest()[:8]}"

    def wants(self, member: str) -> bool:
        """Whether this path inside the wheel is data that the cache keeps."""
        if self.only and not member.startswith(self.only):
            return False
        path = Path(member.lower())
        return path.suffix in DATA_SUFFIXES or path.name.startswith(LICENCE_WORDS)


class DevelopmentFile(Struct, frozen=True):
    """A real robot that the tests read: its format, the package that carries it and its path inside that package."""

    format: str
    package: WheelPackage
    path: str

    @property
    def id(self) -> str:
        """A short name for test reports: package and file name."""
        return f"{self.package.name}/{Path(self.path).name}"


@cache
def load() -> tuple[WheelPackage, ...]:
    """Every package of the catalogue, in its order."""
    return parse(catalogue_path().read_text("utf-8"))


def parse(text: str) -> tuple[WheelPackage, ...]:
    """The packages that a catalogue in TOML names.

    Raises: KeyError, TypeError or tomllib.TOMLDecodeError when the catalogue is wrong, which is our mistake and not a user's.
    """
    return tuple(_package(row) for row in tomllib.loads(text)["package"])


def _package(row: Mapping[str, Any]) -> WheelPackage:
    lists = {key: {name: tuple(paths) for name, paths in row.get(key, {}).items()} for key in ("files", "robots")}
    return WheelPackage(**{**row, "only": tuple(row.get("only", ())), **lists})


def catalogue_path() -> Path:
    """Where the catalogue is: beside this file in an installed wheel, in `corpus/` of a checkout."""
    installed = Path(__file__).with_name("catalog.toml")
    return installed if installed.exists() else Path(__file__).parents[2] / "corpus" / "catalog.toml"


def select(names: tuple[str, ...]) -> tuple[WheelPackage, ...]:
    """The packages with these names (`-` and `_` count as the same, case does not), in catalogue order; all when there are none.

    Raises: Refusal HX211 when a name is not in the catalogue.
    """
    packages = load()
    wanted = {name.lower().replace("-", "_") for name in names}
    unknown = sorted(wanted - {package.name for package in packages})
    if unknown:
        known = ", ".join(package.name for package in packages)
        raise refuse(codes.PACKAGE_UNKNOWN, f"the catalogue has no package '{unknown[0]}'", hint=f"it has: {known}")
    return tuple(package for package in packages if not wanted or package.name in wanted)


def development_files(format: str) -> tuple[DevelopmentFile, ...]:
    """The real robots of one format that the tests read, in catalogue order."""
    return tuple(DevelopmentFile(format, package, path) for package in load() for path in package.files.get(format, ()))
