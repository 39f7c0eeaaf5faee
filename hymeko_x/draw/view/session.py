"""A viewer at work: files read, robots moved, files read again when they change, findings when the verifier has them."""

from __future__ import annotations

import posixpath
import threading
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hymeko_x.assets.shelf import safe_name
from hymeko_x.diagnostics import Refusal
from hymeko_x.draw.comparison.facts import lines_of, losses_of
from hymeko_x.draw.comparison.rows import answer, gap_line
from hymeko_x.draw.view.findings import spots_of
from hymeko_x.draw.view.motion import Partner, PosedRobot
from hymeko_x.draw.view.page import ViewPage
from hymeko_x.draw.view.scene import scene_of
from hymeko_x.draw.view.watch import FileWatch
from hymeko_x.robot import Robot
from hymeko_x.verify.model import KinematicModel, world_body

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import viser

    from hymeko_x.draw.comparison.facts import Side
    from hymeko_x.draw.view.scene import Scene
    from hymeko_x.verify.model import Array
    from hymeko_x.verify.verdict import Verdict

PERIOD = 0.5
"""Seconds between two looks at the files."""


class Session:
    """One or two robots on a page.

    ``read`` reads the robot in a file, ``verify`` gives the verdict about two files. A file that a browser sends is put into ``folder``.
    Raises: Refusal when a file cannot be read at first; later the page shows why.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        paths: Sequence[str],
        read: Callable[[str], Side],
        verify: Callable[[str, str], Verdict],
        folder: str | Path,
    ) -> None:
        self._paths, self._read, self._verify = list(paths), read, verify
        self._folder = Path(folder)
        self._lock = threading.RLock()
        self._stopped = threading.Event()
        self._round = 0
        self.page = ViewPage(server, self._move, self._place, self.compare_with)
        self.sides: Sequence[Side] = ()
        self.scenes: Sequence[Scene] = ()
        self.motion = PosedRobot(KinematicModel("", "", "", (world_body(),)))
        self.partner: Partner | None = None
        self._show(self._paths)

    # ---- reading ---------------------------------------------------------------------------------------------------------

    def _show(self, paths: Sequence[str]) -> None:
        """Read robots, and show them where the joints of the last ones were as far as these have them."""
        sides = [self._read(path) for path in paths]
        scenes = [scene_of(Robot(side.mechanism, side.source.files)) for side in sides]
        self._paths = list(paths)
        self._take(sides, scenes)

    def compare_with(self, name: str, content: bytes) -> None:
        """Show a file that a browser sent as the second robot; an error is shown in the page, and the robots stay."""
        path = self._folder / safe_name(posixpath.basename(name.replace("\\", "/")))
        path.write_bytes(content)
        self._try([self._paths[0], str(path)])

    def _take(self, sides: Sequence[Side], scenes: Sequence[Scene]) -> None:
        with self._lock:
            before = {slider.label: self._value(slider.dof) for slider in self.motion.sliders}
            self.sides, self.scenes = sides, scenes
            self._watch = FileWatch(_files(sides))
            self.motion = PosedRobot(scenes[0].model)
            self.partner = Partner(self.motion, scenes[1].model) if len(scenes) > 1 else None
            for slider in self.motion.sliders:
                if slider.lower <= before.get(slider.label, np.nan) <= slider.upper:
                    self.motion.move(slider.dof, before[slider.label])
            self.page.show(scenes, self.motion.sliders)
            self._place()
            self.page.show_problem("")
            self._round += 1
            finder = threading.Thread(target=self._find, args=(self._round,), daemon=True)
            finder.start()
            self._finder = finder  # from now on: :meth:`stop` waits for it

    def _find(self, number: int) -> None:
        """What got lost, and what the verifier says, as soon as it does."""
        missing = [line for scene in self.scenes for line in scene.missing]
        lists: list[tuple[str, Sequence[str]]] = [("not drawn", missing)]
        spots, words = [], ""
        if self.partner is not None:
            lost = lines_of(losses_of(*self.sides))
            try:
                verdict = self._verify(self._paths[0], self._paths[1])
            except Refusal as refusal:
                words = f"not verified: {refusal.diagnostic.message}"
            else:
                words = answer(verdict)
                spots = spots_of(verdict, *(scene.model for scene in self.scenes))
                lists += [("not compared", [*map(gap_line, verdict.gaps), *verdict.not_compared])]
            lists.insert(0, ("what B does not have as A has it", lost))
        with self._lock:
            if number == self._round and (words or missing):
                self.page.show_findings(words or "notes", spots, lists)

    def watch(self) -> None:
        """Look at the files until the session is stopped."""
        while not self._stopped.wait(PERIOD):
            self.look()

    def look(self) -> bool:
        """Read the robots again if a file has changed; an error is shown in the page, and the robots stay."""
        if not self._watch.has_changed():
            return False
        self._try(self._paths)
        return True

    def _try(self, paths: Sequence[str]) -> None:
        """Show robots; an error is shown in the page, and the last ones stay."""
        try:
            self._show(paths)
        except Refusal as refusal:
            self.page.show_problem(str(refusal.diagnostic))

    def stop(self) -> None:
        """End :meth:`watch`, and wait for the verifier."""
        self._stopped.set()
        with self._lock:
            self._round += 1
        self._finder.join()

    # ---- moving ----------------------------------------------------------------------------------------------------------

    def _move(self, number: int, value: float) -> None:
        """A user has moved a slider."""
        with self._lock:
            if number < len(self.motion.sliders):
                self.motion.move(self.motion.sliders[number].dof, value)
                self._place()

    def _place(self) -> None:
        """Put both robots where they are now, and the sliders as well."""
        with self._lock:
            self.page.set_sliders([self._value(slider.dof) for slider in self.motion.sliders])
            self.page.place(0, self.motion.poses(), np.zeros(3))
            if self.partner is not None:
                self.partner.follow()
                self.page.place(1, self.partner.motion.poses(), self._offset())

    def _offset(self) -> Array:
        """Where the second robot stands: beside the first one, or in the same place."""
        is_apart = self.page.layout.value == "side by side"
        self.page.overlay(is_overlaid=not is_apart)
        return np.array([0.0, -self.page.distance * is_apart, 0.0])

    def _value(self, dof: int) -> float:
        return float(self.motion.q[self.motion.model.columns[dof]])


def _files(sides: Sequence[Side]) -> list[str]:
    """The files of the robots, and those that they include."""
    included = {origin.file for side in sides for origin in side.mechanism.origins.values()}
    return sorted({side.source.name for side in sides} | {name for name in included if not name.startswith("<")})
