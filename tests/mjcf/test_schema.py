"""The schema of MJCF is the one of the MuJoCo that is installed, asked attribute by attribute: good values and bad ones."""

from __future__ import annotations

import json
import warnings

import pytest

from hymeko_x.formats.mjcf.schema import AttributeKind, kinds_of, schema
from tests.mjcf import make_schema

SECTIONS = sorted({path.partition("/")[0] for path in schema().elements if not path.startswith(make_schema.UNASKED)})


def values_of(kind: AttributeKind) -> tuple[list[str], list[str]]:
    """Values that are right, and values that are wrong in their form."""
    if kind.words:
        return [*sorted(kind.words)], ["zz", *([] if kind.several else [""])]
    few, many = " ".join(["1"] * max(kind.least, 1)), " ".join(["1"] * min(kind.most, 3 * 4))
    bad = ["zz", *(["1.5"] if kind.whole else []), *([few[:-2]] if kind.least > 1 else [])]
    return [few, many], bad + ([f"{many} 1"] if kind.most <= 3 * 4 else [])


def is_refused(path: str, attributes: dict[str, str]) -> bool:
    return make_schema.is_of_form(make_schema.complaint(path, attributes, {key: [*names] for key, names in schema().required.items()}))


@pytest.mark.parametrize("section", SECTIONS)
def test_mujoco_takes_the_same_values(section: str) -> None:
    wrong = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for path in [path for path in schema().elements if path.partition("/")[0] == section and not path.startswith(make_schema.UNASKED)]:
            for name, kind in kinds_of(path).items():
                if path == "body/replicate" or (name in make_schema.GIVEN.get(path, {}) and path != "visual/headlight"):
                    continue
                good, bad = values_of(kind)
                wrong += [(path, name, value, "is taken") for value in bad if not is_refused(path, {name: value})]
                wrong += [(path, name, value, "is not taken") for value in good if is_refused(path, {name: value})]
    assert wrong == []


def test_its_elements_and_attributes_are_those_that_mujoco_prints() -> None:
    printed = make_schema.printed_elements()
    assert {path: sorted(kinds) for path, kinds in schema().elements.items()} == {path: sorted(names) for path, names in printed.items()}


@pytest.mark.full
def test_generating_it_again_gives_the_same_file() -> None:
    found = json.loads(make_schema.FILE.read_text())
    words = {word for kinds in found["elements"].values() for kind in kinds.values() if "|" in kind for word in kind.lstrip("*").split("|")}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert make_schema.text_of(make_schema.schema(sorted(words))) == make_schema.FILE.read_text()
