"""<link>: pose, inertial, visuals, collisions, sensors and lights."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.sdf.sensors import light_tag, sensor_tag
from hymeko_x.backends.sdf.shapes import shape_tag
from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations
from hymeko_x.formats.sdf.notations import WrittenPose
from hymeko_x.formats.sdf.values import NUMBER, TENSOR, BadText, ValueField, read_pose
from hymeko_x.ir.digits import numbers_text
from hymeko_x.ir.mechanism import WORLD
from hymeko_x.ir.parts import Body, Inertial, Light
from hymeko_x.ir.solids import solid_of_colliders
from hymeko_x.ir.values import IDENTITY, Pose, rotate_tensor, rpy_of
from hymeko_x.xml.printing import Tag

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.backends.sdf.sheet import SdfSheet
    from hymeko_x.ir.mechanism import Id
    from hymeko_x.ir.values import Tensor

_MASS = ValueField("mass", "mass", NUMBER, 1.0)
_NEW_MASS, *_NEW_TENSOR = [field._replace(default=None) if field.default else field for field in (_MASS, *TENSOR)]
"""Mass and moments are always written, unless the author of an SDF file left them out; products of zero never."""
_DEFAULT = Inertial(1.0, tensor=(1.0, 1.0, 1.0, 0.0, 0.0, 0.0))


def link_tag(key: Id, scope: str, sheet: SdfSheet) -> Tag:
    """The <link> of a body, where its parent joint is, or in the model."""
    tag = Tag("link", {"name": sheet.name(key, scope)})
    above = sheet.mechanism.parent_joint.get(key)
    base = None
    if above is not None and not sheet.is_implied(above) and above.id.name.startswith(scope) and above.parent != WORLD:
        base = above.id
    sheet.add_pose(tag, key, scope, sheet.places.model_frame(scope), base)
    computed = _is_computed(key, sheet)
    if not computed:
        _add_inertial(tag, key, sheet)
    counts: dict[str, int] = {}
    for name, role in words.ROLES.items():
        for view in sheet.mechanism.shapes.get(key, ()):
            if view.shape.role is role:
                counts[name] = counts.get(name, 0) + 1
                tag.children.append(shape_tag(view, name, counts[name], scope, sheet))
    for mount in sheet.mechanism.mounts.get(key, ()):
        if isinstance(sheet.mechanism.graph.vertices.get(mount.mounted), Light):
            tag.children.append(light_tag(mount, scope, key, sheet))
        elif sheet.is_sensor(mount.mounted):
            tag.children.append(sensor_tag(mount, scope, key, sheet))
    sheet.put_back(tag, key, "" if computed else "<inertial")
    return tag


def _is_computed(key: Id, sheet: SdfSheet) -> bool:
    """Whether the inertial still is that of the collisions, which the text of the author then says."""
    inertial = sheet.mechanism.vertex(key, Body).inertial
    if not sheet.mechanism.notation(key, notations.AUTO):
        return False
    found = solid_of_colliders(sheet.mechanism.shapes.get(key, ()), words.DENSITY)
    if found is None or inertial is None or inertial.mass is None or inertial.tensor is None:
        return inertial is None
    scale = inertial.mass / found.mass
    return all(abs(a * scale - b) <= 1e-9 * abs(b) + 1e-15 for a, b in zip(found.tensor, inertial.tensor, strict=True))


def _add_inertial(link: Tag, key: Id, sheet: SdfSheet) -> None:
    inertial = sheet.mechanism.vertex(key, Body).inertial
    if inertial is None or (inertial == _DEFAULT and sheet.mechanism.notation(key, notations.NO_INERTIAL)):
        return
    texts = sheet.written(key)
    tag = link.add("inertial")
    frame, tensor = _as_written(inertial)
    _add_pose(tag, frame, texts)
    mass = 1.0 if inertial.mass is None else inertial.mass
    sheet.put(tag, _MASS if sheet.from_sdf else _NEW_MASS, mass, texts, "inertial/")
    sheet.put_all(tag, "inertia", zip(TENSOR if sheet.from_sdf else _NEW_TENSOR, tensor, strict=True), texts, "inertial/")


def _as_written(inertial: Inertial) -> tuple[Pose, Tensor]:
    """The frame and the tensor in it, as the author gave them where they still mean the same."""
    tensor = inertial.tensor or (1.0, 1.0, 1.0, 0.0, 0.0, 0.0)
    own = inertial.written
    if own is not None and own.frame.xyz == inertial.com and rotate_tensor(own.frame.quat, own.tensor) == tensor:
        return own.frame, own.tensor
    return Pose(inertial.com), tensor


def _add_pose(inertial: Tag, frame: Pose, texts: Mapping[str, str]) -> None:
    marks = {name: texts[f"inertial/pose/@{name}"] for name in ("rotation_format", "degrees") if f"inertial/pose/@{name}" in texts}
    own = texts.get("inertial/pose")
    try:
        kept = own is not None and read_pose(WrittenPose(None, marks.get("rotation_format"), marks.get("degrees"), own)) == frame
    except BadText:
        kept = False
    if kept and own is not None:
        inertial.add("pose", **marks).children.append(own)
    elif frame != IDENTITY:
        inertial.add("pose").children.append(numbers_text((*frame.xyz, *rpy_of(frame))))
