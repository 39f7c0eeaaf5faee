"""MJCF in memory, compiled by MuJoCo."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import mujoco

from hymeko_x.verify.readers import in_own_thread

if TYPE_CHECKING:
    from collections.abc import Mapping


def load(main: bytes, contents: Mapping[str, bytes]) -> Any:
    """The mjModel of a text with the files to which it refers. Raises: ValueError, RuntimeError in MuJoCo's words.

    MuJoCo knows files in memory by their names without the folders; where two have the same name they are in a folder for a moment.
    """
    if len({Path(path).name for path in contents}) == len(contents):
        return in_own_thread(lambda: mujoco.MjModel.from_xml_string(main.decode(), dict(contents)))
    with TemporaryDirectory() as folder:
        root = Path(folder, "robot")
        for path, data in {**contents, "robot.xml": main}.items():
            place = root / path
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(data)
        return in_own_thread(lambda: mujoco.MjModel.from_xml_path(str(root / "robot.xml")))
