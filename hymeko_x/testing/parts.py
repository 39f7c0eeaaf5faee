"""Strategies for the parts of mechanisms, one for each kind of vertex and edge."""

from __future__ import annotations

from hypothesis import strategies as st

from hymeko_x.ir import lumped, parts
from hymeko_x.ir.values import Pose, Written, rotate_tensor, unit
from hymeko_x.testing.values import COLOURS, DIRECTIONS, LENGTHS, NAMES, NUMBERS, PARAMETERS, POSES, SMALL, TEXTS, VECTORS, maybe

TENSORS = st.tuples(*[SMALL] * 6)


def _is_no_segment(pose: Pose) -> bool:
    """Whether a pose is not given by two points, which hold a length beside a rotation."""
    return pose.written is None or pose.written.kind != "fromto"


@st.composite
def inertials(draw: st.DrawFn) -> parts.Inertial:
    """Any mass, centre and tensor, the tensor as it was written in turned axes in half of the cases."""
    mass, com, tensor = draw(maybe(LENGTHS)), draw(VECTORS), draw(maybe(TENSORS))
    if tensor is None or draw(st.booleans()):
        return parts.Inertial(mass, com, tensor)
    frame = draw(POSES.filter(_is_no_segment).map(lambda p: Pose(com, p.quat, p.written)))
    return parts.Inertial(mass, com, rotate_tensor(frame.quat, tensor), parts.InertialWritten(frame, tensor))


LIMITS = st.builds(parts.Limits, *[maybe(NUMBERS)] * 6)
SAFETIES = st.builds(parts.Safety, NUMBERS, NUMBERS, NUMBERS, NUMBERS)
CALIBRATIONS = st.builds(parts.Calibration, maybe(NUMBERS), maybe(NUMBERS), maybe(NUMBERS))


@st.composite
def dofs(draw: st.DrawFn, kinds: tuple[parts.DofKind, ...] = tuple(parts.DofKind)) -> parts.Dof:
    """A degree of freedom of one of these kinds, its axis given by a vector of any length."""
    vector = draw(DIRECTIONS)
    axis = unit(vector)
    scalars = {name: draw(NUMBERS) for name in ("damping", "friction", "stiffness", "spring_ref", "armature", "ref", "pitch")}
    return parts.Dof(
        draw(st.sampled_from(kinds)),
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
    st.sampled_from([(), (0.0, 0.0, 1.0, 0.0, 0.25, 1.0)]),
    st.sampled_from([(), (0, 1, 2), (2, 0, 1)]),
)
SUBSETS = st.builds(parts.Subset, st.lists(st.integers(0, 9), unique=True, max_size=3).map(lambda faces: tuple(sorted(faces))))
TEXTURES = st.builds(parts.Texture, maybe(URIS), maybe(TEXTS))
MOUNTED = st.one_of(
    st.builds(parts.Frame, st.lists(LENGTHS, max_size=3).map(tuple)),
    st.builds(parts.Sensor, TEXTS, maybe(NUMBERS), PARAMETERS),
    st.builds(parts.Camera, maybe(NUMBERS), maybe(st.tuples(st.integers(0, 4096), st.integers(0, 4096))), PARAMETERS),
    st.builds(parts.Light, TEXTS, maybe(VECTORS), PARAMETERS),
)
LUMPED = st.one_of(
    st.builds(lumped.Spring, NUMBERS, NUMBERS, TEXTS, TEXTS),
    st.builds(lumped.Damper, NUMBERS, TEXTS, TEXTS),
    st.builds(lumped.Mass, NUMBERS, TEXTS),
    st.builds(lumped.Port, TEXTS, NUMBERS, TEXTS, PARAMETERS),
)
ACTUATORS = st.builds(parts.Actuator, TEXTS, PARAMETERS)
POSE_SETS = st.builds(parts.PoseSet, maybe(TEXTS), maybe(NUMBERS), PARAMETERS)
_VALUES = st.recursive(NUMBERS | TEXTS | st.none(), lambda inner: st.lists(inner, max_size=3).map(tuple), max_leaves=5)
_DATA = st.lists(st.tuples(NAMES, _VALUES), max_size=3, unique_by=lambda pair: pair[0]).map(tuple)
LISTS_OF_ANY_SHAPE = st.lists(_VALUES, max_size=3).map(tuple)
DATA = st.builds(parts.Datum, _DATA)
LOOPS = st.builds(parts.Loop, TEXTS, st.lists(dofs(), max_size=2).map(tuple), st.booleans(), PARAMETERS)
TENDONS = st.builds(parts.Tendon, TEXTS, LIMITS, NUMBERS, NUMBERS, NUMBERS, NUMBERS, maybe(LENGTHS), maybe(COLOURS), PARAMETERS)
DRIVES = st.builds(parts.Drive, TEXTS, PARAMETERS)
CONTACTS = st.builds(parts.Contact, TEXTS, PARAMETERS)
RELATIONS = st.builds(parts.Relation, _DATA)
