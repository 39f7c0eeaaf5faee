"""The edits in a file that was converted from another one: found by converting that one again, and applied to its mechanism."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x import codes, disk, formats, pipeline
from hymeko_x.compare.contents import Contents
from hymeko_x.compare.diff import Tolerance, diff
from hymeko_x.compare.ledger import TOLERANCE
from hymeko_x.compare.relevance import is_idle, relevant
from hymeko_x.diagnostics import Report
from hymeko_x.edits.classes import edited_classes, with_made_classes
from hymeko_x.edits.differences import (
    aim,
    has_other_forms,
    is_lost_name,
    is_of_asset,
    is_of_extra,
    is_telling,
    is_value_of_shape,
    is_weight,
    is_without_inertial,
)
from hymeko_x.edits.guessing import Guess, best_guess
from hymeko_x.edits.paths import with_same_paths
from hymeko_x.edits.poses import displaced, with_edited_poses
from hymeko_x.edits.unnamed import (
    stem,
    unnamed_bodies,
    unnamed_edges,
    with_same_assets,
    with_same_edges,
    with_same_numbers,
    without_counted_names,
)
from hymeko_x.edits.weights import (
    computed_weights,
    heavier,
    sprung_joints,
    with_computed_gains,
    with_computed_springs,
    with_least_masses,
    without_followed,
)
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.mechanism import WORLD, Id, Mechanism
from hymeko_x.ir.names import rename
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Actuator, Body, Shape
from hymeko_x.residue.align import align
from hymeko_x.residue.delta import residue_of
from hymeko_x.residue.landmarks import NAMED
from hymeko_x.residue.merge import restore
from hymeko_x.residue.originals import fetch_from
from hymeko_x.residue.pairing import colour_of, other_names, reordered_shapes
from hymeko_x.residue.realign import with_new_names, with_old_names
from hymeko_x.rewrite.decimals import shorten_computed
from hymeko_x.source import PackageFiles

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Iterator, Mapping, Set

    from hymeko_x.compare.contents import Fetch
    from hymeko_x.compare.diff import Difference
    from hymeko_x.formats import Format
    from hymeko_x.rewrite import Options
    from hymeko_x.source import Source

_SINGLE = Tolerance(1e-9, 1e-6)
"""By how much a number that a program wrote in single precision differs at most, in its unit and as a part of it: no edit is so small."""
_PLACING = frozenset({"drive", "mount", "sense"})
"""The kinds of edges that are called as what they place."""
_LIKE_LINKS = frozenset({"joint", "frame", "loop"})
"""The kinds of elements that share their names with links in some formats."""


class Left(NamedTuple):
    """The edits that did not arrive, in words; ``made_names`` are of elements whose names the format of ORIGINAL makes.

    ``differences`` is in how much the robots differ, assets apart, whether that tells of an edit or not.
    """

    renamed: Set[Id]
    names: list[str]
    made_names: list[str]
    edits: list[str]
    differences: int

    @property
    def distance(self) -> tuple[int, int]:
        """How far ORIGINAL is from what was edited: how many edits are left, and then the other differences."""
        return len(self.names) + len(self.made_names) + len(self.edits), self.differences


class Computed(NamedTuple):
    """What the conversion computes from masses, and EDITED has otherwise.

    ``old`` are the elements of ORIGINAL whose values, in words, EDITED has from before its edits; ``edits`` are of such values, in words.
    """

    old: Mapping[Id, str]
    edits: tuple[str, ...]


class Conversion:
    """The conversion of ORIGINAL into the format of EDITED, made again, and once more after each round of edits."""

    def __init__(self, edited: Source, format: Format, home: Format, options: Options, report: Report) -> None:
        """``notes`` are what restoring reports, which matters where there are edits."""
        self.format, self.options, self.report, self.notes = format, options, report, Report()
        since = len(report)
        self.edited = self._read = pipeline.read_file(edited, format, report).mechanism
        pipeline.stop_on_errors(report, since, lenient=False)
        self.files, self.home = edited.files, home
        self.folder = os.path.dirname(edited.name) or "."
        self._used: Guess | None = None
        self._first_image: Mechanism | None = None
        self._first_original = Mechanism("")
        self._asked: frozenset[tuple[Id, str, str | None]] | None = None
        self._homes: dict[Id, Id] = {}
        self.computed = Computed({}, ())

    @property
    def is_known(self) -> bool:
        """Whether a round was made, so that the options are known."""
        return self._used is not None

    def edited_mechanism(self, mechanism: Mechanism, source: Source) -> Mechanism:
        """The mechanism of ORIGINAL, as its text is now, with the edits; options that are not given are found out in the first round.

        Raises: Refusal when ORIGINAL cannot be written in the format.
        """
        self.mechanism, self.source = mechanism, source
        if not self.is_known and self.home.in_models is not None:
            self.edited = self._read = rename(self._read, formats.loaded(self.home.in_models)(self._read, mechanism))
        notes = Report() if self.is_known else self.notes
        guess = self._again(self._used) if self._used is not None else self._first()
        self._used = guess
        residue = residue_of(mechanism, guess.image)
        self._homes = homes = dict(residue.alignment.names)
        self.edited, self.computed = self._with_computed(self._comparable(guess.image, fetch_from(guess.files)), guess.image)
        if self._asked is None:
            self._asked = frozenset(map(aim, diff(guess.image, self.edited, TOLERANCE)))
        names = self._renames(guess.image)
        edited = without_followed(self._under(names, self._with_inertials(guess.image), guess.image), guess.image, self._bare_bodies())
        restored = restore(edited, residue, notes).mechanism
        given = names.given.items()
        own = {new: homes.get(old, old) for new, old in given if not (_is_beside(new, old) or self._is_after_body(new, old, guess.image))}
        named = with_new_names(restored, {new: old for new, old in own.items() if old != WORLD})
        return with_edited_poses(self._with_transmissions(named), guess.image, self.edited, self.format)

    def _comparable(self, image: Mechanism, fetch: Fetch) -> Mechanism:
        """EDITED with the image's classes, numbers and files where no edit is of them."""
        if self._first_image is None:
            self._first_image, self._first_original = image, self.mechanism
        read = with_made_classes(self._read, image, self._first_original, self.format)
        bodies, edges = (self._in_image(of(self.mechanism)) for of in (unnamed_bodies, unnamed_edges))
        numbered = with_same_edges(with_same_numbers(read, image, bodies), image, edges)
        placed = with_same_paths(Contents(numbered, fetch_from(self.files)), Contents(image, fetch))
        return without_counted_names(with_same_assets(placed, image), image)

    def _with_computed(self, edited: Mechanism, image: Mechanism) -> tuple[Mechanism, Computed]:
        """EDITED with the values that the conversion computes as it does now, where no edit is of them; and the elements of others."""
        assert self._first_image is not None
        sources = {key: self.mechanism.graph.vertices.get(self._homes.get(key, key)) for key, _ in edited.vertices(Actuator)}
        edited, actuators = with_computed_gains(with_least_masses(edited, image), self._first_image, image, sources)
        joints = sprung_joints(image, self.mechanism, self._homes, self._engine)
        edited, springs, edits = with_computed_springs(edited, self._first_image, image, joints, _SINGLE)
        old = {**dict.fromkeys(actuators, "the gains"), **dict.fromkeys(springs, "stiffness and damping")}
        return edited, Computed({self._homes.get(key, key): words for key, words in old.items()}, tuple(map(str, edits)))

    def _engine(self) -> Mechanism:
        """ORIGINAL with what its engine computes of it."""
        return pipeline.completed(self.mechanism, self.format, self.source.files, Report())

    def _first(self) -> Guess:
        """How the first conversion may have been made."""
        place = pipeline.OutputPlace(self.folder, package=disk.package_uri(self.folder))
        guess = best_guess(self._guess(self.options, place), self.edited, self.format, self._guess)
        if found := guess.given(self.options):
            self.report.note(codes.OPTIONS_FOUND, f"the file was converted with {' '.join(found)}, as far as can be seen")
        return guess

    def _again(self, guess: Guess) -> Guess:
        """The same conversion of what the text is now."""
        return self._converted(guess.options, guess.place)

    def _with_transmissions(self, robot: Mechanism) -> Mechanism:
        """The robot with its transmissions as they were: gains and ranges of the actuators that they become have no place in them."""
        own = {key: part for key, part in self.mechanism.vertices(Actuator) if part.kind == "transmission"}
        changed = {key: part for key, part in own.items() if robot.graph.vertices.get(key, part) != part}
        return robot.replace(vertices=changed)

    def left(self) -> Left:
        """The edits that did not arrive: what the edited file has otherwise than ORIGINAL as it was converted last."""
        assert self._used is not None
        names = self._renames(self._used.image)
        edited = self._under(names, self.edited, self._used.image)
        image = align(self._used.image, edited)[1]
        found = diff(image, edited, _SINGLE)
        rest = relevant(found, image, edited, _SINGLE)
        words: dict[bool, list[str]] = {True: [], False: []}
        for new, old in names.given.items():
            words[self._is_made(new, old)].append(f"{old.kind} '{old.name}' is called '{new.name}'")
        words[True] += [
            f"{old.kind} '{old.name}' is called '{new.name}'" for new, old in names.made.items() if self._is_called_anew(new, old)
        ]
        assert self._first_image is not None
        edits = [str(edit) for edit in rest if is_telling(edit)]
        edits += edited_classes(self._read, self._first_image, self._first_original, self.format)
        edits += displaced(self._read, self._first_image, self.format)
        return Left({*names.given, *names.given.values()}, words[False], words[True], edits, sum(not is_of_asset(edit) for edit in found))

    def unmet(self, known: Container[str], *, of_extras: bool) -> Iterator[tuple[Id, str]]:
        """What EDITED has and ORIGINAL, as it was converted last, does not have: by the element of ORIGINAL, in words.

        Both files are compared name by name, so that no way to see two robots as the same one hides an edit; only shapes without names,
        which may have another number, are found by what they are. It counts what EDITED was edited to have, every other value of a
        shape that was not edited, and masses of bodies that have none there. Names that did not arrive, and what has several forms of
        one meaning, are reported by :meth:`left`, whose edits are ``known``. With ``of_extras`` only masses and texts of EDITED's
        format count, which have one form.
        """
        assert self._used is not None
        image = self._used.image
        names = self._renames(image)
        edited = self._under(names, self.edited, image) if names.every else self.edited
        touched = {element for element, _, _ in self._asked or ()}
        numbered = reordered_shapes(edited, image)
        rest = diff(image, rename(edited, numbered), _SINGLE)
        left, heavy = frozenset(map(aim, rest)), self._heavier(image)
        arrived = computed_weights(image, edited, heavy)

        def is_of_mass(edit: Difference) -> bool:
            return is_without_inertial(edit) and edit.element in heavy

        for edit in diff(image, edited, _SINGLE):
            is_there = edit.element.kind == "shape" and (numbered.get(edit.element, edit.element), *aim(edit)[1:]) not in left
            is_arrived = edit.element in arrived and (is_weight(edit) or is_without_inertial(edit))
            if of_extras and not (is_of_extra(edit) or is_of_mass(edit)):
                continue
            if aim(edit) in (self._asked or ()) and not (has_other_forms(edit) or is_idle(edit) or is_there or is_arrived):
                yield self._homes.get(edit.element, edit.element), f"the edit did not arrive: {edit}"
        for edit in () if of_extras else rest:
            if edit.element not in touched and (is_value_of_shape(edit) or is_of_mass(edit)) and str(edit) not in known:
                words = f"it changed with the edits: {edit.element} {edit.field} is {edit.before}, and {edit.after} in the edited file"
                yield self._homes.get(edit.element, edit.element), words

    def _heavier(self, image: Mechanism) -> set[Id]:
        """The bodies without an inertial in EDITED, also where an engine computes some, that have a mass in the image."""
        names = self._renames(image)
        return heavier(image, self._under(names, self.edited, image), self._under(names, self._with_inertials(image), image))

    def lost_colours(self) -> Iterator[str]:
        """The colours in EDITED of shapes that have another one in ORIGINAL, as of one half of a geom, in words."""
        assert self._used is not None
        image = self._used.image
        edited = self._under(self._renames(image), self.edited, image)
        for key, shape, _ in edited.edges(Shape):
            there, colour = image.graph.edges.get(key), colour_of(edited.graph, edited.graph.edges[key])
            if there is None or colour is None or colour == colour_of(image.graph, there):
                continue
            if shape.rgba is None or there.data.rgba is None:  # type: ignore[union-attr]  # two of their own are edits that are left
                yield f"the edit did not arrive: {key} has the colour {numbers_text(colour)}"

    def lost_names(self) -> list[str]:
        """The names in EDITED of shapes for which ORIGINAL has none, as where one shape of that name became several, in words."""
        assert self._used is not None
        numbered = reordered_shapes(self.edited, self._used.image)
        back = {new: old for old, new in numbered.items()}
        found = diff(self._used.image, rename(self.edited, numbered), TOLERANCE)
        return [f"{back.get(edit.element, edit.element)} is called {edit.after}" for edit in found if is_lost_name(edit)]

    def _is_made(self, new: Id, old: Id) -> bool:
        """Whether a name is one that a format made: of an element without one, or of one beside a link of its name."""
        home = self._homes.get(old, old)
        joint = self.mechanism.joints.get(home)
        is_of_body = joint is not None and len(joint.joint.dofs) != 1
        is_named = home in self.mechanism.graph and self.mechanism.notation(home, UNNAMED) is None
        return is_of_body or not is_named or _is_beside(new, old)

    def _is_after_body(self, new: Id, old: Id, image: Mechanism) -> bool:
        """Whether a joint is called after its body in both files, and has a name of its own in ORIGINAL."""
        views = self.edited.joints.get(new), image.joints.get(old)
        has_own = self._homes.get(old, old).name != old.name
        return has_own and all(view is not None and view.id.name == view.child.name for view in views)

    def _is_called_anew(self, new: Id, old: Id) -> bool:
        """Whether EDITED was edited to have a name for an element that has none by its own words, and that is not called after its body."""
        joint = self.edited.joints.get(new)
        is_after_body = joint is not None and stem(joint.child) == stem(new)
        was_there = self._first_image is not None and new in self._first_image.graph
        return old.kind in ("body", "joint", "frame") and stem(new) != stem(old) and not (is_after_body or was_there)

    def _distance(self, image: Mechanism) -> int:
        """In how much the edited file differs from an image, apart from names."""
        return len(diff(image, self._under(self._renames(image), self.edited, image), TOLERANCE))

    def _under(self, names: Renames, edited: Mechanism, image: Mechanism) -> Mechanism:
        """The edited robot under the names of the image, and the shapes of each body under the ids that they have there."""
        named = with_old_names(edited, names.every)
        return rename(named, reordered_shapes(named, image))

    def _renames(self, image: Mechanism) -> Renames:
        """The other names that elements have in the edited file, as far as the elements around them tell."""
        pairs = {new: old for new, old in other_names(self.edited, image).items() if new.kind == old.kind}
        made = {new: old for new, old in pairs.items() if self._is_unnamed(new, old, image)}
        made_names = {(new.name, old.name) for new, old in made.items()}
        made |= {new: old for new, old in pairs.items() if old.kind in _PLACING and (new.name, old.name) in made_names}
        return Renames({new: old for new, old in pairs.items() if old.kind in NAMED and new not in made}, made)

    def _is_unnamed(self, new: Id, old: Id, image: Mechanism) -> bool:
        """Whether an element has no name in any of the three files: a contact, one that says so, an actuator or a frame that is made."""
        if old.kind in ("actuator", "frame") and self._homes.get(old, old) not in self.mechanism.graph:
            return True
        return old.kind == "contact" or not (_has_name(self.edited, new) or _has_name(image, old))

    def _bare_bodies(self) -> set[Id]:
        """The ids in the image of the bodies of ORIGINAL that have no mass."""
        return self._in_image(key for key, body in self.mechanism.vertices(Body) if body.inertial is None or not body.inertial.mass)

    def _in_image(self, homes: Iterable[Id]) -> set[Id]:
        there = {home: key for key, home in self._homes.items()}
        return {there.get(key, key) for key in homes}

    def _with_inertials(self, image: Mechanism) -> Mechanism:
        """The edited robot; a body without an inertial, where the image has one or has no such body, has what the engine computes."""
        mine = image.graph.vertices
        bare = [key for key, body in self.edited.vertices(Body) if body.inertial is None and mine.get(key) != body]
        if not bare or formats.native_format(self.mechanism) is self.format:
            return self.edited
        complete = pipeline.completed(self.edited, self.home, self.files, Report()).graph.vertices
        return shorten_computed(self.edited.replace(vertices={key: complete[key] for key in bare}), self.edited)

    def _guess(self, options: Options, place: pipeline.OutputPlace) -> Guess:
        guess = self._converted(options, place)
        return guess._replace(distance=self._distance(guess.image))

    def _converted(self, options: Options, place: pipeline.OutputPlace) -> Guess:
        """ORIGINAL as the format has it, in the container that is fastest. Raises: as :func:`hymeko_x.pipeline.write`."""
        format = formats.by_name(self.format.fast_container or self.format.name)
        package = pipeline.write(self.mechanism, format, options, self.source.files, Report(), place)
        files = PackageFiles(package, self.source.files)
        return Guess(options, place, pipeline.read_back(package, format, files), files)


def _is_beside(new: Id, old: Id) -> bool:
    """Whether one of two names is what an element gets beside a link of the other name, so that it tells of no edit."""
    mark = f"_{old.kind}"
    return old.kind in _LIKE_LINKS and new.name.removesuffix(mark) == old.name.removesuffix(mark)


class Renames(NamedTuple):
    """The old ids of renamed elements by their new ones: where people give names, and where formats make them from other names."""

    given: dict[Id, Id]
    made: dict[Id, Id]

    @property
    def every(self) -> dict[Id, Id]:
        """All of them."""
        return {**self.made, **self.given}


def _has_name(robot: Mechanism, key: Id) -> bool:
    """Whether the author of an element gave it a name."""
    return robot.notation(key, UNNAMED) is None
