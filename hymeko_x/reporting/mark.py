"""The first comment of an output: the program that made it, and the file that it was made from. Reading it back, it is not there."""

from __future__ import annotations

import re
from pathlib import PurePath
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.ir.mechanism import ROOT
from hymeko_x.version import __version__

if TYPE_CHECKING:
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Extra, Mechanism

_MARK = re.compile(r"\s*made by hymeko-x [\w.+-]+(?: from [^\r\n]+)?\s*")


def marked(main: bytes, format: Format, source: str) -> bytes:
    """The text of an output with the comment at its beginning, where the format has comments; ``source`` is the name of a file or empty."""
    if format.comment is None:
        return main
    before, line = format.comment
    found = re.match(before, main)
    return main if found is None else main[: found.end()] + line.format(_text(source)).encode() + b"\n" + main[found.end() :]


def _text(source: str) -> str:
    """What the comment says. A name that no comment of XML can hold is left out; text without a file has none."""
    name = PurePath(source.replace("\\", "/")).name
    is_usable = name.isprintable() and "--" not in name and not name.startswith("<")
    program = f"made by hymeko-x {__version__}"
    return f"{program} from {name}" if name and is_usable else program


def without_mark(mechanism: Mechanism) -> Mechanism:
    """The mechanism without the comment that an earlier conversion wrote."""
    own = mechanism.extras.get(ROOT, ())
    marks = [extra for extra in own if _is_mark(extra)]
    if not marks:
        return mechanism
    kept = tuple(replace(extra, index=extra.index - _before(extra, marks)) for extra in own if extra not in marks)
    extras = {key: found for key, found in {**mechanism.extras, ROOT: kept}.items() if found}
    return replace(mechanism, extras=extras)


def _before(extra: Extra, marks: list[Extra]) -> int:
    """How many of the comments stand before an extra at the same place."""
    return sum(mark.path == extra.path and mark.index < extra.index for mark in marks)


def _is_mark(extra: Extra) -> bool:
    return extra.format == "comment" and _MARK.fullmatch(extra.text) is not None
