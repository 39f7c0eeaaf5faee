"""Every element and attribute of SDF 1.12, each in a file of its own: what is read is written as it was.

``schema.txt`` has a line for each part of the format: its name, its tag, and what is in it: ``path:type=default``, attributes with ``@``,
other parts in brackets; blanks of defaults are commas.
"""

from __future__ import annotations

from collections import deque
from pathlib import Path
from xml.etree import ElementTree

import pytest

import hymeko_x as hx
from hymeko_x import formats, pipeline
from hymeko_x.diagnostics import Report
from hymeko_x.rewrite import Options
from hymeko_x.source import NoFiles, Source
from tests.sdf.canonical import canonical

PARTS = {line.split()[0]: line.split()[1:] for line in (Path(__file__).parent / "schema.txt").read_text("utf-8").splitlines()}
VALUES = {
    "number": "0.25",
    "count": "3",
    "text": "words",
    "3": "1 2 3",
    "2": "1 2",
    "color": "0.1 0.2 0.3 0.4",
    "pose": "1 2 3 0.1 0.2 0.3",
    "time": "1 2",
}
OWN_VALUES = {
    **dict.fromkeys(
        ("@relative_to", "@attached_to", "@expressed_in", "@canonical_link", "@placement_frame", "child", "@parent_frame"), "a"
    ),
    "parent": "b",
    "@rotation_format": "euler_rpy",
    "mimic/@joint": "k",
    "@axis": "axis",
    "@version": "1.12",
    "roughness": "0.25",
    "metalness": "0.25",
    "joint/@type": "prismatic",
    "light/@type": "spot",
    "sensor/@type": "imu",
}
"""Values that mean something, by the end of the path."""
SPHERE = "<geometry><sphere><radius>1</radius></sphere></geometry>"
LINKS = '<link name="a"/><link name="b"/>'
JOINT = "<parent>b</parent><child>a</child><axis><xyz>0 0 1</xyz></axis>"
LEADER = '<link name="d"/><joint name="k" type="continuous"><parent>b</parent><child>d</child><axis><xyz>0 0 1</xyz></axis></joint>'
AROUND = {
    "sdf": ({"version": "1.12"}, ""),
    "world": ({"name": "w"}, f'<model name="m">{LINKS}</model>'),
    "model": ({"name": "m"}, LINKS + LEADER),
    "joint": ({"name": "j", "type": "revolute"}, JOINT),
    "sensor": ({"name": "s", "type": "camera"}, ""),
    **{tag: ({"name": "n"}, SPHERE) for tag in ("visual", "collision")},
    "include": ({}, "<uri>model://nowhere</uri>"),
    "physics": ({"type": "ode"}, ""),
    "mimic": ({"joint": "k"}, "<multiplier>1</multiplier>"),
    "light": ({"name": "n", "type": "point"}, ""),
    **{
        tag: ({"name": "n"}, "")
        for tag in ("link", "frame", "plugin", "gripper", "battery", "projector", "particle_emitter", "model_state")
    },
    **{
        tag: ({"name": "n"}, "")
        for tag in ("joint_state", "link_state", "light_state", "state", "population", "road", "actor", "animation")
    },
}
"""The attributes and the content that an element must have."""
NAMED_ONCE = frozenset(("link", "model", "joint", "frame", "light"))
Place = tuple[str, ...]


def places() -> dict[str, Place]:
    """The shortest way to each part of the format, through models where there are several."""
    found: dict[str, Place] = {"root": ("sdf",)}
    waiting = deque(["root"])
    while waiting:
        part = waiting.popleft()
        inner = sorted((item for item in PARTS[part][1:] if item.endswith("]")), key=lambda item: "[model]" not in item)
        for item in inner:
            path, _, name = item[:-1].rpartition("[")
            if name not in found:
                found[name] = (*found[part], *filter(None, path.split("/")), PARTS[name][0])
                waiting.append(name)
    return found


def cases(*, defaults: bool) -> list[tuple[str, str]]:
    """The path of each value, and a text for it."""
    found = []
    for part, place in places().items():
        for item in PARTS[part][1:]:
            if item.endswith("]"):
                continue
            name, _, rest = item.rpartition(":")
            kind, _, usual = rest.partition("=")
            path = "/".join((*place, *filter(None, name.split("/"))))
            own = next((value for end, value in OWN_VALUES.items() if f"/{path}".endswith(f"/{end}")), VALUES.get(kind))
            found.append((path, own or ("false" if usual == "true" else "true")))
            found += [(path, usual.replace(",", " "))] if defaults and usual else []
    return found


def file_with(path: str, value: str) -> str:
    """A file with this value, and what must be around it."""
    *steps, last = path.split("/")
    steps = steps if last.startswith("@") else [*steps, last]
    node = root = ElementTree.Element("sdf", AROUND["sdf"][0])
    for step in steps[1:]:
        there = node.find(step) if step not in NAMED_ONCE else None
        if node.tag == "geometry" and there is None:
            node[:] = []
        node = ElementTree.SubElement(node, step) if there is None else there
        attributes, inner = AROUND.get(step, ({}, ""))
        if there is None:
            node.attrib.update(attributes)
            node.extend(ElementTree.fromstring(f"<x>{inner}</x>"))
    if last.startswith("@"):
        node.set(last[1:], value)
    else:
        node[:] = []
        node.text = value
    if root.find("model") is None and root.find("world") is None:
        root.append(ElementTree.fromstring(f'<model name="m">{LINKS}</model>'))
    return ElementTree.tostring(root, "unicode")


def difference(path: str, value: str) -> str:
    """The file where it is written otherwise than it was; "" where it is the same."""
    text = file_with(path, value)
    mechanism = pipeline.read(Source("a.sdf", text.encode()), formats.SDF, Report(), lenient=True)
    written = pipeline.write(mechanism, formats.SDF, Options(lenient=True), NoFiles(), Report()).main
    return "" if canonical(written) == canonical(text.encode()) else f"{path}: {text}\n{written.decode()}"


@pytest.mark.unread("HX009", "HX021", "HX047", "HX053", "HX316")
def test_a_value_of_the_format_comes_back() -> None:
    tried = cases(defaults=False)
    assert len(tried) == 564
    assert [found for path, value in tried[::5] if (found := difference(path, value))] == []


@pytest.mark.full
@pytest.mark.unread
def test_every_value_and_every_default_comes_back() -> None:
    assert [found for path, value in cases(defaults=True) if (found := difference(path, value))] == []


@pytest.mark.full
@pytest.mark.unread
def test_drake_puts_every_link_where_we_do(tmp_path: Path) -> None:
    pytest.importorskip("pydrake")
    file, compared, different = tmp_path / "a.sdf", 0, []
    for path, value in cases(defaults=True):
        file.write_text(file_with(path, value), "utf-8")
        verdict = hx.verify(str(file), hx.load(file, lenient=True).mechanism, samples=100)
        compared += not verdict.reason
        if not verdict.is_same and "refuses " not in verdict.reason:
            different.append((path, value, verdict.reason, [check for check in verdict.checks if not check.passed]))
    assert different == []
    assert compared >= 700
