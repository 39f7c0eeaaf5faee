"""Between legalizing and printing: every mesh and texture gets the path under which the output refers to it.

What lies beside the output is returned as bytes or as the path to copy from; the mechanism that comes back names it by
relative paths with forward slashes. File names are built here from what is harmless in the source's names, so that
no output ever leads out of its folder.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal

from hymeko_x.assets.refer import Keep, keep_references
from hymeko_x.assets.shelf import Shelf
from hymeko_x.frozen import frozen
from hymeko_x.ir.mechanism import ROOT
from hymeko_x.rewrite import WITHIN
from hymeko_x.rewrite.native import is_native

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.source import Files

Mode = Literal["copy", "reference"]
Packer = Callable[["Mechanism", Shelf, "Files", "Report"], "Mechanism"]


@frozen
class Policy:
    """What a target does with files: its own default, and how it packs in either mode."""

    default: Mode
    copy: Packer
    reference: Packer


def _packer(module: str, name: str) -> Packer:
    found: Packer = getattr(import_module(module), name)
    return found


def _keeping(keep: Keep) -> Packer:
    return lambda mechanism, shelf, files, report: keep_references(mechanism, shelf, files, report, keep)


def _for_mujoco(mechanism: Mechanism, shelf: Shelf, files: Files, report: Report) -> Mechanism:
    if not is_native(mechanism) and not any(mechanism.assets()):
        return mechanism
    return _packer("hymeko_x.backends.mjcf.files", "pack_for_mujoco")(mechanism, shelf, files, report)


def _for_usd(mechanism: Mechanism, shelf: Shelf, files: Files, report: Report) -> Mechanism:
    return _packer("hymeko_x.backends.usd.files", "pack_for_usd")(mechanism, shelf, files, report)


_TEXT = Policy("reference", copy=_keeping(Keep.NOTHING), reference=_keeping(Keep.PACKAGES))
_ROS = Policy("copy", copy=_keeping(Keep.PACKAGES_AND_PATHS), reference=_keeping(Keep.PACKAGES))
_USD = Policy("copy", copy=_for_usd, reference=_for_usd)

POLICIES: Mapping[str, Policy] = MappingProxyType(
    {
        "hymeko": _TEXT,
        "mjcf": Policy("copy", copy=_for_mujoco, reference=_for_mujoco),
        "urdf": _ROS,
        "usd": _USD,
        "usdc": _USD,
        "usdz": _USD,
        "xacro": _ROS,
    }
)


def pack(
    mechanism: Mechanism, target: str, files: Files, mode: Mode | None, report: Report, *, out_dir: str | None = None
) -> tuple[Mechanism, dict[str, bytes], dict[str, str]]:
    """The mechanism with its files' new paths, the new files by relative path, and the copies by relative path.

    ``mode`` copy puts files beside the output, reference refers to them where they are, relative to ``out_dir`` (the
    output's folder); None is the target's own default. A file that is not there is a warning. For MJCF its shapes are
    left out, since MuJoCo reads no model with a missing file; in the other formats the reference stays as it is.
    """
    policy = POLICIES.get(target, _TEXT)
    chosen = mode or policy.default
    shelf = Shelf(chosen, out_dir, mechanism.notation(ROOT, WITHIN) or "")
    packer = policy.copy if chosen == "copy" else policy.reference
    packed = packer(mechanism, shelf, files, report)
    return packed, shelf.files, shelf.copies
