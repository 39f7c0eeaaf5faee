"""Factoring: forms that repeat up to parameters are written once, as macros.

Works on any tree of tags and texts, so that one pass serves every backend. A backend

1. hands in its own text as forms (:class:`~hymeko_x.factor.forms.Element`: tag, leaves, children) and a :class:`Dialect`:
   the costs of definitions, calls and holes in its text, in characters;
2. gets back :class:`~hymeko_x.factor.forms.Factored`: macros with parameters and defaults, named values, and the items with calls
   among them. ``expand(factor(forms, dialect)) == forms``, to the last digit of every number;
3. prints holes, calls and macros in its own spelling::

    forms = (
        Element("link", (("name", "l_hip"), ("mass", "1.5"), ("at", "0 0.1 0"), ("com", "0 0.02 0"))),
        Element("link", (("name", "r_hip"), ("mass", "1.5"), ("at", "0 -0.1 0"), ("com", "0 -0.02 0"))),
        ...
    )
    found = factor(forms, Dialect(call=9, hole=3, ...))
    # macros: hip(prefix, side=1) = link name=(Hole("prefix"), "_hip") mass="1.5" at=("0 ", Signed(("side",), False, "0.1"), " 0") ...
    # items:  Call("hip", (("prefix", "l"),)), Call("hip", (("prefix", "r"), ("side", "-1")))

A text is cut into numbers, words and separators; a hole takes whole pieces. Where numbers differ by their sign alone, and
the same signs change in several places, the sign becomes a parameter ("1" or "-1"; :class:`~hymeko_x.factor.forms.Signed`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.collector import uncollected
from hymeko_x.factor.find import families
from hymeko_x.factor.finish import finish, name_texts
from hymeko_x.factor.flat import Flat, Workspace, to_forms
from hymeko_x.factor.forms import Dialect
from hymeko_x.factor.macros import apply
from hymeko_x.factor.wrappers import tidy

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.factor.forms import Element, Factored

__all__ = ["Dialect", "factor"]

_MOST_ROUNDS = 12
"""Each round looks at the result of the one before, so that macros come to call macros; real robots need three to five."""


def factor(forms: Iterable[Element], dialect: Dialect) -> Factored:
    """The forms with macros for everything that repeats and is shorter so. Deterministic and near-linear in their number."""
    with uncollected():
        workspace = Workspace(to_forms(forms))
        for _ in range(_MOST_ROUNDS):
            flat = Flat(workspace, dialect)
            if not apply(families(flat, dialect), flat, workspace, dialect):
                break
        tidy(workspace, dialect)
        done = finish(workspace, dialect)
        return name_texts(done, dialect) if dialect.values else done
