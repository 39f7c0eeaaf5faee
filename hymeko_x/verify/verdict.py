"""The result of a verification: the checks that were made, their worst differences, and what was not compared."""

from __future__ import annotations

import math

from msgspec import Struct

Row = dict[str, "str | float | bool | list[str] | None"]
Json = dict[str, "str | list[str] | list[Row]"]

SAME, DIFFERENT, NOT_COMPARABLE = "same", "different", "not comparable"


class Finding(Struct, frozen=True):
    """One difference of a quantity, where it arises, and what the two robots have there, where it is a value that can be shown."""

    at: str
    difference: float
    values: tuple[str, str] | None = None


class Check(Struct, frozen=True):
    """One quantity: its worst difference in its unit, where that is, and how much is allowed.

    ``values`` are what the two robots have there, where it is a value that can be shown. ``findings`` are all differences that are not
    allowed, each where it arises: for kinematics at the body whose pose in its parent's frame differs.
    """

    quantity: str
    unit: str
    worst: float
    at: str
    allowed: float
    values: tuple[str, str] | None = None
    findings: tuple[Finding, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether the worst difference is allowed; not-a-number never is."""
        return bool(self.worst <= self.allowed)  # a bool of numpy cannot be written as JSON

    def as_json(self) -> Row:
        """The keys of the ``--json`` contract. Infinity has no spelling in JSON and becomes null."""
        return {
            "quantity": self.quantity,
            "unit": self.unit,
            "worst": self.worst if math.isfinite(self.worst) else None,
            "at": self.at,
            "allowed": self.allowed,
            "passed": self.passed,
            "values": list(self.values) if self.values else None,
        }


class Gap(Struct, frozen=True):
    """A quantity that one robot has and the other one's format, or the engine that reads it, does not represent.

    ``names`` are those of the first few of ``count`` elements.
    """

    format: str
    quantity: str
    count: int
    names: tuple[str, ...] = ()

    def __str__(self) -> str:
        """``loops: 4 ('left-rod', 'right-rod', ...)``."""
        more = [*self.names, *(["..."] if self.names and self.count > len(self.names) else [])]
        shown = f" ({', '.join(more)})" if more else ""
        return f"{self.quantity}: {self.count}{shown}"

    def as_json(self) -> Row:
        """The keys of the ``--json`` contract."""
        return {"format": self.format, "quantity": self.quantity, "count": self.count, "names": list(self.names)}


class Verdict(Struct, frozen=True):
    """The result. ``engines`` are the two reference readers; ``reason`` is why robots are not comparable.

    ``gaps`` are what one of the formats cannot represent; ``nothing`` are the quantities of which there was nothing to compare.
    """

    engines: tuple[str, str]
    checks: tuple[Check, ...] = ()
    not_compared: tuple[str, ...] = ()
    reason: str = ""
    gaps: tuple[Gap, ...] = ()
    nothing: tuple[str, ...] = ()

    @property
    def verdict(self) -> str:
        """``same``, ``same as far as FORMAT can say``, ``different`` or ``not comparable``."""
        if self.reason:
            return NOT_COMPARABLE
        if self.failed:
            return DIFFERENT
        return f"same as far as {' and '.join(self.limits)} can say" if self.gaps else SAME

    @property
    def is_same(self) -> bool:
        """Whether the robots are the same in everything that both formats represent."""
        return not self.reason and not self.failed

    @property
    def limits(self) -> tuple[str, ...]:
        """The formats that cannot represent something of the other robot."""
        return tuple(dict.fromkeys(gap.format for gap in self.gaps))

    @property
    def failed(self) -> tuple[Check, ...]:
        """The checks that found a difference."""
        return tuple(check for check in self.checks if not check.passed)

    def as_json(self) -> Json:
        """The keys of the ``--json`` contract."""
        return {
            "verdict": self.verdict,
            "engines": list(self.engines),
            "checks": [check.as_json() for check in self.checks],
            "nothing_to_compare": list(self.nothing),
            "cannot_say": [gap.as_json() for gap in self.gaps],
            "not_compared": [*([self.reason] if self.reason else []), *self.not_compared],
        }
