"""SVG: the canvas with its lines and texts, and the style that is right for light and dark pages. Names are text, never markup."""

from __future__ import annotations

from hymeko_x.draw.graph.letters import HEIGHT, shown, width
from hymeko_x.xml.text import escaped

SIZE = 13.0
"""The size of names."""
SMALL = 11.0
"""The size of facts and weights."""
_STYLE = """
  .page { fill: #ffffff }
  text { font: 13px "DejaVu Sans Mono", Menlo, Consolas, monospace; fill: #1a1a1a; white-space: pre }
  .fact, .weight { font-size: 11px; fill: #4a4a4a }
  .heading { font-weight: bold }
  .line, .arc { fill: none; stroke: #595959; stroke-width: 1.3 }
  .leader { fill: none; stroke: #b0b0b0; stroke-width: 1; stroke-dasharray: 1 4 }
  .head { fill: #595959; stroke: none }
  .circle { fill: #e3f0fa; stroke: #0072b2; stroke-width: 1.6 }
  .box { fill: #fdeee3; stroke: #b34a00; stroke-width: 1.6 }
  .glyph { fill: #ffffff; stroke: #b34a00; stroke-width: 1.6 }
  .solid { fill: #b34a00; stroke: #b34a00 }
  .track { fill: none; stroke: #007a5a; stroke-width: 1.6 }
  .into { fill: #007a5a; stroke: #007a5a; stroke-width: 1.6 }
  .out { fill: #ffffff; stroke: #007a5a; stroke-width: 1.6 }
  @media (prefers-color-scheme: dark) {
    .page { fill: #16181c }
    text { fill: #f0f0f0 }
    .fact, .weight { fill: #b9b9b9 }
    .line, .arc { stroke: #a0a0a0 }
    .leader { stroke: #5a5a5a }
    .head { fill: #a0a0a0 }
    .circle { fill: #0c2d42; stroke: #56b4e9 }
    .box { fill: #40220c; stroke: #ff9a4d }
    .glyph { fill: #16181c; stroke: #ff9a4d }
    .solid { fill: #ff9a4d; stroke: #ff9a4d }
    .track { stroke: #2fd3a5 }
    .into { fill: #2fd3a5; stroke: #2fd3a5 }
    .out { fill: #16181c; stroke: #2fd3a5 }
  }
"""
MARGIN = 20.0
GLYPHS = {
    "revolute": '<circle class="glyph" r="6"/><circle class="solid" r="1.5"/>',
    "prismatic": '<rect class="glyph" x="-6" y="-4" width="12" height="8"/><path class="glyph" d="M-3 0H3"/>',
    "screw": '<circle class="glyph" r="6"/><path class="glyph" d="M-3 3L3-3"/>',
    "ball": '<circle class="solid" r="3"/><path class="glyph" d="M-6 0A6 6 0 0 0 6 0"/>',
    "free": '<circle class="glyph" r="6" stroke-dasharray="2 2"/>',
    "fixed": '<rect class="solid" x="-4" y="-4" width="8" height="8"/>',
    "several": '<circle class="glyph" r="6"/><circle class="glyph" r="2.5"/>',
}
"""The symbols of joints, 12 units wide about their middle."""
HYPEREDGE = '<path class="into" d="M0-5L5 0L0 5L-5 0Z"/>'
"""The symbol of every other edge."""


class Canvas:
    """Elements in drawing order; the picture is as large as what was drawn needs."""

    def __init__(self, title: str) -> None:
        self._title = title
        self._parts: list[str] = []
        self._right = 0.0
        self._bottom = 0.0

    def add(self, markup: str, right: float = 0.0, bottom: float = 0.0) -> None:
        """Put finished markup, which reaches so far to the right and down."""
        self._parts.append(markup)
        self._right = max(self._right, right)
        self._bottom = max(self._bottom, bottom)

    def text(self, x: float, y: float, words: str, kind: str = "", *, anchor: str = "start") -> None:
        """One line of text, ``y`` at its base line. ``kind`` is a class of the style."""
        if not words:
            return
        size = SMALL if kind in ("fact", "weight") else SIZE
        given = f' class="{kind}"' if kind else ""
        anchored = "" if anchor == "start" else f' text-anchor="{anchor}"'
        share = {"start": 1.0, "middle": 0.5, "end": 0.0}[anchor]
        self.add(
            f'<text{given} x="{fixed(x)}" y="{fixed(y)}"{anchored}>{escaped(words)}</text>',
            x + share * width(words, size),
            y + (HEIGHT - 0.9) * size,
        )

    def heading(self, name: str, note: str) -> None:
        """The name of what is drawn, and what is not drawn."""
        self.text(MARGIN, MARGIN + SIZE, shown(name), "heading")
        self.text(MARGIN, MARGIN + 2 * SIZE + 4, note, "fact")

    def path(self, kind: str, d: str) -> None:
        """A line."""
        self.add(f'<path class="{kind}" d="{d}"/>')

    def open(self, style: str, **data: str) -> None:
        """Begin a group; its data are attributes."""
        words = "".join(f' data-{name}="{escaped(shown(value))}"' for name, value in data.items())
        self.add(f'<g class="{style}"{words}>')

    def close(self) -> None:
        """End the group."""
        self.add("</g>")

    def symbol(self, name: str, x: float, y: float) -> None:
        """The symbol of an edge about a point."""
        self.add(f'<g transform="translate({fixed(x)} {fixed(y)})">{GLYPHS.get(name, HYPEREDGE)}</g>', x + 8, y + 8)

    def svg(self) -> str:
        """The picture as a file."""
        size = f"{fixed(self._right + MARGIN)} {fixed(self._bottom + MARGIN)}"
        across, down = size.split()
        return "\n".join(
            (
                f'<svg xmlns="http://www.w3.org/2000/svg" width="{across}" height="{down}" viewBox="0 0 {size}" role="img">',
                f"<title>{escaped(shown(self._title))}</title>",
                f"<style>{_STYLE}</style>",
                '<rect class="page" width="100%" height="100%"/>',
                *self._parts,
                "</svg>\n",
            )
        )


def fixed(value: float) -> str:
    """A length with one digit behind the point at most."""
    return f"{value + 0.0:.1f}".removesuffix(".0")


def tip(x: float, y: float, towards: int) -> str:
    """The path of an arrow's head that ends at a point, pointing to the right (1) or to the left (-1)."""
    return f"M{fixed(x)} {fixed(y)}l{-9 * towards} -4v8z"
