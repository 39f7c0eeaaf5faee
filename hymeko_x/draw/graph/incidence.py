"""The incidence graph as a picture: circles, boxes, and arcs with their signs and weights."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.draw.graph.facts import SIGNS
from hymeko_x.draw.graph.layers import Size, columns, layered
from hymeko_x.draw.graph.letters import width
from hymeko_x.draw.graph.svg import MARGIN, SIZE, SMALL, Canvas, fixed, tip

if TYPE_CHECKING:
    from hymeko_x.draw.graph.diagram import Diagram, DrawnNode

_RADIUS = 10.0
_GAP = 56.0
_PORT = 20.0
"""The distance of the arcs at a box, so that each has its own line of text."""
_SPACE = 14.0
"""The distance of one node from the next one below it."""
_STUB = 14.0
"""The straight end of an arc at a box, where the head of an arrow may be."""
_TOP = MARGIN + 36.0


class _Port(NamedTuple):
    """Where an arc ends at a box: the number of the arc, and what is written there."""

    line: int
    label: str


class _Box(NamedTuple):
    """A hyperedge as it is drawn: width, half the height, the ports at the left and at the right, and the room of their labels."""

    across: float
    half: float
    ports: tuple[list[_Port], list[_Port]]
    room: tuple[float, float]


def incidence_picture(shape: Diagram) -> str:
    """The SVG of an incidence graph."""
    return _Picture(shape).drawn()


class _Picture:
    def __init__(self, shape: Diagram) -> None:
        self.shape = shape
        self.nodes = list(shape.nodes.values())
        numbers = {key: number for number, key in enumerate(shape.nodes)}
        self.owner = [numbers[line.edge] for line in shape.lines]
        self.target = [numbers[line.target] for line in shape.lines]
        towards = [
            (owner, target) if line.sign < 0 else (target, owner)
            for line, owner, target in zip(shape.lines, self.owner, self.target, strict=True)
        ]
        self.column = columns(len(self.nodes), [arc for arc in towards if arc[0] != arc[1]])
        self.boxes = self._boxes()
        sizes = [self._size(number) for number in range(len(self.nodes))]
        arcs = [tuple(sorted(arc, key=lambda node: self.column[node])) for arc in towards]
        self.arcs = [(start, end) for start, end in arcs]
        self.layout = layered(sizes, self.column, self.arcs, _GAP)

    # ---- how large everything is ---------------------------------------------------------------------------------------

    def _boxes(self) -> dict[int, _Box]:
        ports: dict[int, tuple[list[_Port], list[_Port]]] = {n: ([], []) for n, node in enumerate(self.nodes) if node.is_edge}
        for number, line in enumerate(self.shape.lines):
            owner, target = self.owner[number], self.target[number]
            is_right = self.column[target] >= self.column[owner]
            ports[owner][is_right].append(_Port(number, line.label))
            if target in ports and target != owner:
                ports[target][not is_right].append(_Port(number, ""))
        return {number: _box(self.nodes[number], both) for number, both in ports.items()}

    def _size(self, number: int) -> Size:
        node = self.nodes[number]
        box = self.boxes.get(number)
        if box is not None:
            return Size(box.across + sum(box.room), box.half + _SPACE / 2, box.half + _SPACE / 2)
        lines = SIZE * 1.2 + (SMALL * 1.2 if node.facts else 0.0)
        across = max(2 * _RADIUS, width(node.label, SIZE), width(node.facts, SMALL))
        return Size(across, _RADIUS + _SPACE / 2, _RADIUS + 3 + lines + _SPACE / 2)

    # ---- where everything is ---------------------------------------------------------------------------------------------

    def _middle(self, number: int) -> float:
        left, right = self.layout.ends[self.column[number]]
        box = self.boxes.get(number)
        if box is None:
            return MARGIN + (left + right) / 2
        return MARGIN + (left + right - box.across - sum(box.room)) / 2 + box.room[0] + box.across / 2

    def _height(self, number: int) -> float:
        return _TOP + self.layout.height[number]

    def _sort_ports(self) -> None:
        """The arcs of each side of a box from top to bottom as their other ends are, so that they do not cross there."""
        for number, box in self.boxes.items():
            for side in (0, 1):
                box.ports[side].sort(key=lambda port: self._next_height(port.line, number))

    def _next_height(self, line: int, number: int) -> float:
        start, end = self.arcs[line]
        way = [self.layout.height[start], *self.layout.passing[line], self.layout.height[end]]
        return way[1] if start == number else way[-2]

    def _end(self, line: int, number: int, side: int) -> tuple[float, float]:
        """Where an arc meets the outline of a node, at its left (0) or right (1)."""
        outwards = 2 * side - 1
        box = self.boxes.get(number)
        if box is None:
            return self._middle(number) + outwards * _RADIUS, self._height(number)
        ports = box.ports[side]
        place = next(place for place, port in enumerate(ports) if port.line == line)
        height = self._height(number) + (place - (len(ports) - 1) / 2) * _PORT
        return self._middle(number) + outwards * box.across / 2, height

    # ---- drawing ---------------------------------------------------------------------------------------------------------

    def drawn(self) -> str:
        self._sort_ports()
        canvas = Canvas(self.shape.name)
        canvas.heading(self.shape.name, self.shape.note)
        for line in range(len(self.shape.lines)):
            self._draw_arc(canvas, line)
        for number in range(len(self.nodes)):
            self._draw_node(canvas, number)
        return canvas.svg()

    def _draw_node(self, canvas: Canvas, number: int) -> None:
        node, x, y = self.nodes[number], self._middle(number), self._height(number)
        canvas.open("edge" if node.is_edge else "vertex", kind=node.key.kind, name=node.key.name)
        box = self.boxes.get(number)
        if box is None:
            canvas.add(f'<circle class="circle" cx="{fixed(x)}" cy="{fixed(y)}" r="{fixed(_RADIUS)}"/>', x + _RADIUS, y + _RADIUS)
            canvas.text(x, y + _RADIUS + 3 + SIZE * 0.9, node.label, anchor="middle")
            canvas.text(x, y + _RADIUS + 3 + SIZE * 1.2 + SMALL * 0.9, node.facts, "fact", anchor="middle")
        else:
            left, top = fixed(x - box.across / 2), fixed(y - box.half)
            canvas.add(
                f'<rect class="box" x="{left}" y="{top}" width="{fixed(box.across)}" height="{fixed(2 * box.half)}" rx="3"/>',
                x + box.across / 2,
                y + box.half,
            )
            shift = SMALL * 0.6 if node.facts else 0.0
            canvas.symbol(node.symbol, x - width(node.label, SIZE) / 2 - 4, y - shift)
            canvas.text(x + 8, y - shift + SIZE * 0.35, node.label, anchor="middle")
            canvas.text(x, y + 14, node.facts, "fact", anchor="middle")
        canvas.close()

    def _draw_arc(self, canvas: Canvas, number: int) -> None:
        line, (start, end) = self.shape.lines[number], self.arcs[number]
        owner = self.owner[number]
        canvas.open("incidence", edge=line.edge.name, target=line.target.name, sign=SIGNS[line.sign])
        if start != end:
            canvas.path("arc", self._way(number))
            if line.sign:
                at = owner if line.sign > 0 else self.target[number]
                side = int(at == start)
                x, y = self._end(number, at, side)
                canvas.path("head", tip(x, y, 1 if side == 0 else -1))
        side = int(self.column[self.target[number]] >= self.column[owner])
        x, y = self._end(number, owner, side)
        canvas.text(x + (_STUB if side else -_STUB), y - 4, line.label, "weight", anchor="start" if side else "end")
        canvas.close()

    def _way(self, number: int) -> str:
        """The path of an arc: level through the columns, curved between them."""
        start, end = self.arcs[number]
        (x, y), (last_x, last_y) = self._end(number, start, 1), self._end(number, end, 0)
        passing = self.layout.passing[number]
        path = [f"M{fixed(x)} {fixed(y)}"]
        right = MARGIN + self.layout.ends[self.column[start]][1]
        for step, height in enumerate((*(_TOP + height for height in passing), last_y), self.column[start] + 1):
            is_last = step > self.column[start] + len(passing)
            left = MARGIN + self.layout.ends[self.column[end] if is_last else step][0]
            half = fixed((right + left) / 2)
            path.append(f"H{fixed(right)}C{half} {fixed(y)} {half} {fixed(height)} {fixed(left)} {fixed(height)}")
            right, y = MARGIN + self.layout.ends[min(step, self.column[end])][1], height
        path.append(f"H{fixed(last_x)}")
        return "".join(path)


def _box(node: DrawnNode, ports: tuple[list[_Port], list[_Port]]) -> _Box:
    """The measures of a hyperedge with these arcs."""
    across = max(width(node.label, SIZE) + 16, width(node.facts, SMALL)) + 20
    half = max(*(len(side) * _PORT for side in ports), 38 if node.facts else 26) / 2
    left, right = (max((width(port.label, SMALL) + _STUB + 4 for port in side), default=0.0) for side in ports)
    return _Box(across, half, ports, (left, right))
