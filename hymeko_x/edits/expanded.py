"""Where the elements of a robot are written in a text whose macros were expanded."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from hymeko_x.edits.splicing import ByteLines

if TYPE_CHECKING:
    from hymeko_x.edits.matching import Named
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.outline import Outline, OutlineBlock


def written_blocks(own: Outline, mechanism: Mechanism) -> Named:
    """The blocks of bodies and joints by their tags and the names of their elements, which a text may have as expressions.

    What several elements are made from, in a macro that is used several times, is none's. ``mechanism`` is what the text was read as,
    with the lines of its elements.
    """
    made: dict[tuple[str, int], list[str]] = defaultdict(list)
    for key in (*mechanism.graph.vertices, *mechanism.graph.edges):
        origin = mechanism.origin(key)
        if key.kind in ("body", "joint") and origin is not None and origin.line is not None:
            made[origin.file, origin.line].append(key.name)
    lines = {name: ByteLines(file.data) for name, file in own.files.items()}
    found: dict[tuple[str, str], list[OutlineBlock]] = defaultdict(list)
    for block in own.root.walk():
        names = made.get((block.file, lines[block.file].of(block.start)), ()) if block.name else ()
        if len(names) == 1:
            found[block.tag, names[0]].append(block)
    return {named: blocks[0] for named, blocks in found.items() if len(blocks) == 1}
