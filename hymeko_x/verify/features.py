"""What only some formats represent, and a check needs of both."""

from __future__ import annotations

from enum import Enum


class Feature(Enum):
    """What only some formats represent. It is checked only where both formats and readers do; else the verdict has a note."""

    POSITION_LIMITS = "position limits"
    VELOCITY_LIMITS = "velocity limits"
    EFFORT_LIMITS = "effort limits"
    DAMPING = "damping"
    NEGATIVE_DAMPING = "negative damping"
    FRICTION = "friction"
    ARMATURE = "armature"
    SPRINGS = "springs"
    REFS = "coordinate references"
    VISUALS = "visual shapes"
    COLLISIONS = "collision shapes"
    FLAT_COLLISIONS = "collision meshes without volume"
    FIXED_JOINT_NAMES = "names of fixed joints"
    ACTUATORS = "actuators"
    SENSORS = "sensors"
    TENDONS = "tendons"
    TIED_TENDONS = "couplings of tendons"
    LOOPS = "loops"
    HELD_BASES = "free bases that a closure holds"
    SLIDING_LOOPS = "closures that leave a slide free"
    SCREW_LOOPS = "closures by a screw"
    OPEN_LOOPS = "closures that are open in the zero pose"
    CURVES = "couplings that are no straight line of one leader"
