"""Adding a residue to an image that may have been edited."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from msgspec import NODEFAULT
from msgspec.structs import replace

from hymeko_x import codes, formats
from hymeko_x.compare.leaves import TURN, default_at, get, put
from hymeko_x.ir.graph import Edge, Hypergraph
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.parts import Body, Drive, Layer, Mesh, Mount, Plane, Sense, Shape, Texture
from hymeko_x.ir.types import is_sound, settled
from hymeko_x.residue.alike import URI, holds, is_alike, is_moved, without_surface
from hymeko_x.residue.arcs import ARCS, with_edited_weights, with_own_ends, without_lost_material
from hymeko_x.residue.balls import DOFS, hinges_of_balls, moved_and_apart
from hymeko_x.residue.chains import MOTION, with_open_chains
from hymeko_x.residue.colours import pieces_of_meshes, taken_apart, with_first_pieces
from hymeko_x.residue.landmarks import renamed_since
from hymeko_x.residue.parts import GEOMETRY, broken, capsules_of, parts_of
from hymeko_x.residue.realign import realign, with_new_names, with_old_names
from hymeko_x.residue.sides import by_kind, moved, with_sides
from hymeko_x.residue.stand_ins import with_stand_ins

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from hymeko_x.compare.leaves import Path
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc, RobotEdge
    from hymeko_x.ir.parts import VertexPart
    from hymeko_x.residue import Change, Residue, WholeElement

P = TypeVar("P")

_ROUNDING = 1e-9
"""Numbers closer than this are the same: only their last digits are restored."""


_HOLDS: Mapping[type, int] = MappingProxyType({Mount: -1, Sense: -1, Drive: 1})
"""The sign of the arc to the element that an edge places."""


class Restored(NamedTuple):
    """A restored mechanism, and how much came from the residue: values, elements, and extras."""

    mechanism: Mechanism
    values: int
    elements: int
    extras: int


def restore(image: Mechanism, residue: Residue, report: Report) -> Restored:
    """The source, with what was done to its image since. What no longer applies is reported."""
    names = renamed_since(image, residue.landmarks, {key for key, _ in residue.removals})
    for new, old in names.items():
        report.note(codes.RESIDUE_FOLLOWED, f"{old} is called '{new.name}' now", element=str(new))
    aligned = realign(with_old_names(image, names), residue.alignment)
    merge = _Merge(aligned, with_open_chains(residue, aligned, report), report)
    merged = merge.result()
    elements = sum(key in merged.graph for key, _ in residue.additions)
    extras = sum(key == ROOT or key in merged.graph for key, _ in residue.sides.extras)
    return Restored(with_new_names(merged, names), merge.values, elements, extras)


@dataclass(slots=True)
class _Merge:
    """The result so far, and the report."""

    image: Mechanism
    residue: Residue
    report: Report
    vertices: dict[Id, VertexPart] = field(init=False)
    edges: dict[Id, RobotEdge] = field(init=False)
    values: int = 0
    """How many values of the source have been put in."""
    _parts: dict[Id, list[WholeElement]] = field(init=False)
    """The other parts of shapes that the image has in several."""
    _broken: dict[Id, tuple[Path, ...]] = field(init=False)
    """Those of which one part was edited by itself, and where what they share stands in them."""
    _apart: set[Id] = field(init=False)
    """Those among them that are meshes of several colours."""
    _moved: dict[Id, RobotArc] = field(init=False)
    """The arcs to their parents of balls that were moved."""
    _shapes_then: dict[Id, list[WholeElement]] = field(init=False)
    """The shapes that bodies had in the image, of those that the residue tells of."""

    def result(self) -> Mechanism:
        """All steps, in their order."""
        self.vertices, self.edges = dict(self.image.graph.vertices), dict(self.image.graph.edges)
        self._shapes_then = defaultdict(list)
        for element in (*self.residue.removals, *self.residue.weights):
            if element.id.kind == "shape" and isinstance(element.part, Edge):
                self._shapes_then[_body_of(element.part)].append(element)
        capsules, meshes, balls = parts_of(self.residue), pieces_of_meshes(self.image, self.residue), hinges_of_balls(self.residue)
        self._apart = taken_apart(self.image, self.residue, meshes)
        self._moved, hinges = moved_and_apart(self.image, balls)
        self._parts = capsules | meshes | balls
        self._broken = dict.fromkeys(broken(self.image, capsules), (GEOMETRY,))
        self._broken |= dict.fromkeys(self._apart, (ARCS,)) | dict.fromkeys(hinges, (DOFS, ARCS))
        name = self._change_fields()
        kept, withheld = self._edited_shapes()
        self._add(withheld)
        with_first_pieces(self.image, self.vertices, self.edges, self.residue, self._apart)
        removed = self._remove(kept)
        self._let_nothing_dangle(removed)
        merged = with_sides(replace(self.image, name=name, graph=self._ordered()), self.residue, self.image)
        return with_stand_ins(merged, self.image)

    # ---- fields ------------------------------------------------------------------------------------------------------------

    def _change_fields(self) -> str:
        """Put in the values of the source; return the mechanism's name."""
        name = self.image.name
        grouped: dict[Id, list[Change]] = defaultdict(list)
        for change in self.residue.changes:
            grouped[change.element].append(change)
        for key, changes in grouped.items():
            if key == ROOT:
                name = self._changed_name(name, changes[0])
            elif key in self.vertices:
                self.vertices[key] = self._changed(key, self.vertices[key], changes)
            elif key in self.edges:
                edge = with_own_ends(self._changed(key, self.edges[key], changes))
                self.edges[key] = replace(edge, arcs=(self._moved[key], *edge.arcs[1:])) if key in self._moved else edge
            else:
                self._note(key, "is gone, and with it what was kept for it")
        return name

    def _changed_name(self, name: str, change: Change) -> str:
        if change.there != name:
            self._note(ROOT, f"is called '{name}' now")
            return name
        self.values += 1
        return str(change.value)

    def _changed(self, key: Id, part: P, changes: list[Change]) -> P:
        changes = [with_edited_weights(part, change) for change in changes]
        edited = [change for change in changes if self._is_broken(change) or not self._still_holds(key, part, change)]
        if key in self._apart:
            self._note(key, "stays in several pieces, since one of them was edited")
        elif edited:
            self._note(key, f"was edited: {', '.join(dict.fromkeys(_path_text(change.path) for change in edited))} stays as it is now")
        barred = _barred(part, changes, edited) if edited else set()
        valid = without_lost_material(part, [change for change in changes if change.path not in barred], edited)
        changed = _with_changes(part, valid)
        if changed is not None:
            self.values += len(valid)
            return changed
        self._note(key, "stays as it is: what was kept for it is damaged")
        return part

    def _is_broken(self, change: Change) -> bool:
        """Whether a change is of what an element shares with parts of which one was edited by itself."""
        return any(change.path[: len(path)] == path for path in self._broken.get(change.element, ()))

    def _still_holds(self, key: Id, part: object, change: Change) -> bool:
        try:
            value = get(part, change.path)
            default = default_at(part, change.path)
        except LookupError:
            return False
        if change.path[-1] == TURN:
            value = value[0]  # type: ignore[index]
        if change.path[-1] == URI and change.there is not NODEFAULT:
            return is_moved(value, change.there)
        if not holds(value, change.there, default):
            return False
        is_left_out = change.path == ("inertial",) and change.value is None and isinstance(part, Body)
        follows = is_left_out and formats.completing_format(self.residue.source.format) is not None
        return not follows or self._has_its_shapes(key)

    def _has_its_shapes(self, body: Id) -> bool:
        """Whether the shapes of a body whose mass follows from them are what they were, but for colour and friction."""
        expected = self._shapes_then[body]
        return len(self.image.shapes.get(body, ())) == len(expected) and all(map(self._weighs_the_same, expected))

    def _weighs_the_same(self, then: WholeElement) -> bool:
        now = self.image.graph.edges.get(then.id)
        return now is not None and isinstance(then.part, Edge) and is_alike(without_surface(now), without_surface(then.part))

    # ---- elements ----------------------------------------------------------------------------------------------------------

    def _edited_shapes(self) -> tuple[set[Id], set[Id]]:
        """Shapes that stand for others which the image cannot represent: those to keep since one of them was edited, and those to withhold.

        The parts of a capsule belong together, and else shapes of one name on one body.
        """
        capsules = capsules_of(self.residue)
        whole = {key: key for key in capsules.values()}

        def group_of(shape: WholeElement) -> object:
            return capsules.get(shape.id) or whole.get(shape.id) or _group_of(shape)

        stand_ins: dict[object, list[WholeElement]] = defaultdict(list)
        parts = {part.id for others in self._parts.values() for part in others}
        loose = {part.id for key in self._broken for part in self._parts[key]}
        for removal in self.residue.removals:
            if removal.id.kind == "shape" and removal.id not in parts:
                stand_ins[group_of(removal)].append(removal)
        edited = {group for group, members in stand_ins.items() if not all(map(self._is_untouched, members))}
        kept = loose | {removal.id for group in edited for removal in stand_ins[group]}
        withheld = {added.id for added in self.residue.additions if added.id.kind == "shape" and group_of(added) in edited}
        withheld |= {added.id for added in self.residue.additions if self._is_of_mesh_apart(added)}
        for key in withheld:
            self._note(key, "is not restored, because what stands for it was edited")
        return kept, withheld

    def _is_of_mesh_apart(self, added: WholeElement) -> bool:
        """Whether an element is the part of a mesh in a material of its own, where the mesh was taken apart."""
        return added.id.kind == "subset" and isinstance(added.part, Edge) and any(arc.target in self._apart for arc in added.part.arcs)

    def _is_untouched(self, then: WholeElement) -> bool:
        graph = self.image.graph
        now = graph.vertices.get(then.id) or graph.edges.get(then.id)
        return now is not None and is_alike(now, then.part)

    def _add(self, withheld: set[Id]) -> None:
        """Put in what the image does not have; what it is on must be there."""
        waiting: list[tuple[Id, RobotEdge]] = []
        for key, part in self.residue.additions:
            if key in withheld:
                continue
            if key in self.vertices or key in self.edges:
                self._note(key, "is there already; what was kept under this name stays away")
            elif isinstance(part, Edge):
                waiting.append((key, part))
            else:
                self.vertices[key] = part
        self.edges |= waiting

    def _remove(self, kept: set[Id]) -> dict[Id, VertexPart | RobotEdge]:
        """Take away what only the image has, unless it was edited; an edited file that nothing uses any more, too."""
        gone: dict[Id, VertexPart | RobotEdge] = {}
        together = {part.id for parts in self._parts.values() for part in parts}
        edited: list[Id] = []
        for removal in self.residue.removals:
            key = removal.id
            if key in kept or key in gone or key not in self.image.graph:
                continue
            if key not in together and not self._is_untouched(removal):
                edited.append(key)
            else:
                gone[key] = self.vertices.pop(key) if key in self.vertices else self.edges.pop(key)
        used = {arc.target for edge in self.edges.values() for arc in edge.arcs} if edited else set()
        for key in edited:
            if isinstance(self.vertices.get(key), Mesh | Texture) and key not in used:
                gone[key] = self.vertices.pop(key)
            else:
                self._note(key, "was edited, and stays")
        return gone

    def _let_nothing_dangle(self, removed: dict[Id, VertexPart | RobotEdge]) -> None:
        """Keep what something new is on, and drop what was on something that is gone."""
        added = {key for key, _ in self.residue.additions}
        layers: dict[Id, list[Id]] = defaultdict(list)
        for key, part in removed.items():
            for arc in part.arcs if isinstance(part, Edge) and isinstance(part.data, Layer) else ():
                layers[arc.target].append(key)
        users: dict[Id, list[Id]] = defaultdict(list)
        for key, edge in self.edges.items():
            for arc in edge.arcs:
                users[arc.target].append(key)
        queue = [target for target in users if target not in self.vertices and target not in self.edges]
        while queue:
            target = queue.pop()
            if target in self.vertices or target in self.edges:
                continue
            if target in removed and any(key not in added and key in self.edges for key in users[target]):
                queue += self._put_back(target, removed, layers, users)
                continue
            for key in users[target]:
                if key in self.edges:
                    edge = self.edges.pop(key)
                    self._note(key, f"is not restored, because {target} is gone")
                    queue += [key, *self._drop_things(edge, added)]

    def _drop_things(self, edge: RobotEdge, added: set[Id]) -> list[Id]:
        """Take away what was carried only to be held by an edge that is not restored: a frame's mount, an actuator's drive."""
        sign = _HOLDS.get(type(edge.data))
        elements = [arc.target for arc in edge.arcs if arc.sign == sign and arc.target in added and arc.target in self.vertices]
        for element in elements:
            del self.vertices[element]
        return elements

    def _put_back(
        self, key: Id, removed: dict[Id, VertexPart | RobotEdge], layers: Mapping[Id, list[Id]], users: dict[Id, list[Id]]
    ) -> list[Id]:
        """Keep something, and what it is on: a material with its images, which its ``layers`` name."""
        part = removed[key]
        if not isinstance(part, Edge):
            self.vertices[key] = part
            own = [layer for layer in layers.get(key, ()) if layer not in self.edges]
            return [target for layer in own for target in self._put_back(layer, removed, layers, users)]
        self.edges[key] = part
        for arc in part.arcs:
            users[arc.target].append(key)
        return [arc.target for arc in part.arcs]

    def _ordered(self) -> Hypergraph:  # type: ignore[type-arg]
        if not self.residue.order:
            return Hypergraph(self.vertices, self.edges)
        runs: dict[str, list] = defaultdict(list)  # type: ignore[type-arg]
        for run in self.residue.order:
            runs[run.elements[0].kind].append(run)
        return Hypergraph(_sorted(self.vertices, runs), _sorted(self.edges, runs))

    def _note(self, key: Id, message: str) -> None:
        self.report.note(codes.RESIDUE_SUPERSEDED, f"{key} {message}", element=str(key))


def _group_of(shape: WholeElement) -> tuple[Id, str | None] | None:
    """What a shape belongs to: all shapes of one name on one body stand or fall together."""
    edge = shape.part
    if not (isinstance(edge, Edge) and isinstance(edge.data, Shape)):
        return None
    return _body_of(edge), edge.data.name


def _body_of(edge: RobotEdge) -> Id:
    return next((arc.target for arc in edge.arcs if arc.sign > 0), ROOT)


def _sorted(table: dict[Id, P], runs: Mapping[str, list]) -> dict[Id, P]:  # type: ignore[type-arg]
    return {key: table[key] for kind, keys in by_kind(table).items() for key in moved(keys, runs.get(kind, ()))}


def _with_changes(part: P, changes: list[Change]) -> P | None:
    """The part with all changes; None where they are of no part that there is, as in a damaged residue."""
    try:
        for change in changes:
            owner = type(get(part, change.path[:-1]))
            part = put(part, change.path, settled(owner, change.path[-1], change.value))
    except LookupError:
        return None
    return part if is_sound(part) else None


# ---- fields that hold together ---------------------------------------------------------------------------------------------


def _barred(part: object, changes: Iterable[Change], edited: list[Change]) -> set[Path]:
    """The entries that do not apply: the edited ones, and those that only make sense together with them."""
    barred = {change.path for change in edited}
    groups = {_group(path) for path in barred} - {""}
    for change in changes:
        group = _group(change.path)
        if change.path in barred or not groups or not group or not _bind(group, groups, change):
            continue
        if not _is_rounding(part, change):
            barred.add(change.path)
    return barred


def _bind(group: str, edited: set[str], change: Change) -> bool:
    """Whether an entry of a group falls with an edit. A geometry stands for itself, but a plane's place is not a box's."""
    if group == "geometry":
        return "place" in edited and isinstance(change.value, Plane)
    return group in edited or (group == "place" and "geometry" in edited)


def _group(path: Path) -> str:
    """Which fields are given in one frame: the motion of a joint; the geometry and the place of a shape."""
    match path:
        case ("arcs", *_):
            return "place"
        case ("data", "dofs"):
            return "place"
        case ("data", "dofs", int(), str(name), *_) if name in MOTION:
            return "place"
        case ("data", "geometry", *_):
            return "geometry"
    return ""


def _is_rounding(part: object, change: Change) -> bool:
    before, after = get(part, change.path), change.value
    if change.path[-1] == TURN:
        before, after = before[0], after[0]  # type: ignore[index]
    flat = list(_numbers(before)), list(_numbers(after))
    return len(flat[0]) == len(flat[1]) > 0 and all(abs(a - b) <= _ROUNDING for a, b in zip(*flat, strict=True))


def _numbers(value: object) -> Iterator[float]:
    if isinstance(value, tuple):
        for item in value:
            yield from _numbers(item)
    elif isinstance(value, float | int) and not isinstance(value, bool):
        yield float(value)


def _path_text(path: Path) -> str:
    return ".".join(str(step) for step in path if step not in ("data", "arcs", "weight", TURN))
