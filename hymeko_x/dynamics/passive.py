"""What acts at the dofs of a tree by itself, and along its tendons: springs, dampers, and Coulomb friction.

A spring of a ball pulls to the reference: its torque is minus the stiffness times the rotation vector from there. That of a free dof
pulls its position besides. Coulomb friction f is f v / sqrt(v^2 + SLIP^2) against the velocity v of a dof or of a tendon's length: smooth,
so that what it holds creeps with a velocity below SLIP as long as the load is below 0.7 f.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x.dynamics.lines import ActionLine, act, line_of, seats_of, stretches
from hymeko_x.dynamics.numbers import add, dot, floats, times
from hymeko_x.dynamics.recursion import Constants
from hymeko_x.dynamics.spatial import minus, of_quaternion, scaled, turned_back
from hymeko_x.ir import parts
from hymeko_x.ir.parts import DofKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hymeko_x.dynamics.drives import Left
    from hymeko_x.dynamics.numbers import Matrix, Number, Numbers
    from hymeko_x.dynamics.tree import Link, LinkTree
    from hymeko_x.ir.ids import Id
    from hymeko_x.ir.mechanism import Mechanism

SLIP = 1e-3
"""In m/s or rad/s. Source: Drake's MultibodyPlant has this stiction tolerance by default."""
_TINY = 1e-24
"""Added to the square of a sine of half an angle, so that a rotation vector has derivatives at zero."""


class Cable(Struct, frozen=True):
    """A tendon that acts by itself: friction and a damper, and a spring that does nothing at lengths between the two of ``rest``."""

    id: Id
    line: ActionLine
    stiffness: float
    damping: float
    rest: tuple[float, float]
    friction: float = 0.0


# ---- from the mechanism ------------------------------------------------------------------------------------------------------------


def cables_of(mechanism: Mechanism, tree: LinkTree) -> tuple[tuple[Cable, ...], Left]:
    """The tendons that act by themselves, and those that do and have no equations here."""
    seats = seats_of(mechanism, tree)
    found, left = [], []
    for key, tendon, arcs in mechanism.edges(parts.Tendon):
        if not tendon.stiffness and not tendon.damping and not tendon.friction:
            continue
        line = line_of(mechanism, tree, tendon, arcs, seats)
        if isinstance(line, str):
            left.append((key, line))
        else:
            found.append(Cable(key, line, tendon.stiffness, tendon.damping, _rest(tendon, line, tree), tendon.friction))
    return tuple(found), left


def _rest(tendon: parts.Tendon, line: ActionLine, tree: LinkTree) -> tuple[float, float]:
    """The lengths at rest: ``springlength``, else that at the rests of the joints' springs, as in MuJoCo."""
    given = dict(tendon.parameters).get("springlength", -1.0)
    ends = tuple(map(float, given if isinstance(given, tuple) else (given,)))
    if set(ends) != {-1.0}:
        return ends[0], ends[-1]
    q = list(tree.rest)
    for link in tree.links:
        if link.coordinates == 1:
            q[link.q] = link.dof.spring_ref
    length = float(stretches([line], Constants(tree, floats()), q)[0].length)
    return length, length


def rubbing(tree: LinkTree, cables: Sequence[Cable]) -> list[Id]:
    """The joints and tendons with Coulomb friction."""
    joints = dict.fromkeys(link.joint for link in tree.links if link.dof.friction)
    return [*joints, *[cable.id for cable in cables if cable.friction]]


def smooth(tree: LinkTree, cables: Sequence[Cable]) -> tuple[LinkTree, tuple[Cable, ...]]:
    """A tree and tendons without Coulomb friction."""
    links = tuple([replace(link, dof=replace(link.dof, friction=0.0)) for link in tree.links])
    return replace(tree, links=links), tuple([replace(cable, friction=0.0) for cable in cables])


# ---- forces ------------------------------------------------------------------------------------------------------------------------


def passive_forces(constants: Constants, cables: Sequence[Cable], q: Sequence[Number], v: Sequence[Number]) -> list[Number]:
    """The forces of springs, dampers and friction on all coordinates."""
    numbers = constants.numbers
    forces: list[Number] = [0] * constants.tree.nv
    for link in constants.tree.links:
        for k in range(link.v, link.v + link.velocities):
            forces[k] = minus(times(_resistance(link.dof, v[k], numbers), v[k]))
        if link.dof.stiffness:
            for k, force in enumerate(_spring(link, q[link.q : link.q + link.coordinates], numbers), link.v):
                forces[k] = add(forces[k], force)
    for cable, stretch in zip(cables, stretches([cable.line for cable in cables], constants, q), strict=True):
        rate = stretch.rate(v)
        spring = times(_exact(-cable.stiffness, numbers), elongation(cable, stretch.length, numbers))
        act(forces, stretch, add(spring, minus(times(_resistance(cable, rate, numbers), rate))))
    return forces


def _exact(value: float, numbers: Numbers) -> Number:
    return numbers.exact(value) if value else 0


def _resistance(of: parts.Dof | Cable, rate: Number, numbers: Numbers) -> Number:
    """The force against a velocity, divided by it, by a damper and Coulomb friction; above zero at any velocity."""
    if not of.friction:
        return _exact(of.damping, numbers)
    speed = numbers.functions["sqrt"](add(times(rate, rate), numbers.exact(SLIP * SLIP)))
    return add(_exact(of.damping, numbers), numbers.exact(of.friction) / speed)


def _spring(link: Link, q: Sequence[Number], numbers: Numbers) -> list[Number]:
    """The force of the spring at a dof, over its velocities."""
    stretch = _stretch(link, q, numbers)
    if link.dof.kind is DofKind.FREE:
        stretch = [*turned_back(of_quaternion(q[3:]), stretch[:3]), *stretch[3:]]
    return scaled(stretch, numbers.exact(-link.dof.stiffness))


def _stretch(link: Link, q: Sequence[Number], numbers: Numbers) -> list[Number]:
    """How far the spring of a dof is from its rest: in rad or m, of a free dof a position before a rotation vector."""
    if link.coordinates == 1:
        return [add(q[0], _exact(-link.dof.spring_ref, numbers))]
    return [*q[:-4], *_rotation_vector(q[-4:], numbers)]


def _rotation_vector(quat: Sequence[Number], numbers: Numbers) -> list[Number]:
    """The axis of a unit quaternion (w, x, y, z) times its angle between -pi and pi."""
    w, *imaginary = quat
    squares = dot(imaginary, imaginary)
    size = numbers.functions["sqrt"](squares if numbers.name == "sympy" else squares + _TINY)
    return scaled(imaginary, 2 * numbers.functions["atan"](size / w) / size)


def elongation(cable: Cable, length: Number, numbers: Numbers) -> Number:
    """How far the length (m or rad) is above or below those at rest."""
    lower, upper = cable.rest
    over = add(length, numbers.exact(-upper)) if upper else length
    if lower == upper:
        return over
    under = add(length, numbers.exact(-lower)) if lower else length
    size = numbers.functions["abs"]
    return (over + size(over) + under - size(under)) / 2


# ---- energies ----------------------------------------------------------------------------------------------------------------------


def spring_energy(constants: Constants, cables: Sequence[Cable], q: Sequence[Number]) -> Number:
    """The energy of all springs in J."""
    numbers = constants.numbers
    found: Number = 0
    for link in constants.tree.links:
        if link.dof.stiffness:
            stretch = _stretch(link, q[link.q : link.q + link.coordinates], numbers)
            found = add(found, times(numbers.exact(link.dof.stiffness) / 2, dot(stretch, stretch)))
    for cable, along in zip(cables, stretches([cable.line for cable in cables], constants, q), strict=True):
        far = elongation(cable, along.length, numbers)
        found = add(found, times(_exact(cable.stiffness / 2, numbers), times(far, far)))
    return found


def resistances(constants: Constants, cables: Sequence[Cable], q: Sequence[Number], v: Sequence[Number]) -> Matrix:
    """The matrix R(q, v), positive semidefinite, with which dampers and friction resist: the forces are -R v."""
    count, numbers = constants.tree.nv, constants.numbers
    matrix: Matrix = [[0] * count for _ in range(count)]
    for link in constants.tree.links:
        for k in range(link.v, link.v + link.velocities):
            matrix[k][k] = _resistance(link.dof, v[k], numbers)
    for cable, stretch in zip(cables, stretches([cable.line for cable in cables], constants, q), strict=True):
        resist(matrix, stretch.row, _resistance(cable, stretch.rate(v), numbers))
    return matrix


def resist(matrix: Matrix, row: dict[int, Number], resistance: Number) -> None:
    """Add a resistance along a line with this row to a matrix."""
    for i, a in row.items():
        for k, b in row.items():
            matrix[i][k] = add(matrix[i][k], times(times(resistance, a), b))
