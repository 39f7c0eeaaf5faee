"""A model of nothing but the bodies that MuJoCo has to weigh, where their shapes are all that counts for it.

MuJoCo gets a few bodies of plain solids, each on its own, instead of the whole robot: what a body weighs in its own frame does
not depend on where it is nor on what hangs on it. Wherever something else may count, there is no such model.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x.formats.mjcf.places import PLACE, Place
from hymeko_x.formats.mjcf.tree import parse_text
from hymeko_x.formats.mjcf.words import NAME
from hymeko_x.ir.parts import Box, Capsule, Cylinder, Ellipsoid, Sphere
from hymeko_x.rewrite.native import compilers, someone_says

if TYPE_CHECKING:
    from hymeko_x.formats.mjcf.codec import Settings
    from hymeko_x.ir.mechanism import Id, Mechanism, ShapeView

_SOLIDS = (Box, Capsule, Cylinder, Ellipsoid, Sphere)
_FREE = frozenset(
    (
        *("angle", "eulerseq", "autolimits", "coordinate", "meshdir", "texturedir", "assetdir", "strippath", "convexhull", "fitaabb"),
        *("discardvisual", "fusestatic", "alignfree", "usethread", "saveinertial", "LRopt"),
    )
)
"""Attributes of <compiler> under which a body of solids weighs what it weighs without them, or which the text here heeds."""
_PLACED = frozenset((*(f"@{name}" for name in PLACE.names), "frame"))
"""The notations of a shape that is placed in words of its author's which only the writer of the whole model knows."""


def can_be_lean(mechanism: Mechanism, bodies: list[Id]) -> bool:
    """Whether nothing but their own solids counts for what these bodies of a mechanism from MJCF weigh, and where they stand is known."""
    if not all(_is_free(parse_text(text).attributes) for text in compilers(mechanism)) or someone_says(mechanism, "shellinertia"):
        return False
    reached = set(mechanism.depth_first())
    return all(key in reached and _is_solid(mechanism, key) for key in bodies)


def lean_model(mujoco: Any, mechanism: Mechanism, bodies: list[Id], settings: Settings) -> Any:
    """MuJoCo's model of these bodies in this order, each a child of the world with nothing but its solids, placed as their author did.

    ``settings`` are those of the mechanism's <compiler>.

    Raises: ValueError or mujoco.FatalError when MuJoCo refuses it.
    """
    spec = mujoco.MjSpec()
    spec.compiler.degree = settings.degree
    for place, axis in enumerate(settings.eulerseq):
        spec.compiler.eulerseq[place] = axis
    for key in bodies:
        body = spec.worldbody.add_body()
        for view in mechanism.shapes[key]:
            body.add_geom(**_geom(mujoco, view, settings))
    return spec.compile()


def _is_free(said: dict[str, str]) -> bool:
    """Whether a <compiler> says nothing but what leaves the weight of solids as it is."""
    return said.get("inertiafromgeom", "auto") in ("auto", "true") and _FREE.issuperset(said.keys() - {"inertiafromgeom"})


def _is_solid(mechanism: Mechanism, body: Id) -> bool:
    """Whether a body has nothing but solids whose places the parts say, and no element inside that only MuJoCo knows."""
    return not _has_elements(mechanism, body) and all(
        isinstance(view.shape.geometry, _SOLIDS)
        and _PLACED.isdisjoint(mechanism.notations.get(view.id, ()))
        and not _has_elements(mechanism, view.id)
        for view in mechanism.shapes[body]
    )


def _has_elements(mechanism: Mechanism, key: Id) -> bool:
    return any(extra.format == NAME and extra.text.startswith("<") for extra in mechanism.extras.get(key, ()))


def _geom(mujoco: Any, view: ShapeView, settings: Settings) -> dict[str, Any]:
    said = PLACE.write(Place(view.shape.geometry, view.pose), settings)
    found: dict[str, Any] = {"type": getattr(mujoco.mjtGeom, f"mjGEOM_{said.pop('type').upper()}")}
    found |= {name: [float(number) for number in text.split()] for name, text in said.items()}
    found["size"] += [0.0] * (3 - len(found["size"]))
    if view.shape.mass is not None:
        found["mass"] = view.shape.mass
    if view.shape.density is not None:
        found["density"] = view.shape.density
    return found
