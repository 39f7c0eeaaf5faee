"""Strategies for whole mechanisms."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hypothesis import strategies as st
from msgspec import Struct

from hymeko_x.formats.hymeko.nesting import nest_edge, nest_key, prefix_of
from hymeko_x.ir import lumped, parts
from hymeko_x.ir.graph import Arc, Edge, Hypergraph
from hymeko_x.ir.ids import KINDS
from hymeko_x.ir.mechanism import (
    ROOT,
    WORLD,
    Extra,
    Id,
    Mechanism,
    coupling_edge,
    joint_edge,
    layer_edge,
    mount_edge,
    shape_edge,
    subset_edge,
)
from hymeko_x.ir.values import Pose
from hymeko_x.testing.parts import (
    ACTUATORS,
    CONTACTS,
    DATA,
    DRIVES,
    LISTS_OF_ANY_SHAPE,
    LOOPS,
    LUMPED,
    MATERIALS,
    MESHES,
    MOUNTED,
    POSE_SETS,
    RELATIONS,
    SHAPES,
    SUBSETS,
    TENDONS,
    TEXTURES,
    dofs,
    inertials,
)
from hymeko_x.testing.values import COLOURS, NAMES, NUMBERS, POSES, TEXTS, maybe

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.ir.mechanism import RobotArc, RobotEdge


class Knobs(Struct, frozen=True):
    """The features of drawn mechanisms. By default they have everything that the IR can represent; each knob excludes something.

    ``dof_kinds`` and ``most_dofs`` are of one joint; ``loose`` allows further bodies without a parent joint beside the
    first; ``names`` draws the names of all elements.
    """

    most_bodies: int = 4
    loose: bool = True
    world: bool = True
    dof_kinds: tuple[parts.DofKind, ...] = tuple(parts.DofKind)
    most_dofs: int = 2
    child_poses: bool = True
    shapes: bool = True
    materials: bool = True
    meshes: bool = True
    couplings: bool = True
    loops: bool = True
    tendons: bool = True
    actuators: bool = True
    sensors: bool = True
    poses: bool = True
    lumped: bool = True
    relations: bool = True
    extras: bool = True
    notations: bool = True
    names: st.SearchStrategy[str] = NAMES


EVERYTHING = Knobs()
TREES = Knobs(
    loose=False,
    couplings=False,
    loops=False,
    tendons=False,
    actuators=False,
    sensors=False,
    poses=False,
    lumped=False,
    relations=False,
    extras=False,
    notations=False,
)
"""Bodies, joints and shapes, all of it one tree."""


class _Builder:
    """A mechanism that is being drawn: each element gets a name that is unique among its kind."""

    def __init__(self, draw: st.DrawFn, knobs: Knobs) -> None:
        self.draw = draw
        self.knobs = knobs
        self.vertices: dict[Id, parts.VertexPart] = {}
        self.edges: dict[Id, RobotEdge] = {}

    def id(self, kind: str, name: str | None = None) -> Id:
        wanted = self.draw(self.knobs.names) if name is None else name
        key, number = Id(kind, wanted), 2
        while key in self.vertices or key in self.edges:
            key, number = Id(kind, f"{wanted}#{number}"), number + 1
        return key

    def several(self, part: st.SearchStrategy[parts.VertexPart], most: int) -> list[Id]:
        found = []
        for value in self.draw(st.lists(part, max_size=most)):
            key = self.id(KINDS[type(value)])
            self.vertices[key] = value
            found.append(key)
        return found

    def edge(self, kind: str, edge: RobotEdge, name: str | None = None) -> Id:
        key = self.id(kind, name)
        self.edges[key] = edge
        return key

    def of(self, *kinds: str) -> list[Id]:
        return [key for key in (*self.vertices, *self.edges) if key.kind in kinds]

    def one(self, *kinds: str) -> Id:
        return self.draw(st.sampled_from(self.of(*kinds)))

    def chance(self, *kinds: str) -> bool:
        """Whether to add an element that needs these kinds of elements."""
        return all(self.of(kind) for kind in kinds) and self.draw(st.booleans())

    def arcs(self, sign: int, kinds: tuple[str, ...], weight: st.SearchStrategy[parts.Weight]) -> tuple[RobotArc, ...]:
        """Up to three arcs to elements of these kinds."""
        found = self.of(*kinds)
        targets = self.draw(st.lists(st.sampled_from(found), min_size=1, max_size=3)) if found else []
        roles = st.sampled_from(["", "wrap", "side role"])
        return tuple(Arc(target, sign, self.draw(maybe(weight)), self.draw(roles)) for target in targets)


@st.composite
def mechanisms(draw: st.DrawFn, knobs: Knobs = EVERYTHING) -> Mechanism:
    """A mechanism with any of the parts that the IR has, names in any script, extras, notations and a layout.

    ``knobs`` exclude features. Extras of the mechanism as a whole are in the order of readers: those with a path first,
    then the others by index. It shrinks to an empty mechanism.
    """
    builder = _Builder(draw, knobs)
    if knobs.world and draw(st.booleans()):
        builder.vertices[WORLD] = parts.World()
    builder.several(st.builds(parts.Body, maybe(inertials())), knobs.most_bodies)
    for part, most, wanted in _vertices(knobs):
        if wanted:
            builder.several(part, most)
    _add_joints(builder)
    if knobs.shapes:
        _add_shapes(builder)
    adders = [add for add, is_wanted in _ADDERS if is_wanted(knobs)]
    for add in draw(st.lists(st.sampled_from(adders), unique=True)) if adders else ():
        add(builder)
    return _finished(builder)


def _vertices(knobs: Knobs) -> tuple[tuple[st.SearchStrategy[parts.VertexPart], int, bool], ...]:
    """The vertices beside the bodies: how many at most, and whether they are wanted."""
    return (
        (MATERIALS, 2, knobs.materials),
        (MESHES, 2, knobs.meshes),
        (TEXTURES, 1, knobs.materials),
        (MOUNTED, 2, knobs.sensors),
        (LUMPED, 2, knobs.lumped),
        (ACTUATORS, 1, knobs.actuators),
        (POSE_SETS, 1, knobs.poses),
        (DATA, 1, knobs.relations),
    )


def _add_joints(builder: _Builder) -> None:
    knobs = builder.knobs
    bodies = builder.of("body")
    for number, child in enumerate(bodies):
        above = [*builder.of("world"), *bodies[:number]]
        parent = builder.draw(st.sampled_from([None, *above] if knobs.loose or not above else above))
        if parent is not None:
            joint = parts.Joint(tuple(builder.draw(st.lists(dofs(knobs.dof_kinds), max_size=knobs.most_dofs))))
            child_pose = builder.draw(st.just(Pose()) | POSES) if knobs.child_poses else Pose()
            builder.edge("joint", joint_edge(joint, parent, child, builder.draw(POSES), child_pose))


def _add_shapes(builder: _Builder) -> None:
    for body in builder.of("body", "world"):
        for shape in builder.draw(st.lists(SHAPES, max_size=2)):
            mesh = builder.one("mesh") if builder.chance("mesh") else None
            if mesh is not None:
                shape = parts.Shape(parts.MeshShape(), shape.role, shape.name, shape.rgba)
            material = builder.one("material") if builder.chance("material") else None
            word = {"visual": "visual", "collision": "collision", "both": "shape"}[shape.role.value]
            name = builder.draw(st.just(f"{body.name}/{word}") | builder.knobs.names)
            key = builder.edge("shape", shape_edge(shape, body, builder.draw(POSES), mesh, material), name)
            if material is None and builder.draw(st.booleans()):
                _colour(builder, key, shape, body, mesh)


def _colour(builder: _Builder, key: Id, shape: parts.Shape, body: Id, mesh: Id | None) -> None:
    """Give the shape a nameless material of its own."""
    material = builder.id("material", f"{key.name}/material")
    builder.vertices[material] = parts.Material(None, builder.draw(COLOURS))
    builder.edges[key] = shape_edge(shape, body, builder.draw(POSES), mesh, material)


def _add_couplings(builder: _Builder) -> None:
    if not builder.of("joint"):
        return
    follower = builder.one("joint")
    weights = st.lists(NUMBERS, min_size=1, max_size=3).map(tuple) | st.just((0.0, 1.0))
    leaders = tuple((builder.one("joint"), builder.draw(weights)) for _ in range(builder.draw(st.integers(1, 2))))
    name = builder.draw(st.sampled_from([follower.name, "gear"]))
    builder.edge("coupling", coupling_edge(follower, leaders, active=builder.draw(st.booleans())), name)


def _add_mounts(builder: _Builder) -> None:
    if builder.of("body", "world") and builder.of("frame", "camera", "light", "sensor"):
        builder.edge(
            "mount", mount_edge(builder.one("body", "world"), builder.one("frame", "camera", "light", "sensor"), builder.draw(POSES))
        )


def _add_layers(builder: _Builder) -> None:
    if builder.of("texture") and builder.of("material"):
        builder.edge("layer", layer_edge(builder.one("texture"), builder.one("material"), builder.draw(TEXTS)))


def _add_subsets(builder: _Builder) -> None:
    if builder.of("shape") and builder.of("material"):
        builder.edge("subset", subset_edge(builder.draw(SUBSETS).faces, builder.one("shape"), builder.one("material")))


def _add_any(
    kind: str,
    part: st.SearchStrategy[parts.EdgePart],
    sign: int,
    targets: tuple[str, ...],
    weight: st.SearchStrategy[parts.Weight],
) -> Callable[[_Builder], None]:
    """An adder of one edge of this kind with arcs to any of its targets."""

    def add(builder: _Builder) -> None:
        builder.edge(kind, Edge(builder.draw(part), builder.arcs(sign, targets, weight)))

    return add


def _add_drives(builder: _Builder) -> None:
    """One edge from actuators to what they drive."""
    arcs = (*builder.arcs(1, ("actuator",), _LISTS), *builder.arcs(-1, ("joint", "tendon"), _LISTS))
    builder.edge("drive", Edge(builder.draw(DRIVES), arcs))


def _add_blocks(builder: _Builder) -> None:
    """Data and relations inside of others, with the edges that tell so, as blocks of text have them."""
    for _ in range(builder.draw(st.integers(0, 3))):
        outers = [key for key in builder.of("datum", "relation") if nest_key(key) not in builder.edges]
        if not outers:
            return
        outer = builder.draw(st.sampled_from(outers))
        inner = [_inside(builder, outer) for _ in range(builder.draw(st.integers(1, 3)))]
        builder.edges[nest_key(outer)] = nest_edge(outer, inner)


def _inside(builder: _Builder, outer: Id) -> Id:
    """A new vertex or edge whose name tells that it stands inside of another one."""
    name = prefix_of(outer) + builder.draw(builder.knobs.names)
    if builder.draw(st.booleans()):
        key = builder.id("datum", name)
        builder.vertices[key] = builder.draw(DATA)
        return key
    arcs = builder.arcs(builder.draw(st.sampled_from([-1, 0, 1])), tuple(KINDS.values()), LISTS_OF_ANY_SHAPE)
    return builder.edge("relation", Edge(builder.draw(RELATIONS), arcs), name)


_LISTS = st.lists(NUMBERS, max_size=3).map(tuple)
_PLACED = POSES.filter(lambda p: p != Pose() or p.written is not None)
_ADDERS: tuple[tuple[Callable[[_Builder], None], Callable[[Knobs], bool]], ...] = (
    (_add_couplings, lambda knobs: knobs.couplings),
    (_add_mounts, lambda knobs: knobs.sensors),
    (_add_layers, lambda knobs: knobs.materials),
    (_add_subsets, lambda knobs: knobs.materials and knobs.meshes),
    (_add_any("loop", LOOPS, 0, ("body", "frame", "world"), _PLACED), lambda knobs: knobs.loops),
    (_add_any("tendon", TENDONS, 1, ("frame", "joint", "shape"), _LISTS), lambda knobs: knobs.tendons),
    (_add_drives, lambda knobs: knobs.actuators),
    (_add_any("sense", st.just(parts.Sense()), 1, ("sensor", "body", "joint", "shape"), _LISTS), lambda knobs: knobs.sensors),
    (_add_any("stance", st.just(parts.Stance()), 0, ("pose", "joint"), _LISTS), lambda knobs: knobs.poses),
    (_add_any("contact", CONTACTS, 0, ("shape", "body"), _LISTS), lambda knobs: knobs.relations),
    (
        _add_any("constitutive", st.just(lumped.Constitutive()), -1, ("body", "spring", "damper", "mass", "port"), _LISTS),
        lambda knobs: knobs.lumped,
    ),
    (_add_any("relation", RELATIONS, 0, tuple(KINDS.values()), LISTS_OF_ANY_SHAPE), lambda knobs: knobs.relations),
    (_add_any("nest", st.just(parts.Nest()), 1, ("datum", "relation"), _LISTS), lambda knobs: knobs.relations),
    (_add_blocks, lambda knobs: knobs.relations),
)
_EXTRAS = st.builds(
    Extra,
    st.sampled_from(["urdf", "mjcf", "hymeko", "comment", "odd format"]),
    st.sampled_from(["", "limit", "limit/@foo", "a b", "preceding", "following"]),
    TEXTS,
    st.integers(0, 5),
)


def _finished(builder: _Builder) -> Mechanism:
    draw, knobs = builder.draw, builder.knobs
    keys = [*builder.vertices, *builder.edges]
    extras = _extras(draw, keys) if knobs.extras else {}
    noted = draw(st.lists(st.sampled_from([ROOT, *keys]), max_size=2, unique=True)) if knobs.notations else []
    notations = {key: draw(st.dictionaries(TEXTS, TEXTS, min_size=1, max_size=2)) for key in noted}
    inside = {arc.target for key, edge in builder.edges.items() if key.kind == "nest" for arc in edge.arcs[1:]}
    alone = [key for key in keys if key.kind not in ("shape", "nest") and key not in inside]
    layout = draw(st.just([]) | st.lists(st.sampled_from(alone), unique=True)) if alone else []
    graph = Hypergraph(builder.vertices, builder.edges)
    return Mechanism(draw(knobs.names), graph, extras, {}, notations, {}, tuple(layout))


def _extras(draw: st.DrawFn, keys: list[Id]) -> dict[Id, tuple[Extra, ...]]:
    marked = draw(st.lists(st.sampled_from(keys), max_size=2, unique=True)) if keys else []
    extras = {key: tuple(draw(st.lists(_EXTRAS, min_size=1, max_size=2))) for key in marked}
    whole = draw(st.lists(_EXTRAS, max_size=3))
    if whole:
        standing = sorted((extra for extra in whole if not extra.path), key=lambda extra: extra.index)
        extras[ROOT] = (*(extra for extra in whole if extra.path), *standing)
    return extras
