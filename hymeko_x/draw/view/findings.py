"""What the verifier finds about two robots, at the bodies of the scene where it is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x.draw.graph.letters import visible

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hymeko_x.verify.model import KinematicModel
    from hymeko_x.verify.verdict import Check, Verdict


class Spot(Struct, frozen=True):
    """One difference in a line, and the bodies at which it is, as numbers in each model."""

    words: str
    bodies: tuple[frozenset[int], frozenset[int]]


def spots_of(verdict: Verdict, a: KinematicModel, b: KinematicModel) -> list[Spot]:
    """A spot for every difference that is not allowed."""
    return [Spot(words, (_bodies_in(place, a), _bodies_in(place, b))) for check in verdict.failed for words, place in _places(check)]


def _places(check: Check) -> Iterator[tuple[str, str]]:
    """The differences of a check: in a line each, and the verifier's words for the place."""
    unit = f" {check.unit}" if check.unit else ""
    for found in check.findings:
        size = f" {found.difference:.3g}{unit}" if check.unit else ""
        yield visible(f"{found.at}: {check.quantity}{size}"), found.at
    if not check.findings:
        yield visible(f"{check.at}: {check.quantity} {check.worst:.3g}{unit}"), check.at


def _bodies_in(words: str, model: KinematicModel) -> frozenset[int]:
    """The body, or the child body of the joint, that the words name first."""
    labels = {model.body_label(index): index for index in range(1, len(model.bodies))}
    labels |= {model.dof_label(dof): model.body_of_dof[dof] for dof in range(len(model.dofs))}
    places = sorted((place, -len(label), index) for label, index in labels.items() if (place := words.find(label)) >= 0)
    return frozenset({places[0][2]}) if places else frozenset()
