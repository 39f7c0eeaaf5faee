"""Factoring in rounds, each of which looks at the result of the one before."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.collector import uncollected
from hymeko_x.factor.find import families
from hymeko_x.factor.finish import finish, name_texts
from hymeko_x.factor.flat import FactoringState, Flat, to_forms
from hymeko_x.factor.macros import apply
from hymeko_x.factor.wrappers import tidy

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.factor.forms import Dialect, Factored, FormElement

_MOST_ROUNDS = 12
"""Each round looks at the result of the one before, so that macros come to call macros; real robots need three to five."""


def factor(forms: Iterable[FormElement], dialect: Dialect) -> Factored:
    """The forms with macros for everything that repeats and is shorter so. Deterministic and near-linear in their number."""
    with uncollected():
        workspace = FactoringState(to_forms(forms))
        for _ in range(_MOST_ROUNDS):
            flat = Flat(workspace, dialect)
            if not apply(families(flat, dialect), flat, workspace, dialect):
                break
        tidy(workspace, dialect)
        done = finish(workspace, dialect)
        return name_texts(done, dialect) if dialect.values else done
