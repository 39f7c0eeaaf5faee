"""HyMeKo text read, printed, and read again."""

from __future__ import annotations

from hymeko_x.backends.hymeko import write
from hymeko_x.diagnostics import Report
from hymeko_x.frontends.hymeko import read
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.rewrite.context import Options
from hymeko_x.source import Source


def read_text(text: str) -> Mechanism:
    """The mechanism in a text, of which there is nothing to report."""
    report = Report()
    mechanism = read(Source("robot.hymeko", text.encode()), report).mechanism
    assert not report.diagnostics, [str(diagnostic) for diagnostic in report]
    return mechanism


def text_of(mechanism: Mechanism) -> str:
    """The mechanism as hymeko-x prints it."""
    return write(mechanism, Options(), Report()).main.decode()


def canonical(text: str) -> str:
    """The text as hymeko-x prints it, which means the same and is printed the same."""
    mechanism = read_text(text)
    printed = text_of(mechanism)
    back = read_text(printed)
    assert (back, back.layout, back.extras) == (mechanism, mechanism.layout, mechanism.extras)
    assert text_of(back) == printed
    return printed
