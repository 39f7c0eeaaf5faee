"""Using what is kept for a file: the robot that the file was made from is restored as far as the file still is what was written."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, Refusal
from hymeko_x.residue.reading import BadResidue, parse_residues

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.residue.merge import Restored
    from hymeko_x.source import Kept


def restored(image: Mechanism, kept: Kept, report: Report) -> Mechanism:
    """The mechanism that a file describes, together with what is kept of the one that it was made from. One note counts what that is."""
    from hymeko_x.residue.merge import Restored, restore

    origin = Origin(kept.file)
    try:
        residues = parse_residues(kept.text)
    except (BadResidue, Refusal) as error:
        report.warn(codes.RESIDUE_UNREADABLE, f"what is kept cannot be read, and is left out: {error}", origin)
        return image
    void = _count_void(report)
    found = [Restored(image, 0, 0, 0)]
    for residue in residues:
        found.append(restore(found[-1].mechanism, residue, report))
    report.note(codes.KEPT_USED, _words(found, _count_void(report) - void), origin, hint="--ignore-kept reads the file without it")
    return found[-1].mechanism


def _count_void(report: Report) -> int:
    return sum(diagnostic.code == codes.RESIDUE_SUPERSEDED for diagnostic in report)


def _words(found: list[Restored], void: int) -> str:
    """How much was given back, and how much no longer applies."""
    values, elements, extras = (sum(numbers) for numbers in zip(*[one[1:] for one in found], strict=True))
    counts = ((values, "value"), (elements, "element"), (extras, "extra"))
    given = [f"{number} {word}{'s' if number > 1 else ''}" for number, word in counts if number]
    is_one = values + elements + extras == 1
    text = f"{', '.join(given) or 'names and notations'} that the file cannot represent {'is' if is_one else 'are'} given back"
    return f"{text}; for {void} element{'s' if void > 1 else ''} it no longer applies" if void else text
