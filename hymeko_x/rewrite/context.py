"""What the user chose for the output, and what a rule is given besides the mechanism."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

from msgspec import Struct

from hymeko_x.source import NoFiles

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.source import Files, Package


class Options(Struct, frozen=True):
    """What the user chose for the output.

    ``base``: what becomes of an open base (None = it stays open). ``actuators``: which kind to give every driven dof, ``none`` to
    have none, None to keep those of the mechanism. Both belong to the robot from then on: `rewrite.choose`. ``layout`` and
    ``nested``: how a stage of USD is laid out (None = one file with flat bodies). ``split``: whether the macros of xacro
    go into a file of their own. ``keep``: where what the format cannot represent is kept: ``beside`` the output, or ``inside`` it.
    ``lenient``: whether errors are passed over. ``target``: the name of the program that the output is for, a row of `targets`.
    ``density`` in kg/m^3 and ``inertia_from``: the inertials that bodies without one get, where one of the two is given.
    ``collision``: what replaces concave meshes that collide: their convex hulls, or convex parts.
    ``sites``: whether frames on bodies are links of their own. ``mesh_prefix``: what stands before the paths of files beside the output;
    ``package://`` alone is the package in which the output lies.
    ``package_layout``: whether the output's folder is a model of Gazebo, which ``model://FOLDER`` finds.
    ``beside``: how files of our own that may stand beside the output begin, which is its own name; empty = there is no place.
    ``within``: the folder below the output's own that holds every file beside it, and ends in a slash; empty = each where it belongs.
    """

    base: Literal["fixed", "free"] | None = None
    actuators: Literal["none", "motor", "position", "velocity"] | None = None
    layout: Literal["single", "layered", "rep158"] | None = None
    nested: bool | None = None
    split: bool = False
    keep: Literal["beside", "inside"] | None = None
    lenient: bool = False
    beside: str = ""
    within: str = ""
    target: str | None = None
    density: float | None = None
    inertia_from: Literal["collision", "visual", "hull"] | None = None
    sites: bool | None = None
    mesh_prefix: str | None = None
    package_layout: bool = False
    collision: Literal["hull", "decompose"] | None = None


def _write_nothing(mechanism: Mechanism) -> Package:
    """Nothing, where a rule is used alone."""
    raise NotImplementedError(f"{mechanism.name} is rewritten without a format")


class Context(Struct, frozen=True):
    """The circumstances of one rewriting: the report of what is changed, the files around the robot, and the option that asks for it.

    ``write`` gives a mechanism as it would be written, for rules of targets that ask its engine.
    """

    report: Report
    files: Files = NoFiles()
    reason: str = ""
    write: Callable[[Mechanism], Package] = _write_nothing


Rule = Callable[["Mechanism", Context], "Mechanism"]
"""One step of rewriting. It reports every change, and applied again it changes nothing."""
