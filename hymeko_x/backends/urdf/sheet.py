"""What the printers of links, joints, materials and transmissions look up: one index over the mechanism."""

from __future__ import annotations

import re
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar, cast

from hymeko_x.backends.urdf.meshes import files_of_meshes
from hymeko_x.formats import urdf as words
from hymeko_x.formats.urdf import notations
from hymeko_x.formats.urdf.notations import Defined, Style
from hymeko_x.ir.mechanism import ROOT, numbers_weight
from hymeko_x.ir.parts import Coupling, Layer, Material, Texture
from hymeko_x.ir.values import IDENTITY, numbers_text, rpy_of
from hymeko_x.xml.printing import Tag, put_back

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism, RobotArc
    from hymeko_x.ir.notations import Notation
    from hymeko_x.ir.values import Pose


_RECENT = 256
"""How many poses are remembered: those of one link are near each other."""


E = TypeVar("E")


class Sheet:
    """A mechanism to be printed, with its style and the look-ups that printing needs; all of them linear to build."""

    def __init__(self, mechanism: Mechanism, declared: Mapping[str, str], within: str) -> None:
        self.mechanism = mechanism
        self.declared = declared
        self.within = within
        style = mechanism.notation(ROOT, notations.STYLE) or Style()
        self.explicit = style.explicit
        self._usual = dict(style.usual)
        self._defined_before: set[Id] = set()
        self._places: dict[Id, Defined | None] = {}
        self._origins: dict[int, tuple[Pose, dict[str, str]]] = {}

    # ---- style -----------------------------------------------------------------------------------------------------------

    def choice(self, key: Id, choice: Notation[E]) -> E:
        """Which of several ways of writing an element's author chose: its own, else the file's, else the usual one."""
        own = self.mechanism.notation(key, choice)
        if own is not None:
            return own
        usual: Any = choice.read(self._usual.get(choice.name.removeprefix("urdf."), "")) or notations.USUAL[choice]
        return cast("E", usual)

    @cached_property
    def usual_if_fixed(self) -> tuple[tuple[str, str], ...]:
        """Name and text of the elements that fixed joints have unless they have their own."""
        return self.mechanism.notation(ROOT, notations.FIXED) or ()

    # ---- materials -------------------------------------------------------------------------------------------------------

    @cached_property
    def textures(self) -> Mapping[Id, str]:
        """The file of each material's texture."""
        vertices = self.mechanism.graph.vertices
        found: dict[Id, str] = {}
        for _, _, arcs in self.mechanism.edges(Layer):
            image = next((vertices[arc.target] for arc in arcs if arc.sign > 0), None)
            if isinstance(image, Texture) and image.uri is not None:
                found.update({arc.target: image.uri for arc in arcs if arc.sign < 0})
        return found

    @cached_property
    def first_of_name(self) -> Mapping[str, Id]:
        """For each material name the material that it means: the one with that id, else the first one."""
        found: dict[str, Id] = {}
        for key, material in self.mechanism.vertices(Material):
            if material.name is not None and (material.name not in found or key.name == material.name):
                found[material.name] = key
        return found

    def place_of(self, key: Id) -> Defined | None:
        """Where a material is defined; None where it is only referred to."""
        material = self.mechanism.vertex(key, Material)
        own = self.mechanism.notation(key, notations.DEFINED)
        if material.name is None:
            return Defined.INLINE
        if material.rgba is None and key not in self.textures:
            return own
        if self.first_of_name[material.name] != key:
            return own or Defined.INLINE
        return self.choice(key, notations.DEFINED)

    def defined_now(self, key: Id) -> bool:
        """Whether a shape that uses the material has to define it; asked once for each shape, in printing order."""
        if key not in self._places:
            self._places[key] = self.place_of(key)
        place = self._places[key]
        first = key not in self._defined_before
        self._defined_before.add(key)
        return place in (Defined.INLINE, Defined.BOTH) or (place is Defined.FIRST and first)

    # ---- meshes ----------------------------------------------------------------------------------------------------------

    @cached_property
    def mesh_files(self) -> Mapping[Id, str]:
        """Where the meshes go that carry their points and have no file."""
        return files_of_meshes(self.mechanism, self.within)

    # ---- joints ----------------------------------------------------------------------------------------------------------

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

    # ---- extras ----------------------------------------------------------------------------------------------------------

    def put_back(self, tag: Tag, key: Id) -> None:
        """Write the extras of an element into its tag."""
        own = [extra for extra in self.mechanism.extras.get(key, ()) if extra.format == words.FORMAT]
        if own:
            put_back(tag, own, self.declared)

    def has_own(self, key: Id, tag: str) -> bool:
        """Whether an extra of the element is a child of this name."""
        start = re.compile(rf"<{re.escape(tag)}[\s/>]")
        return any(extra.path == "" and start.match(extra.text) for extra in self.mechanism.extras.get(key, ()))

    # ---- poses -----------------------------------------------------------------------------------------------------------

    def add_origin(self, tag: Tag, pose: Pose, *, always: bool) -> None:
        """Add <origin>: position in m and roll, pitch, yaw in rad, as written where they were written so."""
        if pose is IDENTITY and not always:
            return
        if always or pose.written is not None or pose != IDENTITY:
            tag.children.append(Tag("origin", self._origin(pose).copy()))

    def _origin(self, pose: Pose) -> dict[str, str]:
        """The attributes of <origin>; what is seen at a place often collides there too, and then both have the same pose."""
        found = self._origins.get(id(pose))
        if found is None:  # the pose is kept as well, so that its identity stays its own
            if len(self._origins) == _RECENT:
                self._origins.clear()
            found = self._origins[id(pose)] = pose, {"xyz": numbers_text(pose.xyz), "rpy": numbers_text(rpy_of(pose))}
        return found[1]
