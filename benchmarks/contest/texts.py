"""Reading and printing HyMeKo text, in MB/s, beside lark with the plain grammar and nothing else."""

from __future__ import annotations

from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

from lark import Lark

import hymeko_x as hx
from benchmarks.contest.rows import TEXT, Row
from benchmarks.yardstick import in_turns
from hymeko_x.backends.hymeko import document
from hymeko_x.language.parser import parse
from hymeko_x.language.printer import print_document

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from benchmarks.contest.inputs import Input

WAY = "hymeko text"
READING, PRINTING, LARK = "hymeko-x, reading", "hymeko-x, printing", "lark alone, reading"


def texts(robots: Sequence[Input]) -> Iterator[Row]:
    """Rows whose megabytes are the length of the text."""
    plain = Lark((Path(__file__).parents[1] / "plain.lark").read_text("utf-8"), parser="lalr")
    for robot in robots:
        tree = document(hx.load(robot.path).mechanism)
        text = print_document(tree)
        times = in_turns(lambda: parse(text), lambda: print_document(tree), lambda: plain.parse(text), rounds=3)  # noqa: B023
        for program, seconds in zip((READING, PRINTING, LARK), times, strict=True):
            yield Row(WAY, program, version("lark") if program == LARK else "", robot.name, TEXT, seconds, len(text.encode()) / 1e6)
