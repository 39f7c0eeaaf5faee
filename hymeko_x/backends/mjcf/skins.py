"""Skins as elements instead of binary files, so that their bones can have other names."""

from __future__ import annotations

import struct
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.assets.shelf import read_file
from hymeko_x.backends.mjcf.references import settings_in
from hymeko_x.formats.mjcf.tree import parse_text, verbatim
from hymeko_x.formats.mjcf.words import NAME, joined
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.xml.tree import XmlNode

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hymeko_x.formats.mjcf.codec import Settings
    from hymeko_x.ir.mechanism import Extra, Mechanism
    from hymeko_x.source import Files

_NAME = 40
"""The bytes of the name of a body in a file."""
_DIGITS = range(6, 10)
"""Nine digits are enough for any number of single precision."""


def with_skins_as_elements(mechanism: Mechanism, files: Files) -> Mechanism:
    """The mechanism with the content of its skins' files in place of them; a file that is not there or not a skin stays named.

    Source: MuJoCo, XML reference, asset/skin: four counts, points, texture coordinates and faces; for each bone the name of its body in 40
    bytes, its position and quaternion at binding, the number of its points, their indices and weights.
    """
    found = mechanism.extras.get(ROOT, ())
    if not any(extra.format == NAME and "<skin" in extra.text and ".skn" in extra.text for extra in found):
        return mechanism
    settings = settings_in(mechanism)
    extras = tuple([_inlined(extra, settings, files) if extra.format == NAME and "<skin" in extra.text else extra for extra in found])
    return replace(mechanism, extras={**mechanism.extras, ROOT: extras})


def _inlined(extra: Extra, settings: Settings, files: Files) -> Extra:
    root = parse_text(extra.text)
    changed = False
    for node in root.walk():
        file = node.attributes.get("file") if node.tag == "skin" else None
        found = read_file(files, joined(settings.mesh_folder, file, settings)) if file else None
        if file and found is not None and _fill(node, found[1]):
            node.attributes.setdefault("name", PurePosixPath(file.replace("\\", "/")).stem)
            del node.attributes["file"]
            changed = True
    return replace(extra, text=verbatim(root)) if changed else extra


def _fill(node: XmlNode, data: bytes) -> bool:
    """Give a <skin> the content of a file; False for a file that is none, which changes nothing."""
    try:
        points, coordinates, faces, bones = struct.unpack_from("<4i", data)
        arrays, at = _arrays(data, 16, f"{3 * points}f", f"{2 * coordinates}f", f"{3 * faces}i")
        found = []
        for _ in range(bones):
            bone, at = _bone(data, at)
            found.append(bone)
    except (struct.error, UnicodeDecodeError):
        return False
    if at != len(data):
        return False
    for name, array in zip(("vertex", "texcoord", "face"), arrays, strict=True):
        if array:
            node.attributes[name] = _text(array)
    node.children += found
    return True


def _arrays(data: bytes, at: int, *kinds: str) -> tuple[list[tuple[float, ...]], int]:
    """Consecutive arrays from an offset, and the offset behind them."""
    arrays = []
    for kind in kinds:
        arrays.append(struct.unpack_from(f"<{kind}", data, at))
        at += struct.calcsize(f"<{kind}")
    return arrays, at


def _bone(data: bytes, at: int) -> tuple[XmlNode, int]:
    name = data[at : at + _NAME].split(b"\0", 1)[0].decode()
    (place, quat, (count,)), at = _arrays(data, at + _NAME, "3f", "4f", "i")
    (indices, weights), at = _arrays(data, at, f"{int(count)}i", f"{int(count)}f")
    texts = {"bindpos": _text(place), "bindquat": _text(quat), "vertid": _text(indices), "vertweight": _text(weights)}
    return XmlNode("bone", {"body": name, **texts}), at


def _text(numbers: Sequence[float]) -> str:
    return " ".join(str(number) if isinstance(number, int) else _shortest(number) for number in numbers)


def _shortest(number: float) -> str:
    """The shortest text of a number of single precision."""
    texts = (f"{number:.{digits}g}" for digits in _DIGITS)
    return next((text for text in texts if struct.pack("<f", float(text)) == struct.pack("<f", number)), f"{number:.9g}")
