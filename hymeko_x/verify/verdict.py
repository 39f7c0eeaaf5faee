"""The result of a verification: the checks that were made, their worst differences, and what was not compared."""

from __future__ import annotations

import math
from typing import Literal

from msgspec import Struct

Answer = Literal["same", "different", "not comparable"]
Json = dict[str, "str | float | bool | list[str] | list[dict[str, str | float | bool | None]] | None"]


class Check(Struct, frozen=True):
    """One quantity: its worst difference in its unit, where that is, and how much is allowed."""

    quantity: str
    unit: str
    worst: float
    at: str
    allowed: float

    @property
    def passed(self) -> bool:
        """Whether the worst difference is allowed; not-a-number never is."""
        return bool(self.worst <= self.allowed)  # a bool of numpy cannot be written as JSON

    def as_json(self) -> dict[str, str | float | bool | None]:
        """The keys of the ``--json`` contract. Infinity has no spelling in JSON and becomes null."""
        return {
            "quantity": self.quantity,
            "unit": self.unit,
            "worst": self.worst if math.isfinite(self.worst) else None,
            "at": self.at,
            "allowed": self.allowed,
            "passed": self.passed,
        }


class Verdict(Struct, frozen=True):
    """The result. ``engines`` are the two reference readers; ``reason`` is why robots are not comparable."""

    engines: tuple[str, str]
    checks: tuple[Check, ...] = ()
    not_compared: tuple[str, ...] = ()
    reason: str = ""

    @property
    def verdict(self) -> Answer:
        """``same``, ``different`` or ``not comparable``."""
        if self.reason:
            return "not comparable"
        return "same" if all(check.passed for check in self.checks) else "different"

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
            "not_compared": [*([self.reason] if self.reason else []), *self.not_compared],
        }
