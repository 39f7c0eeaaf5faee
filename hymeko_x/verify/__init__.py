"""The verifier: do two files describe the same robot, as the formats' own engines see them?

No engine of this project takes part where a reference reader exists (URDF, xacro, MJCF, USD, SDF). HyMeKo text and mechanisms
in memory have no other reader; verdicts about them note that.
"""

from __future__ import annotations

import sys
from functools import partial
from os import PathLike
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from hymeko_x import codes
from hymeko_x.diagnostics import Refusal

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.ir.holder import Holder
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.verify.meshes import Meshes
    from hymeko_x.verify.model import KinematicModel
    from hymeko_x.verify.verdict import Verdict

    Packages = Mapping[str, str | PathLike[str]]
    Robot = str | PathLike[str] | Mechanism | Holder | KinematicModel


def verify(
    a: Robot,
    b: Robot,
    *,
    samples: int = 100,
    seed: int = 0,
    structure: bool = False,
    joints: bool = False,
    rename: Mapping[str, str] | None = None,
    meshes: bool | Meshes = True,
    packages: Packages | None = None,
    search_path: tuple[Path, ...] = (),
    arguments: Mapping[str, str] | None = None,
    variants: Mapping[str, str] | None = None,
) -> Verdict:
    """Whether two robots (files, mechanisms or models) are the same one.

    They are compared at the zero pose, at their limits and at ``samples`` random configurations drawn with ``seed``. Bodies
    are matched by name, or with ``structure`` by the shape of the tree. With ``joints`` the robots are compared as their joints
    see them: bodies that are fixed to each other are one, known by the joint above it, wherever their frames are; ``rename`` gives joints
    other names first (:func:`hymeko_x.verify.groups.grouped`). Without ``meshes`` no mesh file is read, which takes
    most of the time; one reader of meshes in several verdicts reads each file once. ``packages`` are the folders of
    ``package://NAME``, ``search_path`` those with further packages, ``arguments`` the values of a file's macro arguments,
    ``variants`` the variant to select of each variant set, in every file that has the set.

    Raises: Refusal HX001, HX003 or HX301 when a file is not there, its format unknown or its engine not installed, HX040
    when a variant set has no such variant. A file that its engine refuses makes the verdict "not comparable".
    """
    from hymeko_x.verify.checks import compare
    from hymeko_x.verify.verdict import Verdict

    read = partial(model_of, packages=packages, search_path=search_path, arguments=arguments, variants=variants)
    models, reasons = _read((a, b), read)
    if reasons:
        return Verdict(("", ""), reason="; ".join(dict.fromkeys(reasons)))
    if joints:
        from hymeko_x.verify.groups import grouped

        models = [grouped(model, rename) for model in models]
    return compare(models[0], models[1], samples=samples, seed=seed, structure=structure, meshes=meshes)


def _read(robots: tuple[Robot, Robot], read: Callable[[Robot], KinematicModel]) -> tuple[list[KinematicModel], list[str]]:
    """The robots as models, and why engines refuse those that are missing."""
    models: list[KinematicModel] = []
    reasons: list[str] = []
    for robot in robots:
        try:
            models.append(read(robot))
        except Refusal as refusal:
            if refusal.diagnostic.code != codes.ENGINE_REFUSED:
                raise
            reasons.append(str(refusal.diagnostic.message))
    return models, reasons


def model_of(
    robot: Robot,
    *,
    packages: Packages | None = None,
    search_path: tuple[Path, ...] = (),
    arguments: Mapping[str, str] | None = None,
    variants: Mapping[str, str] | None = None,
) -> KinematicModel:
    """A robot as its reference engine sees it; a mechanism in memory as it is, a robot in memory with the masses that its engine computes.

    Raises: Refusal, as :func:`verify`, and HX302 when the engine refuses the file.
    """
    from hymeko_x.verify.model import KinematicModel

    if isinstance(robot, KinematicModel):
        return robot
    if not isinstance(robot, str | PathLike):
        from hymeko_x.ir.holder import completed_of
        from hymeko_x.verify.readers.hymeko import from_mechanism

        return from_mechanism(completed_of(robot))
    from hymeko_x.verify.readers import read
    from hymeko_x.verify.readers.lookup import Lookup

    folders = {name: Path(folder) for name, folder in (packages or {}).items()}
    return read(Path(robot), Lookup(folders, search_path, arguments or {}, variants or {}))


class _Callable(ModuleType):
    """``hymeko_x.verify`` is this package and the function of the public API at once."""

    def __call__(self, a: Robot, b: Robot, **options: Any) -> Verdict:
        return verify(a, b, **options)


sys.modules[__name__].__class__ = _Callable
