"""What a difference between two robots tells of an edit."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import formats
from hymeko_x.compare.extras import format_of
from hymeko_x.ir.mechanism import ROOT

if TYPE_CHECKING:
    from hymeko_x.compare.diff import Difference
    from hymeko_x.ir.mechanism import Id


def aim(edit: Difference) -> tuple[Id, str, str | None]:
    """What an edit aims at, whatever stood there before it."""
    return edit.element, edit.field, edit.after


def has_other_forms(edit: Difference) -> bool:
    """Whether an edit is of what two equal robots have in several forms: the frames of a joint, a geom as a visual and a collision."""
    if edit.element.kind == "shape":
        return not edit.field
    return edit.element.kind == "joint" and ".weight" in edit.field


def is_of_extra(edit: Difference) -> bool:
    """Whether an edit is of a text that one format keeps verbatim, and that nothing else in the robot brings along.

    Elements bring the texts of classes and of unused assets along; a text of the whole that is gone may have gone with one of them.
    """
    row = format_of(edit.field)
    if row is None or is_of_asset(edit):
        return False
    return edit.element != ROOT or not (edit.after is None or edit.after.startswith(row.class_elements))


def is_without_inertial(edit: Difference) -> bool:
    """Whether a body has no inertial in EDITED alone."""
    return edit.element.kind == "body" and edit.field == "inertial" and edit.after == "none"


def is_of_asset(edit: Difference) -> bool:
    """Whether an edit is of a mesh, a material or an image, which a file may list without a use."""
    return edit.element.kind in _ASSETS


def is_lost_name(edit: Difference) -> bool:
    """Whether a shape has a name in EDITED alone."""
    return edit.element.kind == "shape" and edit.field == "name" and edit.before == "none"


def is_value_of_shape(edit: Difference) -> bool:
    """Whether a value of a shape differs, other than its name and what its mass follows from."""
    return edit.element.kind == "shape" and edit.field not in ("", "name", "mass", "density") and None not in (edit.before, edit.after)


def is_telling(edit: Difference) -> bool:
    """Whether a difference that is left is an edit, and not a value that one of two equal robots leaves to be computed."""
    if None in (edit.before, edit.after):
        return edit.element.kind in _WHOLE and not edit.field
    if is_weight(edit):
        return False
    return edit.element.kind in _GIVEN or not {"none", "[]"} & {edit.before, edit.after}


_WHOLE = frozenset({"body", "joint", "shape", "actuator", "sensor", "camera", "light", "coupling", "loop", "tendon", "contact"})
"""The kinds of elements that no format computes from others."""
_ASSETS = frozenset({"mesh", "material", "texture"})
_GIVEN = frozenset({"joint", "actuator", "sensor", "camera", "light", "tendon"})
"""The kinds of elements of which no format computes values."""


def is_weight(edit: Difference) -> bool:
    """Whether an edit is of the mass of a shape, which is part of its body's inertial."""
    return edit.element.kind == "shape" and edit.field in ("mass", "density")


def is_given_again(edit: Difference) -> bool:
    """Whether an edit gives a shape a name that it had not, as where one shape of that name has become several."""
    return edit.element.kind == "shape" and edit.field == "name" and edit.before in (None, "none")


def is_inherited(edit: Difference) -> bool:
    """Whether an edit is one of classes alone, which the elements have in fields of their own."""
    rows = [formats.loaded(row.inherited) for row in formats.FORMATS if row.inherited is not None and edit.field.startswith(f"{row.name} ")]
    return any(function(text or "") == function("") for function in rows for text in (edit.after or edit.before,))
