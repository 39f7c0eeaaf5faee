"""What a text inherits from the one format of all the robots that it imports: a robot of that format, with their keyframes and the like."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import formats
from hymeko_x.ir.parts import Body, Shape
from hymeko_x.ir.solids import with_tensor_of
from hymeko_x.joining import shifted
from hymeko_x.rewrite.inertia import moving_bodies, welded_to

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from hymeko_x.formats import Format
    from hymeko_x.frontends.hymeko.instances import Imported
    from hymeko_x.ir.mechanism import Id, Mechanism, RobotEdge
    from hymeko_x.ir.parts import VertexPart


def with_heritage(whole: Mechanism, instances: Sequence[Imported]) -> Mechanism:
    """The whole as a robot of the format that all imported robots came from, where its engine gives more than the parts hold.

    What the text's own bodies leave open would be another thing there, so it is made explicit first; a text that cannot be is left
    as it is, without what only that format represents.
    """
    row = _common_format(whole, instances)
    if row is None:
        return whole
    imported = {key for one in instances for table in (one.robot.graph.vertices, one.robot.graph.edges) for key in table}
    explicit = _explicit(whole, imported)
    if explicit is None:
        return whole
    found = replace(explicit, source=instances[0].original.source._replace(file=whole.source.file))
    if row.joins is not None:
        joins: Callable[..., Mechanism] = formats.loaded(row.joins)
        for one in instances:
            found = joins(found, found, shifted(one.original, one.floor), one.renamed)
    return found


def _common_format(whole: Mechanism, instances: Sequence[Imported]) -> Format | None:
    """The format with an engine of its own of every imported robot; None where there are others, or where the text names its own."""
    if not instances or formats.native_format(whole) is not None:
        return None
    rows = {row.name: row for one in instances if (row := formats.native_format(one.original)) is not None}
    is_common = len(rows) == 1 and all(one.original.source.format in rows for one in instances)
    return next(iter(rows.values())) if is_common else None


def _explicit(whole: Mechanism, imported: set[Id]) -> Mechanism | None:
    """The text's own bodies with the tensors of their shapes, and own shapes without mass where a body has none of its own.

    None where such a body moves.
    """
    vertices: dict[Id, VertexPart] = {}
    edges: dict[Id, RobotEdge] = {}
    moving = {body for key in moving_bodies(whole) for body in welded_to(whole, key)}
    for key, body in whole.vertices(Body):
        if key in imported:
            continue
        inertial = body.inertial
        if inertial is not None and inertial.mass and inertial.tensor is not None:
            continue
        given = with_tensor_of(whole.shapes.get(key, ()), inertial) if inertial is not None and inertial.mass else None
        if given is not None:
            vertices[key] = replace(body, inertial=given)
        elif key in moving or inertial is not None:
            return None
        else:
            edges.update(_weightless(whole, key))
    return whole.replace(vertices=vertices, edges=edges)


def _weightless(whole: Mechanism, body: Id) -> dict[Id, RobotEdge]:
    """The shapes of a body that say nothing of their weight, without any."""
    found: dict[Id, RobotEdge] = {}
    for view in whole.shapes.get(body, ()):
        edge = whole.graph.edges[view.id]
        if isinstance(edge.data, Shape) and edge.data.mass is None and edge.data.density is None:
            found[view.id] = replace(edge, data=replace(edge.data, density=0.0))
    return found
