"""The ledger: in what the result of a conversion, as its own format reads it, is not the mechanism that it was made from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

from hymeko_x import formats
from hymeko_x.compare.diff import Difference, Tolerance, diff
from hymeko_x.compare.relevance import in_fragments, relevant
from hymeko_x.compare.units import unit_of
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Mesh, Texture
from hymeko_x.source import file_stem

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from hymeko_x.compare.leaves import Leaves
    from hymeko_x.diagnostics import Origin
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Id, Mechanism

TOLERANCE = Tolerance(absolute=1e-12, relative=1e-12)
"""Numbers that differ by less are not a loss: turning degrees into radians and back moves the last digit."""

LONGEST_VALUE = 120
"""How many letters of a value a person is shown; the report has all of them."""


Fate = Literal["kept", "approximated", "dropped"]
"""*Kept*: the output's residue holds it, or a fragment that only some programs read. *Approximated*: the output represents something else.
*Dropped*: it represents nothing there."""

_ABSENT = ("none", "[]")
"""How a difference shows that a field has no value; a weight without a value is the identity."""

_ABSENT_AT_ZERO = ("armature", "damping", "friction", "stiffness")
"""The last words of fields that stand for nothing when they are zero."""


class Loss(NamedTuple):
    """One line of the ledger: what is not the same in the result.

    ``unit`` is that of the numbers in ``before`` and ``after``; ``target`` the element in the result, None where it has none.
    """

    element: str
    field: str
    before: str | None
    after: str | None
    fate: Fate
    origin: Origin | None = None
    unit: str = ""
    target: str | None = None

    def __str__(self) -> str:
        place = f"{self.origin}: " if self.origin else ""
        what = f"{self.element} {self.field}".rstrip()
        return f"{place}loss: {what} {self.fate}: {self.change}"

    @property
    def change(self) -> str:
        """Before and after in one short line."""
        return f"{_shown(self.before)} -> {_shown(self.after)}"


def _shown(value: str | None) -> str:
    """A value in one short line."""
    if value is None:
        return "nothing"
    line = " ".join(value.split())
    return f"{line[:LONGEST_VALUE]}..." if len(line) > LONGEST_VALUE else line or "''"


def losses_between(
    mechanism: Mechanism,
    aligned: Mechanism,
    renamed: Iterable[Difference],
    format: Format,
    leaves: Mapping[Id, Leaves] | None = None,
    *,
    is_kept: bool = False,
) -> tuple[Loss, ...]:
    """Everything in which what was written and read back differs from the mechanism; what is only described otherwise, once.

    ``aligned`` is what was read back, aligned with the mechanism; ``renamed`` is what only the alignment
    changed; ``leaves`` is in what their elements differ, if that is known; ``is_kept`` whether what got lost is kept.
    """
    tolerance = Tolerance(1e-12, format.precision, by_vector=True) if format.precision else TOLERANCE
    differences = diff(mechanism, aligned, tolerance, leaves)
    is_held = in_fragments(differences, mechanism, aligned)
    kept = relevant(differences, mechanism, aligned, tolerance, is_held)
    renamed = tuple(renamed)
    names = {difference.element: str(difference.after)[1:-1] for difference in renamed if difference.field == "name"}
    renamed = (difference for difference in renamed if not _is_number(difference, mechanism))
    found = (*renamed, *kept, *_notes_that_count(mechanism, aligned))
    lost = [difference for difference in found if not _is_boilerplate(difference, mechanism, format)]
    return tuple([_loss(difference, mechanism, aligned, names, is_kept=is_kept or is_held(difference)) for difference in lost])


def _is_number(difference: Difference, mechanism: Mechanism) -> bool:
    """Whether an element without a name of its own is only called otherwise: a shape's is a field, a mesh may be called after its file."""
    key = difference.element
    if difference.field != "name":
        return False
    part = mechanism.graph.vertices.get(key)
    of_file = isinstance(part, Mesh | Texture) and part.name is None and part.uri and key.name.partition("#")[0] == file_stem(part.uri)
    return key.kind == "shape" or bool(of_file) or mechanism.notation(key, UNNAMED) is not None


def _notes_that_count(mechanism: Mechanism, image: Mechanism) -> Iterator[Difference]:
    """What only a notation holds, and yet is more than how something was written: where a stage shows its bodies at first."""
    stated = [(field, name) for format in formats.families() for field, name in format.stated_notations.items()]
    for key, table in mechanism.notations.items() if stated else ():
        for field, name in stated:
            after = image.notations.get(key, {}).get(name)
            if name in table and after != table[name]:
                yield Difference(key, field, table[name], after)


def _is_boilerplate(difference: Difference, mechanism: Mechanism, format: Format) -> bool:
    """Whether only every file of the format has it: settings of the whole, and more about an element that is new."""
    if difference.element != ROOT:
        return difference.before is None and difference.field != "" and difference.element not in mechanism.graph
    if difference.field in format.boilerplate:
        return True
    return difference.before is None and difference.field.startswith(f"{format.expands_to or format.family} ")


def _loss(difference: Difference, mechanism: Mechanism, aligned: Mechanism, names: Mapping[Id, str], *, is_kept: bool) -> Loss:
    key, field, before, after = difference
    origin = mechanism.origin(key)
    if key == ROOT:
        return Loss("mechanism", field, before, after, _fate(field, after, is_kept), origin, "", "mechanism")
    target = f"{key.kind} '{names.get(key, key.name)}'" if key in aligned.graph else None
    return Loss(str(key), field, before, after, _fate(field, after, is_kept), origin, unit_of(mechanism, key, field), target)


def _fate(field: str, after: str | None, is_kept: bool) -> Fate:
    if is_kept:
        return "kept"
    last = field.rpartition(".")[2]
    is_absent = after is None or (after in _ABSENT and last != "weight") or (after == "0" and last in _ABSENT_AT_ZERO)
    return "dropped" if is_absent else "approximated"
