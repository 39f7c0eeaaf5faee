"""The names under which elements are printed, looked up once for all references."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x.ir.kinematics import dof_number
from hymeko_x.ir.parts import Mesh, Texture

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Id, JointView, Mechanism, RobotArc
    from hymeko_x.ir.parts import Dof


class Printed(Struct, frozen=True):
    """Printed names by id, for the kinds whose elements carry a name of their own; all others print their id's name."""

    assets: Mapping[Id, str]
    joints: Mapping[Id, JointView]

    def of(self, key: Id) -> str:
        """The name of a body, material, mesh, ...; of the world ``world``."""
        return self.assets.get(key, key.name)

    def joint(self, arc: RobotArc) -> str:
        """The name of the dof that an arc to a joint means."""
        dof = self.dof(arc)
        return (dof.name if dof else None) or arc.target.name

    def dof(self, arc: RobotArc) -> Dof | None:
        """The dof that an arc to a joint means; None where the joint is fixed."""
        view = self.joints[arc.target]
        number = dof_number(view.joint, arc.role)
        return None if number is None else view.joint.dofs[number]


def printed_names(mechanism: Mechanism) -> Printed:
    """The printed names of a mechanism."""
    assets = {key: mesh.name for key, mesh in mechanism.vertices(Mesh) if mesh.name}
    assets |= {key: texture.name for key, texture in mechanism.vertices(Texture) if texture.name}
    return Printed(assets, mechanism.joints)
