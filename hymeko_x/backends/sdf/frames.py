"""Where everything of a mechanism is, for poses that are relative to each other, and what its frames are called in a model."""

from __future__ import annotations

from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING

from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.ir.kinematics import below, reference_poses
from hymeko_x.ir.mechanism import ROOT, WORLD, Id, pose_weight
from hymeko_x.ir.parts import Frame, Loop
from hymeko_x.ir.values import IDENTITY, compose, inverse
from hymeko_x.ir.written import clean_pose

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import JointView, Mechanism
    from hymeko_x.ir.values import Pose

MODEL = Id("frame", words.MODEL_FRAME)
"""The frame of the model that has no scope; it is no element of the mechanism."""


class ZeroPoses:
    """The poses of bodies, joints, frames and models in the world, at the zero configuration."""

    def __init__(self, mechanism: Mechanism) -> None:
        self._mechanism = mechanism

    @cached_property
    def in_world(self) -> Mapping[Id, Pose]:
        """The pose of every frame that a pose may be relative to."""
        mechanism = self._mechanism
        poses = reference_poses(mechanism)
        poses[MODEL] = self._model
        for key, view in self._joints.items():
            poses[key] = compose(poses.get(view.parent, IDENTITY), view.parent_pose)
        for key, _, arcs in mechanism.edges(Loop):
            poses[key] = compose(poses.get(arcs[0].target, IDENTITY), pose_weight(arcs[0])) if arcs else IDENTITY
        for body, views in mechanism.mounts.items():
            for mount in views:
                poses[mount.mounted] = compose(poses.get(body, IDENTITY), mount.pose)
        return poses

    @property
    def _model(self) -> Pose:
        return self._mechanism.notation(ROOT, notations.MODEL) or IDENTITY

    def _of_base(self, frame: Id) -> Pose | None:
        """The pose of a base, or of the frame of the model, in the world, without those of all others; None for other frames."""
        if frame == MODEL:
            return self._model
        above = self._mechanism.parent_joint.get(frame)
        if above is None:
            return IDENTITY if frame.kind == "body" else None
        return below(IDENTITY, above.parent_pose, above.child_pose) if above.parent == WORLD else None

    @property
    def _joints(self) -> Mapping[Id, JointView]:
        return self._mechanism.joints

    def relative(self, frame: Id, base: Id) -> Pose:
        """The pose of a frame in another one; near ones as the mechanism has them."""
        joint = self._joints.get(frame)
        if joint is not None and joint.parent == base:
            return joint.parent_pose
        if joint is not None and joint.child == base:
            return joint.child_pose
        above = self._joints.get(base)
        if above is not None and above.child == frame:
            return inverse(above.child_pose)
        if base == self._body_below(frame) and frame.kind == "frame":
            return self._mount_pose(frame)
        near = self._of_base(frame) if base in (WORLD, MODEL) and self._model == IDENTITY else None
        if near is not None:
            return clean_pose(near)
        poses = self.in_world
        return clean_pose(compose(inverse(poses.get(base, IDENTITY)), poses.get(frame, IDENTITY)))

    def seen_from(self, base: Id, default: Id, pose: Pose) -> Pose:
        """A pose that is given in the default frame, seen from another one."""
        around = self.relative(base, default)
        return pose if around == IDENTITY else clean_pose(compose(inverse(around), pose))

    @cached_property
    def mounts(self) -> Mapping[Id, tuple[Id, Pose]]:
        """The body of each mounted element, and its pose there."""
        return {view.mounted: (view.body, view.pose) for views in self._mechanism.mounts.values() for view in views}

    def body_of(self, target: Id) -> Id:
        """The body that a frame is on; a body itself."""
        if target == MODEL:
            return self._canonical_link
        joint = self._joints.get(target)
        if joint is not None:
            return joint.child
        return self.mounts[target][0] if target in self.mounts else target

    @cached_property
    def _canonical_link(self) -> Id:
        """The link that the frame of the model without a scope is on; one without links has that of the first model in it."""
        named = [extra.text for extra in self._mechanism.extras.get(ROOT, ()) if extra.path.endswith("model/@canonical_link")]
        if named:
            return Id("body", named[0])
        members = [*self._mechanism.layout, *self._mechanism.graph.vertices]
        links = (key for key in members if key.kind == "body" and words.SCOPE not in key.name)
        nested = (self.mounts[key][0] for key in members if key.name.endswith(f"{words.SCOPE}{words.MODEL_FRAME}") and key in self.mounts)
        return next(chain(links, nested), WORLD)

    def _body_below(self, frame: Id) -> Id | None:
        return self.mounts[frame][0] if frame in self.mounts else None

    def _mount_pose(self, frame: Id) -> Pose:
        return self.mounts[frame][1]

    # ---- names -----------------------------------------------------------------------------------------------------------

    @cached_property
    def _named(self) -> Mapping[str, Id]:
        """The element that a name outside of all models means: links first."""
        found: dict[str, Id] = {words.MODEL_FRAME: MODEL, words.WORLD_FRAME: WORLD}
        mechanism = self._mechanism
        keys = [key for key in mechanism.graph.vertices if key.kind in ("body", "frame")]
        for key in [*keys, *(key for key in mechanism.graph.edges if key.kind in ("joint", "loop"))]:
            found.setdefault(key.name, key)
        for key, _ in mechanism.vertices(Frame):
            scope, own = words.split_scope(key.name)
            if own == words.MODEL_FRAME and scope:
                found.setdefault(scope.removesuffix(words.SCOPE), key)
        for key, _ in mechanism.vertices(Frame):
            if mechanism.notation(key, notations.IN_WORLD):
                found[words.WORLD_SCOPE + self._own_name(key)] = key
        return found

    def _own_name(self, key: Id) -> str:
        return (self._mechanism.notation(key, notations.WRITTEN) or {}).get("@name", key.name)

    def find(self, scope: str, name: str) -> Id | None:
        """What a name means in a model."""
        found = self._named.get(words.scoped(scope, name))
        if found is not None or scope != words.WORLD_SCOPE:
            return found
        inside = name.removeprefix(f"{self._mechanism.name}{words.SCOPE}")  # what is beside the only model names it
        return MODEL if name == self._mechanism.name else self._named.get(inside)

    def name(self, key: Id, scope: str) -> str:
        """The name of a frame in a model around it."""
        if key == WORLD:
            return words.WORLD_FRAME
        return key.name.removeprefix(scope)

    def model_frame(self, scope: str) -> Id:
        """The frame of the model with this scope."""
        return self._named.get(scope + words.MODEL_FRAME, MODEL) if scope != words.WORLD_SCOPE else WORLD
