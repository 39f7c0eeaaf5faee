"""Where a file carries its residue, which all other readers of the format pass over.

URDF and xacro: ``<hymeko:residue>`` as the last child of the root. MJCF: ``<custom><text>``. USD: a string in the root
layer's ``customLayerData``. Each is split into parts below ten million characters, where some XML readers stop.
A frontend hands the text on as an extra of format ``residue``, which the pipeline takes off again.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.ir.mechanism import ROOT, Extra
from hymeko_x.xml.text import escaped_lines

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.ir.mechanism import Mechanism

RESIDUE = "residue"
XML_TAG = "hymeko:residue"
XML_NAMESPACE = "urn:hymeko-x"
MJCF_NAME = "hymeko-x residue"
USD_KEY = "hymeko:residue"
LONGEST_PART = 5_000_000

_END = re.compile(rb"</(robot|mujoco)\s*>(?:\s|<!--.*?-->)*\Z", re.DOTALL)
_EMPTY_END = re.compile(rb"/>(?:\s|<!--.*?-->)*\Z", re.DOTALL)


def parts(text: str) -> list[str]:
    """The text in pieces that every reader takes."""
    return [text[start : start + LONGEST_PART] for start in range(0, len(text), LONGEST_PART)]


def with_residue(mechanism: Mechanism, pieces: Iterable[str]) -> Mechanism:
    """The mechanism with what its file carried, for the pipeline."""
    text = "".join(pieces)
    if not text:
        return mechanism
    return replace(mechanism, extras={**mechanism.extras, ROOT: (*mechanism.extras.get(ROOT, ()), Extra(RESIDUE, "", text))})


def taken_off(mechanism: Mechanism) -> tuple[Mechanism, str]:
    """The mechanism without what its file carried, and that text."""
    own = mechanism.extras.get(ROOT, ())
    text = "".join(extra.text for extra in own if extra.format == RESIDUE)
    if not text:
        return mechanism, ""
    rest = tuple(extra for extra in own if extra.format != RESIDUE)
    return replace(mechanism, extras={**mechanism.extras, ROOT: rest}), text


def xml_elements(text: str, *, readable: bool = True) -> str:
    """The elements that carry a residue in URDF; ``readable`` allows CDATA, which xacro would not unescape."""
    texts = [_readable(part) if readable else escaped_lines(part) for part in parts(text)]
    return "".join(f'  <{XML_TAG} xmlns:hymeko="{XML_NAMESPACE}">{part}</{XML_TAG}>\n' for part in texts)


def _readable(part: str) -> str:
    """Text as it stands where XML allows it, so that a person can read it."""
    return escaped_lines(part) if "]]>" in part else f"<![CDATA[\n{part}]]>"


def inserted(data: bytes, markup: str) -> bytes:
    """An XML file with more elements at the end of its root."""
    end = _END.search(data, max(data.rfind(b"</robot"), data.rfind(b"</mujoco"), 0)) or _END.search(data)
    if end is None:
        return _opened(data, markup)
    return data[: end.start()] + markup.encode() + data[end.start() :]


def _opened(data: bytes, markup: str) -> bytes:
    """A file whose root has no content yet."""
    end = _EMPTY_END.search(data)
    assert end is not None, "our own writers end every file with its root"
    root = re.search(rb"<(robot|mujoco)\b", data)
    assert root is not None
    return data[: end.start()] + b">\n" + markup.encode() + b"</" + root[1] + b">\n" + data[end.start() + 2 :]
