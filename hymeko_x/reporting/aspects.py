"""Which aspect of a robot a loss concerns: people want the physical first, and everything else in one line."""

from __future__ import annotations

import math
import re
from enum import Enum
from typing import TYPE_CHECKING

from hymeko_x.ir.parts import MESH_POINTS
from hymeko_x.reporting.values import error_of, is_extra
from hymeko_x.rewrite.inertia import LEAST

if TYPE_CHECKING:
    from hymeko_x.compare.ledger import Loss


class Aspect(Enum):
    """What a loss concerns, the most important first."""

    PHYSICS = "physics"
    """Bodies, joints, shapes, actuators, sensors, and their numbers."""
    SETTINGS = "settings"
    """Extras: what only one format or its engine understands."""
    FORM = "form"
    """The same in another form: a chain of joints, two shapes for one of both roles, an inertia that an engine computes written out."""
    NAME = "name"
    """A name, or the path of a file."""
    APPEARANCE = "appearance"
    """Materials, textures, colours, lights, what is seen of a mesh, the size at which a frame is drawn."""
    TEXT = "text"
    """Comments and declarations."""


_FORMS = ("chain", "frame")
_COMPUTED_VALUES = ("none", "noshape()")
"""What the source leaves to an engine, and the target has in numbers."""
_SAME_SURFACE = "content.order of triangles"
"""Of a mesh whose surface is what it was."""
_COMPUTED = ("mass", "density")
"""Of a shape: from these an engine computes the inertia of its body, which is written out."""
_DRAWN = ("material", "texture", "layer", "subset", "light")
_DRAWN_FIELDS = ("rgba", "width")
_DRAWN_CONTENT = ("texture coordinates", "places in the image", "normals", "turn of normals")
"""Of a mesh: what is seen of it, and nothing touches."""
_DRAWN_EXTRAS = re.compile(r"@(rgba|group|material|type)$")
_DECLARATION = re.compile(r"@xmlns\b|text\(\)$")
_MATERIAL = re.compile(r"(?:\S+ )?material '[^']*'(?: as 'material')?")
"""An arc to a material, or the material to which it leads; a shape that has one is more than that."""
_ONLY_SEEN = re.compile(r"mesh\(|shape\(.*, role visual, ")
"""The text of a mesh, or of a shape that nothing touches: one that is new is a piece of what was there."""


def aspect_of(loss: Loss) -> Aspect:
    """The aspect of a loss, from its element's kind, its field, and what stands on its two sides."""
    kind, field = kind_of(loss), loss.field
    if field.startswith("comment ") or _DECLARATION.search(field):
        return Aspect.TEXT
    if kind in _DRAWN or _MATERIAL.fullmatch(loss.before or loss.after or ""):
        return Aspect.APPEARANCE
    if kind == "frame" and (field == "size" or _DRAWN_EXTRAS.search(field)):
        return Aspect.APPEARANCE
    if is_extra(loss):
        return Aspect.SETTINGS if loss.before is not None else Aspect.FORM  # the words of the target for what the source has as well
    if kind == "body" and field.startswith("inertial.") and (error_of(loss) or math.inf) <= 2.0 * LEAST:
        return Aspect.FORM
    if loss.before is None and not field and _ONLY_SEEN.match(loss.after or ""):
        return Aspect.FORM
    if (
        field in (*_FORMS, _SAME_SURFACE)
        or loss.before in _COMPUTED_VALUES
        or ((kind, field) == ("shape", "role") and loss.before == "both")
    ):
        return Aspect.FORM
    last = field.rpartition(".")[2]
    if last == "name" or (last == "uri" and kind == "mesh") or (last == "role" and _is_number_or_name(loss)):
        return Aspect.NAME
    if (last in _DRAWN_FIELDS and kind in ("shape", "tendon")) or (last in _DRAWN_CONTENT and kind == "mesh"):
        return Aspect.APPEARANCE
    is_computed = (kind == "shape" and field in _COMPUTED) or (kind == "mesh" and field in MESH_POINTS)
    return Aspect.FORM if is_computed else Aspect.PHYSICS


def _is_number_or_name(loss: Loss) -> bool:
    """Whether a dof, which is the role of an arc, has its number on one side and a name on the other."""
    return [(text or "").strip("'").isdigit() for text in (loss.before, loss.after)] in ([True, False], [False, True])


def kind_of(loss: Loss) -> str:
    """The kind of a loss's element: ``joint`` of ``joint 'elbow'``."""
    return loss.element.partition(" ")[0]
