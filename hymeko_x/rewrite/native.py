"""What only MuJoCo knows, for every other format."""

from __future__ import annotations

import math
import re
from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.ir.parts import Actuator, Camera, DofKind, NoShape

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Extra, Id, Mechanism
    from hymeko_x.rewrite.context import Context


_MENDS = ("balanceinertia", "boundinertia")


def is_native(mechanism: Mechanism) -> bool:
    """Whether a mechanism came from MJCF: directly, through HyMeKo text, or carried by another file."""
    return mechanism.source.format == "mjcf"


def engine_mends_inertias(mechanism: Mechanism) -> bool:
    """Whether the file tells MuJoCo to repair inertias that it would refuse otherwise."""
    return compiler_says(mechanism, _MENDS)


def someone_says(mechanism: Mechanism, word: str) -> bool:
    """Whether an element or a class has an attribute of this name, as far as can be told without printing."""
    return any(word in extra.path or word in extra.text for own in mechanism.extras.values() for extra in own)


def compiler_says(mechanism: Mechanism, names: Iterable[str]) -> bool:
    """Whether a <compiler> of the file has one of these attributes."""
    return any(f"{name}=" in text for text in compilers(mechanism) for name in names)


def compilers(mechanism: Mechanism) -> list[str]:
    """The <compiler> elements of the file that a mechanism came from, verbatim."""
    return [extra.text for extra in mechanism.extras.get(ROOT, ()) if extra.format == "mjcf" and extra.text.startswith("<compiler")]


def is_shape_of_mujoco(mechanism: Mechanism, shape: Id) -> bool:
    """Whether a shape without a geometry has one in MJCF: a height field, a distance function, a primitive fitted to a mesh."""
    said = any(extra.format == "mjcf" for extra in mechanism.extras.get(shape, ()))
    return is_native(mechanism) and (said or mechanism.notation(shape, "@type") is not None)


def drop_shapes_of_mujoco(mechanism: Mechanism, context: Context) -> Mechanism:
    """Height fields, distance functions, and primitives that MuJoCo fits to meshes have no word elsewhere."""
    if not is_native(mechanism):
        return mechanism
    gone = [view.id for view in mechanism.every_shape() if isinstance(view.shape.geometry, NoShape)]
    for key in gone:
        said = f"{key} has a geometry that only MuJoCo knows; it is left out"
        context.report.warn(codes.NOT_SAID, said, mechanism.origin(key), element=str(key))
    return mechanism.with_graph(mechanism.graph.replace(without=gone)) if gone else mechanism


_FOVY = math.radians(45.0)


def say_what_cameras_see(mechanism: Mechanism, _context: Context) -> Mechanism:
    """A camera in MJCF that says nothing of its lens sees 45 degrees from top to bottom; elsewhere that is not understood."""
    if not is_native(mechanism):
        return mechanism
    cameras = {key: replace(camera, fovy=_FOVY) for key, camera in mechanism.vertices(Camera) if _has_usual_lens(camera)}
    return mechanism.with_graph(mechanism.graph.replace(vertices=cameras)) if cameras else mechanism


def _has_usual_lens(camera: Camera) -> bool:
    """Whether a camera of MJCF says nothing of what it sees."""
    said = dict(camera.parameters)
    return camera.fovy is None and not {"focal", "focalpixel"} & said.keys() and said.get("projection") != "orthographic"


_COORDINATES: Mapping[DofKind, tuple[int, int]] = MappingProxyType({DofKind.FREE: (7, 6), DofKind.BALL: (4, 3)})
"""How many numbers place a dof, and how many say how fast it moves; one of each for all others."""
_KEY = re.compile(r"<key\b[^>]*?/>|<key\b.*?</key>", re.DOTALL)
_NUMBERS = re.compile(r'\b(qpos|qvel|ctrl)="([^"]*)"')


def drop_stale_keyframes(mechanism: Mechanism, context: Context) -> Mechanism:
    """Keyframes that go along verbatim fit as long as nobody adds or removes a joint or an actuator; MuJoCo refuses others."""
    own = mechanism.extras.get(ROOT, ())
    if any("<flex" in extra.text or "<composite" in extra.text for extra in own) or not any(_is_keyframes(extra) for extra in own):
        return mechanism  # soft bodies have coordinates of their own, which are not counted here
    kinds = [dof.kind for view in mechanism.joints.values() for dof in view.joint.dofs]
    counts = {
        "qpos": sum(_COORDINATES.get(kind, (1, 1))[0] for kind in kinds),
        "qvel": sum(_COORDINATES.get(kind, (1, 1))[1] for kind in kinds),
        "ctrl": sum(1 for _ in mechanism.vertices(Actuator)),
    }
    kept = tuple(_with_fitting_keys(extra, counts, context.report) if _is_keyframes(extra) else extra for extra in own)
    return mechanism if kept == own else replace(mechanism, extras={**mechanism.extras, ROOT: kept})


def _is_keyframes(extra: Extra) -> bool:
    return extra.format == "mjcf" and extra.text.startswith("<keyframe")


def _with_fitting_keys(extra: Extra, counts: dict[str, int], report: Report) -> Extra:
    def fitting(found: re.Match[str]) -> str:
        for name, numbers in _NUMBERS.findall(found[0]):
            if len(numbers.split()) != counts[name]:
                said = f"a keyframe has {len(numbers.split())} numbers in {name}, and the robot has {counts[name]}; it is left out"
                report.warn(codes.NOT_SAID, said)
                return ""
        return found[0]

    return replace(extra, text=_KEY.sub(fitting, extra.text))
