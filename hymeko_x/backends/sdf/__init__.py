"""The SDF backend: prints a legal mechanism as SDF, poses relative to the joint before, or as the author of an SDF file wrote them.

Deterministic; numbers as the shortest decimals that read back to the same doubles; extras from an SDF file are written where they were.
docs/mapping/sdf.md has the mapping.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.assets.written import contents_of
from hymeko_x.backends.sdf.models import document
from hymeko_x.backends.sdf.sheet import SdfSheet
from hymeko_x.formats import sdf as words
from hymeko_x.source import Package
from hymeko_x.xml.printing import Tag, render
from hymeko_x.xml.text import escaped, escaped_lines, parts_of_text

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.rewrite.context import Options


def write(mechanism: Mechanism, options: Options, report: Report) -> Package:
    """The SDF file of a mechanism. Meshes are referred to by their uris as they are.

    Raises: Refusal with HX104 for a joint or a shape that SDF cannot represent; rewriting replaces those beforehand.
    """
    sheet = SdfSheet(mechanism, options.within)
    root = document(sheet)
    before, after = sheet.around()

    def printed(residue: str) -> bytes:
        whole = Tag(root.name, root.attributes, [*root.children, *_residue_elements(residue)])
        return "\n".join(['<?xml version="1.0"?>', *before, *render(whole), *after, ""]).encode()

    files = {**contents_of(mechanism, sheet.mesh_files, sheet.images), **_model_config(sheet, options, report)}
    return Package(printed(""), files, with_residue=printed)


def _model_config(sheet: SdfSheet, options: Options, report: Report) -> dict[str, bytes]:
    """The `model.config` by which Gazebo finds the model of a folder; none for a file that is no single model, which is reported."""
    if not (options.package_layout and options.beside):
        return {}
    if sheet.has_several_models:
        report.warn(codes.NOT_REPRESENTED, "model.config is not written: it is for a file with one model")
        return {}
    config = Tag("model", {})
    config.add("name").children.append(escaped(sheet.mechanism.name))
    config.add("version").children.append("1.0")
    config.add("sdf", version=sheet.version).children.append(escaped(f"{options.beside}.sdf"))
    return {"model.config": "\n".join(['<?xml version="1.0"?>', *render(config), ""]).encode()}


def _residue_elements(text: str) -> list[str]:
    """The elements that contain a residue; a prefix makes them custom elements, which readers of SDF leave alone."""
    texts = [f"<![CDATA[\n{part}]]>" if "]]>" not in part else escaped_lines(part) for part in parts_of_text(text)]
    return [f'<{words.RESIDUE} xmlns:hymeko="{words.RESIDUE_NAMESPACE}">{part}</{words.RESIDUE}>' for part in texts]
