"""One document as the server knows it: its diagnostics, its blocks, and the robot that it describes."""

from __future__ import annotations

import re
from functools import cached_property
from typing import TYPE_CHECKING
from urllib.parse import unquote, urlparse

from msgspec import Struct, field

from hymeko_x import formats
from hymeko_x.diagnostics import Diagnostic, Severity
from hymeko_x.server.reader import Reading, read
from hymeko_x.server.text import Definition, Places, definitions, unquoted

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Mechanism

_IMPORT = re.compile(r'\bimport\s+"([^"\n]+)"(?:\s+as\s+(`[^`]*`|\w+))?')


class Analysis(Struct, dict=True):
    """What is known of one version of a document. ``robot`` is that of the last version that could be read."""

    path: str
    text: str
    places: Places
    format: Format | None
    diagnostics: list[Diagnostic] = field(default_factory=list)
    robot: Mechanism | None = None

    @cached_property
    def definitions(self) -> list[Definition]:
        """Every node of the text, found when it is asked for."""
        return list(definitions(self.text))

    @cached_property
    def by_name(self) -> dict[str, list[Definition]]:
        """The nodes by the last name of their path."""
        found: dict[str, list[Definition]] = {}
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


def analyse(uri: str, text: str, before: Analysis | None, read: Callable[[str, str], Reading] = read) -> Analysis:
    """A document read anew; where it cannot be, its robot is that of the version before."""
    path = path_of(uri)
    found = read(path, text)
    row = None if found.format is None else formats.by_name(found.format)
    robot = before.robot if found.robot is None and before is not None else found.robot
    return Analysis(path, text, Places(text), row, found.diagnostics, robot)


def unread(text: str, before: Analysis) -> Analysis:
    """A document with another text, about whose robot the last version tells."""
    return Analysis(before.path, text, Places(text), before.format, before.diagnostics, before.robot)


SEVERITIES = {Severity.ERROR: 1, Severity.WARNING: 2, Severity.NOTE: 3}
"""Severities as editors number them."""
