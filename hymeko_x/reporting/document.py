"""The report of a conversion as JSON: `conversion.schema.json` beside this file describes it, docs/report.md explains it."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING

from hymeko_x.reporting.aspects import aspect_of, kind_of
from hymeko_x.reporting.values import error_of, values_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from hymeko_x.compare.ledger import Loss
    from hymeko_x.diagnostics import Diagnostic
    from hymeko_x.reporting.values import Value

Json = dict[str, object]

VERSION = 1
"""Raised when a key changes its meaning or goes away; new keys may come without."""

FATES = ("kept", "approximated", "dropped")


def document(source: tuple[str, str], target: tuple[str, str], diagnostics: Iterable[Diagnostic], losses: Sequence[Loss] | None) -> Json:
    """The report; source and target are path and format. ``losses`` None: they were not measured, which ``measured`` says."""
    entries = [_entry(loss) for loss in losses or ()]
    counts = Counter(str(entry["fate"]) for entry in entries)
    return {
        "report": "hymeko-x conversion",
        "version": VERSION,
        "source": {"path": source[0], "format": source[1]},
        "target": {"path": target[0], "format": target[1]},
        "measured": losses is not None,
        "counts": {fate: counts[fate] for fate in FATES},
        "diagnostics": [diagnostic.as_json() for diagnostic in diagnostics],
        "losses": entries,
    }


def _entry(loss: Loss) -> Json:
    before, after = map(_spelled, values_of(loss))
    error = error_of(loss)
    return {
        "element": loss.element,
        "target_element": loss.target,
        "kind": kind_of(loss),
        "field": loss.field,
        "aspect": aspect_of(loss).value,
        "before": before,
        "after": after,
        "unit": loss.unit or None,
        "error": _spelled(error) if error is not None and math.isfinite(error) else None,
        "fate": loss.fate,
        "file": loss.origin.file if loss.origin else None,
        "line": loss.origin.line if loss.origin else None,
    }


def _spelled(value: Value) -> object:
    """A value as JSON has it: numbers that are not finite become words."""
    if isinstance(value, list):
        return [_spelled(number) for number in value]
    if isinstance(value, float) and not isinstance(value, bool):
        return (int(value) if value.is_integer() and abs(value) < 1e15 else value) if math.isfinite(value) else str(value)
    return value
