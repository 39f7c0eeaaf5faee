"""What no type of a document tells: that names are unique, references lead somewhere, edges have their ends, and rotations turn."""

from __future__ import annotations

from collections import Counter
from math import hypot, isfinite
from typing import TYPE_CHECKING, Any

from msgspec import Struct

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse
from hymeko_x.formats.hymeko import POSED_EDGES, TARGETS
from hymeko_x.formats.json.document import PARTS
from hymeko_x.ir.digits import are_numbers
from hymeko_x.ir.ids import KINDS
from hymeko_x.ir.mechanism import WORLD, Id
from hymeko_x.ir.values import Pose

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hymeko_x.diagnostics import Code
    from hymeko_x.formats.json.document import Arc, Document

_MAY_BE_ENDLESS = frozenset({"limits", "parameters", "arcs"})
"""The keys below which numbers need not be finite."""
_ROUNDING = 1e-6
"""How far from one the length of an axis or of a unit quaternion may be."""


def check(document: Document, file: str) -> None:
    """Raises: Refusal HX023, HX040, HX045, HX062 for the first fault, with its path in the document."""
    _Checker(document, file).check()


class _Checker:
    def __init__(self, document: Document, file: str) -> None:
        self._document = document
        self._file = file
        self._found: dict[Id, str] = {}

    def check(self) -> None:
        document = self._document
        for table, items in (("vertices", document.vertices), ("edges", document.edges)):
            for number, item in enumerate(items):
                self._name(item, f"$.{table}[{number}]")
        for number, item in enumerate(document.vertices):
            self._vertex(item, f"$.vertices[{number}]")
        for number, item in enumerate(document.edges):
            self._edge(item, f"$.edges[{number}]")
        self._layout(document.layout)

    def _fail(self, code: Code, path: str, message: str, element: object = "") -> None:
        raise refuse(code, f"{path}: {message}", Origin(self._file), element=str(element))

    def _name(self, item: Any, path: str) -> None:
        key = Id(KINDS[PARTS[type(item)]], item.id)
        if key.kind == WORLD.kind and key != WORLD:
            self._fail(codes.BAD_VALUE, f"{path}.id", f"the world is called '{WORLD.name}', not '{key.name}'")
        if key in self._found:
            self._fail(codes.DUPLICATE_NAME, f"{path}.id", f"{key} stands already at {self._found[key]}", key)
        self._found[key] = path

    def _vertex(self, item: Any, path: str) -> None:
        key = Id(KINDS[PARTS[type(item)]], item.id)
        self._finite(item, path, key)
        written = item.inertial.written if key.kind == "body" and item.inertial is not None else None
        if written is not None:
            self._pose(written.frame, f"{path}.inertial.written.frame", key)
        if key.kind != "mesh":
            return
        corners, points = len(item.faces), len(item.vertices)
        for name, size in (("vertices", 3), ("faces", 3), ("texcoords", 2), ("normals", 3)):
            if len(getattr(item, name)) % size:
                self._fail(codes.BAD_VALUE, f"{path}.{name}", f"{len(getattr(item, name))} numbers are no multiple of {size}", key)
        if corners and not (min(item.faces) >= 0 and max(item.faces) < points // 3):
            self._fail(codes.BAD_VALUE, f"{path}.faces", f"a corner is none of the {points // 3} points", key)
        for name in ("texfaces", "normalfaces"):
            found = len(getattr(item, name))
            if found not in (0, corners):
                self._fail(codes.BAD_VALUE, f"{path}.{name}", f"expected {corners} numbers as in 'faces', found {found}", key)

    def _finite(self, item: Struct, path: str, key: Id) -> None:
        found = endless_in(item)
        if found is not None:
            self._fail(codes.BAD_VALUE, f"{path}{found}", "the number is not finite", key)

    def _edge(self, item: Any, path: str) -> None:
        key = Id(KINDS[PARTS[type(item)]], item.id)
        self._finite(item, path, key)
        for number, arc in enumerate(item.arcs):
            self._arc(key, arc, f"{path}.arcs[{number}]")
        for number, dof in enumerate(item.dofs if key.kind in ("joint", "loop") else ()):
            if not abs(hypot(*dof.axis) - 1.0) < _ROUNDING:
                self._fail(codes.BAD_VALUE, f"{path}.dofs[{number}].axis", f"the axis has length {hypot(*dof.axis):g}, not 1", key)
        signs = {arc.sign for arc in item.arcs}
        if key.kind == "joint" and not {1, -1} <= signs:
            end = "parent (sign 1)" if 1 not in signs else "child (sign -1)"
            self._fail(codes.MISSING_PART, f"{path}.arcs", f"the joint has no {end}", key)

    def _arc(self, key: Id, arc: Arc, path: str) -> None:
        expected = _targets(key.kind, arc)
        if expected and arc.to.kind not in expected:
            self._fail(codes.UNDEFINED_REFERENCE, f"{path}.to", f"expected a {' or '.join(expected)}, found {arc.to}", key)
        if arc.to not in self._found:
            self._fail(codes.UNDEFINED_REFERENCE, f"{path}.to", f"there is no {arc.to}", key)
        if isinstance(arc.weight, Pose):
            self._pose(arc.weight, f"{path}.weight", key)
        if arc.weight is not None and isinstance(arc.weight, Pose) != (key.kind in POSED_EDGES):
            kind = "a pose" if key.kind in POSED_EDGES else "a list of numbers"
            self._fail(codes.BAD_VALUE, f"{path}.weight", f"the weights of a {key.kind} are {kind}", key)

    def _pose(self, pose: Pose, path: str, key: Id) -> None:
        if not all(map(isfinite, pose.xyz)):
            self._fail(codes.BAD_VALUE, f"{path}.xyz", "the position is not finite", key)
        if not abs(hypot(*pose.quat) - 1.0) < _ROUNDING:
            self._fail(codes.BAD_VALUE, f"{path}.quat", f"the quaternion has length {hypot(*pose.quat):g}, not 1", key)

    def _layout(self, layout: Iterable[Id]) -> None:
        for number, key in enumerate(layout):
            if key not in self._found:
                self._fail(codes.UNDEFINED_REFERENCE, f"$.layout[{number}]", f"there is no {key}")
        repeated = next((key for key, count in Counter(layout).items() if count > 1), None)
        if repeated is not None:
            self._fail(codes.DUPLICATE_NAME, "$.layout", f"{repeated} stands twice")


def endless_in(value: object) -> str | None:
    """The path of the first number in a value that is not finite, below limits and parameters aside, which may have such numbers."""
    if isinstance(value, float):
        return None if isfinite(value) else ""
    if isinstance(value, tuple) and not (are_numbers(value) and all(map(isfinite, value))):
        inside = ((f"[{number}]", endless_in(item)) for number, item in enumerate(value))
    elif isinstance(value, Struct):
        names = (name for name in value.__struct_fields__ if name not in _MAY_BE_ENDLESS)
        inside = ((f".{name}", endless_in(getattr(value, name))) for name in names)
    else:
        return None
    return next((f"{step}{rest}" for step, rest in inside if rest is not None), None)


def _targets(kind: str, arc: Arc) -> tuple[str, ...]:
    """The kinds to which an arc of an edge may lead; empty = any kind."""
    if kind == "shape":
        return (arc.role,) if arc.role in ("mesh", "material") else ("body", "world")
    return TARGETS[kind]
