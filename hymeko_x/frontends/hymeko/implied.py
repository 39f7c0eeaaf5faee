"""Actuators of transmissions that nothing describes: the first arc of the drive names them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats.hymeko import TARGETS
from hymeko_x.formats.hymeko.implied import IMPLIED_ACTUATOR, TYPE
from hymeko_x.frontends.hymeko.builder import sign_of
from hymeko_x.language.syntax import ArcItem, is_field

if TYPE_CHECKING:
    from hymeko_x.frontends.hymeko.builder import HymekoBuilder
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.language.expansion import ExpandedElement


def imply_actuators(builder: HymekoBuilder, declared: list[tuple[Id, ExpandedElement]]) -> None:
    """Make the actuators that transmissions name and the text does not describe."""
    for key, element in declared:
        if key.kind != "drive" or not any(is_field(item, (TYPE,)) for item in element.node.items):
            continue
        first = next((item for item in element.node.items if isinstance(item, ArcItem)), None)
        if first is None or first.role or sign_of(first) <= 0 or builder.find(first.ref, element.scope, TARGETS["drive"]) is not None:
            continue
        name = element.scope.define(first.ref.path)
        if name is not None:
            builder.vertices[builder.reserve("actuator", name, first)] = IMPLIED_ACTUATOR
