"""Inertias: those that follow from solids, those that no body can have, and those that a moving body needs."""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import combinations
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.diagnostics import counted, listed
from hymeko_x.formats import native_format
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.notations import WITHOUT_TENSOR
from hymeko_x.ir.parts import Body, Inertial
from hymeko_x.ir.solids import with_tensor_of

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterator

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.ir.values import Tensor, Vec3
    from hymeko_x.rewrite.context import Context


# ---- masses and tensors ------------------------------------------------------------------------------------------------


LEAST = 1e-10
"""The mass in kg and the principal moment in kg m^2 that a massless moving body gets.

Far above the engine's own bound (1e-15), where its mass matrix becomes singular, far below what any comparison sees.
"""
LEAST_TENSOR = (LEAST, LEAST, LEAST, 0.0, 0.0, 0.0)
"""The tensor in kg m^2 of such a body."""
_BOUND = 1e-15
"""MuJoCo's mjMINVAL: a moving body below it is refused."""
_LEAST_TURNED = 2e-14
"""The same for a tensor with products: MuJoCo wants its eigenvalues above 1e-14, and of static bodies too."""
_ACCURACY = 1e-13
"""By which part of its largest moment a tensor with products must keep the triangle inequality, for a solver with rounding."""
_WELL = 1e-6
"""How far, as a part of its size, a tensor is from every bound when no eigenvalue has to be computed; roundings are far smaller."""
_WELL_ABOVE = 1e-13
"""And above the least moments, in kg m^2."""
_ROUNDING = 1e-10
"""A change of a tensor in kg m^2 up to this is worth a note and no warning."""

_NOTHING: Tensor = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


# ---- rules ---------------------------------------------------------------------------------------------------------------


def make_tensors_physical(mechanism: Mechanism, context: Context) -> Mechanism:
    """No negative mass, and principal moments A, B, C >= 0 with A + B >= C in any order, by the smallest change."""
    changed: dict[Id, Body] = {}
    for key, body in mechanism.vertices(Body):
        if body.inertial is None:
            continue
        inertial = body.inertial
        if inertial.mass is not None and inertial.mass < 0.0:
            _report(mechanism, context.report, key, f"mass {inertial.mass!r} is negative; 0 is written")
            inertial = replace(inertial, mass=0.0)
        tensor = physical(inertial.tensor or _NOTHING)
        if inertial.tensor is not None and tensor != inertial.tensor:
            words = f"{_flaw(inertial.tensor)}: {numbers_text(inertial.tensor)} becomes {numbers_text(tensor)}"
            _report(mechanism, context.report, key, words, serious=math.dist(tensor, inertial.tensor) > _ROUNDING)
            inertial = replace(inertial, tensor=tensor, written=None)
        if inertial is not body.inertial:
            changed[key] = replace(body, inertial=inertial)
    return mechanism.replace(vertices=changed)


def give_moving_bodies_mass(mechanism: Mechanism, context: Context, is_meant: Callable[[Id], bool] = lambda _: True) -> Mechanism:
    """A body that moves, and ``is_meant``, gets the least mass and inertia when neither it nor a body fixed to it has both.

    Source: MuJoCo's compiler, which looks for one body with mass and all principal moments among the moving body and
    what is welded to it, and refuses the model otherwise.
    """
    changed: dict[Id, Body] = {}
    for key in moving_bodies(mechanism):
        body = mechanism.vertex(key, Body)
        if not is_meant(key) or _is_sound(body) or any(_is_sound(mechanism.vertex(other, Body)) for other in welded_to(mechanism, key)):
            continue
        new = _least_inertial(body.inertial)
        changed[key] = replace(body, inertial=new)
        old = "no mass" if body.inertial is None else f"mass {body.inertial.mass!r} and inertia {_words(body.inertial.tensor)}"
        hint = "--density 1000 computes masses from shapes (--inertia-from chooses which)" if body.inertial is None else ""
        words = f"moves and has {old}; mass {new.mass!r} and inertia {_words(new.tensor)} are written"
        _report(mechanism, context.report, key, words, hint=hint)
    return mechanism.replace(vertices=changed)


def give_every_body_mass(mechanism: Mechanism, context: Context, without: Container[Id] = ()) -> Mechanism:
    """Every body but ``without`` has at least the least mass and inertia: SDF takes a link without an inertial for one of 1 kg."""
    changed = {}
    for key, body in mechanism.vertices(Body):
        if not _is_sound(body) and key not in without:
            changed[key] = replace(body, inertial=_least_inertial(body.inertial))
    if changed:
        names = listed([f"'{key.name}'" for key in changed], 5)
        links = counted(len(changed), "link has", "links have")
        message = f"{links} no mass or no inertia; mass {LEAST!r} and inertia {LEAST!r} are written: {names}"
        context.report.note(codes.INERTIA_REPAIRED, message, element=str(next(iter(changed))))
    return mechanism.replace(vertices=changed)


# ---- the tree --------------------------------------------------------------------------------------------------------------


def moving_bodies(mechanism: Mechanism) -> Iterator[Id]:
    """The bodies that a joint with dofs leads to, in order."""
    for key, _ in mechanism.vertices(Body):
        joint = mechanism.parent_joint.get(key)
        if joint is not None and joint.joint.dofs:
            yield key


def welded_to(mechanism: Mechanism, body: Id) -> Iterator[Id]:
    """The body itself and everything below it that only joints without dofs separate from it."""
    stack = [body]
    while stack:
        key = stack.pop()
        yield key
        stack.extend(joint.child for joint in mechanism.children.get(key, ()) if not joint.joint.dofs)


# ---- tensors ---------------------------------------------------------------------------------------------------------------


def principal_moments(tensor: Tensor) -> Vec3:
    """The three eigenvalues in ascending order; exactly the diagonal where the products are zero."""
    if not any(tensor[3:]):
        a, b, c = sorted(tensor[:3])
        return (a, b, c)
    import numpy as np

    low, middle, high = np.linalg.eigvalsh(_matrix(tensor)).tolist()
    return (low, middle, high)


def is_physical(tensor: Tensor) -> bool:
    """Whether a mass distribution can have the tensor, up to the rounding of its principal moments."""
    if any(tensor[3:]) and _is_well_inside(tensor):
        return True
    low, middle, high = principal_moments(tensor)
    rounding = 1e-15 * (abs(low) + abs(middle) + abs(high))
    return low >= -rounding and low + middle >= high - rounding


def physical(tensor: Tensor) -> Tensor:
    """The nearest tensor (in the Frobenius norm) that a mass distribution can have; the same one where it can already.

    The principal axes stay. The principal moments are projected onto the cone A + B >= C, which is also A, B, C >= 0.
    """
    if not any(tensor[3:]) or max(map(abs, tensor)) < _LEAST_TURNED:
        x, y, z = _projected(tensor[:3])
        return (x, y, z, 0.0, 0.0, 0.0)
    if _is_well_inside(tensor):
        return tensor
    low, middle, high = principal_moments(tensor)
    if low >= _LEAST_TURNED and low + middle >= high + _ACCURACY * high:
        return tensor
    import numpy as np

    moments, axes = np.linalg.eigh(_matrix(tensor))
    a, b, c = moments.tolist()
    new = np.array(_projected((a, b, c)))
    new += max(2.0 * _ACCURACY * new.max(), 2.0 * _LEAST_TURNED - new.min(), 0.0)
    fixed = (axes * new) @ axes.T
    return tuple(float(fixed[i, k]) for i, k in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))  # type: ignore[return-value]


@lru_cache(4096)  # each of two rules asks for every body
def _is_well_inside(tensor: Tensor) -> bool:
    """Whether a tensor is so far from every bound that this shows without its principal moments, as those of most bodies are.

    With t = (A + B + C) / 2 the eigenvalues of J = t E - I are (A + B - C) / 2 and the like. I and J are well inside when the
    leading minors of J and the determinants of both are: no eigenvalue exceeds t, so that each is at least the determinant / t^2.
    """
    xx, yy, zz, xy, xz, yz = tensor
    t = (xx + yy + zz) / 2.0
    if not 1e-30 < t < 1e90:
        return False
    least = _WELL * t * t * t
    a, b, c = t - xx, t - yy, t - zz
    squares = xy * xy, xz * xz, yz * yz
    products = 2.0 * xy * xz * yz
    if a <= _WELL * t or a * b - squares[0] <= _WELL * t * t:
        return False
    of_tensor = xx * yy * zz + products - xx * squares[2] - yy * squares[1] - zz * squares[0]
    of_others = a * b * c - products - a * squares[2] - b * squares[1] - c * squares[0]
    return of_tensor > max(least, _WELL_ABOVE * t * t) and of_others > least


def _projected(moments: Vec3) -> Vec3:
    """The nearest point of the cone of physical principal moments: on one of its faces, one of its edges, or its tip."""
    if _in_cone(moments):
        return moments
    candidates = [_on_face(moments, largest) for largest in range(3)]
    candidates += [_on_edge(moments, pair) for pair in combinations(range(3), 2)]
    return min(filter(_in_cone, candidates), key=lambda point: math.dist(point, moments), default=(0.0, 0.0, 0.0))


def _on_face(moments: Vec3, largest: int) -> Vec3:
    """The foot on the face where one moment is the sum of the other two."""
    others = [i for i in range(3) if i != largest]
    excess = (moments[largest] - moments[others[0]] - moments[others[1]]) / 3.0
    point = list(moments)
    point[others[0]] += excess
    point[others[1]] += excess
    point[largest] = point[others[0]] + point[others[1]]
    return (point[0], point[1], point[2])


def _on_edge(moments: Vec3, pair: tuple[int, int]) -> Vec3:
    """The foot on the edge where two moments are equal and the third is zero (a thin rod)."""
    point = [0.0, 0.0, 0.0]
    point[pair[0]] = point[pair[1]] = (moments[pair[0]] + moments[pair[1]]) / 2.0
    return (point[0], point[1], point[2])


def _in_cone(point: Vec3) -> bool:
    a, b, c = sorted(point)
    return a >= 0.0 and a + b >= c


def _is_sound(body: Body) -> bool:
    inertial = body.inertial
    if inertial is None or (inertial.mass or 0.0) < _BOUND:
        return False
    tensor = inertial.tensor or _NOTHING
    return _is_well_inside(tensor) or principal_moments(tensor)[0] >= _BOUND


def _least_inertial(inertial: Inertial | None) -> Inertial:
    """The inertial with as much added as it takes: a mass, and the same moment about every axis."""
    if inertial is None:
        return Inertial(LEAST, tensor=LEAST_TENSOR)
    xx, yy, zz, xy, xz, yz = inertial.tensor or _NOTHING
    lacking = max(0.0, LEAST - principal_moments((xx, yy, zz, xy, xz, yz))[0])
    mass = inertial.mass if inertial.mass is not None and inertial.mass >= _BOUND else LEAST
    return Inertial(mass, inertial.com, (xx + lacking, yy + lacking, zz + lacking, xy, xz, yz))


# ---- words -----------------------------------------------------------------------------------------------------------------


def _flaw(tensor: Tensor) -> str:
    low, middle, high = principal_moments(tensor)
    if low < 0.0:
        return f"the inertia has the negative principal moment {low!r}"
    if low + middle < high:
        return f"of the principal moments {low!r}, {middle!r}, {high!r} the last exceeds the sum of the others"
    return f"the principal moments {low!r}, {middle!r}, {high!r} are at the edge of what a body can have"


def _words(tensor: Tensor | None) -> str:
    return "none" if tensor is None else numbers_text(tensor)


def _report(mechanism: Mechanism, report: Report, body: Id, words: str, *, serious: bool = True, hint: str = "") -> None:
    tell = report.warn if serious else report.note
    tell(codes.INERTIA_REPAIRED, f"{body}: {words}", mechanism.origin(body), element=str(body), hint=hint)


def _matrix(tensor: Tensor) -> list[list[float]]:
    xx, yy, zz, xy, xz, yz = tensor
    return [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]


# ---- tensors that follow from shapes -----------------------------------------------------------------------------------


def fill_tensors(mechanism: Mechanism, context: Context) -> Mechanism:
    """A body with a mass and no tensor gets that of its shapes: of those that collide, else of those that are seen.

    The centre of mass comes with the tensor where none is given, which is where it is the origin. Unspecified inertia means zero in
    MJCF, and no inertial in URDF: those stay, and so do bodies without solids, which get a notation: a plane that becomes a thin box
    later is none.
    """
    if native_format(mechanism):
        return mechanism
    changed: dict[Id, Body] = {}
    without: list[Id] = []
    for key, body in mechanism.vertices(Body):
        inertial = body.inertial
        if inertial is None or not inertial.mass or inertial.tensor is not None or mechanism.notation(key, WITHOUT_TENSOR):
            continue
        given = with_tensor_of(mechanism.shapes.get(key, ()), inertial)
        if given is None:
            without.append(key)
            continue
        changed[key] = replace(body, inertial=given)
        message = f"{key} has a mass and no inertia tensor; that of its geometry is written"
        if given.com != inertial.com:
            message = f"{key} has a mass, and neither a centre of mass nor an inertia tensor; those of its geometry are written"
        context.report.note(codes.REWRITTEN, message, mechanism.origin(key), element=str(key))
    return mechanism.with_note(without, WITHOUT_TENSOR, True).replace(vertices=changed)
