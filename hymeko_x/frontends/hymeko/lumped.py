"""Lumped elements of HyMeKo text: the domain that their units tell, and springs and dampers on the edge of a joint."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.formats.hymeko import ALIASES, LUMPED_UNITS, TARGETS, TURNING
from hymeko_x.formats.hymeko.units import unit_exponents
from hymeko_x.ir import lumped, parts
from hymeko_x.language.syntax import Field, Quantity

if TYPE_CHECKING:
    from hymeko_x.frontends.hymeko.block import Block
    from hymeko_x.frontends.hymeko.builder import HymekoBuilder
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.language.expansion import ExpandedElement, Scope
    from hymeko_x.language.syntax import ArcItem

DOMAINS = ("translation", "rotation")


def set_domain(builder: HymekoBuilder, kind: str, element: ExpandedElement, values: dict[str, object]) -> None:
    """Set the domain of a spring, damper or mass from the unit of its value, unless the text names it.

    Raises: Refusal (HX062) for a unit of another quantity, for a domain that is not known, and where the two contradict each other.
    """
    word, *units = LUMPED_UNITS[kind]
    known = {(exponents[:3]): domain for unit, domain in zip(units, DOMAINS, strict=True) if (exponents := unit_exponents(unit))}
    for item in element.node.items:
        if not isinstance(item, Field) or ALIASES.get(kind, {}).get(item.name, item.name) != word or not isinstance(item.value, Quantity):
            continue
        exponents = unit_exponents(item.value.unit)
        domain = known.get(exponents[:3]) if exponents else None
        if domain is None:
            message = f"'{item.name}' of a {kind} is in {' or '.join(units)}, not in {item.value.unit}"
            raise builder.reader.refuse(item, message)
        if values.setdefault("domain", domain) != domain:
            raise builder.reader.refuse(item, f"{item.value.unit} is a unit of {domain}, and the domain is '{values['domain']}'")


def take_compliant(builder: HymekoBuilder, block: Block, scope: Scope) -> list[tuple[ArcItem, Id]]:
    """The arcs of a joint's edge to springs and dampers, in any direction, taken out of its block."""
    found = [(arc, builder.find(arc.ref, scope, (*TARGETS["joint"], "spring", "damper"))) for arc in block.arcs if not arc.role]
    compliant = [(arc, key) for arc, key in found if key is not None and key.kind in ("spring", "damper")]
    for arc, _ in compliant:
        block.arcs.remove(arc)
    return compliant


def with_compliance(
    builder: HymekoBuilder, joint: Id, compliant: list[tuple[ArcItem, Id]], dofs: tuple[parts.Dof, ...]
) -> tuple[parts.Dof, ...]:
    """The dofs of a joint with the springs and dampers on its edge, which act in parallel along its single dof.

    Raises: Refusal (HX062) for a joint that has not exactly one dof.
    """
    for arc, key in compliant:
        if len(dofs) != 1:
            message = f"{joint} has {len(dofs)} dofs; a {key.kind} on its edge acts along exactly one"
            raise builder.reader.refuse(arc, message, hint="give the dof its stiffness and damping in its own block")
        _check_domain(builder, arc, key, joint, dofs[0])
        builder.folded.add(key)
        dofs = (_with(dofs[0], builder.vertices[key]),)
    return dofs


def _check_domain(builder: HymekoBuilder, arc: ArcItem, key: Id, joint: Id, dof: parts.Dof) -> None:
    """Raises: Refusal (HX062) for a spring or damper of a translation at a joint that turns, and the other way around."""
    word, *units = LUMPED_UNITS[key.kind]
    own = DOMAINS[dof.kind in TURNING]
    element = builder.vertices[key]
    assert isinstance(element, lumped.Spring | lumped.Damper)
    if element.domain and element.domain != own:
        message = f"{key} is one of {element.domain}, and {joint} moves by {own}"
        raise builder.reader.refuse(arc, message, hint=f"its '{word}' is in {units[DOMAINS.index(own)]} there")


def _with(dof: parts.Dof, element: object) -> parts.Dof:
    if isinstance(element, lumped.Damper):
        return replace(dof, damping=dof.damping + element.damping)
    assert isinstance(element, lumped.Spring)
    stiffness = dof.stiffness + element.stiffness
    moment = dof.stiffness * dof.spring_ref + element.stiffness * element.rest
    return replace(dof, stiffness=stiffness, spring_ref=moment / stiffness if stiffness else dof.spring_ref)


def remove_folded(builder: HymekoBuilder) -> None:
    """Remove the springs and dampers that have become part of joints and that no other edge leads to."""
    used = {arc.target for edge in builder.edges.values() for arc in edge.arcs}
    for key in builder.folded - used:
        del builder.vertices[key]
        builder.layout.remove(key)
