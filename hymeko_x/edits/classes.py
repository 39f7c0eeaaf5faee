"""Default classes that the writer of a converted file made: its elements have what they give in fields of their own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import formats
from hymeko_x.ir.mechanism import ROOT

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Extra, Mechanism


def with_made_classes(edited: Mechanism, image: Mechanism, original: Mechanism, format: Format) -> Mechanism:
    """The edited robot with the classes of the image, where ORIGINAL has none: they are grouped anew by each conversion."""
    if not (format.class_elements and [*_classes(edited, format)]) or [*_classes(original, format)]:
        return edited
    made = [*_classes(image, format)]
    others = [extra for extra in edited.extras[ROOT] if not _is_class(extra, format)]
    return replace(edited, extras={**edited.extras, ROOT: (*made, *others)})


def edited_classes(edited: Mechanism, image: Mechanism, original: Mechanism, format: Format) -> list[str]:
    """What the classes of EDITED give beyond the fields of its elements, where that is not what those of the image give, in words.

    Where another number of classes was made, what they give cannot be compared.
    """
    if format.classes is None or format.inherited is None or [*_classes(original, format)]:
        return []
    mine, theirs = ([extra.text for extra in _classes(robot, format)] for robot in (edited, image))
    named, stripped = formats.loaded(format.classes), formats.loaded(format.inherited)
    if mine == theirs or named(mine).keys() != named(theirs).keys():
        return []
    rest = set(map(stripped, theirs))
    return [f"{format.name} classes: {text}" for text in mine if stripped(text) not in rest]


def _classes(robot: Mechanism, format: Format) -> Iterator[Extra]:
    """The extras of the whole that are classes of a format, and what is needed to understand them."""
    return (extra for extra in robot.extras.get(ROOT, ()) if _is_class(extra, format))


def _is_class(extra: Extra, format: Format) -> bool:
    return extra.format == format.name and extra.text.startswith(format.class_elements)
