"""The words and tables of a page about two robots, which HTML and Markdown have in common. Names are in visible letters."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.draw.graph.letters import visible
from hymeko_x.ir.parts import Body

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.draw.comparison.facts import Comparison, Side
    from hymeko_x.verify.verdict import Check, Gap, Verdict

HEADINGS = ("", "quantity", "worst", "allowed", "unit", "at", "values")


class CheckRow(NamedTuple):
    """One check: whether it passed, and the texts of the columns behind its mark."""

    passed: bool
    cells: tuple[str, ...]


def title(page: Comparison) -> str:
    """Both files, as the user named them."""
    return f"{visible(page.a.name)} and {visible(page.b.name)}"


def answer(verdict: Verdict) -> str:
    """The verdict in a line."""
    return f"{verdict.verdict}: {visible(verdict.reason)}" if verdict.reason else verdict.verdict


def about(side: Side) -> str:
    """Format and size of a robot."""
    bodies = sum(1 for _ in side.mechanism.vertices(Body))
    return f"{side.format.name}, {bodies} bodies, {len(side.mechanism.joints)} joints"


def check_rows(verdict: Verdict) -> list[CheckRow]:
    """The checks, those that found a difference first."""
    return [_row(check) for check in sorted(verdict.checks, key=lambda check: check.passed)]


def _row(check: Check) -> CheckRow:
    values = f"{check.values[0]} and {check.values[1]}" if check.values and not check.passed else ""
    cells = (check.quantity, f"{check.worst:.3g}", f"{check.allowed:.3g}", check.unit, check.at, values)
    return CheckRow(check.passed, tuple(map(visible, cells)))


def finding_rows(verdict: Verdict) -> Iterator[tuple[str, ...]]:
    """Every difference that is not allowed: quantity, place, size, values."""
    for check in verdict.failed:
        for found in check.findings:
            values = f"{found.values[0]} and {found.values[1]}" if found.values else ""
            yield tuple(map(visible, (check.quantity, found.at, f"{found.difference:.3g} {check.unit}".strip(), values)))


def gap_line(gap: Gap) -> str:
    """What one of the formats cannot represent."""
    return f"{gap.format} cannot represent {gap}"


def changed_words(changed: float) -> str:
    """How much of the pictures differs."""
    return "the pictures are equal" if changed == 0.0 else f"{100.0 * changed:.2f} % of the pixels differ"
