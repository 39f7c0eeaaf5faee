"""The table of what attributes may be, asked of MuJoCo itself: attribute by attribute, good values and bad ones."""

from __future__ import annotations

import warnings

import mujoco
import pytest

from hymeko_x.formats.mjcf.schema import _ATTRIBUTES
from hymeko_x.formats.mjcf.types import REQUIRED, Kind, kinds_of
from tests.mjcf.mjnumbers import BESIDE

# What an element needs so that MuJoCo gets as far as the attribute in question.
NEEDED = {
    "role": "rgb", "plugin": "mujoco.pid", "size": "1 1 1 1", "bindpos": "0 0 0", "bindquat": "1 0 0 0", "vertid": "0", "vertweight": "1",
    "mass": "1", "pos": "0 0 0", "element": "0 1 2", "divisor": "1", "coef": "1", "objtype": "body", "dim": "1",
}  # fmt: skip
NEEDED_BESIDE = {
    **BESIDE,
    "default": {"class": "c"},
    "deformable/flex": {"body": "b", "element": "0 1 2", "vertex": "0 0 0 1 0 0 0 1 0"},
    "actuator/plugin": {"joint": "j"},
}
ELSEWHERE = {("asset/hfield", "elevation")}
"""Judged together with other attributes: see refused.txt."""

UNASKED = ("asset/model", "body/attach", "body/flexcomp", "body/replicate", "mujoco")
COMPLAINTS = ("bad format", "problem reading", "invalid keyword", "enough data", "too much data", "too large")
SECTIONS = sorted({path.partition("/")[0] for path in _ATTRIBUTES if not path.startswith(UNASKED)})


def values_of(kind: Kind) -> tuple[list[str], list[str]]:
    """Values that are right, and values that are wrong in their form."""
    if kind.words:
        return [*sorted(kind.words)], ["zz", *([] if kind.several else [""])]
    few, many = " ".join(["1"] * max(kind.least, 1)), " ".join(["1"] * min(kind.most, 3 * 4))
    bad = ["zz", *(["1.5"] if kind.whole else []), *([few[:-2]] if kind.least > 1 else [])]
    return [few, many], bad + ([f"{many} 1"] if kind.most < 10**6 else [])


def complained(path: str, said: dict[str, str]) -> bool:
    """Whether MuJoCo says that the form of a value is wrong."""
    tags = ["worldbody", *path.split("/")] if path.startswith("body") else path.split("/") if path != "default" else ["default", "default"]
    text = "".join(f"<{tag}{attributes(inner_path(tags, number), said, number == len(tags))}>" for number, tag in enumerate(tags, 1))
    text += "".join(f"</{tag}>" for tag in reversed(tags))
    try:
        mujoco.MjSpec.from_string(f"<mujoco>{text}{'' if tags[0] == 'worldbody' else '<worldbody/>'}</mujoco>")
    except ValueError as error:
        return any(word in str(error) for word in COMPLAINTS)
    return False


def inner_path(tags: list[str], number: int) -> str:
    return "/".join(tags[1:number] if tags[0] == "worldbody" else tags[:number])


def attributes(path: str, said: dict[str, str], own: bool) -> str:
    needed = {name: NEEDED.get(name, "x") for name in REQUIRED.get(path, ())} | NEEDED_BESIDE.get(path, {})
    found = needed | said if own else needed if path != "default" else {}
    return "".join(f' {name}="{value}"' for name, value in found.items())


@pytest.mark.parametrize("section", SECTIONS)
def test_mujoco_takes_the_same_values(section: str) -> None:
    wrong = []
    paths = [path for path in _ATTRIBUTES if path.partition("/")[0] == section and not path.startswith(UNASKED)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for path in paths:
            for name, kind in kinds_of(path).items():
                if (path, name) in ELSEWHERE:
                    continue
                good, bad = values_of(kind)
                wrong += [(path, name, value, "is taken") for value in bad if not complained(path, {name: value})]
                wrong += [(path, name, value, "is not taken") for value in good if complained(path, {name: value})]
    assert wrong == []
