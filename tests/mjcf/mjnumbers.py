"""Every numeric attribute that MuJoCo knows, in a model in which it means something."""

from __future__ import annotations

from collections.abc import Iterator
from xml.sax.saxutils import quoteattr

from msgspec import Struct

from hymeko_x.formats.mjcf.schema import AttributeKind, attributes_of, kinds_of, schema
from tests.mjcf.make_schema import BESIDE

UNASKED = (
    *("asset/model", "body/attach", "body/flexcomp", "body/replicate", "extension", "deformable", "asset/skin"),
    *("asset/mesh/plugin", "body/plugin", "body/geom/plugin", "actuator/plugin", "sensor/plugin"),
)
"""What MuJoCo itself expands, and what needs files or plugins."""

_BODY = (
    '<body name="b"><joint name="j"/><joint name="k" axis="1 0 0"/><geom name="g" size=".1"/><site name="s"/><camera name="cam"/>'
    '<body name="c" pos="1 0 0"><joint name="ball" type="ball"/><geom name="h" size=".1"/><site name="t"/></body></body>'
)
_SECTIONS = {
    "asset": '<material name="mat"/><mesh name="me" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/>',
    "worldbody": _BODY,
    "tendon": '<fixed name="tn"><joint joint="j" coef="1"/></fixed>',
    "actuator": '<motor name="m" joint="j"/>',
}
_REFERENCES = {
    "joint": "j",
    "site": "s",
    "geom": "g",
    "body": "b",
    "tendon": "tn",
    "actuator": "m",
    "camera": "cam",
    "mesh": "me",
    "objtype": "body",
    "objname": "b",
}
_WITHIN = {
    "tendon/spatial": '<site site="s"/><site site="t"/>',
    "tendon/fixed": '<joint joint="k" coef="1"/>',
    "custom/tuple": '<element objtype="body" objname="b"/>',
    "body": '<geom size=".1"/>',
    "body/frame": '<geom size=".1"/>',
}
_PLAIN = {
    "xyaxes": "1 0 0 0 1 0",
    "fullinertia": "1 1 1 0 0 0",
    "maxhullvert": "4",
    "nrow": "2",
    "ncol": "2",
    "nchannel": "3",
    "vertex": "0 0 0 1 0 0 0 1 0 0 0 1",
    "face": "0 2 1 0 3 2 0 1 3 1 2 3",
    "normal": "1 0 0 1 0 0 1 0 0 1 0 0",
    "texcoord": "1 2 3 4 5 6 7 8",
}
_INSTEAD = {
    ("body/inertial", "fullinertia"): "diaginertia",
    ("equality/weld", "anchor"): "",
}
"""What has to make room for an attribute."""


_ALONG = {
    "cranklength": {"joint": None, "cranksite": "s", "slidersite": "t"},
    "delay": {"nsample": "2"},
    "fromto": {"type": "capsule"},
    "focal": {"sensorsize": "1 1", "resolution": "1 1"},
    "focalpixel": {"sensorsize": "1 1", "resolution": "1 1"},
    "principal": {"sensorsize": "1 1", "resolution": "1 1", "focal": "1 1"},
    "principalpixel": {"sensorsize": "1 1", "resolution": "1 1", "focal": "1 1"},
    "thermal": {"motorconst": "1"},
}
"""What some attributes need beside them; None: what must not be there."""


class Place(Struct, frozen=True):
    """An attribute that holds numbers: the place of its element in the schema, its name, and what it may be."""

    path: str
    name: str
    kind: AttributeKind

    @property
    def plain(self) -> str:
        """Numbers in which nothing is odd."""
        return _PLAIN.get(self.name) or " ".join(map(str, range(1, max(self.kind.least, 1) + 1)))

    def text(self, value: str) -> str:
        """A model with this value there."""
        tags = ["worldbody", *self.path.split("/")[1:]] if self.path.startswith("body/") else self.path.split("/")
        if self.path.startswith("body/"):
            tags.insert(1, "body")
        elif self.path == "body":
            tags = ["worldbody", "body"]
        elif tags[0] == "default" and len(tags) > 1:
            tags = ["default", *tags[1:]]
        inner = _WITHIN.get(self.path, "")
        for depth in range(len(tags), 0, -1):
            written = self._written(value) if depth == len(tags) else _needed("/".join(tags[:depth])) if tags[0] != "worldbody" else {}
            attributes = "".join(f" {name}={quoteattr(text)}" for name, text in written.items())
            beside = '<geom size=".1"/>' if tags[depth - 1] == "body" and tags[-1] not in ("body", "geom") else ""
            inner = f"<{tags[depth - 1]}{attributes}>{inner}{beside}</{tags[depth - 1]}>"
        first = tags[0]
        sections = {**_SECTIONS, first: ""} if first in ("compiler", "option", "size", "statistic", "visual") else dict(_SECTIONS)
        body = inner.removeprefix(f"<{first}>").removesuffix(f"</{first}>") if first in _SECTIONS else inner
        if first in _SECTIONS:
            sections[first] += body
            body = ""
        return f"<mujoco>{body}{''.join(f'<{tag}>{text}</{tag}>' for tag, text in sections.items() if text)}</mujoco>"

    def _written(self, value: str) -> dict[str, str]:
        written = _needed(self.path)
        written.pop(_INSTEAD.get((self.path, self.name), ""), None)
        more = _ALONG.get(self.name, {}) if self.path.startswith(("actuator/", "body/")) else {}
        found = {**written, **{name: text for name, text in more.items() if name in attributes_of(self.path)}, self.name: value}
        return {name: text for name, text in found.items() if text is not None}


def _needed(path: str) -> dict[str, str]:
    found = {name: _REFERENCES.get(name, "1") for name in schema().required.get(path, ())}
    if path.startswith("actuator/") and path not in ("actuator/adhesion", "actuator/orientation"):
        found = {"joint": "j"} | found
    return found | BESIDE.get(path, {})


def places() -> Iterator[Place]:
    """Every attribute that holds numbers and is asked about."""
    for path in sorted(schema().elements):
        if not path.startswith(UNASKED) and path != "mujoco":
            yield from (Place(path, name, kind) for name, kind in sorted(kinds_of(path).items()) if not kind.words)
