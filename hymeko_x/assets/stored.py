"""Meshes whose files are not there, of which the file that carried the mechanism has the points: stages of USD hold their geometry."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.assets.refer import is_of_package
from hymeko_x.ir.parts import Mesh

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.ir.mechanism import Id, Mechanism
    from hymeko_x.source import Files

_KEEP_PACKAGES = ("urdf", "xacro")
"""Where ``package://`` is written as it is: who reads the file finds packages in ways of his own."""


def with_stored_points(mechanism: Mechanism, target: str, files: Files, report: Report) -> Mechanism:
    """The mechanism with the points that are stored of every mesh whose file is missing. HyMeKo text keeps the reference."""
    if not mechanism.stored or target == "hymeko":
        return mechanism
    changed: dict[Id, Mesh] = {}
    for key, mesh in mechanism.vertices(Mesh):
        points = mechanism.stored.get(mesh.uri or "")
        if points is None or (target in _KEEP_PACKAGES and is_of_package(mesh.uri or "")) or files.find(mesh.uri or "") is not None:
            continue
        changed[key] = replace(mesh, uri=None, vertices=points.vertices, faces=points.faces)
        said = f"{key}: '{mesh.uri}' was not found; it becomes the points that the source has of it"
        report.note(codes.ASSET_NOT_FOUND, said, mechanism.origin(key), element=str(key))
    return mechanism.with_graph(mechanism.graph.replace(vertices=changed)) if changed else mechanism
