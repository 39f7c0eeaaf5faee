"""HyMeKo text, by this project's own reader: there is no other. The verdict says so.

What came from MJCF may leave inertias to the shapes; they are what MuJoCo computes, as for every export of such a text.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.backends import mjcf
from hymeko_x.diagnostics import Origin, Refusal, Report, refuse
from hymeko_x.formats import native_format
from hymeko_x.frontends import hymeko
from hymeko_x.frontends.mjcf.complete import complete
from hymeko_x.ir.parts import Body
from hymeko_x.rewrite.context import Options
from hymeko_x.source import Source
from hymeko_x.verify.readers.mechanism import from_mechanism

if TYPE_CHECKING:
    from pathlib import Path

    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.source import Files
    from hymeko_x.verify.model import KinematicModel
    from hymeko_x.verify.readers import Places


def read(path: Path, places: Places) -> KinematicModel:
    """The robot that the text describes. Raises: Refusal HX302 when it cannot be read."""
    try:
        files = places.files(path.parent)
        mechanism = hymeko.read(Source(str(path), path.read_bytes(), files), Report()).mechanism
    except Refusal as refusal:
        raise refuse(codes.ENGINE_REFUSED, f"the HyMeKo text cannot be read: {refusal.diagnostic}", Origin(str(path))) from refusal
    if next(mechanism.vertices(Body), None) is None:
        raise refuse(codes.ENGINE_REFUSED, "the HyMeKo text describes a hypergraph without bodies, which is no robot", Origin(str(path)))
    if native_format(mechanism):
        mechanism = _weighed(mechanism, files)
    return from_mechanism(mechanism, format="hymeko")


def _weighed(mechanism: Mechanism, files: Files) -> Mechanism:
    """What came from MJCF, with what only MuJoCo knows."""
    return complete(mechanism, lambda: (mechanism, mjcf.write(mechanism, Options(), Report()).main), files, Report())
