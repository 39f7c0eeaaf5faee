"""Prints a legal mechanism as MJCF for MuJoCo 4.0: radians, named elements, the sections in their usual order.

Everything that MJCF cannot say was rewritten by `ir.legalize` for the target ``mjcf``, and `assets.pack` gave every
mesh and texture a relative path; nothing is decided here.
"""

from __future__ import annotations

from itertools import count
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.backends.mjcf.assets import write_assets
from hymeko_x.backends.mjcf.bodies import write_worldbody
from hymeko_x.backends.mjcf.classes import write_defaults
from hymeko_x.backends.mjcf.names import printed_names
from hymeko_x.backends.mjcf.relations import write_actuators, write_contacts, write_equalities
from hymeko_x.backends.mjcf.tendons import write_tendons
from hymeko_x.backends.mjcf.text import Text
from hymeko_x.formats import carrier
from hymeko_x.rewrite.native import is_native
from hymeko_x.source import Package
from hymeko_x.xml.text import escaped

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Options


def write(mechanism: Mechanism, options: Options, report: Report) -> Package:
    """The MJCF of the mechanism. Files that it refers to are not part of it: `assets.pack` returns them."""
    del options, report
    if is_native(mechanism):
        from hymeko_x.backends.mjcf.native import write_native

        return write_native(mechanism)
    names = printed_names(mechanism)
    text = Text()
    text.open("mujoco", {"model": mechanism.name or None})
    text.leaf("compiler", {"angle": "radian", "autolimits": "true"})
    place, defaults = text.place, Text()
    for section in (write_assets, write_worldbody, write_contacts, write_equalities, write_tendons, write_actuators):
        section(text, mechanism, names)
    write_defaults(defaults, text.leaves)
    text.insert(place, defaults)
    text.close()
    return Package(text.bytes())


def carry_residue(package: Package, text: str) -> Package:
    """The package with a residue in its file: the data of texts that mean nothing to MuJoCo."""
    names = (f"{carrier.MJCF_NAME}{number or ''}" for number in count())
    texts = [f'    <text name="{name}" data="{escaped(part)}"/>\n' for name, part in zip(names, carrier.parts(text), strict=False)]
    markup = f"  <custom>\n{''.join(texts)}  </custom>\n"
    return replace(package, main=carrier.inserted(package.main, markup))
