"""Hypothesis strategies: whole mechanisms with everything that the IR can say, and syntax trees of the language."""

from __future__ import annotations

import string
from collections.abc import Callable

from hypothesis import reject
from hypothesis import strategies as st

from hymeko_x.ir import parts
from hymeko_x.ir.graph import Arc, Edge, Hypergraph
from hymeko_x.ir.mechanism import (
    KINDS,
    ROOT,
    WORLD,
    Extra,
    Id,
    Mechanism,
    RobotArc,
    RobotEdge,
    coupling_edge,
    joint_edge,
    layer_edge,
    mount_edge,
    shape_edge,
)
from hymeko_x.ir.values import Pose, Written, pose, pose_from_rpy, rotate_tensor, unit
from hymeko_x.ir.written import pose_as_written
from hymeko_x.language import syntax

# ---- texts and names -----------------------------------------------------------------------------------------------------

_CHARACTERS = st.characters(exclude_categories=["Cs"])
_ODD_TEXTS = ["", "<x a='1' b=\"2\"/>", "two\nlines", '"""', "'", "${x}", "\\", "\0", "\r\n", "\t", "*/", "// no comment"]
TEXTS = st.text(_CHARACTERS, max_size=12) | st.sampled_from(_ODD_TEXTS)
_MEANINGFUL_NAMES = ["base", "X", "Z", "AXIS_Z", "visual", "dof", "dof#2", "units", "scope", "mass", "safety", "axis", "at", "urdf"]
_WORDS_OF_THE_LANGUAGE = ["world", "use", "import", "as", "rel", "seq", "extra", "written", "files", "kind", "type", "inf", "limit", "true"]
_ODD_NAMES = ["", " ", "a b", "a.b", "a/b", "a`b", 'a"b', "1a", "-a", "ü", "関節", "сустав", "a\\", "a\nb", "${x}", "@a", "a{", "~/a"]
NAMES = st.sampled_from([*_MEANINGFUL_NAMES, *_WORDS_OF_THE_LANGUAGE, *_ODD_NAMES]) | st.text(_CHARACTERS, max_size=6)
PLAIN_NAMES = st.text(string.ascii_letters + "_", min_size=1, max_size=8)

# ---- values --------------------------------------------------------------------------------------------------------------

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
    """A pose whose rotation was written in one of the other notations."""
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


def maybe(strategy: st.SearchStrategy[object]) -> st.SearchStrategy[object]:
    """The value, or None."""
    return st.none() | strategy


PARAMETERS = st.lists(
    st.tuples(NAMES, NUMBERS | TEXTS | st.lists(NUMBERS, max_size=3).map(tuple)), max_size=3, unique_by=lambda pair: pair[0]
).map(tuple)

# ---- parts ---------------------------------------------------------------------------------------------------------------

TENSORS = st.tuples(*[SMALL] * 6)


def _is_no_segment(pose: Pose) -> bool:
    """Whether a pose is not given by two points, which say more than a rotation."""
    return pose.written is None or pose.written.kind != "fromto"


@st.composite
def _inertials(draw: st.DrawFn) -> parts.Inertial:
    mass, com, tensor = draw(maybe(LENGTHS)), draw(VECTORS), draw(maybe(TENSORS))
    if tensor is None or draw(st.booleans()):
        return parts.Inertial(mass, com, tensor)
    frame = draw(POSES.filter(_is_no_segment).map(lambda p: Pose((0.0, 0.0, 0.0), p.quat, p.written)))
    return parts.Inertial(mass, com, rotate_tensor(frame.quat, tensor), parts.InertialWritten(frame, tensor))


LIMITS = st.builds(parts.Limits, *[maybe(NUMBERS)] * 6)
SAFETIES = st.builds(parts.Safety, NUMBERS, NUMBERS, NUMBERS, NUMBERS)
CALIBRATIONS = st.builds(parts.Calibration, maybe(NUMBERS), maybe(NUMBERS), maybe(NUMBERS))


@st.composite
def dofs(draw: st.DrawFn) -> parts.Dof:
    """Any degree of freedom, its axis given by a vector of any length."""
    vector = draw(DIRECTIONS)
    axis = unit(vector)
    scalars = {name: draw(NUMBERS) for name in ("damping", "friction", "stiffness", "spring_ref", "armature", "ref", "pitch")}
    return parts.Dof(
        draw(st.sampled_from(parts.DofKind)),
        axis,
        draw(st.just(parts.UNLIMITED) | LIMITS),
        anchor=draw(st.just((0.0, 0.0, 0.0)) | VECTORS),
        safety=draw(maybe(SAFETIES)),
        calibration=draw(maybe(CALIBRATIONS)),
        name=draw(maybe(TEXTS)),
        written=None if axis == vector else Written("axis", vector),
        **(scalars if draw(st.booleans()) else {}),
    )


GEOMETRIES = st.one_of(
    st.builds(parts.Box, VECTORS),
    st.builds(parts.Sphere, LENGTHS),
    st.builds(parts.Cylinder, LENGTHS, LENGTHS),
    st.builds(parts.Capsule, LENGTHS, LENGTHS),
    st.builds(parts.Ellipsoid, VECTORS),
    st.builds(parts.Plane, st.tuples(LENGTHS, LENGTHS)),
    st.just(parts.NoShape()),
)
SHAPES = st.builds(
    parts.Shape,
    GEOMETRIES,
    st.sampled_from(parts.Role),
    maybe(TEXTS),
    maybe(COLOURS),
    maybe(LENGTHS),
    maybe(LENGTHS),
    st.lists(LENGTHS, max_size=3).map(tuple),
)
MATERIALS = st.builds(parts.Material, maybe(TEXTS), maybe(COLOURS), *[maybe(NUMBERS)] * 6)
URIS = TEXTS | st.sampled_from(["package://arm/meshes/a.stl", "package://arm/meshes/b.stl", "meshes/a.stl", "~/a.obj", "~", "/", "a/"])
MESHES = st.builds(parts.Mesh, maybe(URIS), st.sampled_from([(1.0, 1.0, 1.0), (0.001, 0.001, 0.001)]) | VECTORS) | st.builds(
    parts.Mesh,
    maybe(URIS),
    VECTORS,
    maybe(TEXTS),
    st.just((0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.5)),
    st.just((0, 1, 2)),
)
THINGS = st.one_of(
    st.builds(parts.Frame, st.lists(LENGTHS, max_size=3).map(tuple)),
    st.builds(parts.Sensor, TEXTS, maybe(NUMBERS), PARAMETERS),
    st.builds(parts.Camera, maybe(NUMBERS), maybe(st.tuples(st.integers(0, 4096), st.integers(0, 4096))), PARAMETERS),
    st.builds(parts.Light, TEXTS, maybe(VECTORS), PARAMETERS),
)
LUMPED = st.one_of(
    st.builds(parts.Spring, NUMBERS, NUMBERS),
    st.builds(parts.Damper, NUMBERS),
    st.builds(parts.Mass, NUMBERS),
    st.builds(parts.Port, TEXTS, NUMBERS),
)
ACTUATORS = st.builds(parts.Actuator, TEXTS, PARAMETERS)
POSE_SETS = st.builds(parts.PoseSet, maybe(TEXTS), maybe(NUMBERS), PARAMETERS)
DATA = st.builds(parts.Datum, PARAMETERS)
LOOPS = st.builds(parts.Loop, TEXTS, st.lists(dofs(), max_size=2).map(tuple), st.booleans(), PARAMETERS)
TENDONS = st.builds(parts.Tendon, TEXTS, LIMITS, NUMBERS, NUMBERS, NUMBERS, NUMBERS, maybe(LENGTHS), maybe(COLOURS), PARAMETERS)
DRIVES = st.builds(parts.Drive, TEXTS, PARAMETERS)
CONTACTS = st.builds(parts.Contact, TEXTS, PARAMETERS)
RELATIONS = st.builds(parts.Relation, PARAMETERS)

# ---- mechanisms ------------------------------------------------------------------------------------------------------------


class _Draft:
    """A mechanism in the making: each element gets a name of its own among its kind."""

    def __init__(self, draw: st.DrawFn) -> None:
        self.draw = draw
        self.vertices: dict[Id, parts.VertexPart] = {}
        self.edges: dict[Id, RobotEdge] = {}

    def id(self, kind: str, name: str | None = None) -> Id:
        wanted = self.draw(NAMES) if name is None else name
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
        """Whether to add something that needs these kinds of elements."""
        return all(self.of(kind) for kind in kinds) and self.draw(st.booleans())

    def arcs(self, sign: int, kinds: tuple[str, ...], weight: st.SearchStrategy[object]) -> tuple[RobotArc, ...]:
        """Up to three arcs to elements of these kinds."""
        found = self.of(*kinds)
        targets = self.draw(st.lists(st.sampled_from(found), min_size=1, max_size=3)) if found else []
        roles = st.sampled_from(["", "wrap", "side role"])
        return tuple(Arc(target, sign, self.draw(maybe(weight)), self.draw(roles)) for target in targets)


@st.composite
def mechanisms(draw: st.DrawFn) -> Mechanism:
    """A mechanism with any of the parts that the IR has, names in any script, extras, notations and a layout.

    Extras of the mechanism as a whole come as readers give them: those with a path first, then the others by place.
    """
    draft = _Draft(draw)
    if draw(st.booleans()):
        draft.vertices[WORLD] = parts.World()
    draft.several(st.builds(parts.Body, maybe(_inertials())), 4)
    for part, most in ((MATERIALS, 2), (MESHES, 2), (st.builds(parts.Texture, maybe(URIS), maybe(TEXTS)), 1), (THINGS, 2), (LUMPED, 2)):
        draft.several(part, most)
    for part in (ACTUATORS, POSE_SETS, DATA):
        draft.several(part, 1)
    _add_joints(draft)
    _add_shapes(draft)
    for add in draw(st.lists(st.sampled_from(_ADDERS), unique=True)):
        add(draft)
    return _finished(draft)


def _add_joints(draft: _Draft) -> None:
    bodies = draft.of("body")
    for number, child in enumerate(bodies):
        above = draft.draw(st.sampled_from([None, *draft.of("world"), *bodies[:number]]))
        if above is not None:
            joint = parts.Joint(tuple(draft.draw(st.lists(dofs(), max_size=2))))
            child_pose = draft.draw(st.just(Pose()) | POSES)
            draft.edge("joint", joint_edge(joint, above, child, draft.draw(POSES), child_pose))


def _add_shapes(draft: _Draft) -> None:
    for body in draft.of("body", "world"):
        for shape in draft.draw(st.lists(SHAPES, max_size=2)):
            mesh = draft.one("mesh") if draft.chance("mesh") else None
            if mesh is not None:
                shape = parts.Shape(parts.MeshShape(), shape.role, shape.name, shape.rgba)
            material = draft.one("material") if draft.chance("material") else None
            word = {"visual": "visual", "collision": "collision", "both": "shape"}[shape.role.value]
            name = draft.draw(st.just(f"{body.name}/{word}") | NAMES)
            key = draft.edge("shape", shape_edge(shape, body, draft.draw(POSES), mesh, material), name)
            if material is None and draft.draw(st.booleans()):
                _colour(draft, key, shape, body, mesh)


def _colour(draft: _Draft, key: Id, shape: parts.Shape, body: Id, mesh: Id | None) -> None:
    """Give the shape a nameless colour of its own."""
    material = draft.id("material", f"{key.name}/material")
    draft.vertices[material] = parts.Material(None, draft.draw(COLOURS))
    draft.edges[key] = shape_edge(shape, body, draft.draw(POSES), mesh, material)


def _add_couplings(draft: _Draft) -> None:
    if not draft.of("joint"):
        return
    follower = draft.one("joint")
    weights = st.lists(NUMBERS, min_size=1, max_size=3).map(tuple) | st.just((0.0, 1.0))
    leaders = tuple((draft.one("joint"), draft.draw(weights)) for _ in range(draft.draw(st.integers(1, 2))))
    name = draft.draw(st.sampled_from([follower.name, "gear"]))
    draft.edge("coupling", coupling_edge(follower, leaders, active=draft.draw(st.booleans())), name)


def _add_mounts(draft: _Draft) -> None:
    if draft.of("body", "world") and draft.of("frame", "camera", "light", "sensor"):
        draft.edge("mount", mount_edge(draft.one("body", "world"), draft.one("frame", "camera", "light", "sensor"), draft.draw(POSES)))


def _add_layers(draft: _Draft) -> None:
    if draft.of("texture") and draft.of("material"):
        draft.edge("layer", layer_edge(draft.one("texture"), draft.one("material"), draft.draw(TEXTS)))


def _add_any(
    kind: str, part: st.SearchStrategy[parts.EdgePart], sign: int, targets: tuple[str, ...], weight: st.SearchStrategy[object]
) -> Callable[[_Draft], None]:
    """An adder of one edge of this kind with arcs to any of its targets."""

    def add(draft: _Draft) -> None:
        draft.edge(kind, Edge(draft.draw(part), draft.arcs(sign, targets, weight)))

    return add


_LISTS = st.lists(NUMBERS, max_size=3).map(tuple)
_PLACED = POSES.filter(lambda p: p != Pose() or p.written is not None)
_ADDERS = (
    _add_couplings,
    _add_mounts,
    _add_layers,
    _add_any("loop", LOOPS, 0, ("body", "frame", "world"), _PLACED),
    _add_any("tendon", TENDONS, 1, ("frame", "joint", "shape"), _LISTS),
    _add_any("drive", DRIVES, -1, ("actuator", "joint", "tendon"), _LISTS),
    _add_any("sense", st.just(parts.Sense()), 1, ("sensor", "body", "joint", "shape"), _LISTS),
    _add_any("stance", st.just(parts.Stance()), 0, ("pose", "joint"), _LISTS),
    _add_any("contact", CONTACTS, 0, ("shape", "body"), _LISTS),
    _add_any("constitutive", st.just(parts.Constitutive()), -1, ("body", "spring", "damper", "mass", "port"), _LISTS),
    _add_any("relation", RELATIONS, 0, tuple(KINDS.values()), _LISTS),
)
_EXTRAS = st.builds(
    Extra,
    st.sampled_from(["urdf", "mjcf", "hymeko", "comment", "odd format"]),
    st.sampled_from(["", "limit", "limit/@foo", "a b", "preceding", "following"]),
    TEXTS,
    st.integers(0, 5),
)


def _finished(draft: _Draft) -> Mechanism:
    draw = draft.draw
    keys = [*draft.vertices, *draft.edges]
    marked = draw(st.lists(st.sampled_from(keys), max_size=2, unique=True)) if keys else []
    extras = {key: tuple(draw(st.lists(_EXTRAS, min_size=1, max_size=2))) for key in marked}
    whole = draw(st.lists(_EXTRAS, max_size=3))
    if whole:
        standing = sorted((extra for extra in whole if not extra.path), key=lambda extra: extra.index)
        extras[ROOT] = (*(extra for extra in whole if extra.path), *standing)
    noted = draw(st.lists(st.sampled_from([ROOT, *keys]), max_size=2, unique=True))
    notations = {key: draw(st.dictionaries(TEXTS, TEXTS, min_size=1, max_size=2)) for key in noted}
    alone = [key for key in keys if key.kind != "shape"]
    layout = draw(st.just([]) | st.lists(st.sampled_from(alone), unique=True)) if alone else []
    graph = Hypergraph(draft.vertices, draft.edges)
    return Mechanism(draw(NAMES), graph, extras, {}, notations, {}, tuple(layout))


# ---- syntax trees ----------------------------------------------------------------------------------------------------------

_SIGNS = ("+", "-", "~", "->", "<-", "<>")
_MODIFIERS = ("", "", "|>", "*|>", "-|>", "<<copy>>", "<<use>>", "<<extend>>")
REFS = st.lists(NAMES, min_size=1, max_size=3).map(lambda path: syntax.Ref(tuple(path)))
RELATIONS_TO = st.builds(
    syntax.Ref,
    st.lists(NAMES, min_size=1, max_size=2).map(tuple),
    st.sampled_from(_SIGNS),
    st.sampled_from(_MODIFIERS),
)
QUANTITIES = st.builds(syntax.Quantity, NUMBERS, st.sampled_from(["deg", "mm", "kg*m^2", "rad/s", "%", "°", "µm", "N-m"]))
EXPRESSIONS = st.sampled_from(["", "1", "a + 2*pi", "sqrt(x)"]).map(syntax.Expression)
SCALARS = st.one_of(NUMBERS, st.just(float("inf")), TEXTS, REFS, RELATIONS_TO, QUANTITIES, EXPRESSIONS, st.just(syntax.Query()))
_FLAT_LISTS = st.lists(SCALARS, max_size=3).map(tuple) | st.lists(NUMBERS, max_size=3).map(tuple)
LISTS = st.recursive(_FLAT_LISTS, lambda inner: st.lists(inner | SCALARS, max_size=3).map(tuple), max_leaves=5)
VALUES = SCALARS | LISTS
_PARAMETERS = st.lists(st.builds(syntax.Parameter, NAMES, maybe(VALUES)), max_size=2).map(tuple)
_ARGUMENTS = st.lists(st.tuples(NAMES, VALUES), max_size=2).map(tuple)
_STEREOTYPES = st.lists(st.builds(syntax.Stereotype, REFS | RELATIONS_TO, maybe(_ARGUMENTS)), max_size=2).map(tuple)
_FIELDS = st.builds(syntax.Field, NAMES, maybe(VALUES), st.just("") | PLAIN_NAMES, st.just(0), st.just(0))
_IMPORTS = st.builds(syntax.Import, TEXTS, st.just("") | NAMES.filter(bool), st.just(0), st.just(0))


def _blocks(inner: st.SearchStrategy[syntax.Item]) -> st.SearchStrategy[syntax.Item]:
    items = st.lists(inner, max_size=4).map(tuple)
    return st.one_of(
        st.builds(
            syntax.Node,
            NAMES,
            items,
            _STEREOTYPES,
            maybe(_PARAMETERS),
            st.lists(REFS, max_size=1).map(tuple),
            st.sampled_from(["", "", "@", "rel", "seq", "concurrent", "my edge"]),
            st.just(0),
            st.just(0),
        ),
        st.builds(syntax.ArcItem, RELATIONS_TO, st.just("") | NAMES.filter(bool), maybe(LISTS), items, st.just(0), st.just(0)),
    )


ITEMS = st.recursive(_FIELDS | _IMPORTS, _blocks, max_leaves=12)
DOCUMENTS = st.builds(syntax.Document, st.lists(ITEMS, max_size=4).map(tuple), st.just("") | NAMES.filter(bool)).filter(
    lambda document: bool(document.header) or not _begins_like_a_header(document)
)
"""Whole texts. A text that begins with ``[name]`` has a header in the published examples, and not an arc with that weight."""


def _begins_like_a_header(document: syntax.Document) -> bool:
    first = document.items[0] if document.items else None
    return isinstance(first, syntax.ArcItem) and first.weight is not None and len(first.weight) == 1
