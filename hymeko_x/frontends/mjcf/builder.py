"""The mechanism that the readers of bodies, assets and relations build."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from msgspec import Struct, field

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf import words
from hymeko_x.formats.mjcf.classes import merge
from hymeko_x.formats.mjcf.codec import BadAttribute
from hymeko_x.formats.mjcf.inherited import InheritedValues
from hymeko_x.formats.mjcf.mesh_order import MESHES, noted_order
from hymeko_x.formats.mjcf.notations import attribute
from hymeko_x.formats.mjcf.tree import verbatim
from hymeko_x.ir.builder import Builder
from hymeko_x.ir.mechanism import ROOT, Id, Provenance
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Mesh
from hymeko_x.ir.values import IDENTITY, Pose, compose
from hymeko_x.xml.tree import read_numbers
from hymeko_x.xml.unread import extra_of, unread_extras

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.diagnostics import Refusal, Report
    from hymeko_x.formats.mjcf.classes import Classes
    from hymeko_x.formats.mjcf.codec import AttributeGroup, Settings
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.source import Files
    from hymeko_x.xml.tree import XmlNode

Values = dict[str, Any]

_NO_ATTRIBUTES: Mapping[str, str] = MappingProxyType({})


class MjcfBuilder(Builder):
    """An MJCF model so far. ``named``: elements by MJCF's own kinds and names."""

    report: Report
    settings: Settings
    classes: Classes
    file: str
    files: Files
    named: dict[tuple[str, str], Id] = field(default_factory=dict)
    roles: dict[Id, dict[str, str]] = field(default_factory=dict)
    inherited: InheritedValues = field(default_factory=InheritedValues)
    place: int = 0

    # ---- names -----------------------------------------------------------------------------------------------------------

    def own(self, element: XmlNode, kind: str, unnamed: str) -> Id:
        """A fresh id for an element of the mechanism: its name, or one made from ``unnamed`` that no other format's reader sees."""
        name = element.take("name")
        if name:
            key = Id(kind, name)
            self.register(element, words.NAMESPACES.get(kind, kind), name, key)
        else:
            key = self.names.take(kind, unnamed)
            self.note(key, UNNAMED, True)
        self.origins[key] = element.origin
        return key

    def register(self, element: XmlNode, tag: str, name: str, key: Id) -> None:
        """Make an element known by name. Raises: Refusal when another one of its kind has it."""
        place = (tag, name)
        first = self.named.get(place)
        self.named[place] = key
        if first is not None:
            raise refuse(
                codes.DUPLICATE_NAME,
                f"{place[0]} '{name}' is defined twice; the first one: {self.origins.get(first, '?')}",
                element.origin,
                element=str(key),
            )

    def find(self, element: XmlNode, kind: str, name: str) -> Id:
        """The element of this kind and name. Raises: Refusal (HX040)."""
        found = self.named.get((kind, name))
        if found is None:
            from difflib import get_close_matches

            near = get_close_matches(name, [known for of, known in self.named if of == kind], n=3)
            hint = f"did you mean {' or '.join(near)}?" if near else ""
            raise refuse(
                codes.UNDEFINED_REFERENCE, f"<{element.tag}> refers to the {kind} '{name}', which is not there", element.origin, hint=hint
            )
        return found

    # ---- values ----------------------------------------------------------------------------------------------------------

    def base(self, element: XmlNode, key: Id, childclass: str | None = None, tag: str = "") -> Mapping[str, str]:
        """The attributes that the element's class gives; the class is noted."""
        own = element.take("class")
        if own is not None:
            self.check_class(element, own)
            self.stereotypes[key] = (own,)
        return self.classes.of(tag or element.tag, own or childclass)

    def check_class(self, element: XmlNode, name: str) -> None:
        """Raises: Refusal (HX040) when there is no such class."""
        if not self.classes.has(name):
            raise refuse(codes.UNDEFINED_REFERENCE, f"<{element.tag}> has the class '{name}', which is not defined", element.origin)

    def values(
        self,
        element: XmlNode,
        groups: tuple[AttributeGroup, ...],
        base: Mapping[str, str],
        key: Id,
        prefix: str = "",
        *,
        always: bool = False,
    ) -> Values:
        """What the attributes mean, with those that the class gives.

        Where printing the values again would not mean the same, or ``always``, the attributes are noted as they are.
        """
        own, settings = element.attributes, self.settings
        merged = merge(base, own)
        inherited, read = self.inherited.apart(groups, base, settings, tuple(own))
        found: Values = {**inherited}
        taken: list[str] = []
        try:
            for group in read:
                value = found[group.key] = group.read(merged, settings)
                touched = {name: own[name] for name in group.names if name in own}
                taken += touched
                if touched and (always or not (group.exact or self._is_written_again(group, value, touched, base, own))):
                    for name, text in touched.items():
                        self.note(key, attribute(name, prefix), text)
        except BadAttribute as error:
            raise self.bad(element, error, merged) from error
        for name in taken:
            own.pop(name, None)
        return found

    def _is_written_again(
        self, group: AttributeGroup, value: Any, given: Mapping[str, str], base: Mapping[str, str], own: Mapping[str, str]
    ) -> bool:
        """Whether printing a value gives attributes of the same meaning as those that it was read from; ``given`` are those of its own."""
        written = group.write(value, self.settings)
        if written == given or (written.keys() == given.keys() and all(_are_same_numbers(written[name], given[name]) for name in given)):
            return True
        merged = merge(base, own)
        context = {name: merged[name] for name in group.needs if name in merged}
        again = merge({**base, **context}, written)
        if all(again.get(name) == merged.get(name) for name in group.names):
            return True
        return bool(group.seen(again, self.settings) == group.seen(merged, self.settings))

    def bad(self, element: XmlNode, error: BadAttribute, merged: Mapping[str, str] = _NO_ATTRIBUTES) -> Refusal:
        """The refusal of an attribute that MuJoCo refuses; ``merged`` are the attributes with those that the class gives."""
        own, text = element.attributes.get(error.attribute), merged.get(error.attribute)
        found = f"is '{own}'" if own is not None else "is missing" if text is None else f"is '{text}' in its class"
        return refuse(codes.BAD_NUMBER, f"<{element.tag} {error.attribute}> {found}, expected {error.expected}", element.origin)

    # ---- side tables -----------------------------------------------------------------------------------------------------

    def show(self, key: Id) -> None:
        """Give an element its place among all elements."""
        self.layout.append(key)
        self.place += 1

    def keep(self, element: XmlNode, key: Id, path: str = "") -> None:
        """Everything unread of an element is kept with the element of the mechanism that it became."""
        self.add_extras(key, *unread_extras(element, path, words.NAME, verbatim))

    def keep_at_root(self, element: XmlNode, path: str = "") -> None:
        """An element that the IR cannot represent is kept verbatim."""
        self.add_extras(ROOT, extra_of(element, path, self.place, words.NAME, verbatim))
        self.place += not path

    def keep_rest(self, root: XmlNode) -> None:
        """Everything unread at top level is kept."""
        for child in root.children:
            self.keep_at_root(child)
        root.children = []
        self.keep(root, ROOT)

    def finish(self, name: str) -> Mechanism:
        """The finished mechanism."""
        found = self.build(name, Provenance(words.NAME, words.VERSION, self.file))
        meshes = [key for key, _ in found.vertices(Mesh)]
        if meshes and (order := noted_order(found, meshes)):
            self.note(ROOT, MESHES, order)  # the mechanism has the builder's notations
        return found


def _are_same_numbers(a: str, b: str) -> bool:
    """Whether two texts of an attribute are the same, or the same numbers."""
    return a == b or bool((numbers := read_numbers(a)) and numbers == read_numbers(b))


class BodyScope(Struct, frozen=True):
    """Where an element of a body is: the body, the <frame> in it (its number, empty for none) with its pose there, and the childclass.

    ``stem``: the nearest name further out, after which nameless bodies are called; so their names do not grow with depth.
    """

    body: Id
    stem: str
    frame: str = ""
    pose: Pose = IDENTITY
    childclass: str | None = None


def placed(pose: Pose, scope: BodyScope) -> Pose:
    """A pose, given in the frame around the element, seen from the body."""
    return compose(scope.pose, pose) if scope.frame else pose
