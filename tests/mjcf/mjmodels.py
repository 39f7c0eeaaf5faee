"""Two compiled models compared field by field: what MuJoCo made of a file is the judge."""

from __future__ import annotations

import contextlib
import os
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from msgspec import Struct
from mujoco.introspect import structs

from hymeko_x.backends import hymeko as hymeko_out
from hymeko_x.backends import mjcf as mjcf_out
from hymeko_x.diagnostics import Report
from hymeko_x.frontends import hymeko as hymeko_in
from hymeko_x.frontends import mjcf as mjcf_in
from hymeko_x.rewrite.context import Options
from hymeko_x.source import Source

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from hymeko_x.ir.mechanism import Mechanism

# Where files lie, and how large buffers are: not what the model is.
_STORAGE = {"paths", "npaths", "signature", "nbuffer", "mesh_pathadr", "hfield_pathadr", "tex_pathadr", "skin_pathadr"}
_FIELDS = [field.name for field in structs.STRUCTS["mjModel"].fields if field.name not in _STORAGE]
_PARTS = ("opt", "vis", "stat")


def differences(a: mujoco.MjModel, b: mujoco.MjModel) -> list[str]:
    """The fields of two models that are not equal bit for bit, names and their order included."""
    found = [name for name in _FIELDS if name not in _PARTS and not _equal(getattr(a, name, None), getattr(b, name, None))]
    for part in _PARTS:
        found += [f"{part}.{name}" for name in _inner(getattr(a, part), getattr(b, part))]
    return found


def _inner(a: object, b: object, path: str = "") -> Iterator[str]:
    for name in dir(a):
        if name.startswith("_"):
            continue
        one, other = getattr(a, name), getattr(b, name)
        if callable(one):
            continue
        if type(one).__module__.startswith("mujoco"):
            yield from _inner(one, other, f"{path}{name}.")
        elif not _equal(one, other):
            yield f"{path}{name}"


def _equal(a: object, b: object) -> bool:
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return a.shape == b.shape and bool(np.array_equal(a, b, equal_nan=a.dtype.kind == "f"))
    return a == b


class Folder(Struct, frozen=True):
    """The files beside a model."""

    path: Path

    def find(self, uri: str) -> str | None:
        found = self.path / uri
        return str(found) if found.is_file() else None

    def read(self, path: str) -> bytes:
        from pathlib import Path

        return Path(path).read_bytes()


def read(path: Path) -> Mechanism:
    """The mechanism in a file."""
    return mjcf_in.read(Source(path.name, path.read_bytes(), Folder(path.parent)), Report()).mechanism


def read_text(text: str, report: Report | None = None) -> Mechanism:
    """The mechanism in a piece of MJCF."""
    return mjcf_in.read(Source("robot.xml", text.encode()), Report() if report is None else report).mechanism


def write(mechanism: Mechanism) -> str:
    """The mechanism as MJCF."""
    return mjcf_out.write(mechanism, Options(), Report()).main.decode()


def through_hymeko(mechanism: Mechanism) -> Mechanism:
    """What is left of a mechanism after a visit to HyMeKo text."""
    text = hymeko_out.write(mechanism, Options(), Report()).main
    return hymeko_in.read(Source("robot.hymeko", text), Report()).mechanism


def compiled(text: str, folder: Path | None = None) -> mujoco.MjModel:
    """What MuJoCo makes of a text whose files lie in a folder."""
    with contextlib.chdir(folder or os.curdir):
        return mujoco.MjModel.from_xml_string(text)
