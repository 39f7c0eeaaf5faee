"""How many stereotypes of ten real robots have the name that a person gave them: `names_by_hand.csv`, by the beginning of what each holds.

The names of default classes are those of their authors and do not count.
"""

from __future__ import annotations

import csv
import os
from pathlib import Path

import pytest

from hymeko_x import disk, formats, pipeline
from hymeko_x.backends.hymeko import document
from hymeko_x.corpus import cache, catalog
from hymeko_x.diagnostics import Report
from hymeko_x.language.classes import is_class
from hymeko_x.language.printer import print_item
from hymeko_x.language.syntax import Node

TABLE = Path(__file__).with_name("names_by_hand.csv")
LEAST = 0.8
"""As measured: 68 of 81. What is missing are mostly elements that are called by number."""


def _id(file: catalog.DevelopmentFile) -> str:
    """The robot as the table has it: package and file, or the folder of a `robot.xml`."""
    path = Path(file.path)
    return f"{file.package.name}/{path.parent.name if path.name == 'robot.xml' else path.name}"


def _stereotypes(file: catalog.DevelopmentFile, path: Path) -> list[tuple[str, str]]:
    """Name and content of each stereotype of a robot."""
    robot = pipeline.read(disk.open_source(str(path)), formats.by_name(file.format), Report())
    root = next(item for item in document(robot).items if isinstance(item, Node))
    found = [item for item in root.items if isinstance(item, Node) and item.parameters is not None and not is_class(item)]
    kinds = [item for item in found if not item.stereotypes or item.stereotypes[-1].ref.dotted != "assembly"]
    return [(str(item.name), " ".join(map(print_item, item.items))) for item in kinds]


@pytest.mark.full
def test_most_stereotypes_are_called_as_a_person_would_call_them() -> None:
    root = cache.cache_root(os.environ)
    rows: dict[str, list[tuple[str, list[str]]]] = {}
    for row in csv.DictReader(TABLE.read_text("utf-8").splitlines()):
        rows.setdefault(row["robot"], []).append((row["begins"], row["names"].split()))
    files = [file for format in ("mjcf", "urdf") for file in catalog.development_files(format) if _id(file) in rows]
    if not all(cache.is_fetched(file.package, root) for file in files):
        pytest.skip("the robots are not in the cache: hymeko-x corpus fetch")
    assert len(files) == len(rows) == 10
    found = [(_id(file), *pair) for file in files for pair in _stereotypes(file, cache.package_path(file.package, root) / file.path)]
    wrong = [
        (robot, name) for robot, name, text in found if not any(text.startswith(begins) and name in names for begins, names in rows[robot])
    ]
    assert len(wrong) <= (1.0 - LEAST) * len(found), wrong
