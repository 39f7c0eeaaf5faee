"""The JSON Schema of the documents, made from their types by msgspec."""

from __future__ import annotations

from inspect import cleandoc
from typing import Any

from msgspec.json import decode, encode, schema

from hymeko_x.formats.json import ENDLESS, NUMBERS, VERSION
from hymeko_x.formats.json.document import Document

DIALECT = "https://json-schema.org/draft/2020-12/schema"
_NUMBER: dict[str, Any] = {
    "description": "A double; what JSON has no number for is an object.",
    "anyOf": [
        {"type": "number"},
        {"type": "object", "properties": {ENDLESS: {"enum": [*NUMBERS]}}, "required": [ENDLESS], "additionalProperties": False},
    ],
}


def json_schema() -> dict[str, Any]:
    """The schema, draft 2020-12."""
    made: dict[str, Any] = decode(encode(schema(Document)))
    definitions = {name: _with_numbers(found) for name, found in made["$defs"].items()}
    return {
        "$schema": DIALECT,
        "$id": f"urn:hymeko-x:mechanism:{VERSION}",
        "title": f"A robot in the JSON form of hymeko-x, version {VERSION}",
        **{key: value for key, value in made.items() if key != "$defs"},
        "$defs": {"number": _NUMBER, **definitions},
    }


def _with_numbers(found: Any) -> Any:
    """A schema whose numbers may be those that JSON does not have. No deeper than the types are nested."""
    if isinstance(found, list):
        return [_with_numbers(item) for item in found]
    if not isinstance(found, dict):
        return found
    if found.get("type") == "number":
        return {**{key: value for key, value in found.items() if key != "type"}, "$ref": "#/$defs/number"}
    return {key: cleandoc(value) if key == "description" else _with_numbers(value) for key, value in found.items()}
