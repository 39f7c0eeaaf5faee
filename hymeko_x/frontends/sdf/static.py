"""What other formats need to know of a robot from SDF: what static models hold, what closures join, and inertials as numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.formats.sdf.values import TRUTH, BadText
from hymeko_x.frontends.sdf.anchors import without_anchors
from hymeko_x.frontends.sdf.inertials import with_computed_inertials
from hymeko_x.ir.mechanism import ROOT, Id
from hymeko_x.ir.parts import Frame, Joint

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism, RobotEdge
    from hymeko_x.source import Files


def complete(mechanism: Mechanism, _printed: Callable[[], tuple[Mechanism, bytes]], files: Files, report: Report) -> Mechanism:
    """The mechanism in which joints of static models are fixed, as simulators of SDF hold them, and closures have no links of their own.

    Inertials that come from meshes are computed.
    """
    mechanism = with_computed_inertials(without_anchors(mechanism), files, report)
    static = _static_scopes(mechanism)
    edges: dict[Id, RobotEdge] = {}
    for key, view in mechanism.joints.items() if static else ():
        if view.joint.dofs and _is_within(words.split_scope(key.name)[0], static):
            edges[key] = replace(mechanism.graph.edges[key], data=Joint())
            message = f"{key} is in a static model, in which nothing moves; it is written as fixed"
            report.note(codes.REWRITTEN, message, mechanism.origin(key), element=str(key))
    return mechanism.replace(edges=edges)


def _static_scopes(mechanism: Mechanism) -> set[str]:
    """The scopes of the models that are static by themselves."""
    models = [("", ROOT), *((words.split_scope(key.name)[0], key) for key, _ in mechanism.vertices(Frame) if _is_model(key))]
    return {scope for scope, key in models if _says_static(mechanism, key)}


def _is_model(key: Id) -> bool:
    return words.split_scope(key.name)[1] == words.MODEL_FRAME


def _says_static(mechanism: Mechanism, key: Id) -> bool:
    text = (mechanism.notation(key, notations.WRITTEN) or {}).get("static", "false")
    try:
        return bool(TRUTH.read(text))
    except BadText:
        return False


def _is_within(scope: str, static: set[str]) -> bool:
    """Whether a model or one around it is static."""
    while scope not in static:
        if not scope:
            return False
        scope = words.scope_around(scope)
    return True
