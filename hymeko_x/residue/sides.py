"""The order of elements and the side tables of mechanisms: how the image differs from the source in them, and restoring them."""

from __future__ import annotations

from bisect import bisect_left
from collections import defaultdict
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.compare.extras import as_meant, as_written, unshared
from hymeko_x.ir.fields import identical
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.residue import Run, Sides
from hymeko_x.residue.alike import without_inherited
from hymeko_x.xml.unread import COMMENT

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from hymeko_x.ir.mechanism import Extra, Id, Mechanism
    from hymeko_x.residue import Residue

    Notations = Mapping[Id, Mapping[str, str]]

# ---- order ---------------------------------------------------------------------------------------------------------------


def by_kind(keys: Iterable[Id]) -> dict[str, list[Id]]:
    """The elements of each kind in their order, which is all of a graph's order that means something."""
    found: dict[str, list[Id]] = defaultdict(list)
    for key in keys:
        found[key.kind].append(key)
    return dict(found)


def moves(have: Sequence[Id], want: Sequence[Id]) -> Iterator[Run]:
    """The fewest elements to move so that one order becomes the other, of the same elements."""
    if have == want:
        return
    place = {key: number for number, key in enumerate(have)}
    staying = _rising([place[key] for key in want])
    after: Id | None = None
    run: list[Id] = []
    for key in want:
        if place[key] not in staying:
            run.append(key)
            continue
        if run:
            yield Run(after, tuple(run))
            run = []
        after = key
    if run:
        yield Run(after, tuple(run))


def _rising(numbers: Sequence[int]) -> set[int]:
    """A longest rising subsequence, in n log n."""
    tops: list[int] = []
    before: dict[int, int | None] = {}
    for number in numbers:
        level = bisect_left(tops, number)
        before[number] = tops[level - 1] if level else None
        tops[level : level + 1] = [number]
    found: set[int] = set()
    last: int | None = tops[-1] if tops else None
    while last is not None:
        found.add(last)
        last = before[last]
    return found


def moved(have: Sequence[Id], runs: Sequence[Run]) -> list[Id]:
    """The order with the runs in their places; a run whose place is gone stands behind the one before it."""
    there = set(have)
    going = {key for run in runs for key in run.elements if key in there}
    behind: dict[Id | None, list[Id]] = defaultdict(list)
    last: Id | None = None
    for run in runs:
        last = run.after if run.after is None or run.after in there else last
        behind[last] += [key for key in run.elements if key in going]
    result = list(behind[None])
    for key in have:
        if key not in going:
            result.append(key)
            result += behind.get(key, [])
    placed = set(result)
    return result + [key for key in have if key not in placed]


def laid_out(have: Sequence[Id], want: Sequence[Id], known: set[Id]) -> tuple[Id, ...]:
    """The wanted layout of the elements that are there; what is not known stays behind the element, and the body, that it stood behind."""
    behind: dict[Id | None, list[Id]] = defaultdict(list)
    places: dict[Id | None, int] = {key: place for place, key in enumerate(want)}
    last: Id | None = None
    body: Id | None = None
    for key in have:
        if key in places:
            last, body = key, key if key.kind == "body" else body
        elif key not in known:
            behind[max(last, body, key=lambda one: places.get(one, -1))].append(key)
    result = list(behind[None])
    for key in want:
        result += [key, *behind.get(key, [])]
    return tuple(result)


# ---- side tables -------------------------------------------------------------------------------------------------------------


def sides_between(image: Mechanism, source: Mechanism) -> Sides:
    """What stands beside the graph."""
    written, noted = source.notations, image.notations
    used = {name for table in written.values() for name in table}
    forgotten = {name for table in noted.values() for name in table} - used
    extras = tuple(_extras(image, source))
    return Sides(
        tuple(_notations(noted, written, forgotten)),
        tuple(sorted(forgotten)),
        tuple(_stereotypes(image, source)) if source.stereotypes else (),
        bool(image.stereotypes) and not source.stereotypes,
        tuple((key, extra) for key, extra, new in extras if new),
        tuple((key, extra) for key, extra, new in extras if not new),
    )


def _notations(image: Notations, source: Notations, forgotten: set[str]) -> Iterator[tuple[Id, str, str | None]]:
    for key, table in source.items():
        mine = image.get(key, {})
        yield from ((key, name, text) for name, text in table.items() if mine.get(name) != text)
    for key, table in image.items():
        theirs = source.get(key, {})
        yield from ((key, name, None) for name in table if name not in theirs and name not in forgotten)


def _stereotypes(image: Mechanism, source: Mechanism) -> Iterator[tuple[Id, tuple[str, ...]]]:
    """The stereotypes of the source that the image has not; macros that another format found anew may have their names by chance."""
    mine = image.stereotypes if image.source.format == source.source.format else {}
    for key in dict.fromkeys([*source.stereotypes, *mine]):
        if mine.get(key, ()) != source.stereotypes.get(key, ()):
            yield key, source.stereotypes.get(key, ())


def _extras(image: Mechanism, source: Mechanism) -> Iterator[tuple[Id, Extra, bool]]:
    """The extras to add (True) and to take away (False): those that differ, or all where the order would."""
    for key in dict.fromkeys([*source.extras, *image.extras]):
        mine, theirs = image.extras.get(key, ()), source.extras.get(key, ())
        if identical(mine, theirs):
            continue
        kept = [extra for extra in mine if any(identical(extra, other) for other in theirs)] if len(mine) < 100 else []
        if not identical(tuple(kept), theirs[: len(kept)]):
            kept = []
        rest = list(kept)
        for extra in mine:
            if rest and rest[0] is extra:
                rest.pop(0)
            else:
                yield key, extra, False
        yield from ((key, extra, True) for extra in theirs[len(kept) :])


def with_sides(mechanism: Mechanism, residue: Residue, image: Mechanism) -> Mechanism:
    """The mechanism with the residue's side tables: notations, origins, extras and layout."""
    sides = residue.sides
    there = {ROOT, *mechanism.graph.vertices, *mechanism.graph.edges}
    noted = image.notations.items()
    notations = {key: {name: text for name, text in table.items() if name not in sides.forgotten} for key, table in noted}
    for key, name, text in sides.notations:
        if text is None:
            notations.get(key, {}).pop(name, None)
        elif key in there:
            notations.setdefault(key, {})[name] = text
    is_own = image.source.format == residue.source.format and not sides.is_plain
    stereotypes = {**(image.stereotypes if is_own else {}), **dict(sides.stereotypes)}
    layout = image.layout if residue.layout is None else laid_out(image.layout, residue.layout, set(residue.unplaced))
    return replace(
        mechanism,
        notations={key: table for key, table in notations.items() if table and key in there},
        stereotypes={key: names for key, names in stereotypes.items() if names and key in there},
        extras=_restored_extras(residue, image, there),
        layout=tuple(key for key in layout if key in there),
        source=residue.source._replace(file=image.source.file),
    )


def _restored_extras(residue: Residue, image: Mechanism, there: set[Id]) -> dict[Id, tuple[Extra, ...]]:
    """The extras of the image with those of the source. One that both had, and that was taken out of the image, stays out."""
    foreign: dict[Id, list[Extra]] = defaultdict(list)
    own: dict[Id, list[Extra]] = defaultdict(list)
    for table, rows in ((foreign, residue.sides.foreign_extras), (own, residue.sides.extras)):
        for key, extra in rows:
            table[key].append(extra)
    restored: dict[Id, tuple[Extra, ...]] = {}
    for key in dict.fromkeys([*image.extras, *own]):
        left, gone = unshared(image.extras.get(key, ()), foreign[key], as_written, without_inherited, as_meant)
        deleted = [extra for extra in gone if extra.format != COMMENT]  # programs that save a file leave comments out
        restored[key] = (*left, *unshared(own[key], deleted, as_written, as_meant)[0])
    return {key: found for key, found in restored.items() if found and key in there}
