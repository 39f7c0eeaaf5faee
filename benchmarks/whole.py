"""`hymeko-x convert robot.urdf robot.xml` as a whole process, against a Python script that does the same with MuJoCo.

python -m benchmarks.whole [NAME]     (POSIX; the robot is taken without its meshes, by default a Panda)

Processor time and peak memory of whole processes, run in turns, medians; after one round in which Python compiles our modules.
"""

from __future__ import annotations

import statistics
import sys
import tempfile
from pathlib import Path

from benchmarks import process
from benchmarks.robots import robots
from benchmarks.speed import without_meshes
from benchmarks.yardstick import verdict

ROUNDS = 9
SCRIPT = """\
import sys
import mujoco
spec = mujoco.MjSpec.from_file(sys.argv[1])
spec.compile()
with open(sys.argv[2], "w") as out:
    out.write(spec.to_xml())
"""


def main(name: str) -> int:
    """Both bounds; the exit code is 1 when one is missed."""
    text = without_meshes(robots("urdf", (name,))[0])
    assert text is not None
    with tempfile.TemporaryDirectory() as folder:
        source, out = Path(folder, "robot.urdf"), str(Path(folder, "robot.xml"))
        source.write_text(text)
        ours = [sys.executable, "-m", "hymeko_x", "convert", str(source), out]
        theirs = [sys.executable, "-c", SCRIPT, str(source), out]
        runs = [(process.run(ours), process.run(theirs)) for _ in range(ROUNDS + 1)][1:]
    seconds = [statistics.median(run[side][0] for run in runs) for side in (0, 1)]
    memory = [statistics.median(run[side][1] for run in runs) for side in (0, 1)]
    print(f"{seconds[0]:.3f} s and {memory[0]:.1f} MB, MuJoCo {seconds[1]:.3f} s and {memory[1]:.1f} MB")
    kept = verdict("whole process, ours / MuJoCo, time", seconds[0] / seconds[1], 0.6, at_least=False)
    return 0 if verdict("whole process, ours / MuJoCo, peak memory", memory[0] / memory[1], 1.0, at_least=False) and kept else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else "panda.urdf"))
