"""What the verifier finds about two robots, at the bodies of the scene where it is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x.draw.graph.letters import visible

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.verify.model import KinematicModel
    from hymeko_x.verify.verdict import Check, Verdict


class Spot(Struct, frozen=True):
    """One difference in a line, and the bodies at which it is, as numbers in each model."""

    words: str
    bodies: tuple[frozenset[int], frozenset[int]]


def spots_of(verdict: Verdict, a: KinematicModel, b: KinematicModel) -> list[Spot]:
    """A spot for every difference that is not allowed."""
    labels = _labels(a), _labels(b)
    places = [found for check in verdict.failed for found in _places(check)]
    return [Spot(words, (_bodies_in(place, labels[0]), _bodies_in(place, labels[1]))) for words, place in places]


def _places(check: Check) -> Iterator[tuple[str, str]]:
    """The differences of a check: in a line each, and the verifier's words for the place."""
    unit = f" {check.unit}" if check.unit else ""
    for found in check.findings:
        size = f" {found.difference:.3g}{unit}" if check.unit else ""
        yield visible(f"{found.at}: {check.quantity}{size}"), found.at
    if not check.findings:
        yield visible(f"{check.at}: {check.quantity} {check.worst:.3g}{unit}"), check.at


def _labels(model: KinematicModel) -> dict[str, int]:
    """The number of the body for the label of each body, and for that of each dof its child body."""
    labels = {model.body_label(index): index for index in range(1, len(model.bodies))}
    return labels | {model.dof_label(dof): model.body_of_dof[dof] for dof in range(len(model.dofs))}


def _bodies_in(words: str, labels: Mapping[str, int]) -> frozenset[int]:
    """The body whose label comes first in the words; none where there is no label."""
    places = sorted((place, -len(label), index) for label, index in labels.items() if (place := words.find(label)) >= 0)
    return frozenset({places[0][2]}) if places else frozenset()
