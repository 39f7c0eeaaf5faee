"""Robots by name instead of by path: those of the package robot_descriptions, where it is installed, and those of the catalogue.

`panda_mj_description` is a name of robot_descriptions, which takes it from its cache, or else clones it by its own code.
`PACKAGE/robot.urdf` is a robot of the catalogue whose package has been fetched.
"""

from __future__ import annotations

import os
import re
import sys
from contextlib import redirect_stdout
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x import codes
from hymeko_x.diagnostics import refuse

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from hymeko_x.corpus.catalog import WheelPackage

_DESCRIPTION = re.compile(r"\w+_description")
_LIBRARY = "robot_descriptions"
_PATHS = ("URDF_PATH", "MJCF_PATH", "XACRO_PATH")


class Located(NamedTuple):
    """The file that a word stands for, and the arguments that it is expanded with unless the user gives others."""

    path: str
    arguments: Mapping[str, str] = {}


def located(word: str) -> Located:
    """The file for a word: itself where there is such a file or where it is no name of a robot.

    Raises: Refusal HX001 when it is the name of a robot that is not there.
    """
    if word == "-" or os.path.exists(word):
        return Located(word)
    if _DESCRIPTION.fullmatch(word):
        return _described(word)
    package, slash, name = word.partition("/")
    if slash and re.fullmatch(r"[\w-]+", package):
        from hymeko_x.corpus import catalog

        found = next((row for row in catalog.load() if row.name == package.replace("-", "_")), None)
        if found is not None:
            return Located(_fetched(found, name))
    return Located(word)


def _described(name: str) -> Located:
    """The file of a robot of robot_descriptions."""
    if find_spec(_LIBRARY) is None:
        hint = f"'{name}' looks like a name of {_LIBRARY}: pip install {_LIBRARY}"
        raise refuse(codes.CANNOT_READ, f"there is no file '{name}'", hint=hint)
    if find_spec(f"{_LIBRARY}.{name}") is None:
        near = _near(name, descriptions())
        hint = f"did you mean {near}?" if near else "`hymeko-x corpus search WORD` lists names"
        raise refuse(codes.CANNOT_READ, f"neither a file nor {_LIBRARY} has the name '{name}'", hint=hint)
    try:
        with redirect_stdout(sys.stderr):  # it tells there that it clones
            module = import_module(f"{_LIBRARY}.{name}")
    except Exception as error:  # its own code clones by git, which can fail in any way
        reason = " ".join(str(error).split())[:200]
        raise refuse(codes.CANNOT_READ, f"{_LIBRARY} cannot provide '{name}': {reason}") from error
    path = next((str(getattr(module, attribute)) for attribute in _PATHS if hasattr(module, attribute)), None)
    if path is None:
        raise refuse(codes.CANNOT_READ, f"'{name}' of {_LIBRARY} is no robot that can be read")
    return Located(path, dict(getattr(module, "XACRO_ARGS", {})) if not hasattr(module, "URDF_PATH") else {})


def _near(name: str, known: Iterable[str]) -> str:
    """Names that were probably meant, joined by ``or``."""
    from difflib import get_close_matches

    return " or ".join(get_close_matches(name, list(known), 3))


def descriptions() -> Iterator[str]:
    """The names of robot_descriptions; none where it is not installed."""
    if find_spec(_LIBRARY) is None:
        return
    folder = os.path.dirname(str(import_module(_LIBRARY).__file__))
    yield from sorted(name.removesuffix(".py") for name in os.listdir(folder) if name.endswith("_description.py") and name[0] != "_")


# ---- the catalogue ---------------------------------------------------------------------------------------------------------


def catalogued(package: WheelPackage) -> dict[str, str]:
    """The robots of a package, each by the shortest end of its path that no other one has, with its path there."""
    paths = [path for _, path in package.listed()]
    found = {}
    for path in paths:
        parts = path.split("/")
        ends = ("/".join(parts[-count:]) for count in range(1, len(parts) + 1))
        found[next(end for end in ends if sum(other == end or other.endswith(f"/{end}") for other in paths) == 1)] = path
    return found


def _fetched(package: WheelPackage, name: str) -> str:
    """The path of a robot of the catalogue in the user's cache."""
    from hymeko_x.corpus import cache

    robots = catalogued(package)
    path = robots.get(name) or next((path for path in robots.values() if path == name), None)
    if path is None:
        near = _near(name, robots)
        hint = f"did you mean {near}?" if near else f"`hymeko-x corpus search {package.name}` lists its robots"
        raise refuse(codes.CANNOT_READ, f"{package.name} has no robot '{name}'", hint=hint)
    root = cache.cache_root(os.environ)
    if not cache.is_fetched(package, root):
        raise refuse(codes.CANNOT_READ, f"the package {package.name} is not here", hint=f"hymeko-x corpus fetch {package.name}")
    return str(cache.package_path(package, root) / path)


def matching(word: str) -> Iterator[tuple[str, str, str]]:
    """The robots whose name or package contains a word: name, format, and whether it is here; those of robot_descriptions without both."""
    from hymeko_x.corpus import cache, catalog

    wanted = word.lower()
    root = cache.cache_root(os.environ)
    for package in catalog.load():
        formats = {path: format for format, path in package.listed()}
        here = "yes" if cache.is_fetched(package, root) else "no"
        for name, path in catalogued(package).items():
            if wanted in f"{package.name}/{path}".lower():
                yield f"{package.name}/{name}", formats[path], here
    for name in descriptions():
        if wanted in name:
            yield name, "-", "-"
