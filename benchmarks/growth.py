"""Robots of 1,000 to 100,000 links, as a chain and as a tree: the time per link must not grow with the number of links.

python -m benchmarks.growth [LINKS [WAY ...]]   (default 100,000, and every way)

Every figure is the processor time per link of a process of its own, in which each round has a robot with other numbers. What grows
there as well are the caches that miss: how much that is shows in what XML alone takes, and MuJoCo where it ends.
"""

from __future__ import annotations

import gc
import statistics
import subprocess
import sys
import time
from typing import TYPE_CHECKING

import hymeko_x as hx
from benchmarks.yardstick import verdict

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    Work = Callable[[], object]

BOUND = 1.2
SHAPES: Mapping[str, int] = {"chain": 1, "tree": 4}
"""How many links hang on each."""
ROUNDS = 20_000
"""How many links are converted in all, at least, by a process that measures."""
LIMIT = 900.0
"""Seconds after which nobody waits for a process any longer."""


def main(links: int, names: tuple[str, ...]) -> int:
    """All ways for both shapes; the exit code is 1 when one of ours grows too much."""
    kept = True
    for shape in SHAPES:
        for name in names or (*WAYS, *YARDSTICKS):
            times = [_asked(shape, name, size) for size in (links // 100, links // 10, links)]
            print(
                f"{shape}, {name}: {', '.join('no end' if time is None else f'{time * 1e6:.1f} us' for time in times)} per link", flush=True
            )
            if name in WAYS:
                growth = float("inf") if times[0] is None or times[-1] is None else times[-1] / times[0]
                kept = verdict(f"  growth from {links // 100} to {links} links", growth, BOUND, at_least=False) and kept
    return 0 if kept else 1


def _asked(shape: str, name: str, links: int) -> float | None:
    """The time per link in s of a way, as another process says it; None where it fails or does not end."""
    command = [sys.executable, "-m", "benchmarks.growth", "--measure", shape, name, str(links)]
    try:
        return float(subprocess.run(command, capture_output=True, check=True, timeout=LIMIT).stdout)
    except (subprocess.SubprocessError, ValueError):
        return None


def _measured(shape: str, name: str, links: int) -> float:
    """The median over several robots of the time per link; the first one only warms up where there are others."""
    prepared = {**WAYS, **YARDSTICKS}[name]
    rounds = max(1, ROUNDS // links)
    prepared(robot(1000, SHAPES[shape], -1))()
    times = [_seconds(prepared(robot(links, SHAPES[shape], number))) for number in range(rounds)]
    return statistics.median(times) / links


def _seconds(work: Work) -> float:
    gc.collect()
    start = time.process_time()
    work()
    return time.process_time() - start


# ---- ways ------------------------------------------------------------------------------------------------------------------


def _from_urdf(target: str) -> Callable[[str], Work]:
    return lambda urdf: lambda: hx.dumps(hx.loads(urdf, "urdf"), target)


def _to_urdf(urdf: str) -> Work:
    mjcf = hx.dumps(hx.loads(urdf, "urdf"), "mjcf")
    return lambda: hx.dumps(hx.loads(mjcf, "mjcf"), "urdf")


def _print(urdf: str) -> Work:
    mechanism = hx.loads(urdf, "urdf")
    return lambda: hx.dumps(mechanism, "hymeko")


def _parse(urdf: str) -> Work:
    text = hx.dumps(hx.loads(urdf, "urdf"), "hymeko")
    return lambda: hx.loads(text, "hymeko")


def _xml(urdf: str) -> Work:
    from lxml import etree

    return lambda: [(element.tag, dict(element.attrib)) for element in etree.fromstring(urdf, etree.XMLParser(huge_tree=True)).iter()]


def _mujoco(urdf: str) -> Work:
    import mujoco

    def work() -> str:
        spec = mujoco.MjSpec.from_string(urdf)
        spec.compile()
        return str(spec.to_xml())

    return work


WAYS: Mapping[str, Callable[[str], Work]] = {
    "URDF -> URDF": _from_urdf("urdf"),
    "URDF -> MJCF": _from_urdf("mjcf"),
    "MJCF -> URDF": _to_urdf,
    "HyMeKo printed": _print,
    "HyMeKo parsed": _parse,
    "URDF -> USD": _from_urdf("usd"),
}
YARDSTICKS: Mapping[str, Callable[[str], Work]] = {"lxml reads the URDF": _xml, "MuJoCo, URDF -> MJCF": _mujoco}


def robot(links: int, fan: int, number: int) -> str:
    """A URDF with this many links, ``fan`` of them on each, whose masses and places are those of no other ``number``."""
    parts = ['<robot name="grown">']
    for i in range(links):
        value = 1.0 + (number + 2) * 0.001 + i * 1e-6
        tensor = f'<inertia ixx="{value:.6f}" ixy="0" ixz="0" iyy="{value:.6f}" iyz="0" izz="{value:.6f}"/>'
        shape = '<collision><geometry><box size="0.1 0.1 0.2"/></geometry></collision>'
        parts.append(f'<link name="l{i}"><inertial><mass value="{value:.6f}"/>{tensor}</inertial>{shape}</link>')
    for i in range(1, links):
        ends = f'<parent link="l{(i - 1) // fan}"/><child link="l{i}"/>'
        place = f'<origin xyz="0 {i * 1e-6:.6f} 0.{number + 2:03d}"/><axis xyz="0 1 0"/>'
        parts.append(f'<joint name="j{i}" type="continuous">{ends}{place}</joint>')
    return "\n".join([*parts, "</robot>"])


if __name__ == "__main__":
    if sys.argv[1:2] == ["--measure"]:
        print(_measured(sys.argv[2], sys.argv[3], int(sys.argv[4])))
    else:
        sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 100_000, tuple(sys.argv[2:])))
