"""A page about two robots as one HTML file: no scripts, nothing from elsewhere, pictures inside, right for light and dark.

Whatever comes from the robots is text: every string goes through :func:`_text`, except for our own SVG, which does so itself.
"""

from __future__ import annotations

from base64 import b64encode
from typing import TYPE_CHECKING

from hymeko_x.draw.comparison.rows import HEADINGS, about, answer, changed_words, check_rows, finding_rows, gap_line, title
from hymeko_x.draw.files import png
from hymeko_x.draw.graph.letters import visible
from hymeko_x.xml.text import escaped

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from hymeko_x.draw.comparison.facts import Comparison

_MOST_ROWS = 500
"""So many differences and losses are listed one by one; the others are counted."""
_SMALL = 50_000
"""A tree of fewer characters is shown without a click: about forty bodies."""
_SHORT = 12
"""A cell with fewer letters is one line."""
_POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'"
_STYLE = """
  :root { color-scheme: light dark; --ink: #1a1a1a; --faint: #57606a; --paper: #ffffff; --line: #d0d7de }
  :root { --good: #116329; --bad: #b3261e; --part: #7d4e00 }
  @media (prefers-color-scheme: dark) {
    :root { --ink: #f0f0f0; --faint: #b9b9b9; --paper: #16181c; --line: #3d444d; --good: #56d364; --bad: #ff8a80; --part: #e3b341 }
  }
  body { margin: 0 auto; padding: 1.5rem; max-width: 76rem; background: var(--paper); color: var(--ink) }
  body { font: 15px/1.5 system-ui, sans-serif }
  h1 { font-size: 1.5rem; overflow-wrap: anywhere }
  h2 { font-size: 1.15rem; margin-top: 2.2rem }
  .verdict { font-size: 1.2rem; font-weight: bold; overflow-wrap: anywhere }
  .same, .ok { color: var(--good) } .different, .wrong { color: var(--bad) } .limited, .unknown { color: var(--part) }
  .about, figcaption { color: var(--faint); overflow-wrap: anywhere }
  .pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(18rem, 1fr)); gap: 1rem }
  figure { margin: 0 } img { width: 100%; height: auto; border: 1px solid var(--line) }
  .wide { overflow-x: auto; border: 1px solid var(--line) }
  table { border-collapse: collapse; width: 100% }
  td.short, th { white-space: nowrap }
  th, td { padding: 0.2rem 0.6rem; text-align: start; border-bottom: 1px solid var(--line); vertical-align: top }
  td { unicode-bidi: isolate } td.long { overflow-wrap: anywhere; min-width: 10rem } li { unicode-bidi: isolate; overflow-wrap: anywhere }
  summary { cursor: pointer; margin: 0.6rem 0 }
"""


def html(page: Comparison) -> str:
    """The whole file."""
    return "\n".join(
        (
            "<!DOCTYPE html>",
            '<html lang="en">',
            "<head>",
            '<meta charset="utf-8">',
            f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>{escaped(title(page))}</title>",
            f"<style>{_STYLE}</style>",
            "</head>",
            "<body>",
            *_head(page),
            *_pictures(page),
            *_checks(page),
            *_lost(page),
            *_trees(page),
            "</body>",
            "</html>",
            "",
        )
    )


def _head(page: Comparison) -> Iterable[str]:
    verdict = page.verdict
    style = "unknown" if verdict.reason else "different" if verdict.failed else "limited" if verdict.gaps else "same"
    yield f"<h1>{escaped(title(page))}</h1>"
    yield f'<p class="verdict {style}">{escaped(answer(verdict))}</p>'
    for letter, side, engine in (("A", page.a, verdict.engines[0]), ("B", page.b, verdict.engines[1])):
        read = f"; read by {engine}" if engine else ""
        yield f'<p class="about">{letter}: {escaped(visible(side.name))} ({escaped(about(side))}{escaped(read)})</p>'


def _pictures(page: Comparison) -> Iterable[str]:
    yield "<h2>Pictures</h2>"
    found = page.drawn.pair
    if found is None:
        yield f"<p>There are no pictures. {escaped(visible(page.drawn.reason))}</p>"
        return
    yield '<div class="pictures">'
    for picture, words in (
        (found.before, "A"),
        (found.after, "B"),
        (found.difference, f"difference: {changed_words(found.changed)}"),
    ):
        data = b64encode(png(picture)).decode()
        yield f'<figure><img alt="{escaped(words)}" src="data:image/png;base64,{data}"><figcaption>{escaped(words)}</figcaption></figure>'
    yield "</div>"


def _checks(page: Comparison) -> Iterable[str]:
    yield "<h2>Checks</h2>"
    rows = check_rows(page.verdict)
    marks = {True: '<td class="ok short">ok</td>', False: '<td class="wrong short">FAIL</td>'}
    yield from _table(HEADINGS, (marks[row.passed] + _cells(row.cells) for row in rows)) if rows else ("<p>Nothing was compared.</p>",)
    found = [_cells(row) for row in finding_rows(page.verdict)]
    if found:
        yield from _folded(f"each difference: {len(found)}", _table(("quantity", "at", "size", "values"), _most(found)))
    if page.verdict.gaps:
        yield from ("<p>Not compared, because a format cannot represent it:</p>", *_list(map(gap_line, page.verdict.gaps)))
    if page.verdict.not_compared:
        yield from _folded(f"notes: {len(page.verdict.not_compared)}", _list(page.verdict.not_compared))


def _lost(page: Comparison) -> Iterable[str]:
    yield "<h2>What B does not have as A has it</h2>"
    if not page.losses:
        yield "<p>Nothing: B has everything that A has.</p>"
        return
    yield from _list(page.lost)
    rows = [_cells((loss.element, loss.field, loss.fate, loss.change, str(loss.origin or ""))) for loss in page.losses]
    yield from _folded(f"each of them: {len(rows)}", _table(("element", "field", "fate", "change", "place"), _most(rows)))


def _trees(page: Comparison) -> Iterable[str]:
    yield "<h2>Trees</h2>"
    for letter, side, svg in (("A", page.a, page.trees[0]), ("B", page.b, page.trees[1])):
        yield from _folded(f"{letter}: {visible(side.name)}", ('<div class="wide">', svg, "</div>"), is_open=len(svg) < _SMALL)


# ---- markup ------------------------------------------------------------------------------------------------------------


def _cells(texts: Sequence[str]) -> str:
    return "".join(f'<td class="{"short" if len(text) < _SHORT else "long"}">{escaped(visible(text))}</td>' for text in texts)


def _table(headings: Sequence[str], rows: Iterable[str]) -> Iterable[str]:
    """A table of rows whose cells are markup."""
    yield '<div class="wide"><table>'
    yield f"<thead><tr>{''.join(f'<th>{escaped(heading)}</th>' for heading in headings)}</tr></thead><tbody>"
    yield from (f"<tr>{row}</tr>" for row in rows)
    yield "</tbody></table></div>"


def _most(rows: Sequence[str]) -> Iterable[str]:
    yield from rows[:_MOST_ROWS]
    if len(rows) > _MOST_ROWS:
        yield f"<td>... and {len(rows) - _MOST_ROWS} more</td>"


def _list(lines: Iterable[str]) -> Iterable[str]:
    yield "<ul>"
    yield from (f"<li>{escaped(visible(line))}</li>" for line in lines)
    yield "</ul>"


def _folded(summary: str, inside: Iterable[str], *, is_open: bool = False) -> Iterable[str]:
    yield f"<details{' open' if is_open else ''}><summary>{escaped(summary)}</summary>"
    yield from inside
    yield "</details>"
