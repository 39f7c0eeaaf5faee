"""Declarations of XML namespaces in elements that are kept as text, and those that the root of their file has."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.ir.mechanism import ROOT
from hymeko_x.xml.text import attributes_text, escaped

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.ir.mechanism import Extra, Mechanism

PREFIX = "xmlns:"
_GAZEBO = "http://playerstage.sourceforge.net/gazebo/xmlschema/#"
KNOWN_PREFIXES = {
    "xacro": "http://www.ros.org/wiki/xacro",
    "drake": "http://drake.mit.edu",
    "gz": "http://gazebosim.org/schema",
    **{word: f"{_GAZEBO}{word}" for word in ("body", "controller", "geom", "interface", "sensor")},
}
"""What an undeclared prefix stands for; others become ``urn:prefix``."""

_HEAD = re.compile(r"<[^\s/>]+")


def without_declared(text: str, declared: Mapping[str, str]) -> str:
    """An element's text without the namespace declarations (attribute -> uri) right behind its name that stand further up already."""
    name = _HEAD.match(text)
    if name is None:
        return text
    rest = text[name.end() :]
    known = [f' {attribute}="{escaped(uri)}"' for attribute, uri in declared.items()]
    while (repeated := next((words for words in known if rest.startswith(words)), None)) is not None:
        rest = rest.removeprefix(repeated)
    return name[0] + rest


def with_declared(text: str, declared: Mapping[str, str], *, again: bool = False) -> str:
    """An element's text with the declarations (attribute -> uri) of those prefixes that it uses and does not declare, by name.

    ``again``: also of those that only elements in it declare.
    """
    name = _HEAD.match(text)
    own = text.partition(">")[0] if again else text
    needed = {word: declared[word] for word in sorted(declared) if f"{word.removeprefix(PREFIX)}:" in text and f"{word}=" not in own}
    return text if name is None or not needed else name[0] + attributes_text(needed) + text[name.end() :]


def with_texts(mechanism: Mechanism, change: Callable[[str, Mapping[str, str]], str]) -> Mechanism:
    """The mechanism with its elements of formats as ``change`` makes them from their texts and what the whole declares for their format."""
    declared: dict[str, dict[str, str]] = {}
    for extra in mechanism.extras.get(ROOT, ()):
        if extra.path.startswith(f"@{PREFIX}"):
            declared.setdefault(extra.format, {})[extra.path[1:]] = extra.text

    def changed(extra: Extra) -> Extra:
        spaces = declared.get(extra.format, {}) if extra.text.startswith("<") else {}
        text = change(extra.text, spaces) if spaces else extra.text
        return extra if text == extra.text else replace(extra, text=text)

    return replace(mechanism, extras={key: tuple(map(changed, own)) for key, own in mechanism.extras.items()}) if declared else mechanism
