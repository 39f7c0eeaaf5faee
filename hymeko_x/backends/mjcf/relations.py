"""What connects elements beside the tree: contacts, equalities and actuators."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.text import Attributes, Text, numbers
from hymeko_x.formats.mjcf import TARGETS
from hymeko_x.ir.mechanism import numbers_weight, pose_weight
from hymeko_x.ir.parts import Actuator, Contact, Coupling, Drive, Loop
from hymeko_x.ir.values import ZERO, quat_inverse, quat_product, unit_quat

if TYPE_CHECKING:
    from hymeko_x.backends.mjcf.names import Printed
    from hymeko_x.ir.mechanism import Mechanism, RobotArc
    from hymeko_x.ir.parts import Parameters

_POLYNOMIAL = 5
"""How many coefficients a joint equality has."""


# ---- contact ---------------------------------------------------------------------------------------------------------------


def write_contacts(text: Text, mechanism: Mechanism, names: Printed) -> None:
    """Pairs of bodies that do not collide; MuJoCo itself leaves out neighbours in the tree."""
    excluded = [(key, arcs) for key, contact, arcs in mechanism.edges(Contact) if contact.kind == "exclude"]
    if not excluded:
        return
    text.section("contact")
    for key, (first, second) in excluded:
        text.leaf("exclude", {"name": names.of(key), "body1": names.of(first.target), "body2": names.of(second.target)})
    text.close()


# ---- equality --------------------------------------------------------------------------------------------------------------


def write_equalities(text: Text, mechanism: Mechanism, names: Printed) -> None:
    """Joints that follow joints, and closures of loops."""
    couplings = [(key, coupling, arcs) for key, coupling, arcs in mechanism.edges(Coupling) if _between_joints(arcs)]
    closures = [(key, loop, arcs) for key, loop, arcs in mechanism.edges(Loop) if loop.kind in ("connect", "weld") and len(arcs) == 2]
    if not (couplings or closures):
        return
    text.section("equality")
    for key, coupling, arcs in couplings:
        text.leaf("joint", {"name": names.of(key), **_coupling_attributes(arcs, names), **_activity(active=coupling.active)})
    for key, loop, (first, second) in closures:
        text.leaf(loop.kind, {"name": names.of(key), **_closure_attributes(loop, first, second, names), **_activity(active=loop.active)})
    text.close()


def _between_joints(arcs: tuple[RobotArc, ...]) -> bool:
    return all(arc.target.kind == "joint" for arc in arcs)


def _activity(*, active: bool) -> Attributes:
    return {"active": None if active else "false"}


def _coupling_attributes(arcs: tuple[RobotArc, ...], names: Printed) -> Attributes:
    """The follower's coordinate as a polynomial of the leader's, both counted from their reference values.

    Source: MuJoCo, equality/joint: q1 - q1_0 = c0 + c1 (q2 - q2_0) + ...; without a leader q1 - q1_0 = c0.
    """
    follower = next(arc for arc in arcs if arc.sign > 0)
    leader = next(arc for arc in arcs if arc.sign < 0)
    followed, led = names.dof(leader), names.dof(follower)
    factor = (numbers_weight(follower) or (1.0,))[0]
    shifted = _shifted(numbers_weight(leader), followed.ref if followed else 0.0)
    coefficients = [value / factor for value in shifted]
    coefficients[0] -= led.ref if led else 0.0
    if followed is None:
        coefficients = [coefficients[0], *[0.0] * (_POLYNOMIAL - 1)]
    while len(coefficients) > 2 and coefficients[-1] == 0.0:
        coefficients.pop()
    return {
        "joint1": names.joint(follower),
        "joint2": None if followed is None else names.joint(leader),
        "polycoef": numbers(*coefficients),
    }


def _shifted(coefficients: tuple[float, ...], by: float) -> list[float]:
    """The coefficients of p(x + by), padded with zeros to a quartic. By repeated synthetic division."""
    shifted = [*coefficients[:_POLYNOMIAL], *[0.0] * (_POLYNOMIAL - len(coefficients))]
    for start in range(_POLYNOMIAL - 1):
        for power in range(_POLYNOMIAL - 2, start - 1, -1):
            shifted[power] += shifted[power + 1] * by
    return shifted


def _closure_attributes(loop: Loop, first: RobotArc, second: RobotArc, names: Printed) -> Attributes:
    """Of a weld: ``anchor`` is the point in body 2 that meets the position of ``relpose`` in body 1, whose rotation is body 2's.

    Source: MuJoCo's constraint, seen from its residual; the manual speaks of the relative pose of the bodies.
    """
    if first.target.kind == "frame":
        return {"site1": names.of(first.target), "site2": names.of(second.target)}
    bodies: Attributes = {"body1": names.of(first.target), "body2": names.of(second.target)}
    if loop.kind == "connect":
        return {**bodies, "anchor": numbers(*pose_weight(first).xyz)}
    one, two = pose_weight(first), pose_weight(second)
    turn = unit_quat(quat_product(one.quat, quat_inverse(two.quat)))
    return {**bodies, "anchor": None if two.xyz == ZERO else numbers(*two.xyz), "relpose": numbers(*one.xyz, *turn)}


# ---- actuator --------------------------------------------------------------------------------------------------------------


def write_actuators(text: Text, mechanism: Mechanism, names: Printed) -> None:
    """Every actuator, as the element of its kind."""
    drives = {driver.target: arcs for _, _, arcs in mechanism.edges(Drive) for driver in arcs if driver.sign > 0}
    actuators = list(mechanism.vertices(Actuator))
    if not actuators:
        return
    text.section("actuator")
    for key, actuator in actuators:
        target = _target_attributes(drives[key], names)
        text.later(actuator.kind, {"name": names.of(key), **target, **_parameter_attributes(actuator.parameters)}, key.name)
    text.close()


def _target_attributes(arcs: tuple[RobotArc, ...], names: Printed) -> Attributes:
    """What the actuator acts on, and its gear where it is not 1."""
    found: Attributes = {}
    for arc in arcs:
        if arc.sign >= 0:
            continue
        found[TARGETS[arc.target.kind]] = names.joint(arc) if arc.target.kind == "joint" else names.of(arc.target)
        gear = numbers_weight(arc)
        found["gear"] = numbers(*gear) if gear and gear != (1.0,) else None
    return found


def _parameter_attributes(parameters: Parameters) -> Attributes:
    """Parameters as the attributes of the same name."""
    found: Attributes = {}
    for name, value in parameters:
        if isinstance(value, str):
            found[name] = value
        else:
            found[name] = numbers(*value) if isinstance(value, tuple) else numbers(value)
    return found
