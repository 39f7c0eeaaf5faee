"""What a rule is given besides the mechanism: the options of the user, and the report."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

from msgspec import Struct

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism


class Options(Struct, frozen=True):
    """What the user chose for the output.

    ``base``: what becomes of an open base (None = the target's own default). ``actuators``: which kind to give every
    driven dof, ``none`` to write none, None to write those that the mechanism has and the target knows. ``layout`` and
    ``nested``: how a stage of USD is laid out (None = one file with flat bodies). ``split``: whether the macros of xacro
    go into a file of their own. ``pure``: whether the output carries no residue. ``lenient``: whether errors are passed over.
    ``beside``: how files of our own that may stand beside the output begin, which is its own name; empty = there is no place.
    ``within``: the folder below the output's own that holds every file beside it, and ends in a slash; empty = each where it belongs.
    """

    base: Literal["fixed", "free"] | None = None
    actuators: Literal["none", "motor", "position", "velocity"] | None = None
    layout: Literal["single", "layered"] | None = None
    nested: bool | None = None
    split: bool = False
    pure: bool = False
    lenient: bool = False
    beside: str = ""
    within: str = ""


class Context(Struct, frozen=True):
    """The circumstances of one rewriting: the user's options, and the report of what is changed."""

    options: Options
    report: Report


Rule = Callable[["Mechanism", Context], "Mechanism"]
"""One step of rewriting. It reports every change, and applied again it changes nothing."""
