"""What a robot of the public API holds: its mechanism, the files that it refers to, and its elements by name."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from hymeko_x import pipeline
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.diagnostics import Report
from hymeko_x.robot.draft import Draft
from hymeko_x.robot.named import Named

if TYPE_CHECKING:
    from typing import Self

    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.source import Files


class RobotData(Named):
    """A mechanism that never changes, and ``files``, which finds its meshes and images."""

    def __init__(self, mechanism: Mechanism, files: Files | None = None) -> None:
        self.mechanism = mechanism
        self.files: Files = DiskFiles(Path(mechanism.source.file).parent) if files is None else files

    @property
    def name(self) -> str:
        """The name of the robot."""
        return self.mechanism.name

    @cached_property
    def draft(self) -> Draft:
        """The tables behind the mappings."""
        return Draft(self.mechanism, lambda: self.completed, is_locked=True)

    @property
    def completed(self) -> Mechanism:
        """The mechanism with what only the engine of its format computes, such as inertias from shapes."""
        return self._completed

    @cached_property
    def _completed(self) -> Mechanism:
        return pipeline.fully_completed(self.mechanism, self.files, Report())

    @cached_property
    def inlined(self) -> Mechanism:
        """The mechanism without files that name its elements."""
        return pipeline.inlined(self.mechanism, self.files)

    def changed(self, mechanism: Mechanism, files: Files | None = None) -> Self:
        """A robot of another mechanism, with the files of this one unless others are given."""
        return type(self)(mechanism, self.files if files is None else files)
