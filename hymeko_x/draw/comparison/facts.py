"""What a page about two robots shows, put together from the verifier, the ledger, and the pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from msgspec import Struct

from hymeko_x.compare.contents import Contents
from hymeko_x.draw.attempt import attempt
from hymeko_x.draw.graph.picture import picture
from hymeko_x.draw.render import PictureOptions, choose_backend, is_drawn
from hymeko_x.reporting.summary import kept_line, minor_line, summary_lines
from hymeko_x.residue.measuring import losses_between_files
from hymeko_x.residue.originals import fetcher
from hymeko_x.robot import Robot

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hymeko_x.compare.ledger import Loss
    from hymeko_x.draw.pair import PicturePair
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.source import Source
    from hymeko_x.verify.verdict import Verdict


class Side(NamedTuple):
    """One of the two robots, as this program read its file; ``name`` is what the user called it."""

    name: str
    mechanism: Mechanism
    format: Format
    source: Source


class Drawn(NamedTuple):
    """The pictures of two robots, or why there are none."""

    pair: PicturePair | None
    reason: str = ""


class Comparison(Struct, frozen=True, eq=False):
    """What a page shows; ``trees`` are SVG."""

    a: Side
    b: Side
    verdict: Verdict
    losses: tuple[Loss, ...]
    drawn: Drawn
    trees: tuple[str, str]

    @property
    def lost(self) -> list[str]:
        """What the second robot does not have as the first one has it: a line for each kind."""
        return lines_of(self.losses)


def comparison(a: Side, b: Side, verdict: Verdict, drawn: Drawn) -> Comparison:
    """Everything about two robots."""
    return Comparison(a, b, verdict, losses_of(a, b), drawn, (picture(a.mechanism), picture(b.mechanism)))


def losses_of(a: Side, b: Side) -> tuple[Loss, ...]:
    """What the second robot does not have as the first one has it."""
    source, image = (Contents(side.mechanism, fetcher(side.mechanism, side.source.files)) for side in (a, b))
    return losses_between_files(source, image, b.format)


def lines_of(losses: Sequence[Loss]) -> list[str]:
    """A line for each kind of loss."""
    return [line for line in (*summary_lines(losses), kept_line(losses), minor_line(losses)) if line]


def draw(a: Side, b: Side, size: tuple[int, int]) -> Drawn:
    """The pictures of both robots, each of this size in pixels. It goes before the verifier, which loads MuJoCo without what draws."""
    return Drawn(*attempt(lambda: _pair(a, b, size)))


def _pair(a: Side, b: Side, size: tuple[int, int]) -> PicturePair:
    choose_backend()
    from hymeko_x.draw.pair import Subject, pair

    first, second = (
        Subject(Robot(side.mechanism, side.source.files), side.source.name if is_drawn(side.format) else None) for side in (a, b)
    )
    return pair(first, second, PictureOptions(size))
