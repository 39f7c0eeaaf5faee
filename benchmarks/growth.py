"""Robots of 1,000 and 100,000 links, as a chain and as a tree: the time per link must not grow with the number of links.

python -m benchmarks.growth [LINKS [WAY ...]]   (default 100,000, and every way)

A process for each way measures small robots, a large one, and small robots again, and all that twice more; the median of the three
ratios counts, each of which compares what ran within a minute, since the pace of a machine may change. All robots have other names
and numbers, so that none finds in a cache what another one left there. What grows as well are the caches that miss: how much that
is shows in what XML alone takes, and MuJoCo where it ends.
"""

from __future__ import annotations

import gc
import statistics
import subprocess
import sys
import time
from itertools import count
from typing import TYPE_CHECKING

import hymeko_x as hx
from benchmarks.yardstick import verdict

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    Work = Callable[[], object]

BOUND = 1.2
SHAPES: Mapping[str, int] = {"chain": 1, "tree": 4}
"""How many links hang on each."""
ROUNDS = 3
"""How many large robots are converted."""
SMALL = 32
"""How many small robots are converted before each large one, and after it: seconds, as the machine's pace changes within seconds."""
LIMIT = 3600.0
"""Seconds after which nobody waits for a process any longer."""


def main(links: int, names: tuple[str, ...]) -> int:
    """All ways for both shapes; the exit code is 1 when one of ours grows too much."""
    kept = True
    for shape in SHAPES:
        for name in names or (*WAYS, *YARDSTICKS):
            rounds = _asked(shape, name, links)
            grown = statistics.median([large / small for small, large in rounds])
            printed = ", ".join(f"{small * 1e6:.1f} -> {large * 1e6:.1f}" for small, large in rounds)
            print(f"{shape}, {name}: {printed} us per link, {grown:.2f} times", flush=True)
            if name in WAYS:
                kept = verdict(f"  growth from {links // 100} to {links} links", grown, BOUND, at_least=False) and kept
    return 0 if kept else 1


def _asked(shape: str, name: str, links: int) -> list[tuple[float, float]]:
    """The times per link in s of a way, for few links and for many, as another process says them; infinite where it does not end."""
    command = [sys.executable, "-m", "benchmarks.growth", "--measure", shape, name, str(links)]
    try:
        printed = subprocess.run(command, capture_output=True, check=True, timeout=LIMIT, text=True).stdout.splitlines()
        return [(float(small), float(large)) for small, large in map(str.split, printed)]
    except subprocess.SubprocessError:
        return [(1.0, float("inf"))]


def _measured(shape: str, name: str, links: int) -> Iterator[tuple[float, float]]:
    """The mean time per link of small robots, and that of a large one between them, in each round."""
    prepared, few, fan = {**WAYS, **YARDSTICKS}[name], links // 100, SHAPES[shape]
    numbers = count()
    prepared(robot(few, fan, next(numbers)))()
    for _ in range(ROUNDS):
        small = [prepared(robot(few, fan, next(numbers))) for _ in range(2 * SMALL)]
        large = prepared(robot(links, fan, next(numbers)))
        before = [*map(_seconds, small[:SMALL])]
        many_links = _seconds(large)
        after = [*map(_seconds, small[SMALL:])]
        yield statistics.mean([*before, *after]) / few, many_links / links


def _seconds(work: Work) -> float:
    gc.collect()
    start = time.process_time()
    work()
    return time.process_time() - start


# ---- ways ------------------------------------------------------------------------------------------------------------------


def _from_urdf(target: str) -> Callable[[str], Work]:
    return lambda urdf: lambda: hx.dumps(hx.loads(urdf, "urdf").mechanism, target)


def _from_sdf(urdf: str) -> Work:
    text = hx.dumps(hx.loads(urdf, "urdf").mechanism, "sdf")
    return lambda: hx.dumps(hx.loads(text, "sdf").mechanism, "urdf")


def _to_urdf(urdf: str) -> Work:
    mjcf = hx.dumps(hx.loads(urdf, "urdf").mechanism, "mjcf")
    return lambda: hx.dumps(hx.loads(mjcf, "mjcf").mechanism, "urdf")


def _print(urdf: str) -> Work:
    mechanism = hx.loads(urdf, "urdf").mechanism
    return lambda: hx.dumps(mechanism, "hymeko")


def _parse(urdf: str) -> Work:
    text = hx.dumps(hx.loads(urdf, "urdf").mechanism, "hymeko")
    return lambda: hx.loads(text, "hymeko").mechanism


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
    "URDF -> SDF": _from_urdf("sdf"),
    "SDF -> URDF": _from_sdf,
}
YARDSTICKS: Mapping[str, Callable[[str], Work]] = {"lxml reads the URDF": _xml, "MuJoCo, URDF -> MJCF": _mujoco}


def robot(links: int, fan: int, number: int) -> str:
    """A URDF with this many links, ``fan`` of them on each, whose names, masses and places are those of no other ``number``."""
    parts = ['<robot name="grown">']
    for i in range(links):
        value = 1.0 + (number + 2) * 0.001 + i * 1e-6
        tensor = f'<inertia ixx="{value:.6f}" ixy="0" ixz="0" iyy="{value:.6f}" iyz="0" izz="{value:.6f}"/>'
        shape = '<collision><geometry><box size="0.1 0.1 0.2"/></geometry></collision>'
        parts.append(f'<link name="l{number}_{i}"><inertial><mass value="{value:.6f}"/>{tensor}</inertial>{shape}</link>')
    for i in range(1, links):
        ends = f'<parent link="l{number}_{(i - 1) // fan}"/><child link="l{number}_{i}"/>'
        place = f'<origin xyz="0 {i * 1e-6:.6f} 0.{number + 2:03d}"/><axis xyz="0 1 0"/>'
        parts.append(f'<joint name="j{number}_{i}" type="continuous">{ends}{place}</joint>')
    return "\n".join([*parts, "</robot>"])


if __name__ == "__main__":
    if sys.argv[1:2] == ["--measure"]:
        for small, large in _measured(sys.argv[2], sys.argv[3], int(sys.argv[4])):
            print(small, large, flush=True)
    else:
        sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 100_000, tuple(sys.argv[2:])))
