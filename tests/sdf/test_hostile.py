"""Large and hostile SDF: every step is linear in the number of elements."""

from __future__ import annotations

import pytest

from hymeko_x import formats, pipeline
from hymeko_x.diagnostics import Report
from hymeko_x.ir.parts import Body
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Source
from tests.pace import assert_at_most

AXIS = "<axis><xyz>0 0 1</xyz></axis>"


def _again(text: str) -> None:
    """Read a file and write it again."""
    mechanism = pipeline.read(Source("a.sdf", text.encode()), formats.SDF, Report(), lenient=True)
    pipeline.write(mechanism, formats.SDF, Options(lenient=True), NoFiles(), Report())


def _model(inside: str) -> str:
    return f'<sdf version="1.11"><model name="m">{inside}</model></sdf>'


def _joint(number: int, parent: str, child: str, inside: str = AXIS) -> str:
    return f'<joint name="j{number}" type="revolute"><parent>{parent}</parent><child>{child}</child>{inside}</joint>'


CASES = {
    "closures between two links": lambda n: _model('<link name="a"/><link name="b"/>' + "".join(_joint(i, "a", "b") for i in range(n))),
    "one cycle": lambda n: _model("".join(f'<link name="l{i}"/>{_joint(i, f"l{i}", f"l{(i + 1) % n}")}' for i in range(n))),
    "frames in a circle": lambda n: _model("".join(f'<link name="l{i}"><pose relative_to="l{(i + 1) % n}"/></link>' for i in range(n))),
    "frames on frames": lambda n: _model(
        '<link name="f0"/>' + "".join(f'<frame name="f{i}" attached_to="f{i - 1}"/>' for i in range(1, n))
    ),
    "links of one name": lambda n: _model('<link name="l"/>' * n),
    "models in a world": lambda n: (
        '<sdf version="1.9"><world name="w">' + "".join(f'<model name="m{i}"><link name="l"/></model>' for i in range(n)) + "</world></sdf>"
    ),
    "mimics of one leader": lambda n: _model(
        '<link name="a"/>'
        + "".join(
            f'<link name="l{i}"/>'
            + _joint(i, "a", f"l{i}", AXIS.replace("</axis>", '<mimic joint="j0"><multiplier>2</multiplier></mimic></axis>'))
            for i in range(1, n)
        )
        + f'<link name="l0"/>{_joint(0, "a", "l0")}'
    ),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.unread("HX009", "HX023", "HX043")
def test_time_grows_with_the_file(case: str) -> None:
    small, large = CASES[case](400), CASES[case](1600)
    assert_at_most(1.7, lambda: _again(large), lambda: _again(small), 4)


def test_densities_without_end_make_no_inertial() -> None:
    collision = '<collision name="c"><density>1e308</density><geometry><box><size>1 2 3</size></box></geometry></collision>'
    report = Report()
    text = _model(f'<link name="a"><inertial auto="true"/>{collision}</link>')
    mechanism = pipeline.read(Source("a.sdf", text.encode()), formats.SDF, report, lenient=True)
    assert [body.inertial for _, body in mechanism.vertices(Body)] == [None]
    assert report.diagnostics[0].message == "link 'a': the inertial of its collisions is not finite; it is left unspecified"
