"""One document as the server knows it: its diagnostics, its blocks, and the robot that it describes."""

from __future__ import annotations

import pickle
import re
from collections.abc import Callable
from functools import cache, cached_property
from typing import TYPE_CHECKING
from urllib.parse import unquote, urlparse

from msgspec import Struct, field

from hymeko_x import formats
from hymeko_x.diagnostics import Diagnostic, Severity
from hymeko_x.server.reader import TextReading, read
from hymeko_x.server.text import NodeDefinition, TextPlaces, definitions, unquoted

if TYPE_CHECKING:
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Mechanism

_IMPORT = re.compile(r'\bimport\s+"([^"\n]+)"(?:\s+as\s+(`[^`]*`|\w+))?')


Robot = Callable[[], "Mechanism | None"]
"""A robot, which another process may have read: it is unpickled when it is asked for."""


def no_robot() -> None:
    """The robot of a text that never could be read."""


class Analysis(Struct, dict=True):
    """What is known of one version of a document."""

    path: str
    text: str
    places: TextPlaces
    format: Format | None
    diagnostics: list[Diagnostic] = field(default_factory=list)
    last_robot: Robot = no_robot

    @property
    def robot(self) -> Mechanism | None:
        """The robot of the last version that could be read."""
        return self.last_robot()

    @cached_property
    def definitions(self) -> list[NodeDefinition]:
        """Every node of the text, found when it is asked for."""
        return list(definitions(self.text))

    @cached_property
    def by_name(self) -> dict[str, list[NodeDefinition]]:
        """The nodes by the last name of their path."""
        found: dict[str, list[NodeDefinition]] = {}
        for one in self.definitions:
            found.setdefault(one.path[-1], []).append(one)
        return found

    @property
    def is_text(self) -> bool:
        """Whether it is text of the HyMeKo language."""
        return self.format is formats.OWN

    def imports(self) -> dict[str, str]:
        """The imported files by alias, and by path."""
        found: dict[str, str] = {}
        for path, alias in _IMPORT.findall(self.text):
            found[path] = path
            if alias:
                found[unquoted(alias)] = path
        return found


def path_of(uri: str) -> str:
    """The path of a document."""
    return unquote(urlparse(uri).path) if uri.startswith("file:") else uri


def analyse(uri: str, text: str) -> Analysis:
    """A document read at once."""
    reading = read(path_of(uri), text)
    document = analysis(uri, text, reading, None)
    document.last_robot = lambda: reading.robot
    return document


def analysis(uri: str, text: str, reading: TextReading, before: Analysis | None) -> Analysis:
    """A document of which the robot is not there yet: it is that of the version before."""
    row = None if reading.format is None else formats.by_name(reading.format)
    robot = no_robot if before is None else before.last_robot
    return Analysis(path_of(uri), text, TextPlaces(text), row, reading.diagnostics, robot)


def unpickled(data: bytes) -> Robot:
    """The robot that a process sent."""
    return cache(lambda: pickle.loads(data))


def unread(text: str, before: Analysis) -> Analysis:
    """A document with another text, about whose robot the last version tells."""
    return Analysis(before.path, text, TextPlaces(text), before.format, before.diagnostics, before.last_robot)


SEVERITIES = {Severity.ERROR: 1, Severity.WARNING: 2, Severity.NOTE: 3}
"""Severities as editors number them."""
