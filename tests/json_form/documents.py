"""A document with every kind of value, and documents that are broken in one place each."""

from __future__ import annotations

import copy
import json
from typing import Any, NamedTuple

SOUND: dict[str, Any] = {
    "hymeko-x": 1,
    "name": "arm",
    "vertices": [
        {"type": "world", "id": "world"},
        {"type": "body", "id": "base", "inertial": {"mass": 2.0, "com": [0.0, 0.0, 0.1], "tensor": [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]}},
        {"type": "body", "id": "tip", "extras": [{"format": "urdf", "path": "", "text": "<x/>", "index": 1}], "notations": [["a", "b"]]},
        {"type": "mesh", "id": "m", "vertices": [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0], "faces": [0, 1, 2]},
        {"type": "material", "id": "red", "rgba": [1.0, 0.0, 0.0, 1.0]},
        {"type": "camera", "id": "eye", "resolution": [640, 480]},
        {"type": "actuator", "id": "motor", "kind": "position", "parameters": [["kp", 3.0], ["mode", "fast"], ["range", [0.0, 1.0]]]},
    ],
    "edges": [
        {
            "type": "joint",
            "id": "elbow",
            "dofs": [{"kind": "hinge", "axis": [0.0, 0.0, 1.0], "limits": {"lower": -1.0, "upper": {"number": "inf"}}}],
            "arcs": [{"to": ["body", "base"], "sign": 1, "weight": {"xyz": [0.0, 0.0, 0.5]}}, {"to": ["body", "tip"], "sign": -1}],
        },
        {
            "type": "shape",
            "id": "tip/shape",
            "geometry": {"type": "box", "size": [1.0, 1.0, 1.0]},
            "role": "both",
            "arcs": [{"to": ["body", "tip"], "sign": 1}, {"to": ["material", "red"], "role": "material"}],
        },
        {"type": "drive", "id": "motor", "arcs": [{"to": ["actuator", "motor"], "sign": 1}, {"to": ["joint", "elbow"], "weight": [2.0]}]},
    ],
    "layout": [["body", "base"], ["joint", "elbow"]],
}
GONE = object()


class Broken(NamedTuple):
    """The value at this path becomes another one, or goes; the message names the path, or the other one."""

    path: str
    value: object
    named: str = ""


FORM = (
    Broken("hymeko-x", GONE, "$"),
    Broken("hymeko-x", 2),
    Broken("hymeko-x", True),
    Broken("hymeko-x", "1"),
    Broken("name", GONE, "$"),
    Broken("name", 3),
    Broken("name", None),
    Broken("robots", [], "$"),
    Broken("$schema", 3, "$.$schema"),
    Broken("vertices", {}),
    Broken("vertices", "none"),
    Broken("edges", None),
    Broken("layout", [["body"]], "$.layout[0]"),
    Broken("layout", [["body", "base", "x"]], "$.layout[0]"),
    Broken("layout", ["base"], "$.layout[0]"),
    Broken("extras", [{"format": "urdf", "path": ""}], "$.extras[0]"),
    Broken("notations", [["a"]], "$.notations[0]"),
    Broken("notations", {"a": "b"}),
    Broken("classes", [1], "$.classes[0]"),
    Broken("vertices.1", [], "$.vertices[1]"),
    Broken("vertices.1", "base", "$.vertices[1]"),
    Broken("vertices.1.type", GONE, "$.vertices[1]"),
    Broken("vertices.1.type", "link", "$.vertices[1].type"),
    Broken("vertices.1.type", "joint", "$.vertices[1].type"),
    Broken("vertices.1.id", GONE, "$.vertices[1]"),
    Broken("vertices.1.id", 7),
    Broken("vertices.1.mass", 2.0, "$.vertices[1]"),
    Broken("vertices.1.arcs", [], "$.vertices[1]"),
    Broken("vertices.1.inertial", [], "$.vertices[1].inertial"),
    Broken("vertices.1.inertial.mass", "2 kg"),
    Broken("vertices.1.inertial.mass", True),
    Broken("vertices.1.inertial.com", [0.0, 0.0]),
    Broken("vertices.1.inertial.com.2", "up"),
    Broken("vertices.1.inertial.tensor", [1.0, 1.0, 1.0]),
    Broken("vertices.1.inertial.inertia", [1.0], "$.vertices[1].inertial"),
    Broken("vertices.2.extras.0.text", 1),
    Broken("vertices.2.extras.0.index", 1.5),
    Broken("vertices.2.extras.0.line", 1, "$.vertices[2].extras[0]"),
    Broken("vertices.2.notations.0", ["a", 1], "$.vertices[2].notations[0][1]"),
    Broken("vertices.3.faces.1", 0.5),
    Broken("vertices.3.vertices.1", None),
    Broken("vertices.4.rgba", [1.0, 0.0, 0.0]),
    Broken("vertices.4.rgba", "red"),
    Broken("vertices.5.resolution", [640]),
    Broken("vertices.6.kind", 1),
    Broken("vertices.6.parameters", {"kp": 3.0}),
    Broken("vertices.6.parameters.0", ["kp"], "$.vertices[6].parameters[0]"),
    Broken("vertices.6.parameters.0.1", {"a": 1}),
    Broken("vertices.6.parameters.0.1", {"number": "infinite"}),
    Broken("edges.0.arcs", {}),
    Broken("edges.0.arcs.0.to", GONE, "$.edges[0].arcs[0]"),
    Broken("edges.0.arcs.0.to", "base"),
    Broken("edges.0.arcs.0.sign", 2),
    Broken("edges.0.arcs.0.sign", "+"),
    Broken("edges.0.arcs.0.weight", 1.0),
    Broken("edges.0.arcs.0.weight.xyz", [0.0]),
    Broken("edges.0.arcs.0.weight.rpy", [0.0, 0.0, 0.0], "$.edges[0].arcs[0].weight"),
    Broken("edges.0.arcs.0.weight.written", ["rpy"]),
    Broken("edges.0.arcs.0.pose", {}, "$.edges[0].arcs[0]"),
    Broken("edges.0.arcs.0.role", None),
    Broken("edges.0.dofs", {}),
    Broken("edges.0.dofs.0.kind", "revolute"),
    Broken("edges.0.dofs.0.axis", "z"),
    Broken("edges.0.dofs.0.axis.1", {"number": "none"}),
    Broken("edges.0.dofs.0.limits", [-1.0, 1.0]),
    Broken("edges.0.dofs.0.limits.lower", "-1"),
    Broken("edges.0.dofs.0.limits.min", -1.0, "$.edges[0].dofs[0].limits"),
    Broken("edges.0.dofs.0.safety", {"k_position": 1.0}, "$.edges[0].dofs[0].safety"),
    Broken("edges.0.type", "body", "$.edges[0].type"),
    Broken("edges.1.geometry", GONE, "$.edges[1]"),
    Broken("edges.1.geometry", "box"),
    Broken("edges.1.geometry.type", "cube", "$.edges[1].geometry.type"),
    Broken("edges.1.geometry.type", GONE, "$.edges[1].geometry"),
    Broken("edges.1.geometry.size", GONE, "$.edges[1].geometry"),
    Broken("edges.1.geometry.radius", 1.0, "$.edges[1].geometry"),
    Broken("edges.1.role", "shown"),
    Broken("edges.1.friction", 0.5),
)
"""Documents of another form, which the schema refuses as well."""

MEANING = (
    ("HX023", Broken("vertices.2.id", "base")),
    ("HX023", Broken("layout", [["body", "base"], ["body", "base"]])),
    ("HX040", Broken("layout.0", ["body", "hand"])),
    ("HX040", Broken("edges.0.arcs.0.to", ["body", "hand"])),
    ("HX040", Broken("edges.0.arcs.0.to", ["material", "red"])),
    ("HX040", Broken("edges.1.arcs.1.to", ["body", "base"])),
    ("HX040", Broken("edges.1.arcs.1.role", "", "$.edges[1].arcs[1].to")),
    ("HX045", Broken("edges.0.arcs", [])),
    ("HX045", Broken("edges.0.arcs.1.sign", 0, "$.edges[0].arcs")),
    ("HX062", Broken("vertices.0.id", "earth")),
    ("HX062", Broken("vertices.3.vertices", [0.0, 1.0])),
    ("HX062", Broken("vertices.3.faces", [0, 1])),
    ("HX062", Broken("vertices.3.faces.2", 3, "$.vertices[3].faces")),
    ("HX062", Broken("vertices.3.faces.2", -1, "$.vertices[3].faces")),
    ("HX062", Broken("vertices.3.texfaces", [0])),
    ("HX062", Broken("vertices.1.inertial.written", {"frame": {"quat": [2.0, 0.0, 0.0, 0.0]}, "tensor": [0.0] * 6}, "quat")),
    ("HX062", Broken("edges.0.dofs.0.axis", [0.0, 0.0, 0.0])),
    ("HX062", Broken("edges.0.dofs.0.axis", [0.0, {"number": "nan"}, 1.0], "$.edges[0].dofs[0].axis[1]")),
    ("HX062", Broken("edges.0.dofs.0.damping", {"number": "inf"})),
    ("HX062", Broken("edges.1.geometry.size.2", {"number": "-inf"})),
    ("HX062", Broken("vertices.1.inertial.mass", {"number": "nan"})),
    ("HX062", Broken("edges.0.arcs.0.weight", [1.0])),
    ("HX062", Broken("edges.0.arcs.0.weight.quat", [1.0, 1.0, 0.0, 0.0])),
    ("HX062", Broken("edges.0.arcs.0.weight.xyz.0", {"number": "nan"}, "$.edges[0].arcs[0].weight.xyz")),
    ("HX062", Broken("edges.2.arcs.1.weight", {})),
)
"""Documents of the right form that describe no mechanism, with the code."""

TEXTS = (
    (b"", "1:1"),
    (b"{", "1:2"),
    (b'{"hymeko-x": 1,}', "1:16"),
    (b'{"hymeko-x": 1, "name": "\xff"}', "byte 25 is not UTF-8"),
    (b'{"hymeko-x": 1, "name": "a", "name": "b"}', "the key 'name' stands twice in one object"),
    (b'{"hymeko-x": NaN}', 'NaN is no JSON; write {"number": "nan"}'),
    (b'{"hymeko-x": ' + b"1" * 5000 + b"}", "4300"),
    (b'{"hymeko-x": 1} {}', "extra data"),
)
"""Bytes that are no JSON, and a part of the message or its place."""


def text_of(root: object) -> bytes:
    return json.dumps(root).encode()


def broken(change: Broken) -> Any:
    """The sound document with the change."""
    root = copy.deepcopy(SOUND)
    *steps, last = change.path.split(".")
    place: Any = root
    for step in steps:
        place = place[int(step) if isinstance(place, list) else step]
    key: Any = int(last) if isinstance(place, list) else last
    if change.value is GONE:
        del place[key]
    else:
        place[key] = change.value
    return root


def path_of(change: Broken) -> str:
    """The JSON path that the message has to name."""
    steps = (f"[{step}]" if step.isdigit() else f".{step}" for step in change.path.split("."))
    return change.named or f"${''.join(steps)}"
