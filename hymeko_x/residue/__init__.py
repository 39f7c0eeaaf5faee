"""What a format could not represent, so that it can be restored: the difference between a robot and its native image.

The *native image* of a mechanism in a format is what the format's own frontend reads from what its backend wrote.
:func:`residue_of` is the difference between the two, and :func:`restore` adds it to the image again, edited or not:

    restore(image, residue_of(source, image)) == source
    restore(edited image, residue) == source with the edit

Every entry has what the source says and what the image says, and is applied only where the image still says that, but for
rounding. So what an editor changed wins, what was deleted stays deleted, and what was added is kept.

Some differences are only another description of the same thing: another name, another frame on a body, a joint of
several dofs as a chain. They are not entries but a :class:`Alignment`, which is aligned first, with all edits.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from msgspec import Struct, field

from hymeko_x.ir.provenance import Provenance

if TYPE_CHECKING:
    from hymeko_x.compare.leaves import Path
    from hymeko_x.ir.mechanism import Extra, Id, RobotEdge
    from hymeko_x.ir.parts import VertexPart
    from hymeko_x.ir.values import Pose


class Fold(NamedTuple):
    """A joint that is a chain of joints in the image, with bodies between them that carry nothing."""

    joint: Id
    chain: tuple[Id, ...]
    between: tuple[Id, ...]


class Join(NamedTuple):
    """A shape for both roles that is two shapes in the image."""

    shape: Id
    twin: Id


class Alignment(Struct, frozen=True):
    """Which element of the image is which of the source, and where the image describes the same otherwise.

    ``names``: source id by the image's. ``folds`` and ``joins``: what the image takes leaves. ``frames``: pose of the source's
    body frame in the image's, where they differ. Coordinates of dofs are the same in both, as every writer sees to.
    """

    names: tuple[tuple[Id, Id], ...] = ()
    folds: tuple[Fold, ...] = ()
    joins: tuple[Join, ...] = ()
    frames: tuple[tuple[Id, Pose], ...] = ()


class Change(NamedTuple):
    """A field with its value in the source, and its other value in the image (``there``; NODEFAULT: the field's default)."""

    element: Id
    path: Path
    value: object
    there: object


class WholeElement(NamedTuple):
    """An element with its part: a vertex, or an edge with its arcs."""

    id: Id
    part: VertexPart | RobotEdge


class Landmark(NamedTuple):
    """By what else than its name an element of the image is known: the elements that it is on or with, and a few numbers."""

    element: Id
    beside: tuple[Id, ...] = ()
    numbers: tuple[float, ...] = ()


class Run(NamedTuple):
    """Elements that stand behind another one (None = at the head), in the source's order."""

    after: Id | None
    elements: tuple[Id, ...]


class Sides(Struct, frozen=True):
    """The side tables of the source where they differ: None takes an entry away.

    ``forgotten`` are keys of notations that only the image uses; ``is_plain``: only the image has stereotypes; ``foreign_extras`` are
    those that only the image has.
    """

    notations: tuple[tuple[Id, str, str | None], ...] = ()
    forgotten: tuple[str, ...] = ()
    stereotypes: tuple[tuple[Id, tuple[str, ...]], ...] = ()
    is_plain: bool = False
    extras: tuple[tuple[Id, Extra], ...] = ()
    foreign_extras: tuple[tuple[Id, Extra], ...] = ()


class Residue(Struct, frozen=True):
    """All of it.

    ``source`` is where the source came from; ``additions`` are the elements that only the source has, ``removals`` those that only the
    image has, ``weights`` shapes that both have and from which masses follow that only the image states.
    """

    source: Provenance = Provenance()
    alignment: Alignment = field(default_factory=Alignment)
    changes: tuple[Change, ...] = ()
    additions: tuple[WholeElement, ...] = ()
    removals: tuple[WholeElement, ...] = ()
    weights: tuple[WholeElement, ...] = ()
    sides: Sides = field(default_factory=Sides)
    order: tuple[Run, ...] = ()
    layout: tuple[Id, ...] | None = None
    """The source's layout, where it is another one; ``unplaced`` are elements that only the image has a place for."""
    unplaced: tuple[Id, ...] = ()
    landmarks: tuple[Landmark, ...] = ()

    @property
    def is_empty(self) -> bool:
        """Whether the image has everything."""
        entries = (self.changes, self.additions, self.removals, self.order)
        return not any(entries) and self.layout is None and self.alignment == Alignment() and self.sides == Sides()
