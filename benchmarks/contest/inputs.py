"""The robots that are converted: made ones of every size, and a real one. None has meshes, which everybody reads differently."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct

from benchmarks.robots import robots
from benchmarks.speed import without_meshes

if TYPE_CHECKING:
    from pathlib import Path

LIMB = 8
"""Links in a limb: parsers that call themselves once per level get no deeper than that."""

REAL = {"urdf": ("panda.urdf", "Panda"), "mjcf": ("panda_free_base.xml", "Panda")}
SUFFIXES = {"urdf": ".urdf", "mjcf": ".xml", "usd": ".usda"}


class Input(Struct, frozen=True):
    """A file, what it is called in the results, and how many links it has, which is 0 for a real robot."""

    name: str
    links: int
    path: Path


def made(format: str, links: int, folder: Path) -> Input:
    """A body with limbs: every link has a mass, a tensor, a box and a hinge with limits."""
    path = folder / f"robot_{links}{SUFFIXES[format]}"
    path.write_text(_urdf(links) if format == "urdf" else _mjcf(links), "utf-8")
    return Input(f"{links:,} links", links, path)


def real(format: str, folder: Path) -> Input:
    """A Panda arm with its hand."""
    file, name = REAL[format]
    text = without_meshes(robots(format, (file,))[0])
    assert text is not None
    path = folder / f"real{SUFFIXES[format]}"
    path.write_text(text, "utf-8")
    return Input(name, 0, path)


def _urdf(links: int) -> str:
    tensor = '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.015"/>'
    inertial = f'<inertial><origin xyz="0 0 0.05"/><mass value="1.5"/>{tensor}</inertial>'
    box = '<origin xyz="0 0 0.05"/><geometry><box size="0.05 0.05 0.1"/></geometry>'
    inside = f"{inertial}<visual>{box}</visual><collision>{box}</collision>"
    parts = ['<robot name="robot">', *(f'<link name="link{i}">{inside}</link>' for i in range(links))]
    for i in range(1, links):
        above = 0 if i % LIMB == 1 else i - 1
        ends = f'<parent link="link{above}"/><child link="link{i}"/><origin xyz="0 0 0.1" rpy="0 0.1 0"/><axis xyz="0 1 0"/>'
        parts.append(f'<joint name="joint{i}" type="revolute">{ends}<limit lower="-1" upper="1.5" effort="20" velocity="3"/></joint>')
    return "\n".join([*parts, "</robot>\n"])


def _mjcf(links: int) -> str:
    inside = '<inertial pos="0 0 0.05" mass="1.5" diaginertia="0.01 0.02 0.015"/>'
    box = '<geom type="box" size="0.025 0.025 0.05" pos="0 0 0.05"/>'
    parts = ['<mujoco model="robot"><compiler angle="radian"/><worldbody>', f'<body name="link0">{inside}{box}']
    for i in range(1, links):
        joint = f'<joint name="joint{i}" type="hinge" axis="0 1 0" range="-1 1.5"/>'
        parts.append(f'<body name="link{i}" pos="0 0 0.1" euler="0 0.1 0">{inside}{joint}{box}')
        if i % LIMB == 0 or i == links - 1:
            parts.append("</body>" * ((i - 1) % LIMB + 1))
    return "\n".join([*parts, "</body></worldbody></mujoco>\n"])
