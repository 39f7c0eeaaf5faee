"""Pairing: the elements of the image that are elements of the source under another name.

Elements with names of their own are paired by these. Names that readers generate (``calf/visual#3``) say only where an element stands, and
a format that has its shapes in another order gives them to others: shapes without names are paired by what they are.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from hymeko_x.ir.fields import layout_of
from hymeko_x.ir.mechanism import WORLD, WORLD_LINK, Id
from hymeko_x.ir.names import Names
from hymeko_x.ir.parts import Joint, Material, Mesh, Role, Shape, Texture
from hymeko_x.ir.values import IDENTITY, Pose
from hymeko_x.rewrite.roots import RENAMED_LINK, stands_for_world
from hymeko_x.source import file_stem

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from hymeko_x.ir.mechanism import Mechanism, RobotArc, RobotEdge, RobotGraph
    from hymeko_x.ir.parts import Rgba

_PLACED = ("actuator", "sensor", "frame", "camera", "light")
"""Kinds of elements that an edge places, which most often has their name."""
_DIGITS = 7
"""To how many decimals the numbers of two shapes agree that are the same one: formats round angles and single-precision numbers."""


def other_names(image: Mechanism, source: Mechanism) -> dict[Id, Id]:
    """The source's id of every element of the image that goes by another one."""
    pairs = _Pairs(image.graph, source.graph)
    is_link, was_link = (WORLD_LINK in robot.roots and stands_for_world(WORLD_LINK, robot) for robot in (image, source))
    pairs.match_world(is_link=is_link, was_link=was_link)
    pairs.match_ends()  # bodies by the joints that both have, materials and meshes by the shapes
    for with_layers in (False, True):  # then edges by what they connect, and once more what only those lead to
        pairs.match_edges(with_layers=with_layers)
        pairs.match_ends()
    return pairs.names | dict(pairs.ousted())


class _Pairs:
    """Elements of the image without a namesake, and elements of the source without one, being matched.

    Shapes whose namesakes are other shapes count as elements without one.
    """

    def __init__(self, image: RobotGraph, source: RobotGraph) -> None:
        self.image, self.source = image, source
        self.names: dict[Id, Id] = {}
        mine, theirs = {*image.vertices, *image.edges}, {*source.vertices, *source.edges}
        self.doubtful = set(_doubtful(image, source))
        self.strange = (mine - theirs) | self.doubtful
        self.missing = (theirs - mine) | self.doubtful

    def pair(self, old: Id, new: Id) -> None:
        """They are the same element from now on."""
        is_world = new == WORLD and old.kind == "body" and WORLD not in self.image.vertices  # a link that stands for the world
        if old in self.strange and (is_world or (new in self.missing and old.kind == new.kind)):
            if old != new:
                self.names[old] = new
            self.strange.discard(old)
            self.missing.discard(new)

    def ousted(self) -> Iterator[tuple[Id, Id]]:
        """A free id for each element of the image that has no partner, and whose own id is now that of another element."""
        left = self.doubtful & self.strange - self.missing
        if left:
            free = Names((*self.image.vertices, *self.image.edges, *self.source.vertices, *self.source.edges))
            yield from ((key, free.take(*key)) for key in self.image.edges if key in left)

    def match_world(self, *, is_link: bool, was_link: bool) -> None:
        """The world of the one and the link that represents it in the other; whether there is one in the image, and was in the source.

        A body of the source that is called so, and is no such link, has another name beside the world.
        """
        if WORLD in self.source.vertices:
            if is_link and not was_link and WORLD_LINK in self.source.vertices:
                self.strange.add(WORLD_LINK)
                self.missing.add(WORLD_LINK)
            self.pair(WORLD_LINK, WORLD)
        elif was_link and WORLD in self.strange and WORLD_LINK in self.missing:
            self.names[WORLD] = WORLD_LINK
            self.strange.discard(WORLD)
            self.missing.discard(WORLD_LINK)
        if not was_link:
            self.pair(RENAMED_LINK, WORLD_LINK)

    def match_ends(self) -> None:
        """What the arcs of an edge lead to, for the edges that both have."""
        if not self.strange or not self.missing:
            return
        unsure = self.doubtful & self.strange
        for key, edge in self.image.edges.items():
            is_strange = key not in unsure and any(arc.target in self.strange and arc.target not in unsure for arc in edge.arcs)
            other = self.source.edges.get(self.names.get(key, key)) if is_strange else None
            if other is None:
                continue
            ends = _ends_by_place(other)
            for place, target in _ends_by_place(edge).items():
                if target in self.strange and target not in unsure and place in ends:
                    self.pair(target, ends[place])

    def match_edges(self, *, with_layers: bool) -> None:
        """Edges of the same kind between the same elements; layers once their materials are known from the shapes that have them."""
        if not self.strange or not self.missing:
            return
        waiting: dict[object, list[Id]] = defaultdict(list)
        for key, edge in self.source.edges.items():
            if key in self.missing and (with_layers or key.kind != "layer"):
                waiting[self._ends(self.source, key, edge, {})].append(key)
        if not waiting:
            return
        candidates: dict[object, list[Id]] = defaultdict(list)
        for key, edge in self.image.edges.items():
            if key in self.strange:
                candidates[self._ends(self.image, key, edge, self.names)].append(key)
        for ends, keys in candidates.items():
            if ends in waiting:
                self._match(keys, waiting[ends])

    def _match(self, old: list[Id], new: list[Id]) -> None:
        """Equal ones first, at first by their colours, since formats have other materials; then namesakes of a sort, then in their order,
        then namesakes of any sort.
        """
        if len(old) == len(new) == 1 and _sort(self.source.edges[new[0]]) == _sort(self.image.edges[old[0]]):
            self.pair(old[0], new[0])
            return
        own = self.names.get
        self._match_by(old, new, lambda edge: _appearance_of(self.image, edge), lambda edge: _appearance_of(self.source, edge))
        self._match_by(old, new, lambda edge: essence_of(self.image, edge, own), lambda edge: essence_of(self.source, edge))
        for key in old:
            if key in self.missing and _sort(self.source.edges[key]) == _sort(self.image.edges[key]):
                self.pair(key, key)
        self._match_by(old, new, content_of, content_of)
        self._match_by(old, new, _sort, _sort)
        for key in old:
            self.pair(key, key)

    def _match_by(self, old: list[Id], new: list[Id], ours: Callable[[RobotEdge], object], theirs: Callable[[RobotEdge], object]) -> None:
        """Pair the edges that have the same key, in their order."""
        alike: dict[object, list[Id]] = defaultdict(list)
        for key in reversed(new):
            if key in self.missing:
                alike[theirs(self.source.edges[key])].append(key)
        for key in old:
            if key in self.strange and (same := alike.get(ours(self.image.edges[key]))):
                self.pair(key, same.pop())

    def _ends(self, graph: RobotGraph, key: Id, edge: RobotEdge, names: dict[Id, Id]) -> object:
        """What an edge is and what it is on; assets do not count, which are renamed most often, nor what is called as the edge is.

        A layer is on its material, or on the file of its texture where it is not known which material that is.
        """
        if key.kind == "layer":
            ends = [names.get(arc.target, arc.target) for arc in edge.arcs]
            known = [end for end in ends if end.kind == "material" and end in self.source.vertices and end not in self.missing]
            return key.kind, edge.data, tuple(known or [_file_of(graph, arc.target) for arc in edge.arcs])
        targets = [arc.target for arc in edge.arcs if arc.target.kind not in ("mesh", "material", "texture")]
        return key.kind, tuple([end.kind if end.kind in _PLACED and end.name == key.name else names.get(end, end) for end in targets])


def _ends_by_place(edge: RobotEdge) -> dict[object, Id]:
    """What the arcs of an edge lead to, by sign, role, and number among such arcs: a tendon has many."""
    counts: dict[object, int] = defaultdict(int)
    found: dict[object, Id] = {}
    for arc in edge.arcs:
        place = arc.sign, arc.role
        found[place, counts[place]] = arc.target
        counts[place] += 1
    return found


def _doubtful(image: RobotGraph, source: RobotGraph) -> Iterator[Id]:
    """The shapes that are another shape in the source, by their names; without names of their own, by what they are."""
    for key, edge in image.edges.items():
        data, other = edge.data, source.edges.get(key)
        if other is None or not isinstance(data, Shape) or not isinstance(other.data, Shape) or not _may_be_others(data, other.data):
            continue
        is_same = data.geometry == other.data.geometry and _placed(edge) == _placed(other)
        if not is_same and essence_of(image, edge) != essence_of(source, other):
            yield key


def _placed(edge: RobotEdge) -> list[RobotArc]:
    """The arcs of a shape to its body and its mesh; formats without names of materials give them others."""
    return [arc for arc in edge.arcs if arc.target.kind != "material"]


def _may_be_others(shape: Shape, other: Shape) -> bool:
    """Whether two shapes of one id do not have the same name of their own."""
    return not shape.name or shape.name != other.name


def reordered_shapes(edited: Mechanism, image: Mechanism) -> dict[Id, Id]:
    """New ids for shapes of bodies that have the same ones in another order: those of the image's shapes that they are. Linear."""
    found: dict[Id, Id] = {}
    free = Names((*edited.graph.edges, *image.graph.edges))
    for body, views in edited.shapes.items():
        mine, theirs = [view.id for view in views], [view.id for view in image.shapes.get(body, ())]
        pairs = _same_shapes(edited.graph, mine, image.graph, theirs)
        if any(old != new for old, new in pairs.items()):
            taken = set(pairs.values())
            found |= pairs | {key: free.take(*key) for key in mine if key not in pairs and key in taken}
    return found


def _same_shapes(edited: RobotGraph, mine: list[Id], image: RobotGraph, theirs: list[Id]) -> dict[Id, Id]:
    """Which shape of the image each shape of one body is: by its name, then by what it is, then by its id."""
    pairs: dict[Id, Id] = {}
    for key_of in (_name_of, _content):
        waiting: dict[object, list[Id]] = defaultdict(list)
        taken = set(pairs.values())
        for key in reversed([key for key in theirs if key not in taken]):
            waiting[key_of(image, image.edges[key])].append(key)
        for key in mine:
            wanted = None if key in pairs else key_of(edited, edited.edges[key])
            if wanted is not None and (same := waiting.get(wanted)):
                pairs[key] = same.pop()
    left = {*theirs}.difference(pairs.values())
    return pairs | {key: key for key in mine if key not in pairs and key in left}


def _name_of(graph: RobotGraph, edge: RobotEdge) -> object:
    """The name, the role and the sort of a shape; None without a name."""
    return (edge.data.name, edge.data.role, _sort(edge)) if isinstance(edge.data, Shape) and edge.data.name else None


def _content(graph: RobotGraph, edge: RobotEdge) -> object:
    """The role of a shape, and what it is."""
    return (edge.data.role, essence_of(graph, edge)) if isinstance(edge.data, Shape) else None


def content_of(edge: RobotEdge) -> object:
    """The content of an edge, without names."""
    weights = tuple(arc.weight for arc in edge.arcs if arc.target.kind not in ("mesh", "material"))
    data = edge.data
    return (data.geometry, weights) if isinstance(data, Shape) else (data, weights)


def essence_of(graph: RobotGraph, edge: RobotEdge, own: Callable[[Id, Id], Id] = lambda key, _: key) -> object:
    """The content of an edge; of a shape also its sort, mesh and material (``own`` gives their ids), with rounded numbers."""
    if not isinstance(edge.data, Shape):
        return content_of(edge)
    assets = tuple([_asset(graph, arc.target, own) for arc in edge.arcs if arc.target.kind in ("mesh", "material")])
    placed = [rounded(arc.weight or IDENTITY) for arc in edge.arcs if arc.sign > 0]
    return _sort(edge), rounded(edge.data.geometry), tuple(placed), assets


def _appearance_of(graph: RobotGraph, edge: RobotEdge) -> object:
    """What a shape is and which colour it has, whether that is its own or a material's. Of other edges their content."""
    if not isinstance(edge.data, Shape):
        return content_of(edge)
    meshes = [_file_of(graph, arc.target) for arc in edge.arcs if arc.target.kind == "mesh"]
    placed = [rounded(arc.weight or IDENTITY) for arc in edge.arcs if arc.sign > 0]
    return _sort(edge), rounded(edge.data.geometry), tuple(placed), tuple(meshes), colour_of(graph, edge)


def colour_of(graph: RobotGraph, edge: RobotEdge) -> Rgba | None:
    """The rounded colour of a shape, its own or that of its material; None for none, and for an edge that is no shape."""
    if not isinstance(edge.data, Shape):
        return None
    materials = (graph.vertices.get(arc.target) for arc in edge.arcs if arc.target.kind == "material")
    colour = edge.data.rgba or next((part.rgba for part in materials if isinstance(part, Material)), None)
    return None if colour is None else tuple([round(number, _DIGITS) for number in colour])  # type: ignore[return-value]


def _asset(graph: RobotGraph, key: Id, own: Callable[[Id, Id], Id]) -> object:
    """A mesh is the one of its file, whatever its id."""
    return (_file_of(graph, key) if key.kind == "mesh" else None) or own(key, key)


def _file_of(graph: RobotGraph, key: Id) -> str | None:
    """The stem of the file of a mesh or a texture, if it has one."""
    part = graph.vertices.get(key)
    return file_stem(part.uri) if isinstance(part, Mesh | Texture) and part.uri else None


def rounded(value: object) -> object:
    """A value whose numbers are rounded; a rotation is one of two quaternions."""
    if isinstance(value, float):
        return round(value, _DIGITS) + 0.0
    if isinstance(value, Pose):
        return rounded(value.xyz), rounded(value.quat if value.quat[0] >= 0.0 else tuple([-number for number in value.quat]))
    if isinstance(value, tuple):
        return tuple(map(rounded, value))
    layout = layout_of(type(value))
    return value if layout is None else (type(value), rounded(layout.compared(value)))


def _sort(edge: RobotEdge) -> object:
    """What must be equal for two edges to be the same one, changed."""
    data = edge.data
    if isinstance(data, Shape):
        return type(data.geometry), data.role is Role.COLLISION
    return tuple(dof.kind for dof in data.dofs) if isinstance(data, Joint) else ()
