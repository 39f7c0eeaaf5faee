"""What programs expect of a stage as a whole: how time counts, what the asset is, and a physics scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.backends.usd.sheet import valid_name
from hymeko_x.formats import usd as words
from hymeko_x.formats.usd.articulations import ARTICULATION, moves
from hymeko_x.ir.mechanism import ROOT, Extra

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Context

_TIME = "#usda 1.0\n(\n    timeCodesPerSecond = 1\n)"
_SCENE = 'def PhysicsScene "physicsScene"\n{\n}'
"""Without numbers its gravity is that of the earth along the up axis."""


def _root(name: str, mechanism: Mechanism) -> str:
    """The robot's prim with all of its metadata, and with the articulation that the writer makes of a single tree."""
    schemas = f'    prepend apiSchemas = ["{ARTICULATION}"]\n' if moves(mechanism) and len(mechanism.roots) == 1 else ""
    asset = f'    assetInfo = {{\n        string identifier = "{name}"\n        string version = "1.0.0"\n    }}\n'
    shown = mechanism.name.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    display = f'    displayName = "{shown}"\n' if name != mechanism.name else ""
    return f'def Xform "{name}" (\n{schemas}{asset}{display}    kind = "component"\n)\n{{\n}}'


def follow_rep_158(mechanism: Mechanism, context: Context) -> Mechanism:
    """The stage has a layer for each concern and each engine, infinite limits, neutral couplings, and tensors as principal moments alone.

    Source: REP 158 (draft of 2026), 1.3 Joint Limits, Inertia Representation and Extended Physics, and 1.4.
    """
    own = mechanism.notations.get(ROOT, {})
    if own.get(words.PROFILE.name) == words.REP_158:
        return mechanism
    message = f"tensors are principal moments in single precision, and limits that joints do not have are infinite ({context.reason})"
    context.report.note(codes.FOR_TARGET, message)
    return replace(mechanism, notations={**mechanism.notations, ROOT: {**own, words.PROFILE.name: words.REP_158}})


def describe_stage(mechanism: Mechanism, context: Context) -> Mechanism:
    """One time code is one second, the asset has an identifier and a version, and there is a scene; for robots of other formats.

    Source: REP 158 (draft of 2026), 1.1 Time Metadata and 1.2.5 Asset Management.
    """
    own = mechanism.extras.get(ROOT, ())
    if any(extra.format == words.FORMAT for extra in own):
        return mechanism
    name = valid_name(mechanism.name)
    texts = {"/": _TIME, name: _root(name, mechanism), f"{name}/physicsScene": _SCENE}
    added = tuple(Extra(words.FORMAT, path, text) for path, text in texts.items())
    context.report.note(codes.FOR_TARGET, f"the stage has timeCodesPerSecond, assetInfo and a physics scene ({context.reason})")
    return replace(mechanism, extras={**mechanism.extras, ROOT: (*own, *added)})
