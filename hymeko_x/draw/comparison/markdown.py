"""A page about two robots as Markdown for a pull request, with its pictures as files beside it.

Whatever comes from the robots stands in code, in which code hosts see no markup, no links and no names of people.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING
from urllib.parse import quote

from hymeko_x.draw.comparison.rows import HEADINGS, about, changed_words, check_rows, gap_line
from hymeko_x.draw.files import png
from hymeko_x.draw.graph.letters import visible

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from hymeko_x.draw.comparison.facts import Comparison

_MOST_LINES = 20
_NAMES = ("a", "b", "difference")


def markdown(page: Comparison, stem: str) -> tuple[str, Mapping[str, bytes]]:
    """The text, and the pictures beside it by name, which begin with ``stem``, the name of the text's file without suffix."""
    pictures = _pictures(page, stem)
    lines = [*_head(page), *_shown(page, [*pictures]), *_checks(page), *_lost(page)]
    return "".join(f"{line}\n" for line in lines), pictures


def _pictures(page: Comparison, stem: str) -> Mapping[str, bytes]:
    found = page.drawn.pair
    pictures = () if found is None else (found.before, found.after, found.difference)
    return {f"{stem}-{name}.png": png(picture) for name, picture in zip(_NAMES, pictures, strict=False)}


def _head(page: Comparison) -> Iterator[str]:
    verdict = page.verdict
    mark = "❔" if verdict.reason else "❌" if verdict.failed else "⚠️" if verdict.gaps else "✅"
    yield f"### {mark} {_code(page.a.name)} and {_code(page.b.name)}: {verdict.verdict}"
    yield ""
    if verdict.reason:
        yield from (_code(verdict.reason), "")
    yield f"A is {about(page.a)}; B is {about(page.b)}."


def _shown(page: Comparison, names: list[str]) -> Iterator[str]:
    yield ""
    if page.drawn.pair is None:
        yield f"There are no pictures: {_code(page.drawn.reason)}"
        return
    yield "| A | B | difference |"
    yield "| --- | --- | --- |"
    yield f"| {' | '.join(f'![{name}](<{quote(file)}>)' for name, file in zip(_NAMES, names, strict=True))} |"
    yield ""
    yield f"{changed_words(page.drawn.pair.changed)}.".capitalize()


def _checks(page: Comparison) -> Iterator[str]:
    rows = check_rows(page.verdict)
    if rows:
        yield ""
        yield f"| {' | '.join(HEADINGS)} |"
        yield f"|{' --- |' * len(HEADINGS)}"
        yield from (f"| {'ok' if row.passed else '**FAIL**'} | {row.cells[0]} | {' | '.join(map(_cell, row.cells[1:]))} |" for row in rows)
    yield from _list("Not compared", [*map(gap_line, page.verdict.gaps), *page.verdict.not_compared])


def _lost(page: Comparison) -> Iterator[str]:
    if not page.losses:
        yield from ("", "B has everything that A has.")
    yield from _list("What B does not have as A has it", page.lost)


def _list(heading: str, lines: list[str]) -> Iterable[str]:
    if not lines:
        return ()
    rest = [f"- ... and {len(lines) - _MOST_LINES} more"] if len(lines) > _MOST_LINES else []
    return ("", f"**{heading}**", "", *(f"- {_code(line)}" for line in lines[:_MOST_LINES]), *rest)


def _cell(words: str) -> str:
    return _code(words).replace("|", "\\|") if words else ""


def _code(words: str) -> str:
    """A text as code, whatever backticks it has."""
    shown = visible(words) or " "
    fence = "`" * (1 + max(map(len, re.findall("`+", shown)), default=0))
    space = " " if shown[0] == "`" or shown[-1] == "`" else ""
    return f"{fence}{space}{shown}{space}{fence}"
