"""The report of a conversion as SARIF 2.1.0, which code hosts and editors show at the lines of the source.

Source: https://docs.oasis-open.org/sarif/sarif/v2.1.0/sarif-v2.1.0.html
"""

from __future__ import annotations

from typing import TYPE_CHECKING
from urllib.parse import quote

from hymeko_x.codes import CODES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.reporting.document import Json

_SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/os/schemas/sarif-schema-2.1.0.json"

_FATES = {
    "kept": ("note", "The target cannot represent it; the output keeps it for the way back."),
    "approximated": ("note", "The target represents something else."),
    "dropped": ("warning", "The target cannot represent it."),
}
"""The level of a physical loss of each fate, and what the fate means."""


def sarif(document: Json) -> Json:
    """The JSON report as one SARIF run: a result for each diagnostic and each loss; the properties of a loss are its JSON entry."""
    results = [*_diagnostics(document), *_losses(document)]
    used = dict.fromkeys(str(result["ruleId"]) for result in results)
    driver = {"name": "hymeko-x", "rules": [_rule(rule) for rule in used]}
    return {"$schema": _SCHEMA, "version": "2.1.0", "runs": [{"tool": {"driver": driver}, "results": results}]}


def _rule(rule: str) -> Json:
    if rule in CODES:
        code = CODES[rule]
        return {"id": rule, "shortDescription": {"text": code.title}, "fullDescription": {"text": code.explanation}}
    return {"id": rule, "shortDescription": {"text": _FATES[rule][1]}}


def _diagnostics(document: Json) -> Iterator[Json]:
    for row in _rows(document, "diagnostics"):
        hint = f" ({row['hint']})" if row["hint"] else ""
        yield _result(str(row["code"]), str(row["severity"]), f"{row['message']}{hint}", row)


def _losses(document: Json) -> Iterator[Json]:
    for row in _rows(document, "losses"):
        level = _FATES[str(row["fate"])][0] if row["aspect"] == "physics" else "note"
        unit = f" {row['unit']}" if row["unit"] else ""
        change = " -> ".join("nothing" if row[key] is None else f"{row[key]}{unit}" for key in ("before", "after"))
        result = _result(str(row["fate"]), level, f"{row['element']} {row['field']} {row['fate']}: {change}", row)
        yield {**result, "properties": row}


def _rows(document: Json, key: str) -> Iterator[Json]:
    rows = document[key]
    assert isinstance(rows, list)
    yield from rows


def _result(rule: str, level: str, message: str, row: Json) -> Json:
    result: Json = {"ruleId": rule, "level": level, "message": {"text": message}}
    if row["file"]:
        place: Json = {"artifactLocation": {"uri": quote(str(row["file"]))}}
        if row["line"]:
            place["region"] = {"startLine": row["line"]}
        result["locations"] = [{"physicalLocation": place}]
    return result
