"""Models in models, on the way back from formats that have only their names."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest

import hymeko_x as hx
from tests.sdf.samples import AXIS, TWO, model

HINGE = f'<joint name="j" type="revolute"><parent>a</parent><child>b</child>{AXIS.format("")}</joint>'
INNER = f'<model name="inner"><pose>0 0 1 0 0 0</pose>{TWO}{HINGE}</model>'
OUTER = (
    '<model name="outer"><pose>0 1 0 0 0 0</pose><link name="l"/><frame name="f"/>'
    f'{INNER}<joint name="c" type="ball"><parent>l</parent><child>inner::a</child></joint></model>'
)
DEEP = model(f'<link name="base"/>{OUTER}<joint name="k" type="ball"><parent>base</parent><child>outer::l</child></joint>')


def structure(text: str) -> dict[str, set[str]]:
    """The names of what is in each model, by the names of the models around it."""
    found: dict[str, set[str]] = {}
    stack = [("", ElementTree.fromstring(text))]
    while stack:
        path, element = stack.pop()
        for child in element.iterfind("model"):
            inner = f"{path}/{child.get('name')}"
            found[inner] = {child.get("name", "") for child in child if child.get("name")}
            stack.append((inner, child))
    return found


def pose_of(text: str, name: str) -> str | None:
    return ElementTree.fromstring(text).findtext(f".//model[@name='{name}']/pose")


@pytest.mark.parametrize("format", ["mjcf", "usd"])
def test_models_in_models_come_back_with_their_names_and_poses(format: str) -> None:
    back = hx.dumps(hx.loads(hx.dumps(hx.loads(DEEP, "sdf"), format), format), "sdf")
    found = structure(back)
    assert found["/m/outer/inner"] == {"a", "b", "j"}
    assert {"l", "f", "inner", "c"} <= found["/m/outer"]
    assert {"base", "outer", "k"} <= found["/m"]
    assert pose_of(back, "inner") == "0 0 1 0 0 0"
    assert hx.dumps(hx.loads(back, "sdf"), "sdf") == back


def test_a_joint_goes_into_the_model_that_has_both_of_its_links() -> None:
    mjcf = """<mujoco model="m"><worldbody><body name="base"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <body name="a::l"><joint name="a::j"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><site name="a::__model__"/></body>
    </body></worldbody></mujoco>"""
    found = structure(hx.dumps(hx.loads(mjcf, "mjcf"), "sdf"))
    assert found["/m/a"] == {"l"}
    assert "a_j" in found["/m"]


def test_without_the_frame_of_a_model_a_name_is_no_path() -> None:
    mjcf = '<mujoco model="m"><worldbody><body name="a::l"><freejoint/><geom size="1"/></body></worldbody></mujoco>'
    assert structure(hx.dumps(hx.loads(mjcf, "mjcf"), "sdf")) == {"/m": {"a_l"}}


def test_a_link_with_the_name_of_a_model_beside_it_gets_another_one() -> None:
    inside = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
    mjcf = f"""<mujoco model="m"><worldbody><body name="a"><freejoint name="f"/>{inside}</body>
      <body name="a::l"><freejoint name="g"/>{inside}<site name="a::__model__"/></body></worldbody></mujoco>"""
    assert structure(hx.dumps(hx.loads(mjcf, "mjcf"), "sdf")) == {"/m": {"a", "a_body"}, "/m/a": {"l"}}
