"""The edits in a file that was converted from another one: found by converting that one again, and applied to its mechanism."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, NamedTuple

from msgspec.structs import replace

from hymeko_x import codes, disk, formats, pipeline, targets
from hymeko_x.compare.diff import diff
from hymeko_x.compare.ledger import TOLERANCE
from hymeko_x.diagnostics import Report
from hymeko_x.edits.poses import with_edited_poses
from hymeko_x.ir.mechanism import WORLD, Id
from hymeko_x.ir.parts import Actuator, Body, Mesh, Texture
from hymeko_x.residue.delta import residue_of
from hymeko_x.residue.landmarks import NAMED
from hymeko_x.residue.merge import restore
from hymeko_x.residue.pairing import other_names
from hymeko_x.residue.realign import with_new_names, with_old_names
from hymeko_x.source import PackageFiles

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.compare.diff import Difference
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import JointView, Mechanism
    from hymeko_x.rewrite import Options
    from hymeko_x.source import Files, Source

_BASES = ("fixed", "free")
_ACTUATORS = ("none", "motor", "position", "velocity")
_ASSETS = ("copy", "reference")


class Guess(NamedTuple):
    """How the first conversion may have been made, and what it gives."""

    options: Options
    place: pipeline.Place
    image: Mechanism
    distance: int


class Conversion:
    """The conversion of ORIGINAL into the format of EDITED, made again."""

    def __init__(
        self, mechanism: Mechanism, source: Source, edited: Source, format: Format, home: Format, report: Report, notes: Report
    ) -> None:
        """``notes`` gets what restoring reports, which matters where there are edits."""
        self.mechanism, self.source, self.format, self.report, self.notes = mechanism, source, format, report, notes
        since = len(report)
        self.edited = pipeline.read_file(edited, format, report).mechanism
        pipeline.stop_on_errors(report, since, lenient=False)
        self.files, self.home = edited.files, home
        self.folder = os.path.dirname(edited.name) or "."

    def edited_mechanism(self, options: Options) -> Mechanism:
        """The mechanism of ORIGINAL with the edits; options that are not given are found out.

        Raises: Refusal when ORIGINAL cannot be written in the format.
        """
        guess = self._found_out(self._guess(options, pipeline.Place(self.folder, package=disk.package_uri(self.folder))))
        self._report_found(options, guess)
        self._used = guess
        residue = residue_of(self.mechanism, guess.image)
        names = renames(self.edited, guess.image)
        restored = restore(with_old_names(self._with_inertials(guess.image), names), residue, self.notes).mechanism
        ours = dict(residue.alignment.names)
        named = with_new_names(restored, {new: ours.get(old, old) for new, old in names.items() if ours.get(old) != WORLD})
        return with_edited_poses(self._with_transmissions(named), guess.image, self.edited, self.format)

    def _with_transmissions(self, robot: Mechanism) -> Mechanism:
        """The robot with its transmissions as they were: gains and ranges of the actuators that they become have no place in them."""
        own = {key: part for key, part in self.mechanism.vertices(Actuator) if part.kind == "transmission"}
        changed = {key: part for key, part in own.items() if robot.graph.vertices.get(key, part) != part}
        return robot.replace(vertices=changed)

    def missing(self, source: Source) -> list[str]:
        """The edits that did not arrive, in words: what the edited file has otherwise than ORIGINAL with its new text, converted again."""
        changed, edits = self._against(self._used.image)
        if not changed and not edits:
            return []
        home = pipeline.read(source, self.home, Report(), lenient=True)
        names, rest = self._against(self._converted(home, self._used.options, self._used.place, source.files))
        new_names = {old: new for new, old in changed.items() if new not in names}
        known = {(new_names.get(edit.element, edit.element), *edit[1:]) for edit in edits}
        named = [f"{old.kind} '{old.name}' is called '{new.name}'" for new, old in names.items() if new in changed]
        return named + [str(edit) for edit in rest if tuple(edit) in known and _is_telling(edit)]

    def _against(self, image: Mechanism) -> tuple[dict[Id, Id], tuple[Difference, ...]]:
        """The old ids of elements that the edited file calls otherwise than an image, by their new ones, and what else differs."""
        names = renames(self.edited, image)
        return names, diff(image, with_old_names(self.edited, names), TOLERANCE)

    def _with_inertials(self, image: Mechanism) -> Mechanism:
        """The edited robot; a body without an inertial, where the image has one or has no such body, has what the engine computes."""
        mine = image.graph.vertices
        bare = [key for key, body in self.edited.vertices(Body) if body.inertial is None and mine.get(key) != body]
        if not bare or formats.native_format(self.mechanism) is self.format:
            return self.edited
        complete = pipeline.completed(self.edited, self.home, self.files, Report())
        return self.edited.replace(vertices={key: complete.graph.vertices[key] for key in bare})

    def _guess(self, options: Options, place: pipeline.Place) -> Guess:
        image = self._converted(self.mechanism, options, place, self.source.files)
        return Guess(options, place, image, len(self._against(image)[1]))

    def _converted(self, mechanism: Mechanism, options: Options, place: pipeline.Place, files: Files) -> Mechanism:
        """A mechanism as the format has it. Raises: as :func:`hymeko_x.pipeline.write`."""
        package = pipeline.write(mechanism, self.format, options, files, Report(), place)
        return pipeline.read_back(package, self.format, PackageFiles(package, files))

    def _found_out(self, first: Guess) -> Guess:
        """The guess with the fewest differences, one option after the other; only those that may explain some are tried."""
        best = first
        for others in (self._other_files, self._other_bases, self._other_actuators, self._other_targets):
            for options, place in others(best):
                guess = self._guess(options, place)
                if guess.distance < best.distance:
                    best = guess
        return best

    def _other_files(self, guess: Guess) -> Iterator[tuple[Options, pipeline.Place]]:
        """Where files are called otherwise: beside the output or where they are, and in a folder of the output's name."""
        mine, theirs = ({part.uri for _, part in robot.assets() if part.uri} for robot in (guess.image, self.edited))
        if theirs <= mine:
            return
        for assets in _ASSETS:
            yield guess.options, replace(guess.place, assets=assets)
        first = next(iter(sorted(theirs - mine))).partition("/")[0]
        yield replace(guess.options, within=f"{first}/"), replace(guess.place, assets="copy")

    def _other_bases(self, guess: Guess) -> Iterator[tuple[Options, pipeline.Place]]:
        """Where a body is joined to the world in one of the two only, which may be a body by that name."""
        mine, theirs = ([(view.child, view.joint.dofs) for view in _on_world(robot)] for robot in (guess.image, self.edited))
        if guess.options.base is None and mine != theirs:
            yield from ((replace(guess.options, base=base), guess.place) for base in _BASES)

    def _other_actuators(self, guess: Guess) -> Iterator[tuple[Options, pipeline.Place]]:
        """Where one of the two has actuators that the other one does not have."""
        mine, theirs = ({(key, part.kind) for key, part in robot.vertices(Actuator)} for robot in (guess.image, self.edited))
        if guess.options.actuators is None and mine != theirs:
            yield from ((replace(guess.options, actuators=kind), guess.place) for kind in _ACTUATORS)

    def _other_targets(self, guess: Guess) -> Iterator[tuple[Options, pipeline.Place]]:
        """Where the two differ in anything."""
        if guess.options.target is None and guess.distance:
            for target in targets.of_format(self.format):
                yield replace(guess.options, target=target.name), guess.place

    def _report_found(self, options: Options, guess: Guess) -> None:
        names = {
            "base": guess.options.base,
            "actuators": guess.options.actuators,
            "for": guess.options.target,
            "assets": guess.place.assets,
        }
        given = {"base": options.base, "actuators": options.actuators, "for": options.target, "assets": None}
        found = [f"--{name} {value}" for name, value in names.items() if value != given[name]]
        if found:
            self.report.note(codes.OPTIONS_FOUND, f"the file was converted with {' '.join(found)}, as far as can be seen")


def _is_telling(edit: Difference) -> bool:
    """Whether a difference that is left is an edit, and not a value that one of two equal robots leaves to be computed."""
    if None in (edit.before, edit.after):
        return edit.element.kind in _WHOLE and not edit.field
    is_weight = edit.element.kind == "shape" and edit.field in ("mass", "density")
    return not is_weight and "none" not in (edit.before, edit.after)


_WHOLE = frozenset({"body", "joint", "actuator", "sensor", "camera", "light", "coupling", "loop", "tendon", "contact"})
"""The kinds of elements that no format computes from others."""


def _on_world(robot: Mechanism) -> Iterator[JointView]:
    """The joints that join bodies to the world, or to a body that a format without a world has in its place."""
    for world in (WORLD, Id("body", WORLD.name)):
        yield from robot.children.get(world, ())


def renames(edited: Mechanism, image: Mechanism) -> dict[Id, Id]:
    """The old ids of renamed elements by their new ones, as far as the elements around them tell."""
    return {new: old for new, old in other_names(edited, image).items() if old.kind in NAMED and new.kind == old.kind}


def new_assets(before: Mechanism, after: Mechanism) -> Iterator[str]:
    """The uris of meshes and images that only the edited mechanism refers to."""
    known = {part.uri for _, part in before.assets()}
    for _, part in after.assets():
        if isinstance(part, Mesh | Texture) and part.uri and part.uri not in known:
            yield part.uri
