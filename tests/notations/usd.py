"""The same stage written otherwise: the operations that place prims, which axis is up, the order of prims."""

from __future__ import annotations

from random import Random

from pxr import Gf, Usd, UsdGeom, UsdPhysics

_PLACED = ("xformOp:translate", "xformOp:orient")


def otherwise(text: str, chance: Random) -> str:
    """Another text of the same robot."""
    stage = Usd.Stage.CreateInMemory()
    stage.GetRootLayer().ImportFromString(text)
    for prim in list(stage.Traverse()):
        _place(prim, chance)
    for prim in [stage.GetPseudoRoot(), *stage.Traverse()]:
        names = [child.GetName() for child in prim.GetChildren()]
        chance.shuffle(names)
        if len(names) > 1:
            prim.SetChildrenReorder(names)
    if chance.random() < 0.5:
        _lay_down(stage)
    return str(stage.GetRootLayer().ExportToString())


def _place(prim: Usd.Prim, chance: Random) -> None:
    """The same translation and rotation by a matrix, by angles, or in several steps."""
    if not all(prim.HasAttribute(name) for name in _PLACED):
        return
    translation, quat = (prim.GetAttribute(name).Get() for name in _PLACED)
    turn = Gf.Rotation(Gf.Quatd(quat.GetReal(), Gf.Vec3d(*quat.GetImaginary())))
    form = UsdGeom.Xformable(prim)
    rest = [op for op in form.GetOrderedXformOps() if op.GetOpName() not in _PLACED]
    way = chance.choice(["as it is", "matrix", "angles", "steps"])
    if way == "as it is":
        return
    for name in _PLACED:
        prim.RemoveProperty(name)
    form.ClearXformOpOrder()
    if way == "matrix":
        made = [form.AddTransformOp()]
        made[0].Set(Gf.Matrix4d(turn, Gf.Vec3d(*translation)))
    elif way == "angles":
        made = [form.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble), form.AddRotateZYXOp(UsdGeom.XformOp.PrecisionDouble)]
        made[0].Set(Gf.Vec3d(*translation))
        x, y, z = turn.Decompose(Gf.Vec3d.XAxis(), Gf.Vec3d.YAxis(), Gf.Vec3d.ZAxis())
        made[1].Set(Gf.Vec3d(x, y, z))
    else:
        made = [form.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble, name) for name in ("one", "other")]
        made.append(form.AddOrientOp(UsdGeom.XformOp.PrecisionDouble, "turn"))
        for op in made[:2]:
            op.Set(Gf.Vec3d(*translation) / 2.0)
        made[2].Set(turn.GetQuat())
    form.SetXformOpOrder([*made, *rest])


def _lay_down(stage: Usd.Stage) -> None:
    """y is up, and the robot turned so that its own z axis still is, with what holds it in the world."""
    down = Gf.Rotation(Gf.Vec3d.XAxis(), -90.0)
    for prim in stage.Traverse():
        joint = UsdPhysics.Joint(prim)
        if joint and not joint.GetBody0Rel().GetTargets():
            local = Gf.Rotation(Gf.Quatd(joint.GetLocalRot0Attr().Get()))
            joint.GetLocalRot0Attr().Set(Gf.Quatf((local * down).GetQuat()))
            joint.GetLocalPos0Attr().Set(Gf.Vec3f(down.TransformDir(Gf.Vec3d(joint.GetLocalPos0Attr().Get()))))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    form = UsdGeom.Xformable(stage.GetDefaultPrim())
    op = form.AddRotateXOp(UsdGeom.XformOp.PrecisionDouble, "upright")
    op.Set(-90.0)
    form.SetXformOpOrder([op, *(other for other in form.GetOrderedXformOps() if other.GetOpName() != op.GetOpName())])
