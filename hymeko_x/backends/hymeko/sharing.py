"""Joints of several bodies as one edge of HyMeKo text (:mod:`hymeko_x.formats.hymeko.sharing`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.hymeko.extras import is_comment_in_block
from hymeko_x.formats.hymeko.sharing import follower_dof, follower_name
from hymeko_x.ir import parts
from hymeko_x.ir.fields import identical
from hymeko_x.ir.mechanism import Id, numbers_weight
from hymeko_x.ir.values import IDENTITY

if TYPE_CHECKING:
    from collections.abc import Container, Iterator, Mapping

    from hymeko_x.ir.mechanism import Mechanism, RobotArc


def shared_joints(
    mechanism: Mechanism, mimics: Mapping[Id, tuple[RobotArc, ...]], noted: Container[Id] = ()
) -> Mapping[Id, tuple[Id, ...]]:
    """The joints in whose edge the children of others stand, with those others: named after it, behind it, and exactly following it.

    Those that are ``noted`` have a comment before them and stand alone.
    """
    found: dict[Id, tuple[Id, ...]] = {}
    following = {key: then for key, then in zip(mechanism.layout, mechanism.layout[1:], strict=False) if then not in noted}
    for second in mechanism.joints:
        leader = Id("joint", second.name.removesuffix("_2"))
        if leader != second and leader in mechanism.joints:
            followers = tuple(_followers(mechanism, mimics, leader, following))
            found.update({leader: followers} if followers else {})
    return found


def ratio_of(mimics: Mapping[Id, tuple[RobotArc, ...]], follower: Id) -> float:
    """The factor by which a joint follows its only leader; 1 for a fixed joint, which has nothing to follow."""
    leaders = mimics.get(Id("coupling", follower.name))
    return numbers_weight(leaders[0])[1] if leaders else 1.0


def _followers(mechanism: Mechanism, mimics: Mapping[Id, tuple[RobotArc, ...]], leader: Id, following: Mapping[Id, Id]) -> Iterator[Id]:
    last, number = leader, 2
    while (key := Id("joint", follower_name(leader.name, number))) in mechanism.joints and following.get(last) == key:
        if not (_follows(mechanism, mimics.get(Id("coupling", key.name), ()), leader) and _is_alike(mechanism, mimics, leader, key)):
            return
        yield key
        last, number = key, number + 1


def _follows(mechanism: Mechanism, leaders: tuple[RobotArc, ...], leader: Id) -> bool:
    """Whether a joint follows this one alone, by a factor; of fixed joints, whether there is nothing to follow."""
    if not mechanism.joints[leader].joint.dofs:
        return not leaders
    if len(leaders) != 1 or leaders[0].target != leader:
        return False
    coefficients = numbers_weight(leaders[0])
    return len(coefficients) == 2 and str(coefficients[0]) == "0.0" and coefficients[1] not in (0.0, float("inf"), float("-inf"))


def _is_alike(mechanism: Mechanism, mimics: Mapping[Id, tuple[RobotArc, ...]], leader: Id, key: Id) -> bool:
    """Whether the edge of the first joint says everything about the other one but its child, its pose and its ratio."""
    first, other = mechanism.joints[leader], mechanism.joints[key]
    dofs = first.joint.dofs
    if (
        not all(map(is_comment_in_block, mechanism.extras.get(key, ())))
        or key in mechanism.notations
        or len(mechanism.graph.incidence.get(key, ())) != len(dofs)
    ):
        return False  # a coupling is an edge at the joint
    if mechanism.stereotypes.get(key) != mechanism.stereotypes.get(leader) or first.parent != other.parent or len(dofs) > 1:
        return False
    if not identical(other.child_pose, IDENTITY) and not identical(other.parent_pose, first.parent_pose):
        return False
    expected = tuple(follower_dof(dof, ratio_of(mimics, key)) for dof in dofs)
    return identical(parts.Joint(expected), other.joint)
