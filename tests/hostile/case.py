"""What a hostile case is: files made by code, a command line, and how it has to end."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    Content = bytes | str | Callable[[], bytes]


class Case(Struct, frozen=True):
    """``files`` are laid into an empty folder ``in``, ``prepare`` does the rest; then ``words`` are run there.

    The command ends with the exit code ``code`` and says ``codes``, and no error with another code. It takes no longer
    than ``seconds`` (of a busy machine), and leaves no file behind but ``leaves``.
    """

    name: str
    files: Mapping[str, Content]
    words: tuple[str, ...]
    code: int
    codes: tuple[str, ...] = ()
    seconds: float = 15.0
    leaves: tuple[str, ...] = ()
    prepare: Callable[[Path], None] | None = None


def reading(name: str, content: Content, *codes: str, code: int = 1, seconds: float = 15.0, **files: Content) -> Case:
    """A file called ``name`` (the case's name is in front of a colon) that is only read."""
    title, _, file = name.partition(": ")
    return Case(title, {file: content, **files}, ("info", file), code, codes, seconds)
