"""Strategies for texts, names, numbers, poses, colours and parameters."""

from __future__ import annotations

import string
from typing import TypeVar

from hypothesis import reject
from hypothesis import strategies as st

from hymeko_x.ir.values import Pose, Written, pose, pose_from_rpy
from hymeko_x.ir.written import pose_as_written

T = TypeVar("T")

_CHARACTERS = st.characters(exclude_categories=["Cs"])
_ODD_TEXTS = ["", "<x a='1' b=\"2\"/>", "two\nlines", '"""', "'", "${x}", "\\", "\0", "\r\n", "\t", "*/", "// no comment"]
TEXTS = st.text(_CHARACTERS, max_size=12) | st.sampled_from(_ODD_TEXTS)
_MEANINGFUL_NAMES = ["base", "X", "Z", "AXIS_Z", "visual", "dof", "dof#2", "units", "scope", "mass", "safety", "axis", "at", "urdf"]
_WORDS_OF_THE_LANGUAGE = ["world", "use", "import", "as", "rel", "seq", "extra", "written", "files", "kind", "type", "inf", "limit", "true"]
_ODD_NAMES = ["", " ", "a b", "a.b", "a/b", "a`b", 'a"b', "1a", "-a", "ü", "関節", "сустав", "a\\", "a\nb", "${x}", "@a", "a{", "~/a"]
NAMES = st.sampled_from([*_MEANINGFUL_NAMES, *_WORDS_OF_THE_LANGUAGE, *_ODD_NAMES]) | st.text(_CHARACTERS, max_size=6)
PLAIN_NAMES = st.text(string.ascii_letters + "_", min_size=1, max_size=8)

NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
SMALL = st.floats(-1e3, 1e3, allow_nan=False)
LENGTHS = st.floats(0.0, 1e3)
VECTORS = st.tuples(SMALL, SMALL, SMALL)
DIRECTIONS = st.sampled_from([(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -2.0)]) | VECTORS.filter(
    lambda v: max(map(abs, v)) > 1e-3
)
QUATERNIONS = st.tuples(SMALL, SMALL, SMALL, SMALL).filter(lambda q: max(map(abs, q)) > 1e-3)
_NOTATIONS = {"euler:xyz": 3, "euler:ZYX": 3, "axisangle": 4, "xyaxes": 6, "zaxis": 3, "fromto": 6, "dir": 3}


@st.composite
def _written_poses(draw: st.DrawFn) -> Pose:
    """A pose whose rotation has one of the other notations."""
    kind, count = draw(st.sampled_from(sorted(_NOTATIONS.items())))
    numbers = draw(st.tuples(*[SMALL] * count))
    try:
        return pose_as_written(draw(VECTORS), Written(kind, numbers))
    except ZeroDivisionError:
        reject()


POSES = st.one_of(
    st.just(Pose()),
    st.builds(Pose, VECTORS),
    st.builds(pose_from_rpy, VECTORS, VECTORS),
    st.builds(pose, VECTORS, QUATERNIONS),
    _written_poses(),
)
COLOURS = st.tuples(*[st.floats(0.0, 1.0)] * 4)


def maybe(strategy: st.SearchStrategy[T]) -> st.SearchStrategy[T | None]:
    """The value, or None."""
    return st.none() | strategy


PARAMETERS = st.lists(
    st.tuples(NAMES, NUMBERS | TEXTS | st.lists(NUMBERS, max_size=3).map(tuple)), max_size=3, unique_by=lambda pair: pair[0]
).map(tuple)
