"""What a report calls the pieces of a stage that are kept as text."""

from __future__ import annotations

import re

_NEW = re.compile(r'def (\w+) "')
_METADATA = re.compile(r"^ {4}(\w+) =", re.MULTILINE)
_ADDED = re.compile(
    r'"(\w+API(?::\w+)?)"|^ {4}(?!prepend |append |delete |add |reorder )(?:custom |uniform )*(?:rel|[\w\[\]]+) ([\w:]+)', re.MULTILINE
)
"""An applied schema, or a property of the prim itself."""


def settings(text: str) -> list[str]:
    """The type of a prim; of a prim that an element became the schemas and properties that were left; the metadata of a stage."""
    if text.startswith("#usda"):
        return [f"{name} of the stage" for name in _METADATA.findall(text)]
    new = _NEW.match(text)
    return [new[1]] if new else [schema or name for schema, name in _ADDED.findall(text)]
