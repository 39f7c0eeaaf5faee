"""What all views of elements have in common, and mappings of them by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from hymeko_x.diagnostics import listed
from hymeko_x.robot.errors import EditError, hint_of, unknown_name

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Origin
    from hymeko_x.ir.mechanism import Id, RobotArc
    from hymeko_x.robot.draft import Draft

V = TypeVar("V", bound="Element")


class Element:
    """One element: its ``name``, and the id and the draft to which it belongs."""

    def __init__(self, draft: Draft, key: Id) -> None:
        self.draft = draft
        self.id = key

    if not TYPE_CHECKING:  # a type checker that sees it takes every field

        def __setattr__(self, name: str, value: Any) -> None:
            """Assign a field. Raises: EditError for one that elements of this kind do not have."""
            if name not in ("draft", "id") and not hasattr(type(self), name):
                fields = [field for field in dir(type(self)) if not field.startswith("_")]
                raise EditError(f"{self.id} has no {name!r}; {hint_of(name, fields, 'fields')}")
            super().__setattr__(name, value)

    @property
    def name(self) -> str:
        """Its name, unique among the elements of its kind."""
        return self.id.name

    @property
    def part(self) -> Any:
        """The frozen value of :mod:`hymeko_x.ir.parts` that the element carries. Raises: EditError when it was removed."""
        try:
            return self.draft.part(self.id)
        except KeyError:
            raise EditError(f"{self.id} is no longer there") from None

    @property
    def origin(self) -> Origin | None:
        """File and line of its source, if known."""
        return self.draft.mechanism.origin(self.id)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Element) and (self.draft, self.id) == (other.draft, other.id)

    def __hash__(self) -> int:
        return hash(self.id)

    def __repr__(self) -> str:
        return f"<{self.id}>"

    @property
    def posed(self) -> Id:
        """The edge whose arcs have its poses: its own."""
        return self.id

    def arc(self, edge: Id, sign: int) -> RobotArc | None:
        """The first arc of an edge with this sign."""
        return next((arc for arc in self.draft.edges[edge].arcs if arc.sign == sign), None)


class Elements(Mapping[str, V], Generic[V]):
    """The elements of one kind by name, in order. An unknown name is a KeyError that lists similar ones."""

    def __init__(self, draft: Draft, kind: str, view: type[V]) -> None:
        self._draft, self._kind, self._view = draft, kind, view

    def __getitem__(self, name: str) -> V:
        key = self._draft.find(self._kind, name)
        if key is None:
            raise unknown_name(self._kind, name, self)
        return self._view(self._draft, key)

    def __iter__(self) -> Iterator[str]:
        return (key.name for key in self._draft.ids(self._kind))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __contains__(self, name: object) -> bool:
        return self._draft.find(self._kind, str(name)) is not None

    def __repr__(self) -> str:
        names = [*self]
        return f"<{len(names)} of kind {self._kind}: {listed(names, 8)}>"
