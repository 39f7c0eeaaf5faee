"""References to elements by their names, in what only one format represents."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import formats
from hymeko_x.xml.references import with_new_names_in_fragments

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism


def with_references(mechanism: Mechanism, names: Mapping[Id, Id]) -> Mechanism:
    """The mechanism, whose elements have their new names already, with these names in its notations and fragments as well."""
    fragments = frozenset(row.name for row in formats.FORMATS if row.has_fragments)
    mechanism = with_new_names_in_fragments(mechanism, names, fragments) if names else mechanism
    notations = mechanism.notations
    for row in formats.FORMATS:
        if row.references is not None and names:
            notations = formats.loaded(row.references)(notations, names)
    return mechanism if notations is mechanism.notations else replace(mechanism, notations=notations)
