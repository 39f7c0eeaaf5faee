"""Closed loops: accelerations under the forces that keep them closed, as a system of index 1.

The closure phi(q) = 0 (three coordinates for a point that coincides, six for a frame) is differentiated twice, so that accelerations and
forces follow from [M J'; J 0] [a; -f] = [tau - bias; -J' v - 2 s J v - s^2 phi]. Without the last two terms positions drift;
with the rate s > 0 they return to the closure as exp(-s t): the stabilisation of Baumgarte (1972).
Source: Featherstone, Rigid Body Dynamics Algorithms, chapter 8.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x.dynamics.numbers import graphs
from hymeko_x.dynamics.operating import moved
from hymeko_x.dynamics.recursion import Constants
from hymeko_x.dynamics.spatial import UNIT, ZERO, Frame, composed, minus, plus, product, transposed, turned_back
from hymeko_x.dynamics.tree import frame_of
from hymeko_x.ir import parts
from hymeko_x.ir.mechanism import pose_weight

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from hymeko_x.dynamics.numbers import Number
    from hymeko_x.dynamics.trees import Trees
    from hymeko_x.ir.ids import Id

    Floats = NDArray[np.floating[Any]]


def closures(found: Trees) -> list[tuple[Id, str, tuple[Id, Frame], tuple[Id, Frame]]]:
    """The active loops between two bodies or frames on bodies: id, kind, and the closure's frame in each of the two bodies."""
    mechanism = found.mechanism
    mounts = {view.thing: (view.body, frame_of(view.pose)) for views in mechanism.mounts.values() for view in views}
    loops = []
    for key, loop, arcs in mechanism.edges(parts.Loop):
        if not loop.active or len(arcs) != 2 or loop.kind not in ("connect", "weld"):
            continue
        ends = []
        for arc in arcs:
            body, frame = mounts.get(arc.target, (arc.target, Frame(UNIT, ZERO)))
            ends.append((body, composed(frame, frame_of(pose_weight(arc)))))
        loops.append((key, loop.kind, ends[0], ends[1]))
    return loops


def constraint(found: Trees) -> Any:
    """The casadi function (q, v) -> (phi, J, J' v) of all closures."""
    import casadi

    tree, numbers = found.tree, graphs()
    constants = Constants(tree, numbers, found.gravity)
    q, v, step = casadi.SX.sym("q", tree.nq), casadi.SX.sym("v", tree.nv), casadi.SX.sym("d", tree.nv)
    at = moved(tree.links, [q[k] for k in range(tree.nq)], [step[k] for k in range(tree.nv)])
    world: list[Frame] = []
    for link, frame in zip(tree.links, constants.link_frames(at), strict=True):
        world.append(composed(world[link.parent], frame) if link.parent >= 0 else frame)

    def pose(end: tuple[Id, Frame]) -> Frame:
        link, place = tree.bodies[end[0]]
        inside = composed(place, end[1])
        return composed(world[link], inside) if link >= 0 else inside

    rows: list[Number] = []
    for _, kind, first, second in closures(found):
        a, b = pose(first), pose(second)
        rows += turned_back(a.rotation, plus(b.position, [minus(x) for x in a.position]))
        if kind == "weld":
            r = product(transposed(a.rotation), b.rotation)
            rows += [(r[2][1] - r[1][2]) / 2, (r[0][2] - r[2][0]) / 2, (r[1][0] - r[0][1]) / 2]
    phi = casadi.vertcat(*rows)
    still = casadi.DM.zeros(tree.nv)
    slope = casadi.jacobian(phi, step)
    rate = casadi.jacobian(casadi.mtimes(slope, v), step)
    values = [casadi.substitute(value, step, still) for value in (phi, slope, casadi.mtimes(rate, v))]
    return casadi.Function("closure", [q, v], values)


def closed_forward(
    found: Trees, closure: Any, q: Sequence[float], v: Sequence[float], tau: Sequence[float], rate: float = 0.0
) -> tuple[Floats, Floats]:
    """The accelerations, and the forces of the closures, of a mechanism with loops; ``rate`` in 1/s stabilises them.

    Closures that say the same twice (a planar four-bar closed by a point in space) share their force evenly.
    """
    import numpy as np

    phi, slope, drift = (np.array(value, dtype=float) for value in closure(q, v))
    state, rates = np.array(q, dtype=float), np.array(v, dtype=float)
    mass, bias = found.mass_matrix(state), found.bias(state, rates)
    free = np.linalg.solve(mass, np.array(tau) - bias)
    wanted = -drift[:, 0] - 2 * rate * slope @ rates - rate**2 * phi[:, 0]
    inverse = np.linalg.solve(mass, slope.T)
    force = np.linalg.lstsq(slope @ inverse, wanted - slope @ free, rcond=1e-10)[0]
    return free + inverse @ force, force


def freedom(found: Trees, closure: Any, q: Sequence[float]) -> int:
    """The degrees of freedom that the closures leave: velocities less the rank of J."""
    import numpy as np

    slope = np.array(closure(q, [0.0] * found.tree.nv)[1], dtype=float)
    return found.tree.nv - int(np.linalg.matrix_rank(slope, tol=1e-8))
