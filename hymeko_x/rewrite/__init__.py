"""What a target cannot say, rewritten into what it can: one pure function per feature, in a fixed order per target.

A rule takes a mechanism and returns one that is legal in its respect; it says in the report what it changed, and a
second application changes nothing. Backends receive the result and only print.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Literal

from hymeko_x import formats
from hymeko_x.frozen import frozen
from hymeko_x.ir.mechanism import ROOT

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism


@frozen
class Options:
    """What the user chose for the output.

    ``base``: what becomes of an open base (None = the target's own default). ``actuators``: which kind to give every
    driven dof, ``none`` to write none, None to write those that the mechanism has and the target knows. ``layout`` and
    ``nested``: how a stage of USD is laid out (None = as it was, else one file with flat bodies). ``split``: whether the
    macros of xacro go into a file of their own. ``pure``: whether the output carries nothing but what its format says.
    ``beside``: how files of our own that may stand beside the output begin, which is its own name; empty = there is no place.
    ``within``: the folder below the output's own that holds every file beside it, and ends in a slash; empty = each where it belongs.
    """

    base: Literal["fixed", "free"] | None = None
    actuators: Literal["none", "motor", "position", "velocity"] | None = None
    layout: Literal["single", "layered"] | None = None
    nested: bool | None = None
    split: bool = False
    pure: bool = False
    beside: str = ""
    within: str = ""


WITHIN = "files.within"
"""The notation of a mechanism whose files stand below a folder of their own; see :class:`Options`."""


Rule = Callable[["Mechanism", Options, "Report"], "Mechanism"]


def rules_of(target: str, *, native: bool = False) -> tuple[Rule, ...]:
    """The rules of a target, loaded now; ``native`` for what came from MJCF and goes there again. None = it takes every mechanism."""
    rules = formats.by_name(target).rules
    if rules is None:
        return ()
    module = formats.loaded(rules)
    found: tuple[Rule, ...] = module.NATIVE if native else module.RULES
    return found


def legalize(mechanism: Mechanism, target: str, options: Options, report: Report) -> Mechanism:
    """The mechanism rewritten so that the target's backend can print all of it. Idempotent.

    What came from MJCF, directly, through HyMeKo text or carried by another file, is legal there but for what was edited since.
    """
    native = formats.by_name(target) is formats.native_format(mechanism)
    for rule in rules_of(target, native=native):
        mechanism = rule(mechanism, options, report)
    if options.within:
        own = {**mechanism.notations.get(ROOT, {}), WITHIN: options.within}
        return replace(mechanism, notations={**mechanism.notations, ROOT: own})
    return mechanism
