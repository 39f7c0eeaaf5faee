"""How a file was converted, found out from the file itself: with the options with which the conversion differs least from it."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, NamedTuple

from msgspec.structs import replace

from hymeko_x import targets
from hymeko_x.ir.mechanism import WORLD, WORLD_LINK
from hymeko_x.ir.parts import Actuator

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from hymeko_x import pipeline
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import JointView, Mechanism
    from hymeko_x.rewrite import Options
    from hymeko_x.source import Files

_BASES = ("fixed", "free")
_ACTUATORS = ("none", "motor", "position", "velocity")
_ASSETS = ("copy", "reference")


class Guess(NamedTuple):
    """How the first conversion may have been made, and what it gives."""

    options: Options
    place: pipeline.OutputPlace
    image: Mechanism
    files: Files
    distance: int = 0

    def given(self, options: Options) -> list[str]:
        """The options of the command line that it has and that were not given."""
        names = {"base": self.options.base, "actuators": self.options.actuators, "for": self.options.target, "assets": self.place.assets}
        given = {"base": options.base, "actuators": options.actuators, "for": options.target, "assets": None}
        return [f"--{name} {value}" for name, value in names.items() if value != given[name]]


def best_guess(first: Guess, edited: Mechanism, format: Format, again: Callable[[Options, pipeline.OutputPlace], Guess]) -> Guess:
    """The guess with the fewest differences, one option after the other; only those that may explain some are tried."""
    best = first
    for others in (_other_files, _other_folders, _other_bases, _other_actuators, _other_targets):
        for options, place in others(best, edited, format):
            with suppress(ModuleNotFoundError):  # of a target whose rules ask an engine that is not installed
                best = min(best, again(options, place), key=lambda guess: guess.distance)
    return best


def _other_files(guess: Guess, edited: Mechanism, format: Format) -> Iterator[tuple[Options, pipeline.OutputPlace]]:
    """Where files are called otherwise: they may be beside the output, or where they are."""
    if _other_paths(guess, edited):
        yield from (
            (guess.options, replace(guess.place, assets=assets)) for assets in _ASSETS if assets != (guess.place.assets or format.assets)
        )


def _other_folders(guess: Guess, edited: Mechanism, _: Format) -> Iterator[tuple[Options, pipeline.OutputPlace]]:
    """Where files are still called otherwise: they may be in a folder of the output's name."""
    if paths := _other_paths(guess, edited):
        yield replace(guess.options, within=f"{paths[0].partition('/')[0]}/"), replace(guess.place, assets="copy")


def _other_paths(guess: Guess, edited: Mechanism) -> list[str]:
    """The paths of meshes and images that the edited file alone has, in order."""
    mine, theirs = ({part.uri for _, part in robot.assets() if part.uri} for robot in (guess.image, edited))
    return sorted(theirs - mine)


def _other_bases(guess: Guess, edited: Mechanism, _: Format) -> Iterator[tuple[Options, pipeline.OutputPlace]]:
    """Where a body is joined to the world in one of the two only, which may be a body by that name."""
    mine, theirs = ([(view.child, view.joint.dofs) for view in _on_world(robot)] for robot in (guess.image, edited))
    if guess.options.base is None and mine != theirs:
        yield from ((replace(guess.options, base=base), guess.place) for base in _BASES)


def _other_actuators(guess: Guess, edited: Mechanism, _: Format) -> Iterator[tuple[Options, pipeline.OutputPlace]]:
    """Where one of the two has actuators that the other one does not have."""
    mine, theirs = ({(key, part.kind) for key, part in robot.vertices(Actuator)} for robot in (guess.image, edited))
    if guess.options.actuators is None and mine != theirs:
        kinds = _ACTUATORS if len(mine) > 1 else _ACTUATORS[1:]  # one that is gone was removed
        yield from ((replace(guess.options, actuators=kind), guess.place) for kind in kinds)


def _other_targets(guess: Guess, _: Mechanism, format: Format) -> Iterator[tuple[Options, pipeline.OutputPlace]]:
    """Where the two differ in anything. Of targets with the same rules one tells as much as all of them."""
    if guess.options.target is None and guess.distance:
        of_rules = {(target.rules, *target.defaults.items()): target for target in reversed(targets.of_format(format))}
        for target in reversed(of_rules.values()):
            yield replace(guess.options, target=target.name), guess.place


def _on_world(robot: Mechanism) -> Iterator[JointView]:
    """The joints that join bodies to the world, or to a body that a format without a world has in its place."""
    for world in (WORLD, WORLD_LINK):
        yield from robot.children.get(world, ())
