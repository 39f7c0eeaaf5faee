"""The kinematic tree as a picture: bodies and joints at the left, their facts in columns, hyperedges as tracks at the right."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.draw.graph.facts import symbol
from hymeko_x.draw.graph.letters import shown, width
from hymeko_x.draw.graph.svg import MARGIN, SIZE, SMALL, Canvas, fixed
from hymeko_x.draw.graph.tree import LINE, joint_text
from hymeko_x.ir.mechanism import WORLD

if TYPE_CHECKING:
    from hymeko_x.draw.graph.tree import BodyRow, DrawnTree, OverRow

_PITCH = 30.0
"""The distance of rows."""
_LANE = 40.0
_RADIUS = 7.0
_SPACE = 24.0
"""The distance of columns of text."""
_TRACK = 16.0
_TOP = MARGIN + 48.0
_SYMBOL = 20.0


def tree_picture(shape: DrawnTree) -> str:
    """The SVG of a kinematic tree."""
    return _Picture(shape).drawn()


class _Picture:
    def __init__(self, shape: DrawnTree) -> None:
        self.shape = shape
        self.at = {body.row: body for body in shape.bodies}
        joints = [joint_text(body.joint) for body in shape.bodies if body.joint]
        self.mass = max((self._name_end(body) for body in shape.bodies), default=MARGIN) + _SPACE
        masses = [width(body.mass, SMALL) for body in shape.bodies]
        self.mass_end = self.mass + max(masses, default=0.0)
        self.joint = self.mass_end + (_SPACE if any(masses) else 0.0)
        names = [width(name, SIZE) for name, _ in joints] + [width(shown(over.key.name), SIZE) + _SYMBOL for over in shape.over]
        self.motion = self.joint + max(names, default=0.0) + _SPACE
        facts = [width(text, SMALL) for _, text in joints] + [width(text, SMALL) for over in shape.over for text in over.text]
        self.note = self.motion + max(facts, default=0.0) + _SPACE
        notes = [width(body.note, SMALL) + _SPACE for body in shape.bodies if body.note]
        self.tracks = self.note + max(notes, default=0.0)

    def _x(self, body: BodyRow) -> float:
        return MARGIN + _RADIUS + body.lane * _LANE

    def _name_end(self, body: BodyRow) -> float:
        return self._x(body) + _RADIUS + 6 + width(shown(body.key.name), SIZE)

    def drawn(self) -> str:
        canvas = Canvas(self.shape.name)
        canvas.heading(self.shape.name, self.shape.note)
        for over in self.shape.over:
            self._draw_track(canvas, over)
        for body in self.shape.bodies:
            self._draw_joint(canvas, body)
        for body in self.shape.bodies:
            self._draw_body(canvas, body)
        for over in self.shape.over:
            self._draw_over(canvas, over)
        return canvas.svg()

    def _draw_body(self, canvas: Canvas, body: BodyRow) -> None:
        x, y = self._x(body), _y(body.row)
        canvas.open("vertex", kind=body.key.kind, name=body.key.name)
        if body.key == WORLD:
            canvas.add(f'<path class="track" d="M{fixed(x - 8)} {fixed(y)}h16m-14 0l-3 5m8 -5l-3 5m8 -5l-3 5"/>')
        else:
            canvas.add(f'<circle class="circle" cx="{fixed(x)}" cy="{fixed(y)}" r="{fixed(_RADIUS)}"/>')
        canvas.text(x + _RADIUS + 6, y + SIZE * 0.35, shown(body.key.name))
        canvas.text(self.mass_end, y + SIZE * 0.35, body.mass, "fact", anchor="end")
        canvas.text(self.note, y + SIZE * 0.35, body.note, "fact")
        canvas.close()

    def _draw_joint(self, canvas: Canvas, body: BodyRow) -> None:
        """The line from the parent with the symbol of the joint, and its words."""
        if body.joint is None:
            return
        y, parent = _y(body.row), self.at.get(body.parent) if body.parent is not None else None
        canvas.open("edge", kind="joint", name=body.joint.id.name)
        if parent is not None:
            x, start = self._x(parent), _y(parent.row) + (2 if parent.key == WORLD else _RADIUS)
            is_beside = parent.lane != body.lane
            canvas.path("line", f"M{fixed(x)} {fixed(start)}V{fixed(y)}" + (f"H{fixed(self._x(body) - _RADIUS)}" if is_beside else ""))
            canvas.symbol(symbol(body.joint.joint), x + _LANE / 2 if is_beside else x, y if is_beside else y - _PITCH / 2)
        name, moves = joint_text(body.joint)
        canvas.text(self.joint, y + SIZE * 0.35, name)
        canvas.text(self.motion, y + SIZE * 0.35, moves, "fact")
        canvas.close()

    def _draw_over(self, canvas: Canvas, over: OverRow) -> None:
        y = _y(over.row)
        canvas.open("edge", kind=over.key.kind, name=over.key.name)
        canvas.symbol(over.key.kind, self.joint + 6, y)
        canvas.text(self.joint + _SYMBOL, y + SIZE * 0.35, shown(over.key.name))
        for number, line in enumerate(over.text):
            canvas.text(self.motion, _y(over.row + LINE * number) + SIZE * 0.35, line, "fact")
        canvas.close()

    def _draw_track(self, canvas: Canvas, over: OverRow) -> None:
        """The line from the first member down to the hyperedge's own row, with a mark at every member."""
        x, last = self.tracks + over.track * _TRACK, _y(over.row)
        canvas.open("over", kind=over.key.kind, name=over.key.name)
        for row in over.members:
            canvas.path("leader", f"M{fixed(self._row_end(row))} {fixed(_y(row))}H{fixed(x)}")
        canvas.path("leader", f"M{fixed(self.motion + width(over.text[0], SMALL) + 6)} {fixed(last)}H{fixed(x)}")
        canvas.path("track", f"M{fixed(x)} {fixed(_y(min(over.members, default=over.row)))}V{fixed(last)}")
        for row, sign in over.members.items():
            kind = "out" if sign < 0 else "into"
            canvas.add(f'<circle class="{kind}" cx="{fixed(x)}" cy="{fixed(_y(row))}" r="{3 if sign == 0 else 4}"/>')
        canvas.add(f'<g transform="translate({fixed(x)} {fixed(last)})"><path class="into" d="M0-5L5 0L0 5L-5 0Z"/></g>', x + 8, last)
        canvas.close()

    def _row_end(self, row: float) -> float:
        """Where the text of a body's row ends."""
        body = self.at[row]
        if body.note:
            return self.note + width(body.note, SMALL) + 6
        if body.joint is not None:
            return self.motion + width(joint_text(body.joint)[1], SMALL) + 6
        return (self.mass_end if body.mass else self._name_end(body)) + 6


def _y(row: float) -> float:
    return _TOP + row * _PITCH
