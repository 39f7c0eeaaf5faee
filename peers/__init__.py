"""Other people's programs that the tests and benchmarks compare with, each in an environment of its own.

They cannot share ours: some bring their own build of USD, others pin an older MuJoCo. ``python -m peers`` makes the
environments below ``.peers/``; without them the tests that need one are skipped with that reason.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msgspec import Struct

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

ROOT = Path(__file__).parents[1] / ".peers"
_DRIVERS = Path(__file__).parent / "drivers"


class Peer(Struct, frozen=True):
    """A program: its name in the package index, further requirements, and the driver that runs in its environment.

    One without requirements runs in our environment, which has it.
    """

    name: str
    requirements: tuple[str, ...]
    driver: str

    @property
    def python(self) -> Path:
        """The interpreter of its environment, which need not exist."""
        if not self.requirements:
            return Path(sys.executable)
        return ROOT / self.name / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")

    def is_installed(self) -> bool:
        """Whether ``python -m peers`` has made its environment."""
        return not self.requirements or (ROOT / self.name / ".installed").exists()

    def command(self, *jobs: Mapping[str, Any]) -> list[str]:
        """The command line of its driver: a process that does these jobs, or those that it reads from stdin if there is none."""
        return [str(self.python), str(_DRIVERS / self.driver), *map(json.dumps, jobs)]

    def install(self) -> None:
        """Make the environment from the package index. Raises: subprocess.CalledProcessError."""
        subprocess.run([sys.executable, "-m", "venv", "--clear", str(ROOT / self.name)], check=True)
        command = [str(self.python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *self.requirements]
        subprocess.run(command, check=True)
        (ROOT / self.name / ".installed").touch()

    def run(self, jobs: Iterable[Mapping[str, Any]], timeout: float = 600.0) -> list[dict[str, Any]]:
        """The answers of the driver to all jobs, in one process so that imports are paid once.

        A job that fails has ``error``. When the process dies, so have all jobs that it did not answer.
        """
        asked = [json.dumps(job) for job in jobs]
        done = subprocess.run(self.command(), input="\n".join(asked), capture_output=True, text=True, timeout=timeout, check=False)
        answers = [json.loads(line[2:]) for line in done.stdout.splitlines() if line.startswith("> ")]
        reason = done.stderr.strip().splitlines()[-1:] or [f"exit {done.returncode}"]
        return answers + [{"error": f"the process died: {reason[0]}"}] * (len(asked) - len(answers))


URDF_USD_CONVERTER = Peer("urdf-usd-converter", ("urdf-usd-converter==0.3.4",), "urdf_usd.py")
MUJOCO_USD_CONVERTER = Peer("mujoco-usd-converter", ("mujoco-usd-converter==0.8.0",), "mujoco_usd.py")
CYBERWAVE = Peer("cyberwave-robot-format", ("cyberwave-robot-format[usd]==0.1.8",), "cyberwave.py")
SCIKIT_ROBOT = Peer("scikit-robot", ("scikit-robot==0.4.7", "usd-core==26.11"), "scikit.py")
NEWTON = Peer(
    "newton",
    (
        "newton==1.8.0",
        "newton-usd-schemas==0.6.0",
        "usd-core>=25.5,<26.9",
        "mujoco~=3.17.0",
        "trimesh>=4.6.8",
        "scipy>=1.11",
        "pillow>=11.3",
        "pycollada>=0.9",
        "resolve-robotics-uri-py>=0.5.1",
    ),
    "newton_models.py",
)
VALIDATOR = Peer("usd-validation-nvidia", ("usd-validation-nvidia==1.22.0", "usd-core==26.11", "numpy"), "validator.py")
URDF2MJCF = Peer("urdf2mjcf", ("urdf2mjcf==0.2.39",), "urdf2mjcf_run.py")
URDF_TO_MJCF = Peer("urdf-to-mjcf", ("urdf-to-mjcf==0.1.1",), "urdf_to_mjcf_run.py")
MJCF_URDF = Peer("mjcf-urdf-simple-converter", ("mjcf-urdf-simple-converter==0.7.3",), "mjcf_urdf.py")
IDYNTREE = Peer("idyntree", ("idyntree==15.1.0",), "idyntree_urdf.py")
HYMEKO_X = Peer("hymeko-x", (), "hymeko.py")
MUJOCO = Peer("mujoco", (), "mujoco_import.py")
YOURDFPY = Peer("yourdfpy", (), "yourdfpy_load.py")
PEERS = (URDF_USD_CONVERTER, MUJOCO_USD_CONVERTER, CYBERWAVE, SCIKIT_ROBOT, NEWTON, VALIDATOR, URDF2MJCF, URDF_TO_MJCF, MJCF_URDF, IDYNTREE)
CONVERTERS = {"urdf": (URDF_USD_CONVERTER, CYBERWAVE, SCIKIT_ROBOT), "mjcf": (MUJOCO_USD_CONVERTER, CYBERWAVE)}
"""Who converts which format to USD."""
