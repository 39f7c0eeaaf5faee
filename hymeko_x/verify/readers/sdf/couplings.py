"""Mimic joints and gearboxes of SDF, from the text: Drake knows the ones and does not hand them out, and refuses the others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hymeko_x.verify.model import WORLD, Array, Coupling, Kind

if TYPE_CHECKING:
    from collections.abc import Iterator
    from xml.etree import ElementTree

    from hymeko_x.verify.model import KinematicModel

_MIMIC = (("multiplier", "1"), ("offset", "0"), ("reference", "0"))
_PARALLEL = 1e-6


# ---- mimic joints --------------------------------------------------------------------------------------------------------


def mimics(root: ElementTree.Element, model: KinematicModel) -> Iterator[Coupling]:
    """The <mimic> of single axes, as the file has them."""
    numbers = {dof.name: number for number, dof in enumerate(model.dofs) if dof.name is not None}
    for joint in root.iter("joint"):
        mimic = joint.find("axis/mimic")
        follower, leader = numbers.get(joint.get("name", "")), None if mimic is None else numbers.get(mimic.get("joint", ""))
        if mimic is None or follower is None or leader is None:
            continue
        multiplier, offset, reference = (float(mimic.findtext(tag, usual)) for tag, usual in _MIMIC)
        yield Coupling(follower, offset - multiplier * reference, ((leader, (multiplier,)),), joint.get("name"))


# ---- gearboxes -----------------------------------------------------------------------------------------------------------


def gearboxes(root: ElementTree.Element, model: KinematicModel, plant: Any) -> Iterator[Coupling]:
    """theta_2 = -ratio theta_1, the angles of the child and of the parent link from the reference body.

    Those of the model at top level whose links have one hinge to the reference body; others are no relation of two coordinates.
    """
    bodies = {body.name: number for number, body in enumerate(model.bodies)}
    for joint in root.findall("model/joint[@type='gearbox']") + root.findall("world/model/joint[@type='gearbox']"):
        parent, child, reference = (bodies.get(_text(joint, tag, "world")) for tag in ("parent", "child", "gearbox_reference_body"))
        if parent is None or child is None or reference is None:
            continue
        leader, follower = (
            _turn(model, body, reference, _axis(joint.find(tag), joint, model, plant)) for body, tag in ((parent, "axis"), (child, "axis2"))
        )
        if leader is not None and follower is not None and leader[0] != follower[0]:
            factor = -float(_text(joint, "gearbox_ratio", "1")) * leader[1] * follower[1]
            yield Coupling(follower[0], 0.0, ((leader[0], (factor,)),), joint.get("name"))


def _text(node: ElementTree.Element, tag: str, usual: str) -> str:
    return (node.findtext(tag) or "").strip() or usual


def _axis(axis: ElementTree.Element | None, joint: ElementTree.Element, model: KinematicModel, plant: Any) -> Array | None:
    """An axis of a gearbox in the world at the zero pose: given in the model, in a named frame, or in that of the joint."""
    xyz = None if axis is None else axis.find("xyz")
    if axis is None or xyz is None:
        return None
    own = joint.get("name", "")
    name = xyz.get("expressed_in") or (own if plant.HasFrameNamed(own) else _text(joint, "child", "world"))
    frame = plant.GetFrameByName("__model__" if _text(axis, "use_parent_model_frame", "0") in ("1", "true") else name)
    number = next((i for i, body in enumerate(model.bodies) if i and body.name == str(frame.body().name())), WORLD)
    direction = np.array(frame.GetFixedPoseInBodyFrame().rotation().matrix()) @ [float(word) for word in (xyz.text or "").split()]
    return _in_world(model, number, direction / np.linalg.norm(direction))


def _in_world(model: KinematicModel, body: int, direction: Array) -> Array:
    """A direction in a body's frame as one in the world at the zero pose."""
    while body != WORLD:
        direction, body = model.bodies[body].joint.placement[:3, :3] @ direction, model.bodies[body].parent
    return direction


def _turn(model: KinematicModel, body: int, reference: int, axis: Array | None) -> tuple[int, float] | None:
    """The dof that is the angle of a body from the reference body about an axis, and its sign; None where there is none."""
    forwards = model.bodies[body].parent == reference
    moved = body if forwards else reference
    dofs = model.bodies[moved].joint.dofs
    if axis is None or model.bodies[moved].parent not in (body, reference) or [dof.kind for dof in dofs] != [Kind.HINGE]:
        return None
    along = float(_in_world(model, moved, dofs[0].axis) @ axis)
    if abs(abs(along) - 1.0) > _PARALLEL:
        return None
    return model.first_dof[moved], (1.0 if along > 0.0 else -1.0) * (1.0 if forwards else -1.0)
