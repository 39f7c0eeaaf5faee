"""The words of <gazebo> fragments, by which files of other formats hold what SDF represents; for both directions.

Source: libsdformat's reader of such files. An element for which they have no own name is copied into the link or the joint.
"""

from __future__ import annotations

import re
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING
from xml.parsers.expat import ExpatError

from hymeko_x.xml.parse import parse_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.xml.tree import XmlNode

TAG = "gazebo"

OF_LINK: Mapping[str, str] = MappingProxyType({"self_collide": "self_collide", "selfCollide": "self_collide", "gravity": "gravity"})
TURN_GRAVITY_OFF = "turnGravityOff"
DAMPING = "dampingFactor"
"""Both velocities of a link decay by it."""
IN_LINK = frozenset(
    {
        *("sensor", "projector", "battery", "audio_sink", "audio_source", "particle_emitter", "light"),
        *("enable_wind", "kinematic", "must_be_base_link", "velocity_decay"),
    }
)
"""The children of <link> that a fragment holds as they are."""
OF_COLLISION: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "mu2": ("surface/friction/ode", "mu2"),
        "fdir1": ("surface/friction/ode", "fdir1"),
        "kp": ("surface/contact/ode", "kp"),
        "kd": ("surface/contact/ode", "kd"),
        "minDepth": ("surface/contact/ode", "min_depth"),
        "maxVel": ("surface/contact/ode", "max_vel"),
        "maxContacts": ("", "max_contacts"),
        "laserRetro": ("", "laser_retro"),
    }
)
OF_JOINT: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "provideFeedback": ("physics", "provide_feedback"),
        "implicitSpringDamper": ("physics/ode", "implicit_spring_damper"),
        "cfmDamping": ("physics/ode", "cfm_damping"),
        "fudgeFactor": ("physics/ode", "fudge_factor"),
        "stopCfm": ("physics/ode/limit", "cfm"),
        "stopErp": ("physics/ode/limit", "erp"),
    }
)
"""The path and the name in SDF of what a fragment calls otherwise."""
OF_DOF: Mapping[str, str] = MappingProxyType({"springStiffness": "stiffness", "springReference": "spring_ref"})
"""The field of a joint's only dof."""
FLAGS = frozenset((*OF_LINK, TURN_GRAVITY_OFF, "provideFeedback", "implicitSpringDamper", "cfmDamping"))
"""What is true or false: true by the words ``true``, ``yes`` and ``1``, in any case."""
VECTORS = frozenset(("fdir1",))
"""What is more than one number."""
OF_MODEL = frozenset(("static", "self_collide", "allow_auto_disable", "enable_wind", "plugin", "gripper", "frame", "link", "joint"))
"""The children of <model>; other elements of a fragment without a link are those of older programs, and SDF has none of them."""
OBEYED = ("preserveFixedJoint", "disableFixedJointLumping")
"""They keep fixed joints, which always stay here."""

MATERIALS = "file://media/materials/scripts/gazebo.material"
"""Where the materials are that a fragment names, or a file of SDF up to 1.2."""
BESIDE = "ros2_control"
"""A custom element of <model> that the root of URDF has as well. Of URDF alone it is not written into SDF: Drake refuses it there."""

_SENSOR = re.compile(r"""<sensor\b[^>]*?\bname=["']([^"']*)["']""")


def sensor_names(texts: Iterable[str]) -> frozenset[str]:
    """The names of the sensors in fragments."""
    return frozenset(name for text in texts if text.startswith(f"<{TAG}") for name in _SENSOR.findall(text))


@lru_cache(256)
def parsed(text: str) -> XmlNode | None:
    """The tree of a fragment, which is never changed: reading, writing and comparing ask for it. None for a text that is no XML."""
    try:
        return parse_text(text)
    except ExpatError:
        return None
