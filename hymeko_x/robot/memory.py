"""Robots for other libraries, in memory: MuJoCo, Pinocchio, USD through the rows of the formats, networkx directly."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x import codes, formats, pipeline
from hymeko_x.diagnostics import Report, refuse
from hymeko_x.extras import install_command
from hymeko_x.rewrite import Options

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.source import Files


def hand_over(mechanism: Mechanism, files: Files, library: str) -> Any:
    """What a library loads of the robot. Raises: Refusal HX301 when the library is not installed, HX302 when it refuses the robot."""
    row = next(row for row in formats.FORMATS if library in row.memory)
    package = pipeline.write(mechanism, row, Options(), files, Report(), pipeline.OutputPlace(assets=row.assets))
    try:
        load = formats.loaded(row.memory[library])
    except ImportError as error:
        hint = install_command(row.libraries[library])
        raise refuse(codes.ENGINE_MISSING, f"{library} is not installed", hint=hint) from error
    contents = package.contents(files)
    try:
        return load(package.main, contents)
    except (ValueError, RuntimeError) as error:
        reason = " ".join(str(error).split())
        raise refuse(codes.ENGINE_REFUSED, f"{library} refuses robot '{mechanism.name}': {reason}") from error


def as_networkx(mechanism: Mechanism) -> Any:
    """The bipartite graph: nodes are ids with the attribute ``part``, arrows have ``sign``, ``weight`` and ``role`` of their arcs."""
    try:
        import networkx
    except ImportError as error:
        raise refuse(codes.ENGINE_MISSING, "networkx is not installed", hint=install_command("meshes")) from error
    graph = networkx.MultiDiGraph(name=mechanism.name)
    for key, part in mechanism.graph.vertices.items():
        graph.add_node(key, part=part, bipartite=0)
    for key, edge in mechanism.graph.edges.items():
        graph.add_node(key, part=edge.data, bipartite=1)
    for key, edge in mechanism.graph.edges.items():
        for arc in edge.arcs:
            ends = (key, arc.target) if arc.sign < 0 else (arc.target, key)
            graph.add_edge(*ends, sign=arc.sign, weight=arc.weight, role=arc.role)
    return graph
