"""The models of a world with several, and what is in none of them: in such a world all links are in models.

Source: sdformat, world.sdf and libsdformat's World, which have models, joints and frames, and no links.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.ir.mechanism import ROOT, Id
from hymeko_x.ir.names import rename

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Context


def put_bodies_into_models(mechanism: Mechanism, context: Context) -> Mechanism:
    """In a world of several models every body is in one; what joins bodies of one model is in that as well."""
    renamed = in_models(mechanism, mechanism)
    for old, new in renamed.items():
        message = f"{old} is written as '{new.name}': in a world of several models all links are in models"
        context.report.note(codes.RENAMED, message, mechanism.origin(old), element=str(new))
    return rename(mechanism, renamed)


def in_models(mechanism: Mechanism, original: Mechanism) -> dict[Id, Id]:
    """The names that bodies, joints and closures without a model have in a file with the models of ``original``, by their ids.

    A body goes into the model whose frame is on it, else into that of the body above it, else into one of its own name.
    """
    if original.notation(ROOT, notations.SEVERAL) is None:
        return {}
    scopes = _scopes(mechanism)
    renamed = {body: _in(scope, body) for body, scope in scopes.items() if not _is_in_model(body)}
    for key, edge in mechanism.graph.edges.items() if renamed else ():
        around = {scopes[arc.target] for arc in edge.arcs if arc.target in scopes}
        if key.kind in ("joint", "loop") and not _is_in_model(key) and len(around) == 1:
            renamed[key] = _in(around.pop(), key)
    return renamed


def _scopes(mechanism: Mechanism) -> dict[Id, str]:
    """The scope of the model of each body."""
    elements = [(view.body, *words.split_scope(view.mounted.name)) for views in mechanism.mounts.values() for view in views]
    of_frames = {body: scope for body, scope, own in elements if own == words.MODEL_FRAME}
    found: dict[Id, str] = {}
    for body in mechanism.depth_first():
        above = mechanism.parent_joint.get(body)
        of_parent = "" if above is None else found.get(above.parent, "")
        found[body] = words.split_scope(body.name)[0] or of_frames.get(body) or of_parent or f"{body.name}{words.SCOPE}"
    return found


def _is_in_model(key: Id) -> bool:
    return words.SCOPE in key.name


def _in(scope: str, key: Id) -> Id:
    return Id(key.kind, words.scoped(scope, key.name))
