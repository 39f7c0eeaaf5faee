"""What the program says to its user: codes, places, messages, and the report that collects them.

Every statement is one :class:`Diagnostic` with a stable :class:`Code`. A stage that can go on reports and uses the documented
default; a stage that cannot raises :class:`Refusal`, which the shell catches once. Errors stop the pipeline at the end of their stage.
"""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

from msgspec import Struct, field

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence


class Severity(Enum):
    """How bad it is; :mod:`hymeko_x.severities` justifies that of each code.

    ``ERROR``: the result is not what the author meant. It ends the command, unless the user asks to go on.
    ``WARNING``: something is odd, or the output cannot represent it. ``NOTE``: all is well, and this is how it was done.
    """

    NOTE = "note"
    WARNING = "warning"
    ERROR = "error"

    @property
    def rank(self) -> int:
        """0 for a note, 1 for a warning, 2 for an error."""
        return _RANKS[self]


_RANKS = {Severity.NOTE: 0, Severity.WARNING: 1, Severity.ERROR: 2}


class Code(Struct, frozen=True):
    """A stable name for one kind of statement.

    ``id`` is ``HX`` and three digits: 0xx reading, 1xx loss and rewriting, 2xx assets, 3xx verification,
    9xx a bug of ours. ``title`` is a short sentence, ``explanation`` what `hymeko-x explain` prints.
    """

    id: str
    title: str
    explanation: str


class Origin(Struct, frozen=True):
    """A place in an input: the file as the user named it, and one-based line and column (None = unknown)."""

    file: str
    line: int | None = None
    column: int | None = None

    def __str__(self) -> str:
        return ":".join(str(part) for part in (self.file, self.line, self.column) if part is not None)


class Diagnostic(Struct, frozen=True):
    """One statement. ``element`` is what it is about (``joint 'elbow'``), ``hint`` what the user can do.

    ``excerpt`` holds ready lines to show below the message, such as a source line and its caret.
    """

    code: Code
    severity: Severity
    message: str
    origin: Origin | None = None
    element: str = ""
    hint: str = ""
    excerpt: tuple[str, ...] = ()

    def __str__(self) -> str:
        """``arm.urdf:41: error[HX012]: message`` with excerpt and hint on lines of their own."""
        place = f"{self.origin}: " if self.origin else ""
        lines = [f"{place}{self.severity.value}[{self.code.id}]: {self.message}", *self.excerpt]
        if self.hint:
            lines.append(f"  hint: {self.hint}")
        return "\n".join(lines)

    def as_json(self) -> dict[str, str | int | None]:
        """The keys of the `--report` and `--json` contract."""
        return {
            "code": self.code.id,
            "severity": self.severity.value,
            "message": self.message,
            "file": self.origin.file if self.origin else None,
            "line": self.origin.line if self.origin else None,
            "element": self.element,
            "hint": self.hint,
        }


class Report(Struct):
    """The diagnostics of one run, in the order in which they were made. The only thing that a stage may append to."""

    diagnostics: list[Diagnostic] = field(default_factory=list)

    def note(self, code: Code, message: str, origin: Origin | None = None, *, element: str = "", hint: str = "") -> None:
        """Record something that the user may want to know."""
        self.diagnostics.append(Diagnostic(code, Severity.NOTE, message, origin, element, hint))

    def warn(self, code: Code, message: str, origin: Origin | None = None, *, element: str = "", hint: str = "") -> None:
        """Record something that was repaired, guessed or left out; the message says which."""
        self.diagnostics.append(Diagnostic(code, Severity.WARNING, message, origin, element, hint))

    def error(self, code: Code, message: str, origin: Origin | None = None, *, element: str = "", hint: str = "") -> None:
        """Record an error: the stage goes on with the documented default, to find all of them, and then the command ends."""
        self.diagnostics.append(Diagnostic(code, Severity.ERROR, message, origin, element, hint))

    def extend(self, diagnostics: Iterable[Diagnostic]) -> None:
        """Append the diagnostics of another stage."""
        self.diagnostics.extend(diagnostics)

    def __iter__(self) -> Iterator[Diagnostic]:
        return iter(self.diagnostics)

    def __len__(self) -> int:
        return len(self.diagnostics)

    @property
    def worst(self) -> Severity | None:
        """The highest severity so far, or None when nothing was reported."""
        return max((d.severity for d in self.diagnostics), key=lambda s: s.rank, default=None)

    def errors(self, since: int = 0) -> tuple[Diagnostic, ...]:
        """The errors, from the diagnostic of this number on."""
        return tuple(diagnostic for diagnostic in self.diagnostics[since:] if diagnostic.severity is Severity.ERROR)


class Refusal(Exception):
    """The one exception for input that cannot be processed. Carries the diagnostic that says why."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        super().__init__(str(diagnostic))
        self.diagnostic = diagnostic

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Everything that there is to report: the reason alone, unless the stage had come to its end."""
        return (self.diagnostic,)


class Stopped(Refusal):
    """A stage came to its end with errors, each with its documented default; the user has to allow what comes out (``--lenient``)."""

    def __init__(self, report: Report, since: int = 0) -> None:
        errors = report.errors(since)
        super().__init__(errors[0])
        self.args = ("\n".join(map(str, errors)),)
        self._diagnostics = tuple(report.diagnostics)

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """The whole report of the run, in its order."""
        return self._diagnostics


def counted(count: int, one: str, many: str = "") -> str:
    """A number of things for a message: ``1 body``, ``2 bodies``; ``many`` is the plural, by default with an ``s`` at the end."""
    return f"{count} {one if count == 1 else many or f'{one}s'}"


def listed(words: Sequence[str], most: int) -> str:
    """The first words for a message, and ``...`` where there are more than ``most``."""
    return ", ".join(words[:most]) + (", ..." if len(words) > most else "")


def with_article(noun: str) -> str:
    """A noun for a message: ``a box``, ``an ellipsoid``, ``an hfield``."""
    return f"{'an' if noun[0] in 'aeiou' or noun == 'hfield' else 'a'} {noun}"


def refuse(
    code: Code, message: str, origin: Origin | None = None, *, element: str = "", hint: str = "", excerpt: tuple[str, ...] = ()
) -> Refusal:
    """A :class:`Refusal` to raise: ``raise refuse(codes.NOT_XML, "...", origin) from error``."""
    return Refusal(Diagnostic(code, Severity.ERROR, message, origin, element, hint, excerpt))
