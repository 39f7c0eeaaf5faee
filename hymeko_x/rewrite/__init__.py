"""Rewriting a mechanism so that a format can represent it: one pure function per feature, in a fixed order per format.

A rule takes a mechanism and returns one that is legal in its respect; it reports what it changed, and a
second application changes nothing. Backends receive the result and only print.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import formats
from hymeko_x.rewrite.choices import choose
from hymeko_x.rewrite.context import Context, Options, Rule

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism

__all__ = ["Context", "Options", "Rule", "actuate", "choose", "legalize", "rules_of"]


def rules_of(target: str, *, native: bool = False) -> tuple[Rule, ...]:
    """The rules of a format, loaded now; ``native`` for what came from this format and goes there again."""
    rules = formats.by_name(target).rules
    if rules is None:
        return ()
    module = formats.loaded(rules)
    found: tuple[Rule, ...] = getattr(module, "NATIVE", module.RULES) if native else module.RULES
    return found


def actuate(mechanism: Mechanism, target: str, options: Options, report: Report) -> Mechanism:
    """The mechanism with what the engine of a format needs besides for the actuators that the options ask for. Idempotent."""
    rules = formats.by_name(target).rules
    if options.actuators is None or rules is None:
        return mechanism
    context = Context(report, reason=f"--actuators {options.actuators}")
    found: tuple[Rule, ...] = getattr(formats.loaded(rules), "ACTUATED", ())
    for rule in found:
        mechanism = rule(mechanism, context)
    return mechanism


def legalize(mechanism: Mechanism, target: str, report: Report) -> Mechanism:
    """The mechanism rewritten so that the target's backend can print all of it. Idempotent."""
    context, row = Context(report), formats.by_name(target)
    for rule in rules_of(target, native=row.family == mechanism.source.format):
        mechanism = rule(mechanism, context)
    return mechanism
