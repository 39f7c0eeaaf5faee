"""The rule of libsdformat for names in a file, as a checker of ours for tests, and libsdformat itself where it is installed.

Source: libsdformat 12, Element::HasUniqueChildNames with its NameUniquenessExceptions (plugins), recursiveSiblingUniqueNames,
recursiveSiblingNoDoubleColonInNames, isReservedName. What is in a plugin or in an element with a prefix is free.
"""

from __future__ import annotations

import ctypes.util
import subprocess
import sys
from xml.etree import ElementTree

_SIBLINGS = {"world", "model", "link", "joint", "visual", "collision", "sensor", "light", "frame"}
_REFUSED_BY = """import ctypes, sys
sys.exit(ctypes.CDLL(sys.argv[1]).cmdCheck(sys.argv[2].encode()) != 0)"""


def refused_names(text: str) -> list[str]:
    """One line for each name in the text of an SDF file for which libsdformat refuses the file."""
    found = []
    for element in ElementTree.fromstring(text).iter():
        children = [child for child in element if child.tag != "plugin" and "name" in child.attrib]
        names = [child.attrib["name"] for child in children] if element.tag in _SIBLINGS else []
        for child, name in zip(children, names, strict=False):
            if names.count(name) > 1:
                found.append(f"{child.tag} '{name}' in {element.tag} '{element.get('name')}' shares its name")
            if child.tag in _SIBLINGS and (not name or name == "world" or "::" in name or (name[:2] == name[-2:] == "__")):
                found.append(f"{child.tag} has the reserved name '{name}'")
    return found


def library() -> str | None:
    """The shared library of libsdformat, or None."""
    names = (ctypes.util.find_library(f"sdformat{version}") for version in range(16, 11, -1))
    return next((name for name in names if name), None)


def is_accepted(path: str) -> bool:
    """Whether ``gz sdf --check`` accepts the file. Only where :func:`library` finds libsdformat."""
    return subprocess.run([sys.executable, "-c", _REFUSED_BY, str(library()), path], capture_output=True, check=False).returncode == 0
