"""Importing yourdfpy without trimesh, which it needs only to load meshes.

Importing trimesh takes half a second, which is half of a verification without meshes.
"""

from __future__ import annotations

import sys
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import Any

_PACKAGE = "trimesh"


class _Deferred(ModuleType):
    """Stands for a package: its attributes are types while another package is imported, and afterwards those of the package."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        spec = find_spec(name)
        self.__path__ = [] if spec is None else list(spec.submodule_search_locations or ())
        self.__spec__ = spec
        self._is_used = False

    def __getattr__(self, name: str) -> Any:
        """Only asked for what is not there."""
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(import_module(self.__name__), name) if self._is_used else object


def without_trimesh(name: str) -> Any:
    """The module of this name. What it uses of trimesh is imported when it is used."""
    if name in sys.modules or _PACKAGE in sys.modules:
        return import_module(name)
    deferred = _Deferred(_PACKAGE)
    sys.modules[_PACKAGE] = deferred
    try:
        return import_module(name)
    finally:
        deferred._is_used = True
        for loaded in [key for key in sys.modules if key.partition(".")[0] == _PACKAGE]:
            del sys.modules[loaded]
