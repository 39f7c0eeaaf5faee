"""From the hypergraph to equations: lumped networks and mechanisms, their linear forms, simulation, and generated files.

import hymeko_x as hx

car = hx.dynamics(hx.load("quarter_vehicle_model.hymeko"))
print(car.state_space().A)
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hymeko_x.dynamics.lumped import Lumped
    from hymeko_x.ir.mechanism import Mechanism


def dynamics(robot: Mechanism) -> Lumped:
    """The equations of motion of a lumped network.

    Raises: Refusal (HX4xx) that names the element for which there are none.
    """
    from hymeko_x.dynamics.lumped import Lumped
    from hymeko_x.dynamics.network import network_of

    return Lumped(network_of(robot))


class _Callable(ModuleType):
    """This module, which is called like its function: ``hx.dynamics(robot)``."""

    def __call__(self, robot: Mechanism) -> Lumped:
        return dynamics(robot)


sys.modules[__name__].__class__ = _Callable
