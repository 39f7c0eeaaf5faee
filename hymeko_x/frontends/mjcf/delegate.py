"""What only MuJoCo can expand: <replicate>, <attach>, <flexcomp> and <composite>, replaced by what they stand for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf_tree import parse_text, verbatim

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.formats.mjcf_tree import Element
    from hymeko_x.source import Files, Source

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
    try:
        spec = mujoco.MjSpec.from_string(verbatim(root), assets=_assets(root, source.files))
        spec.compiler.savecompiled = False
        spec.compiler.savecanonical = False
        text = spec.to_xml()
    except (ValueError, mujoco.FatalError) as error:
        raise refuse(codes.ENGINE_REFUSED, f"MuJoCo refuses to expand <{found.tag}>: {error}", found.origin) from error
    report.note(codes.REWRITTEN, f"<{found.tag}> was expanded by MuJoCo; lines after it are those of the expanded file", found.origin)
    expanded = parse_text(text)
    for element in expanded.walk():
        element.file = source.name
    return expanded


def _assets(root: Element, files: Files) -> dict[str, bytes]:
    """The files of sub-models, by the name under which they are referred to."""
    found: dict[str, bytes] = {}
    for element in root.walk():
        uri = element.attributes.get("file")
        path = files.find(uri) if uri and element.tag in ("model", "flexcomp", "mesh", "texture", "hfield") else None
        if uri and path is not None:
            found[uri] = files.read(path)
    return found
