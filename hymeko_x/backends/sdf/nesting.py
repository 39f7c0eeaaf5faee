"""Models in models, found again in the names of a mechanism that came back from another format."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.formats import sdf as words
from hymeko_x.ir.mechanism import ROOT, WORLD
from hymeko_x.ir.parts import Coupling, Frame, Joint, Loop

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.ir.mechanism import Id, Mechanism


class ModelNesting(NamedTuple):
    """The frame of each model that is in another one, by the scope of its elements (``a::b::``), and what elements are connected to."""

    models: Mapping[str, Id]
    connected: Mapping[Id, list[Id]]

    def scope_of(self, key: Id) -> str:
        """The scope of the innermost model that an element is in by its name, together with all that it is connected to."""
        scope = words.split_scope(key.name)[0] if self.models else ""
        while scope and not (scope in self.models and all(_is_in(other, scope) for other in self.connected.get(key, ()))):
            scope = words.scope_around(scope)
        return scope


def nesting_of(mechanism: Mechanism) -> ModelNesting:
    """The models in models that names tell of.

    The frame of such a model is on a link of it, and the models around it have frames as well; other names with ``::`` are no models.
    """
    bodies = {view.mounted: view.body for views in mechanism.mounts.values() for view in views}
    frames = [(*words.split_scope(key.name), key) for key, _ in mechanism.vertices(Frame)]
    models: dict[str, Id] = {}
    for scope, own, key in sorted(frames):  # a model comes before those in it
        around = words.scope_around(scope)
        is_inside = bool(scope) and (not around or around in models)
        if own == words.MODEL_FRAME and is_inside and bodies.get(key, ROOT).name.startswith(scope):
            models[scope] = key
    return ModelNesting(models, _connected(mechanism, bodies) if models else {})


def _connected(mechanism: Mechanism, bodies: Mapping[Id, Id]) -> dict[Id, list[Id]]:
    """The links of joints and closures, the link that a frame is on, and the joints that are coupled to a joint."""
    found = {frame: [body] for frame, body in bodies.items()}
    for key, edge in mechanism.graph.edges.items():
        targets = [arc.target for arc in edge.arcs]
        if isinstance(edge.data, Joint | Loop):
            found.setdefault(key, []).extend(targets)
        elif isinstance(edge.data, Coupling):
            for target in targets:
                found.setdefault(target, []).extend(targets)
    return found


def _is_in(key: Id, scope: str) -> bool:
    return key == WORLD or key.name.startswith(scope)
