"""A mechanism: a named hypergraph of robot parts with its side tables.

Everything that a frontend returns and a backend takes. Ids are unique per kind, so a body and a joint may share a name.
"""

from __future__ import annotations

from functools import cached_property
from itertools import chain
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeGuard, TypeVar

from msgspec import Struct, field
from msgspec.structs import replace

from hymeko_x.ir import parts
from hymeko_x.ir.fields import NUMBERS, Noted
from hymeko_x.ir.graph import Arc, Edge, Hypergraph
from hymeko_x.ir.ids import KINDS
from hymeko_x.ir.ids import ROOT as ROOT
from hymeko_x.ir.ids import WORLD as WORLD
from hymeko_x.ir.ids import WORLD_LINK as WORLD_LINK
from hymeko_x.ir.ids import Id as Id
from hymeko_x.ir.provenance import Provenance as Provenance
from hymeko_x.ir.values import IDENTITY, Pose
from hymeko_x.ir.views import JointView as JointView
from hymeko_x.ir.views import MountView as MountView
from hymeko_x.ir.views import ShapeView as ShapeView
from hymeko_x.ir.views import SubsetView as SubsetView

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from hymeko_x.diagnostics import Origin
    from hymeko_x.ir.notations import Notation
    from hymeko_x.ir.provenance import StoredMesh

P = TypeVar("P")
T = TypeVar("T")


RobotArc = Arc[Id, parts.Weight]
RobotEdge = Edge[Id, parts.EdgePart, parts.Weight]
RobotGraph = Hypergraph[Id, parts.VertexPart, parts.EdgePart, parts.Weight]


class Extra(Noted, frozen=True, gc=False):
    """Text of one format about an element that the IR cannot represent, verbatim.

    ``path`` leads from the element's own node to where it stood: ``""`` is the node itself, ``limit`` its child of that
    name, ``limit/@foo`` an attribute of it (``text`` is then the attribute's value). ``text`` of a child is the whole
    XML element with the namespaces that it needs. Comments of every format are of the format ``comment``, without their
    signs; path ``preceding`` and ``following`` are outside the root. ``index`` is its place among the children of its parent node (for the
    mechanism as a whole: among everything that stands at top level); comparisons ignore it.
    """

    format: str
    path: str
    text: str
    index: int = 0

    uncompared = ("index",)


class Mechanism(Struct, frozen=True, eq=False, dict=True):
    """Name, graph and side tables. Equality compares name, graph and extras, not places or notations.

    ``notations`` keeps, by element and name, how an author wrote what the value itself cannot keep, as text
    (see :class:`hymeko_x.ir.notations.Notation`); ``stereotypes`` the classes, macros and templates that elements were made
    from; ``layout`` the order in which the author wrote the elements (of any kind), as far as known; ``places`` by uri the
    name that the file which carried the mechanism has for a mesh or an image; ``originals`` by uri the path of the very file, where that
    is kept; ``stored`` what the file that carried it has in the place of a mesh or an image, which is used where its file is not found;
    ``source`` where all of it came from.
    """

    name: str
    graph: RobotGraph = field(default_factory=Hypergraph)
    extras: Mapping[Id, tuple[Extra, ...]] = field(default_factory=dict)
    origins: Mapping[Id, Origin] = field(default_factory=dict)
    notations: Mapping[Id, Mapping[str, str]] = field(default_factory=dict)
    stereotypes: Mapping[Id, tuple[str, ...]] = field(default_factory=dict)
    layout: tuple[Id, ...] = ()
    places: Mapping[str, str] = field(default_factory=dict)
    originals: Mapping[str, str] = field(default_factory=dict)
    stored: Mapping[Id, StoredMesh | parts.Texture] = field(default_factory=dict)
    source: Provenance = Provenance()

    __ne__ = object.__ne__  # the opposite of __eq__, which a Struct's own is not
    __hash__ = None  # type: ignore[assignment]

    def __eq__(self, other: object) -> bool:
        """Same name, graph and extras; the order of elements, and of extras of different places, does not count."""
        if not isinstance(other, Mechanism):
            return NotImplemented
        return self.name == other.name and self.graph == other.graph and _sorted(self.extras) == _sorted(other.extras)

    # ---- elements by kind ------------------------------------------------------------------------------------------------

    def vertices(self, part: type[P]) -> Iterator[tuple[Id, P]]:
        """The vertices that carry this kind of part, in order. Raises: KeyError for a class that is no kind of part."""
        return iter(self._vertices_by_kind.get(KINDS[part], ()))

    def edges(self, part: type[P]) -> Iterator[tuple[Id, P, tuple[RobotArc, ...]]]:
        """The edges of this kind with their arcs, in order. Raises: KeyError for a class that is no kind of part."""
        return iter(self._edges_by_kind.get(KINDS[part], ()))

    def assets(self) -> Iterator[tuple[Id, parts.Mesh | parts.Texture]]:
        """What may be in files of its own: the meshes in order, then the textures."""
        yield from self.vertices(parts.Mesh)
        yield from self.vertices(parts.Texture)

    @cached_property
    def _vertices_by_kind(self) -> Mapping[str, list[tuple[Id, Any]]]:
        found: dict[str, list[tuple[Id, Any]]] = {}
        for key, data in self.graph.vertices.items():
            found.setdefault(key.kind, []).append((key, data))
        return found

    @cached_property
    def _edges_by_kind(self) -> Mapping[str, list[tuple[Id, Any, tuple[RobotArc, ...]]]]:
        found: dict[str, list[tuple[Id, Any, tuple[RobotArc, ...]]]] = {}
        for key, edge in self.graph.edges.items():
            found.setdefault(key.kind, []).append((key, edge.data, edge.arcs))
        return found

    # ---- the tree --------------------------------------------------------------------------------------------------------

    @cached_property
    def joints(self) -> Mapping[Id, JointView]:
        """Every joint with its two ends, in order. Joints without exactly one parent and one child arc are left out."""
        found: dict[Id, JointView] = {}
        for key, joint, arcs in self.edges(parts.Joint):
            above, below = _ends(arcs)
            if above is not None and below is not None:
                found[key] = JointView(key, joint, above.target, below.target, pose_weight(above), pose_weight(below))
        return found

    @cached_property
    def children(self) -> Mapping[Id, tuple[JointView, ...]]:
        """For each body (and the world) the joints below it, in order."""
        found: dict[Id, list[JointView]] = {}
        for joint in self.joints.values():
            found.setdefault(joint.parent, []).append(joint)
        return {key: tuple(below) for key, below in found.items()}

    @cached_property
    def parent_joint(self) -> Mapping[Id, JointView]:
        """For each body the joint above it; the first one where there are several."""
        found: dict[Id, JointView] = {}
        for joint in self.joints.values():
            found.setdefault(joint.child, joint)
        return found

    @cached_property
    def roots(self) -> tuple[Id, ...]:
        """The bodies that no joint leads to from another body: the world's children and the open bases, in order."""
        above = self.parent_joint
        return tuple(key for key, _ in self.vertices(parts.Body) if key not in above or above[key].parent == WORLD)

    def depth_first(self) -> Iterator[Id]:
        """The bodies, parents before children, each subtree in one piece, siblings in joint order. Not recursive.

        A body that several joints lead to is below its parent joint, the first one.
        """
        above = self.parent_joint
        stack = list(reversed(self.roots))
        seen: set[Id] = set()
        while stack:
            body = stack.pop()
            if body in seen:
                continue
            seen.add(body)
            yield body
            stack.extend(joint.child for joint in reversed(self.children.get(body, ())) if above[joint.child].id == joint.id)

    # ---- what is on an element -----------------------------------------------------------------------------------------------

    @cached_property
    def shapes(self) -> Mapping[Id, tuple[ShapeView, ...]]:
        """For each body (and the world) its shapes in order."""
        found: dict[Id, list[ShapeView]] = {}
        for key, shape, arcs in self.edges(parts.Shape):
            body = _end(arcs, 1)
            if body is None:
                continue
            mesh = material = None
            for arc in arcs:
                if arc.role == "mesh":
                    mesh = arc.target
                elif arc.role == "material":
                    material = arc.target
            found.setdefault(body.target, []).append(ShapeView(key, shape, body.target, pose_weight(body), mesh, material))
        return {key: tuple(views) for key, views in found.items()}

    def every_shape(self) -> Iterator[ShapeView]:
        """All shapes, those of one body after those of another."""
        return chain.from_iterable(self.shapes.values())

    def shapes_by_mesh(self) -> dict[Id, list[ShapeView]]:
        """For each mesh that a shape has, its shapes."""
        found: dict[Id, list[ShapeView]] = {}
        for view in self.every_shape():
            if view.mesh is not None:
                found.setdefault(view.mesh, []).append(view)
        return found

    @cached_property
    def subsets(self) -> Mapping[Id, tuple[SubsetView, ...]]:
        """For each shape what of its mesh shows another material, in order."""
        found: dict[Id, list[SubsetView]] = {}
        for key, subset, arcs in self.edges(parts.Subset):
            shape, material = _ends(arcs)
            if shape is not None and material is not None:
                found.setdefault(shape.target, []).append(SubsetView(key, subset.faces, material.target))
        return {key: tuple(views) for key, views in found.items()}

    @property
    def constraints(self) -> list[Id]:
        """Closures and couplings in their common order: that of the author's layout, behind it those without a place there."""
        found = [key for key, edge in self.graph.edges.items() if isinstance(edge.data, parts.Loop | parts.Coupling)]
        if len(found) < 2:
            return found
        places = {key: place for place, key in enumerate(self.layout)}
        return sorted(found, key=lambda key: places.get(key, len(places)))

    @cached_property
    def mounts(self) -> Mapping[Id, tuple[MountView, ...]]:
        """For each body (and the world) the frames, cameras, lights and sensors on it, in order."""
        found: dict[Id, list[MountView]] = {}
        for key, _, arcs in self.edges(parts.Mount):
            body, mounted = _ends(arcs)
            if body is not None and mounted is not None:
                found.setdefault(body.target, []).append(MountView(key, mounted.target, body.target, pose_weight(body)))
        return {key: tuple(views) for key, views in found.items()}

    def vertex(self, key: Id, part: type[P]) -> P:
        """The part of a vertex, which must be of this kind.

        Raises: KeyError when there is no such vertex, TypeError when it carries something else.
        """
        data = self.graph.vertices[key]
        if not isinstance(data, part):
            raise TypeError(f"{key} carries {type(data).__name__}, not {part.__name__}")
        return data

    def part(self, key: Id | None, part: type[P]) -> P | None:
        """The part of a vertex; None where there is no such vertex, or it carries another kind of part."""
        data = None if key is None else self.graph.vertices.get(key)
        return data if isinstance(data, part) else None

    def origin(self, key: Id) -> Origin | None:
        """Where the element stands in its source, if known."""
        return self.origins.get(key)

    def notation(self, key: Id, notation: Notation[T]) -> T | None:
        """How the author wrote something of an element, or None."""
        text = self.notations.get(key, _NO_NOTATIONS).get(notation.name)
        return None if text is None else notation.read(text)

    def with_note(self, keys: Iterable[Id], notation: Notation[T], value: T) -> Mechanism:
        """The mechanism with this notation on these elements; itself for none."""
        text = notation.write(value)
        new = {key: {**self.notations.get(key, _NO_NOTATIONS), notation.name: text} for key in keys}
        return replace(self, notations={**self.notations, **new}) if new else self

    def replace(
        self,
        *,
        vertices: Mapping[Id, parts.VertexPart] | None = None,
        edges: Mapping[Id, RobotEdge] | None = None,
        without: Iterable[Id] = (),
    ) -> Mechanism:
        """The mechanism with these elements added or exchanged in their place, and without the ones named; itself where nothing changes."""
        gone = frozenset(without)
        if not (vertices or edges or gone):
            return self
        graph = self.graph.replace(vertices=vertices, edges=edges, without=gone)
        is_same = graph.vertices is self.graph.vertices and graph.edges is self.graph.edges
        return self if is_same else self.with_graph(graph)

    def with_graph(self, graph: RobotGraph) -> Mechanism:
        """The same mechanism with another graph. What is known of its edges stays known where they are the same table."""
        changed = replace(self, graph=graph)
        if graph.edges is self.graph.edges:
            known = self.__dict__
            changed.__dict__.update({name: known[name] for name in _OF_EDGES if name in known})
        return changed


_NO_NOTATIONS: Mapping[str, str] = MappingProxyType({})
_OF_EDGES = ("_edges_by_kind", "joints", "children", "parent_joint", "shapes", "subsets", "mounts")
"""What a mechanism computes of its edges alone."""


def _sorted(extras: Mapping[Id, tuple[Extra, ...]]) -> dict[Id, list[Extra]]:
    """Extras by element, those of one format and path in their order."""
    return {key: sorted(found, key=lambda extra: (extra.format, extra.path)) for key, found in extras.items() if found}


# ---- making edges --------------------------------------------------------------------------------------------------------


def _end(arcs: tuple[RobotArc, ...], sign: int) -> RobotArc | None:
    """The first arc of this sign."""
    for arc in arcs:
        if arc.sign * sign > 0:
            return arc
    return None


def _ends(arcs: tuple[RobotArc, ...]) -> tuple[RobotArc | None, RobotArc | None]:
    """The first arc into the edge and the first one out of it: nearly always these two and no other."""
    if len(arcs) == 2 and arcs[0].sign > 0 > arcs[1].sign:
        return arcs
    return _end(arcs, 1), _end(arcs, -1)


def end_of(arcs: tuple[RobotArc, ...], sign: int) -> Id | None:
    """The element to which the first arc of this sign leads."""
    arc = _end(arcs, sign)
    return None if arc is None else arc.target


def pose_weight(arc: RobotArc) -> Pose:
    """The arc's weight as a pose; an arc without one stands for the identity."""
    return arc.weight if isinstance(arc.weight, Pose) else IDENTITY


def numbers_weight(arc: RobotArc) -> tuple[float, ...]:
    """The arc's weight as numbers; an arc without one has none."""
    return arc.weight if has_numbers(arc.weight) else ()


def has_numbers(weight: parts.Weight | None) -> TypeGuard[tuple[float, ...]]:
    """Whether a weight is a list of numbers."""
    return isinstance(weight, tuple) and all(isinstance(number, NUMBERS) for number in weight)


def joint_edge(joint: parts.Joint, parent: Id, child: Id, parent_pose: Pose = IDENTITY, child_pose: Pose = IDENTITY) -> RobotEdge:
    """The edge of a joint; identity poses are left out, so that equal joints are equal edges."""
    return Edge(joint, (_posed(parent, 1, parent_pose), _posed(child, -1, child_pose)))


def shape_edge(shape: parts.Shape, body: Id, pose: Pose = IDENTITY, mesh: Id | None = None, material: Id | None = None) -> RobotEdge:
    """The edge of a shape on a body."""
    arcs = [_posed(body, 1, pose)]
    if mesh is not None:
        arcs.append(Arc(mesh, 0, None, "mesh"))
    if material is not None:
        arcs.append(Arc(material, 0, None, "material"))
    return Edge(shape, tuple(arcs))


def mount_edge(body: Id, mounted: Id, pose: Pose = IDENTITY) -> RobotEdge:
    """The edge that puts a frame, camera, light or sensor on a body."""
    return Edge(parts.Mount(), (_posed(body, 1, pose), Arc(mounted, -1)))


def sense_edge(measured: Id, sensor: Id) -> RobotEdge:
    """The edge by which a sensor measures one element."""
    return Edge(parts.Sense(), (Arc(measured, 1), Arc(sensor, -1)))


def layer_edge(texture: Id, material: Id, use: str = "rgb") -> RobotEdge:
    """The edge that puts a texture on a material."""
    return Edge(parts.Layer(use), (Arc(texture, 1), Arc(material, -1)))


def subset_edge(faces: tuple[int, ...], shape: Id, material: Id) -> RobotEdge:
    """The edge that shows a material on some triangles of a shape's mesh."""
    return Edge(parts.Subset(faces), (Arc(shape, 1), Arc(material, -1)))


def coupling_edge(follower: Id, leaders: tuple[tuple[Id, tuple[float, ...]], ...], *, active: bool = True) -> RobotEdge:
    """The edge that makes a joint follow others, each by a polynomial's coefficients (constant first)."""
    arcs: list[RobotArc] = [Arc(follower, 1, (1.0,))]
    arcs += [Arc(leader, -1, coefficients) for leader, coefficients in leaders]
    return Edge(parts.Coupling(active), tuple(arcs))


def _posed(target: Id, sign: int, pose: Pose) -> RobotArc:
    if pose is IDENTITY or (pose.written is None and pose.quat == IDENTITY.quat and pose.xyz == IDENTITY.xyz):
        return Arc(target, sign)
    return Arc(target, sign, pose)
