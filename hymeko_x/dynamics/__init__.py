"""From the hypergraph to equations: lumped networks and mechanisms, their linear forms, simulation, and generated files.

import hymeko_x as hx

car = hx.dynamics(hx.load("quarter_vehicle_model.hymeko"))
print(car.state_space().A)
arm = hx.dynamics(hx.load("arm.urdf"))
print(arm.mass_matrix(q))
"""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.dynamics.lumped import Lumped
    from hymeko_x.dynamics.multibody import Multibody
    from hymeko_x.ir.holder import Holder
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.source import Files


def dynamics(
    robot: Mechanism | Holder,
    *,
    base: str | None = None,
    gravity: tuple[float, float, float] = (0.0, 0.0, -9.81),
    inputs: Literal["joints", "actuators"] = "joints",
    files: Files | None = None,
    report: Report | None = None,
) -> Lumped | Multibody:
    """The equations of motion of a lumped network, or of a mechanism with joints.

    ``base`` is what becomes of a base without a joint (fixed, free), ``gravity`` in m/s^2 in the world; the inputs of a mechanism are
    forces of its joints, or the controls of its actuators, which then act by their laws; inertias that only the
    engine of the robot's format computes are computed with the meshes among ``files`` (those beside the robot's file by default).

    Raises: Refusal (HX4xx) that names the element for which there are none.
    """
    from hymeko_x.diagnostics import Report
    from hymeko_x.dynamics.lumped import checked
    from hymeko_x.dynamics.multibody import multibody_of
    from hymeko_x.ir.holder import mechanism_of
    from hymeko_x.networks.assembly import has_network, network_of
    from hymeko_x.rewrite.context import Context
    from hymeko_x.rewrite.poses import name_poses

    mechanism = mechanism_of(robot)
    if has_network(mechanism):
        return checked(network_of(mechanism), mechanism)
    whole = name_poses(_with_inertias(mechanism, files, report), Context(Report()))
    found = multibody_of(whole, base=base, gravity=gravity, actuated=inputs == "actuators")
    if report is not None:
        _report_left_out(found, report)
    return found


def _report_left_out(found: Multibody, report: Report) -> None:
    """Warn (HX408) of every element that acts on a robot's motion and has no part in its equations."""
    from hymeko_x import codes
    from hymeko_x.dynamics.couplings import followers_of
    from hymeko_x.dynamics.drives import motors_of
    from hymeko_x.dynamics.loops import closures_of
    from hymeko_x.dynamics.passive import cables_of
    from hymeko_x.ir import parts

    robot, tree = found.mechanism, found.tree
    words = [(key, f"{key} is a loop of a kind") for key in closures_of(robot, tree)[1]]
    words += [(key, f"{key} couples along a path, or by a polynomial of several coordinates") for key in followers_of(robot, tree)[1]]
    words += [(key, f"{key} {why}") for key, why in cables_of(robot, tree)[1]]
    words += [(key, f"{key} {why}") for key, why in (motors_of(robot, tree)[1] if found.motors is not None else [])]
    words += [(key, f"{key} has an armature") for key, tendon, _ in robot.edges(parts.Tendon) if tendon.armature]
    for key, what in words:
        report.warn(codes.NO_FORM, f"{what}, which is not in the equations", robot.origin(key), element=str(key))


def _with_inertias(robot: Mechanism, files: Files | None, report: Report | None) -> Mechanism:
    """The robot with inertias that its format computes from shapes."""
    from hymeko_x import pipeline
    from hymeko_x.assets.resolve import DiskFiles
    from hymeko_x.diagnostics import Report
    from hymeko_x.rewrite.context import Context
    from hymeko_x.rewrite.inertia import fill_tensors

    found = Report() if report is None else report
    beside = DiskFiles(Path(robot.source.file).parent, {}, (), None) if files is None else files
    return fill_tensors(pipeline.fully_completed(robot, beside, found), Context(found))


class _Callable(ModuleType):
    """This module, which is called like its function: ``hx.dynamics(robot)``."""

    def __call__(self, robot: Mechanism, **options: Any) -> Lumped | Multibody:
        return dynamics(robot, **options)


sys.modules[__name__].__class__ = _Callable
