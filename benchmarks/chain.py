"""A chain of 100,000 links through URDF -> HyMeKo -> URDF: the time per link must not grow with the length.

python -m benchmarks.chain [LINKS]
"""

from __future__ import annotations

import sys
import time

import hymeko_x as hx
from benchmarks.yardstick import verdict


def main() -> int:
    """Compare the time per link of a long chain with that of one a tenth as long."""
    links = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000
    short, long = _seconds(links // 10) / (links // 10), _seconds(links) / links
    return 0 if verdict(f"time per link, {links} links / {links // 10} links", long / short, 1.5, at_least=False) else 1


def _seconds(links: int) -> float:
    urdf = chain(links)
    start = time.process_time()
    robot = hx.loads(urdf, "urdf")
    read = time.process_time()
    text = hx.dumps(robot, "hymeko")
    printed = time.process_time()
    again = hx.loads(text, "hymeko")
    parsed = time.process_time()
    back = hx.dumps(again, "urdf")
    end = time.process_time()
    assert again == robot
    assert back.count("<link ") == links
    steps = f"read {read - start:.2f} s, print {printed - read:.2f} s, parse {parsed - printed:.2f} s, write {end - parsed:.2f} s"
    print(f"{links} links: {end - start:.2f} s of processor time ({steps})")
    return end - start


def chain(links: int) -> str:
    """A URDF with this many links, each hanging on the one before."""
    parts = ['<robot name="chain">', *(f'<link name="l{i}"><inertial><mass value="1"/></inertial></link>' for i in range(links))]
    for i in range(1, links):
        ends = f'<parent link="l{i - 1}"/><child link="l{i}"/>'
        parts.append(f'<joint name="j{i}" type="continuous">{ends}<origin xyz="0 0 0.1"/><axis xyz="0 1 0"/></joint>')
    return "\n".join([*parts, "</robot>"])


if __name__ == "__main__":
    sys.exit(main())
