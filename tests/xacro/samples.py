"""Small xacro files in a folder of their own, and what reading them gives."""

from __future__ import annotations

from pathlib import Path

import pytest

from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.diagnostics import Diagnostic, Refusal, Report
from hymeko_x.frontends.xacro import read
from hymeko_x.frontends.xacro.child.limits import ExpansionLimits
from hymeko_x.frontends.xacro.expand import LIMITS, Expansion, expand
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.source import Source

ROOT = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'


def robot(body: str) -> str:
    """A xacro file whose body starts on line 2."""
    return f"{ROOT}\n{body}\n</robot>\n"


class Folder:
    """Files on disk, and reading one of them. Messages show their places from this folder on."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def put(self, name: str, text: str) -> Path:
        """Write a file; folders are made."""
        place = self.path / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text, "utf-8")
        return place

    def source(
        self,
        name: str = "r.xacro",
        *,
        packages: dict[str, Path] | None = None,
        search_path: tuple[Path, ...] = (),
        confine: Path | None = None,
        arguments: dict[str, str] | None = None,
        environment: dict[str, str] | None = None,
    ) -> Source:
        place = self.path / name
        files = DiskFiles(place.parent, packages or {}, search_path, confine)
        return Source(str(place), place.read_bytes(), files, arguments or {}, environment or {})

    def read(self, body: str, report: Report | None = None, **how: object) -> Mechanism:
        """The mechanism of ``r.xacro`` with this body."""
        self.put("r.xacro", robot(body))
        return read(self.source(**how), Report() if report is None else report).mechanism  # type: ignore[arg-type]

    def expand(self, body: str, limits: ExpansionLimits = LIMITS, **how: object) -> Expansion:
        """The expansion of ``r.xacro`` with this body."""
        self.put("r.xacro", robot(body))
        return expand(self.source(**how), Report(), limits)  # type: ignore[arg-type]

    def reported(self, body: str, **how: object) -> list[str]:
        """The diagnostics of ``r.xacro`` with this body: everything reported, or the refusal, without hints."""
        report = Report()
        try:
            self.read(body, report, **how)
        except Refusal as refusal:
            return [*(self._line(diagnostic) for diagnostic in report), self._line(refusal.diagnostic)]
        return [self._line(diagnostic) for diagnostic in report]

    def refusal(self, body: str, limits: ExpansionLimits = LIMITS, **how: object) -> Diagnostic:
        """Why ``r.xacro`` with this body is refused."""
        with pytest.raises(Refusal) as refusal:
            self.expand(body, limits, **how)
        return refusal.value.diagnostic

    def _line(self, diagnostic: Diagnostic) -> str:
        return str(diagnostic).split("\n")[0].replace(f"{self.path}/", "")
