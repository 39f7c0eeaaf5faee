"""The sheet of the URDF backend: the mechanism to be printed, its style, and the look-ups that printing needs."""

from __future__ import annotations

import re
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar, cast

from hymeko_x.assets.written import files_of_meshes
from hymeko_x.backends.urdf.materials import Materials
from hymeko_x.formats import urdf as words
from hymeko_x.formats.urdf import notations
from hymeko_x.formats.urdf.notations import Style
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.mechanism import ROOT, numbers_weight
from hymeko_x.ir.parts import Coupling, Mesh
from hymeko_x.ir.values import NO_ROTATION, ZERO, rpy_of
from hymeko_x.xml.printing import put_back

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc
    from hymeko_x.ir.notations import Notation
    from hymeko_x.ir.values import Pose
    from hymeko_x.xml.printing import Tag


E = TypeVar("E")


class UrdfSheet:
    """A mechanism to be printed; all look-ups are linear to build. Files beside the output are in the folder ``within``."""

    def __init__(self, mechanism: Mechanism, declared: Mapping[str, str], within: str, prefix: str = "") -> None:
        self.mechanism = mechanism
        self.declared = declared
        self.within = within
        self._prefix = f"{prefix}/" if prefix else ""
        style = mechanism.notation(ROOT, notations.STYLE) or Style()
        self._habits = style.habits
        self._usual = dict(style.usual)
        self.materials = Materials(mechanism, self._usual_choice(notations.DEFINED))

    def choice(self, key: Id, choice: Notation[E]) -> E:
        """Which of several ways of writing an element's author chose: its own, else the file's, else the usual one."""
        own = self.mechanism.notation(key, choice)
        return self._usual_choice(choice) if own is None else own

    def _usual_choice(self, choice: Notation[E]) -> E:
        usual: Any = choice.read(self._usual.get(choice.name.removeprefix("urdf."), "")) or notations.USUAL[choice]
        return cast("E", usual)

    def has_habit(self, key: Id, habit: str) -> bool:
        """Whether an element with a default value is written by a habit: that of its file, unless it differs."""
        return (habit in self._habits) != (habit in (self.mechanism.notation(key, notations.OTHERWISE) or ()))

    @cached_property
    def usual_if_fixed(self) -> tuple[tuple[str, str], ...]:
        """Name and text of the elements that fixed joints have unless they have their own."""
        return self.mechanism.notation(ROOT, notations.FIXED) or ()

    @cached_property
    def mesh_files(self) -> Mapping[Id, str]:
        """The new files of the meshes that have points and no file."""
        return files_of_meshes(self.mechanism, self.within)

    def uri(self, key: Id) -> str | None:
        """How a mesh is referred to."""
        path = self.mesh_files.get(key)
        return self.mechanism.vertex(key, Mesh).uri if path is None else f"{self._prefix}{path}"

    @cached_property
    def leaders(self) -> Mapping[Id, RobotArc]:
        """For each joint that mimics another one, the arc to its leader with the coefficients."""
        found: dict[Id, RobotArc] = {}
        for _, _, arcs in self.mechanism.edges(Coupling):
            followers = [arc.target for arc in arcs if arc.sign > 0]
            leaders = [arc for arc in arcs if arc.sign < 0]
            if len(followers) == len(leaders) == 1 and not any(numbers_weight(leaders[0])[2:]):
                found[followers[0]] = leaders[0]
        return found

    def put_back(self, tag: Tag, key: Id) -> None:
        """Write the extras of an element into its tag."""
        own = [extra for extra in self.mechanism.extras.get(key, ()) if extra.format == words.FORMAT]
        if own:
            put_back(tag, own, self.declared)

    def has_own(self, key: Id, tag: str) -> bool:
        """Whether an extra of the element is a child of this name."""
        start = re.compile(rf"<{re.escape(tag)}[\s/>]")
        return any(extra.path == "" and start.match(extra.text) for extra in self.mechanism.extras.get(key, ()))

    def add_origin(self, tag: Tag, key: Id, pose: Pose) -> None:
        """Add <origin> to a tag of an element: position in m and roll, pitch, yaw in rad, as written where they were written so."""
        is_written, no_xyz, no_rpy = notations.origin_habits(tag.name)
        is_turned = pose.written is not None or pose.quat != NO_ROTATION
        if not is_turned and pose.xyz == ZERO and not self.has_habit(key, is_written):
            return
        origin = tag.add("origin")
        if pose.xyz != ZERO or not self.has_habit(key, no_xyz):
            origin.attributes["xyz"] = numbers_text(pose.xyz)
        if is_turned or not self.has_habit(key, no_rpy):
            origin.attributes["rpy"] = numbers_text(rpy_of(pose))
