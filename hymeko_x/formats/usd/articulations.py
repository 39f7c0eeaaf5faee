"""The API of a stage by which joints are one articulation, in a robot that got its first joint or lost its last one."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.formats import usd as words
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.notations import flag
from hymeko_x.ir.parts import DofKind

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Extra, Mechanism

ARTICULATION = "PhysicsArticulationRootAPI"
BEGUN = flag("usd.begun")
"""The notation of the mechanism of a stage that had no joints that move, and got some: the writer makes an articulation of them."""

_ONLY = re.compile(rf'\n *(?:prepend )?apiSchemas = \["{ARTICULATION}"\]')
_AMONG = re.compile(rf'"{ARTICULATION}", |, "{ARTICULATION}"')


def moves(mechanism: Mechanism) -> bool:
    """Whether some joint has degrees of freedom; a floating base has none in a stage."""
    return any(dof.kind is not DofKind.FREE for view in mechanism.joints.values() for dof in view.joint.dofs)


def fit_articulation(changed: Mechanism, source: Mechanism) -> Mechanism:
    """The changed mechanism without the author's articulations if nothing moves any more, and with one if something moves now."""
    if moves(changed) == moves(source):
        return changed
    own = changed.notations.get(ROOT, {})
    if moves(changed):
        noted = {**own, BEGUN.name: "true"} if words.ROOT_PRIM.name in own else own
        return replace(changed, notations={**changed.notations, ROOT: noted}) if noted is not own else changed
    return replace(changed, extras={key: tuple(map(_at_rest, found)) for key, found in changed.extras.items()})


def _at_rest(extra: Extra) -> Extra:
    """The extra without the API of articulations."""
    if extra.format != words.FORMAT or ARTICULATION not in extra.text:
        return extra
    return replace(extra, text=_AMONG.sub("", _ONLY.sub("", extra.text)))
