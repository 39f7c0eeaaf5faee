"""What only MuJoCo can expand: <replicate>, <attach> and <flexcomp>, replaced by what they stand for."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf_tree import parse_text, verbatim
from hymeko_x.frontends.mjcf.handover import hand_over

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.formats.mjcf_tree import Element
    from hymeko_x.frontends.mjcf.handover import Handover
    from hymeko_x.source import Source

_DELEGATED = ("replicate", "attach", "flexcomp")


def expand_by_mujoco(root: Element, source: Source, report: Report) -> Element:
    """The tree as MuJoCo writes it when something in it has to be expanded; else the tree as it is.

    Raises: Refusal when MuJoCo refuses the file, or is not there.
    """
    found = next((element for element in root.walk() if element.tag in _DELEGATED), None)
    if found is None:
        return root
    try:
        import mujoco
    except ImportError as error:
        raise refuse(codes.ENGINE_MISSING, f"<{found.tag}> is expanded by MuJoCo, which is not installed", found.origin) from error
    handover = hand_over(root, source, report)
    try:
        text = _expanded(mujoco, root, handover)
    except (ValueError, mujoco.FatalError) as error:
        said = handover.in_own_words(" ".join(str(error).split()))
        raise refuse(codes.ENGINE_REFUSED, f"MuJoCo refuses to expand <{found.tag}>: {said}", found.origin) from error
    report.note(codes.REWRITTEN, f"<{found.tag}> was expanded by MuJoCo; lines after it are those of the expanded file", found.origin)
    expanded = parse_text(text)
    handover.restore(expanded)
    for element in expanded.walk():
        element.file = source.name
    return expanded


def _expanded(mujoco: Any, root: Element, handover: Handover) -> str:
    """The model as MuJoCo writes it, with every value as its author wrote it.

    What MuJoCo warns of is not about the expansion; whoever compiles the result hears it.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        spec = mujoco.MjSpec.from_string(verbatim(root), include=handover.models, assets=handover.assets)
        spec.compiler.savecompiled = False
        spec.compiler.savecanonical = False
        if handover.has_keyframes:
            spec.compile()
        text: str = spec.to_xml()
        return text
