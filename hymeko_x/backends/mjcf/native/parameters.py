"""Parameters as attributes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.formats.mjcf.codec import parameter_text, parameter_value

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.parts import Parameters


def parameter_attributes(parameters: Parameters, base: Mapping[str, str]) -> dict[str, str]:
    """The parameters that say something else than the class."""
    return {name: parameter_text(value) for name, value in parameters if name not in base or parameter_value(name, base[name]) != value}
