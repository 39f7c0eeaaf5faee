"""Small URDF texts for the tests, and the way there and back."""

from __future__ import annotations

from collections import Counter

from lxml import etree

from hymeko_x.backends.urdf import write
from hymeko_x.diagnostics import Report
from hymeko_x.frontends.urdf import read
from hymeko_x.ir.mechanism import Mechanism
from hymeko_x.rewrite.context import Options
from hymeko_x.source import Source

TWO_LINKS = '<link name="a"/><link name="b"/>'
LIMIT = '<limit lower="-1" upper="2" effort="3" velocity="4"/>'


def robot(body: str, attributes: str = ' name="r"') -> str:
    """A robot whose body starts on line 2."""
    return f"<robot{attributes}>\n{body}\n</robot>"


def joint(inside: str = "", kind: str = "revolute", name: str = "j", parent: str = "a", child: str = "b") -> str:
    """A joint between two links."""
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{inside}</joint>'


def visual(inside: str, tag: str = "visual") -> str:
    """A link called ``a`` with one shape."""
    return f'<link name="a"><{tag}>{inside}</{tag}></link>'


def load(text: str | bytes, report: Report | None = None) -> Mechanism:
    """The mechanism of a text."""
    data = text if isinstance(text, bytes) else text.encode()
    return read(Source("robot.urdf", data), report if report is not None else Report()).mechanism


def reported(text: str | bytes) -> list[str]:
    """What reading a text reports."""
    report = Report()
    load(text, report)
    return [str(diagnostic) for diagnostic in report]


def dump(mechanism: Mechanism) -> str:
    """The URDF text of a mechanism."""
    return write(mechanism, Options(), Report()).main.decode()


def again(text: str | bytes) -> str:
    """A text read and written."""
    return dump(load(text))


def tags(data: str | bytes) -> Counter[str]:
    """How often each path of tags occurs, with attributes as steps of their own."""
    root = etree.fromstring(data if isinstance(data, bytes) else data.encode(), etree.XMLParser(recover=True, huge_tree=True))
    found: Counter[str] = Counter()
    waiting = [(root, root.tag)]
    while waiting:
        element, path = waiting.pop()
        found[path] += 1
        found.update(f"{path}@{name}" for name in element.attrib)
        waiting += [(child, f"{path}/{child.tag}") for child in element if isinstance(child.tag, str)]
    return found
