"""The words of <ros2_control> that its reader and its writer share.

Each command interface of a joint is an actuator. What it is for MuJoCo stands in parameters of the interface, which ros2_control hands to
the hardware's plugin and reads no further; so a robot comes back with the same actuators. Interfaces without them are commands that the
hardware takes, as a transmission has them: which gains a controller has is not known.

An actuator on a combination of joints is a <gpio>, the component for commands that belong to no single joint, with the joints and their
coefficients as its parameters.

Source: ros2_control, hardware_interface/src/component_parser.cpp.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

TAG = "ros2_control"
PLUGIN = "mock_components/GenericSystem"
"""The hardware that ros2_control itself brings: it follows every command, until the robot's own plugin stands here."""
NAME, TYPE, GEAR = "actuator", "actuator_type", "gear"
"""Parameters of an interface: name and type of the actuator, and its gear."""
COMBINED = "gpio"
TENDON, JOINTS, COEFFICIENTS = "tendon", "joints", "coefficients"
"""Parameters of a <gpio>: the combination that its commands drive, its joints, and the coefficient of each."""
COMMAND = "command_interface"
"""The parameters of a drive that are the command interfaces of its joint, in their order."""
REDUCTIONS = ("mechanical_reduction", "mechanicalReduction")
"""Below a joint of a <transmission> of a system: its reduction, in the words of ROS 2 and of ROS 1."""
POSITION, VELOCITY, EFFORT = "position", "velocity", "effort"
INTERFACES: Mapping[str, str] = MappingProxyType(
    {"position": POSITION, "velocity": VELOCITY, "intvelocity": VELOCITY, "motor": EFFORT, "general": EFFORT, "dcmotor": EFFORT}
)
"""The command interface of an actuator by its type; a general one that holds a position or a speed has that interface."""


def interface_of(kind: str, parameters: Mapping[str, object]) -> str | None:
    """What an actuator is commanded: a position, a velocity or an effort; None where it is none of these."""
    if kind == "general" and parameters.get("biastype") == "affine":
        bias = parameters.get("biasprm")
        numbers = (*bias, 0.0, 0.0, 0.0) if isinstance(bias, tuple) else (0.0, 0.0, 0.0)
        return POSITION if numbers[1] else VELOCITY if numbers[2] else EFFORT
    return INTERFACES.get(kind)
