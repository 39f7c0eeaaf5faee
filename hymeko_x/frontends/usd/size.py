"""How large a stage would become: references that copy references double with every level, and USD composes them all."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from hymeko_x import codes
from hymeko_x.diagnostics import Origin, refuse

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from hymeko_x.source import Source

FEW = 12
"""With fewer references than these a stage is not counted: it cannot grow far."""

MOST_DEPTH = 2048
"""How deep blocks of a text may be nested: USD's parser recurses."""

Place = tuple[str, str]
"""A layer by its identifier, and the path of a prim in it."""


_PIECES = re.compile(rb'''"""(?:\\.|[^\\])*?"""|'{3}(?:\\.|[^\\])*?'{3}|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|#[^\n]*|[{}]''', re.DOTALL)


def check_depth(path: str, source: Source) -> None:
    """Refuse a text that would overflow the stack of USD's parser.

    Raises: Refusal HX007.
    """
    with open(path, "rb") as file:
        data = file.read() if file.read(5) == b"#usda" else b""
    if data.count(b"{") <= MOST_DEPTH:
        return
    depth = 0
    for found in _PIECES.finditer(data):
        depth += (found[0] == b"{") - (found[0] == b"}")
        if depth > MOST_DEPTH:
            raise refuse(codes.TOO_LARGE, f"blocks are nested more than {MOST_DEPTH} deep", Origin(source.name))


def check_paths(paths: Iterable[str], source: Source) -> None:
    """Refuse prims that lie too deep, which a binary layer shows only when it is open: composing them recurses.

    Raises: Refusal HX007.
    """
    if any(path.count("/") > MOST_DEPTH for path in paths):
        raise refuse(codes.TOO_LARGE, f"prims are nested more than {MOST_DEPTH} deep", Origin(source.name))


def check_size(layers: list[Any], most: int, source: Source) -> None:
    """Refuse a stage of more than ``most`` prims before USD composes it. A prim that refers to itself counts once.

    Raises: Refusal HX007.
    """
    known = {layer.identifier: layer for layer in layers} | {layer.realPath: layer for layer in layers}
    below = {(layer.identifier, str(spec.path)): list(_parts(layer, spec, known)) for layer in layers for spec in specs(layer)}
    check_paths((path for _, path in below), source)
    if sum(len(parts) for parts in below.values()) - len(below) < FEW:
        return
    sizes: dict[Place, int] = {}
    for start in below:
        if _count(start, below, sizes) > most:
            raise refuse(codes.TOO_LARGE, f"it has more than {most} prims when everything is composed", Origin(source.name))


def _count(start: Place, below: dict[Place, list[Place]], sizes: dict[Place, int]) -> int:
    """The number of prims at a place with everything that is in it and everything that it refers to."""
    stack, open_now = [start], set()
    while stack:
        place = stack[-1]
        if place in sizes:
            stack.pop()
        elif place in open_now:
            open_now.discard(place)
            sizes[place] = 1 + sum(sizes.get(part, 0) for part in below.get(place, ()))
            stack.pop()
        else:
            open_now.add(place)
            stack.extend(part for part in below.get(place, ()) if part not in open_now and part not in sizes)
    return sizes[start]


def specs(layer: Any) -> Iterator[Any]:
    """Every prim that a layer says something about, also in variants. Not recursive."""
    stack = [layer.pseudoRoot]
    while stack:
        spec = stack.pop()
        yield spec
        stack.extend(spec.nameChildren)
        stack.extend(variant.primSpec for group in spec.variantSets for variant in group.variants)


def _parts(layer: Any, spec: Any, known: dict[str, Any]) -> Iterator[Place]:
    """What a prim is made of: the prims in it, and those that it refers to."""
    for inside in (*spec.nameChildren, *(variant.primSpec for group in spec.variantSets for variant in group.variants)):
        yield layer.identifier, str(inside.path)
    for path in (*spec.inheritPathList.GetAppliedItems(), *spec.specializesList.GetAppliedItems()):
        yield layer.identifier, str(path)
    for arc in (*spec.referenceList.GetAppliedItems(), *spec.payloadList.GetAppliedItems()):
        target = known.get(layer.ComputeAbsolutePath(arc.assetPath)) if arc.assetPath else layer
        path = str(arc.primPath) or (f"/{target.defaultPrim}" if target is not None else "")
        if target is not None:
            yield target.identifier, path
