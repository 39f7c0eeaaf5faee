"""What xacro asks the world for, as the parent provides it: files, packages, variables, arguments; and its output, as notices."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, BinaryIO, NoReturn

from hymeko_x.frontends.xacro.child.channel import Trouble
from hymeko_x.frontends.xacro.child.dom import current_place

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.frontends.xacro.child.channel import Parent
    from hymeko_x.frontends.xacro.child.dom import SourcePlace

MOST_NOTICES = 200


class Arguments(dict[str, str]):
    """The values of $(arg ...). Remembers every name that the file mentions."""

    def __init__(self, given: Mapping[str, str]) -> None:
        super().__init__(given)
        self.mentioned: set[str] = set()

    def __contains__(self, name: object) -> bool:
        self.mentioned.add(str(name))
        return super().__contains__(name)

    def __getitem__(self, name: str) -> str:
        self.mentioned.add(name)
        return super().__getitem__(name)

    def __missing__(self, name: str) -> NoReturn:
        raise Trouble("argument", name=name)


class Desk:
    """Files, packages and variables, as the parent provides them."""

    def __init__(self, parent: Parent, environment: Mapping[str, str]) -> None:
        self._parent = parent
        self._environment = environment
        self._packages: dict[tuple[str, str], str] = {}
        self._guesses: dict[str, str] = {}
        self.notices: list[dict[str, object]] = []
        self.files: list[str] = []

    def notice(self, kind: str, place: SourcePlace | None, **more: object) -> None:
        """Something to report when the expansion is done, once for each place."""
        facts = {"kind": kind, "file": place and place.file, "line": place and place.line, **more}
        if facts not in self.notices and len(self.notices) < MOST_NOTICES:
            self.notices.append(facts)

    def read(self, path: str) -> tuple[str, bytes]:
        """A file as the user would call it, and its content."""
        answer, data = self._parent.ask("read", path=path)
        if "path" in answer:
            return answer["path"], data
        for folder, package in self._guesses.items():
            if path.startswith(f"{folder}/"):
                raise Trouble("package", name=package)
        raise FileNotFoundError(2, answer["error"], path)

    def open(self, path: str, *_: object) -> BinaryIO:
        """A file to read, in place of `open` where xacro reads yaml."""
        try:
            return io.BytesIO(self.read(path)[1])
        except FileNotFoundError as error:
            raise Trouble("file", path=path, reason=error.strerror) from error

    def glob(self, pattern: str) -> list[str]:
        """The files that a pattern names, in place of `glob.glob` where xacro includes several files."""
        found: list[str] = self._parent.ask("match", pattern=pattern)[0]["paths"]
        return found

    def find(self, package: str, beside: str) -> str:
        """The folder of a package, for the file ``beside``."""
        if (package, beside) not in self._packages:
            answer, _ = self._parent.ask("find", package=package, beside=beside)
            if answer["folder"] is None:
                raise Trouble("package", name=package)
            self._packages[package, beside] = answer["folder"]
            if answer["guessed"]:
                self._guesses[answer["folder"]] = package
                self.notice("guessed", current_place(), name=package, folder=answer["folder"])
        return self._packages[package, beside]

    def variable(self, name: str) -> str:
        """$(env NAME)."""
        if name not in self._environment:
            raise Trouble("variable", name=name)
        return self._environment[name]

    def optional_variable(self, name: str, default: str = "") -> str:
        """$(optenv NAME DEFAULT)."""
        if name not in self._environment:
            self.notice("closed", current_place(), name=name, default=default)
        return self._environment.get(name, default)


class NoticeStream(io.TextIOBase):
    """Standard error and output while xacro works: its messages become notices."""

    _PLACES = ("when instantiating macro:", "instantiated from:", "in file:", "when processing file:", "included from:")

    def __init__(self, desk: Desk) -> None:
        self._desk = desk
        self._line = ""

    def write(self, text: str) -> int:
        """Report each whole line of a text, but for those that only name places; the number of letters."""
        *lines, self._line = (self._line + text).split("\n")
        for line in lines:
            if line.strip() and not line.startswith(self._PLACES):
                self._desk.notice("printed", current_place(), text=line)
        return len(text)
