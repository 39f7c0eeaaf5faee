"""What only MuJoCo knows, for every other format."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.parts import NoShape

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.legalize import Options
    from hymeko_x.ir.mechanism import Mechanism


def drop_shapes_of_mujoco(mechanism: Mechanism, options: Options, report: Report) -> Mechanism:
    """Height fields, distance functions, and primitives that MuJoCo fits to meshes have no word elsewhere."""
    del options
    if mechanism.notation(ROOT, "mjcf") is None:
        return mechanism
    gone = [view.id for views in mechanism.shapes.values() for view in views if isinstance(view.shape.geometry, NoShape)]
    for key in gone:
        said = f"{key} has a geometry that only MuJoCo knows; it is left out"
        report.warn(codes.NOT_SAID, said, mechanism.origin(key), element=str(key))
    return mechanism.with_graph(mechanism.graph.replace(without=gone)) if gone else mechanism
