"""Looks for silent losses: what can be changed in a source without anybody noticing, in the output or in the ledger.

`python -m tests.residue.silence FORMAT FILE...` perturbs every attribute and removes every element of each file, one at a time.
"""

from __future__ import annotations

import random
import re
import sys
from collections.abc import Iterator
from copy import deepcopy
from pathlib import Path
from typing import Any

from lxml import etree

from hymeko_x import formats, pipeline
from hymeko_x.assets.resolve import DiskFiles
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.ir.legalize import Options
from hymeko_x.source import Files, NoFiles, Source

_NUMBER = re.compile(r"-?\d+\.?\d*(?:[eE][-+]?\d+)?")
Outcome = tuple[object, ...]


def silent_changes(data: bytes, own: str, target: str, files: Files | None = None, *, most: int | None = None) -> list[str]:
    """The changes of a text that leave output, ledger and diagnostics as they are; ``most`` looks at a sample of them."""
    files = NoFiles() if files is None else files
    root = etree.fromstring(data, etree.XMLParser(remove_comments=True, huge_tree=True))
    before = outcome(etree.tostring(root), own, target, files)
    changes = list(_places(root))
    if most is not None and len(changes) > most:
        changes = random.Random(len(changes)).sample(changes, most)
    return [
        what
        for path, name in changes
        for what, text in [_changed(root, path, name)]
        if text and outcome(text, own, target, files) == before
    ]


def outcome(data: bytes, own: str, target: str, files: Files) -> Outcome:
    """Everything that a user sees of a pure conversion; places in the source do not count."""
    report = Report()
    try:
        robot = pipeline.read(Source("robot", data, files), formats.by_name(own), report)
        result = pipeline.convert(robot, formats.by_name(target), Options(pure=True), files, report)
    except Refusal as refusal:
        return ("refused", refusal.diagnostic.message)
    losses = [(loss.element, loss.field, loss.before, loss.after) for loss in result.losses or ()]
    said = [(item.code.id, item.message) for item in report]
    return result.package.main, tuple(result.package.files.items()), tuple(losses), tuple(said)


def _places(root: Any) -> Iterator[tuple[str, str]]:
    """The path of every element, with each of its attributes and, for its removal, an empty name."""
    tree = root.getroottree()
    for element in root.iter():
        path = tree.getpath(element)
        if element is not root and not _says_nothing(element):
            yield path, ""
        yield from ((path, name) for name in element.attrib)


def _says_nothing(element: Any) -> bool:
    """Whether an element only says zeros, or the axis that joints have anyway, which mean the same as leaving it out."""
    if element.tag == "axis" and [float(number) for number in _NUMBER.findall(element.get("xyz", ""))] == [1.0, 0.0, 0.0]:
        return True
    return len(element) == 0 and bool(element.attrib) and all(re.fullmatch(r"[-+0.\s]+", text) for text in element.attrib.values())


def _changed(root: Any, path: str, name: str) -> tuple[str, bytes]:
    copy = deepcopy(root)
    element = copy.getroottree().xpath(path, namespaces={key: uri for key, uri in copy.nsmap.items() if key})[0]
    if not name:
        element.getparent().remove(element)
        return f"without {path}", etree.tostring(copy)
    old = element.get(name)
    new = perturbed(old)
    element.set(name, new)
    return f"{path}/@{name}: {old} -> {new}", etree.tostring(copy)


def perturbed(text: str) -> str:
    """Another number, another truth, or another word."""
    opposite = {"true": "false", "false": "true"}.get(text)
    if opposite:
        return opposite
    numbers = list(_NUMBER.finditer(text))
    # a direction of another length is the same: the second number of most, and the angle of an axis and an angle
    found = numbers[-1 if len(numbers) == 4 else min(1, len(numbers) - 1)] if numbers else None
    if found is None or not re.fullmatch(r"[-+.\deE\s]+", text):
        return f"{text}_other"
    value = float(found[0])
    other = value * 1.25 if value else 0.125
    return (
        f"{text[: found.start()]}{int(value) + 1 if '.' not in found[0] and value and value == int(value) else other}{text[found.end() :]}"
    )


if __name__ == "__main__":
    target, *names = sys.argv[1:]
    for name in names:
        path = Path(name)
        own = formats.of_input(name, path.read_bytes()).name
        for silent in silent_changes(path.read_bytes(), own, target, DiskFiles(path.parent)):
            sys.stdout.write(f"{path.name} -> {target}: {silent}\n")
