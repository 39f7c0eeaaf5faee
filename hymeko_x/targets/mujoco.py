"""MuJoCo: a model that runs as it is. docs/targets.md lists what MuJoCo Menagerie's models have, and where each rule is from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.backends.mjcf.steady import integrate_implicitly
from hymeko_x.diagnostics import Report, counted, listed
from hymeko_x.formats.mjcf import NAME
from hymeko_x.formats.mjcf.keyframes import Key, has_keyframes, keys_of, with_keys
from hymeko_x.ir.graph import Arc, Edge
from hymeko_x.ir.mechanism import ROOT, Id, numbers_weight
from hymeko_x.ir.names import names_in_use
from hymeko_x.ir.notations import UNNAMED
from hymeko_x.ir.parts import Contact, Coupling, DofKind
from hymeko_x.rewrite import legalize
from hymeko_x.rewrite.rotors import give_light_dofs_rotors
from hymeko_x.rewrite.servos import dof_of, home
from hymeko_x.targets.engine import touching
from hymeko_x.targets.held import servos

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Mechanism, RobotEdge
    from hymeko_x.rewrite.context import Context, Rule

_SHOWN = 3
"""How many pairs a note names."""


def name_home(mechanism: Mechanism, context: Context) -> Mechanism:
    """A keyframe ``home``: every joint at its reference, or at the limit next to it, and every servo there.

    A robot with named poses has these as keyframes, with the controls by which its servos hold them.
    """
    if has_keyframes(mechanism):
        return mechanism
    legal = legalize(mechanism, NAME, Report())
    keys = keys_of(legal)
    new = [_held(legal, key) for key in keys] if keys else _home(legal)
    if new == keys:
        return mechanism
    keyed = with_keys(legal, new)
    what = f"keyframes have the controls of servos: {', '.join(_name(key) for key in keys)}" if keys else "keyframe 'home' is written"
    context.report.note(codes.FOR_TARGET, f"{context.reason}: {what}", element="mechanism")
    extras = {key: found for key, found in {**mechanism.extras, ROOT: keyed.extras[ROOT]}.items() if found}
    return replace(mechanism, extras=extras)


def _name(key: Key) -> str:
    return f"'{key.attributes.get('name', '')}'"


def _home(mechanism: Mechanism) -> list[Key]:
    """The keyframe ``home``; none for a robot that does not move."""
    places = _at_home(mechanism)
    numbers: dict[tuple[str, Id], tuple[float, ...]] = {}
    for view in mechanism.joints.values():
        if view.joint.dofs and all(dof.kind not in (DofKind.BALL, DofKind.FREE) for dof in view.joint.dofs):
            numbers["qpos", view.id] = tuple(places[view.id, number] for number in range(len(view.joint.dofs)))
    return [_held(mechanism, Key({"name": "home"}, numbers))] if places else []


def _held(mechanism: Mechanism, key: Key) -> Key:
    """The keyframe with the controls by which the servos hold the robot in it, unless it has controls."""
    if any(word == "ctrl" for word, _ in key.numbers):
        return key
    places = {(of, number): q for (word, of), numbers in key.numbers.items() if word == "qpos" for number, q in enumerate(numbers)}
    controls: dict[tuple[str, Id], tuple[float, ...]] = {}
    for servo in servos(mechanism):
        if all(place in places for place, _ in servo.lengths):
            controls["ctrl", servo.actuator] = (servo.control(sum(factor * places[place] for place, factor in servo.lengths)),)
    return Key(key.attributes, {**key.numbers, **controls})


def _at_home(mechanism: Mechanism) -> dict[tuple[Id, int], float]:
    """The coordinates of hinges and slides at home; followers are where their leaders put them."""
    places = {(view.id, n): home(dof) for view in mechanism.joints.values() for n, dof in enumerate(view.joint.dofs)}
    for _, _, arcs in mechanism.edges(Coupling):
        ends = [(dof_of(mechanism, arc), arc) for arc in arcs]
        followers = [place for place, arc in ends if arc.sign > 0 and place in places]
        leaders = [(places[place], numbers_weight(arc)) for place, arc in ends if arc.sign < 0 and place in places]
        if len(followers) == 1 and leaders:
            places[followers[0]] = sum(sum(c * at**power for power, c in enumerate(weights)) for at, weights in leaders)
    return places


def exclude_what_touches_at_home(mechanism: Mechanism, context: Context) -> Mechanism:
    """Bodies that touch at home, where nothing should push, never collide: their shapes overlap by design.

    Source: MoveIt Setup Assistant, which disables pairs that are in collision by default; MuJoCo's <exclude>.
    """
    present = {frozenset(arc.target for arc in arcs) for _, contact, arcs in mechanism.edges(Contact) if contact.kind == "exclude"}
    found = [pair for pair in touching(mechanism, context) if frozenset(pair) not in present]
    if not found:
        return mechanism
    names = names_in_use(mechanism)
    edges: dict[Id, RobotEdge] = {}
    for pair in found:
        key = names.take("contact", "_".join(body.name for body in pair))
        edges[key] = Edge(Contact("exclude"), tuple(Arc(body, 0) for body in pair))
    named = listed([f"'{a.name}' and '{b.name}'" for a, b in found], _SHOWN)
    message = f"{counted(len(found), 'pair')} of bodies touching at home excluded from collision: {named}"
    context.report.note(codes.FOR_TARGET, f"{context.reason}: {message}", element=str(found[0][0]))
    return mechanism.replace(edges=edges).with_note(edges, UNNAMED, True)


RULES: tuple[Rule, ...] = (integrate_implicitly, give_light_dofs_rotors, name_home, exclude_what_touches_at_home)
