"""Wavefront MTL libraries: what the materials of OBJ files look like."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.meshes.part import Finish

if TYPE_CHECKING:
    from collections.abc import Sequence

_SOLID = 3
_DIGITS = 12
"""After which what is left of 1 is a matter of its double."""


def finishes_of(library: bytes) -> dict[str, Finish]:
    """The colour and the image of each material of an MTL file that has some.

    Source: MTL material format (Lightwave, OBJ), Wavefront.
    """
    found: dict[str, Finish] = {}
    shares: dict[str, dict[str, list[str]]] = {}
    name = ""
    for line in library.decode("utf-8", "replace").splitlines():
        word, _, rest = line.strip().partition(" ")
        said = rest.strip()
        if word == "newmtl":
            name = said
        elif word == "Kd" and (rgb := _rgb(said)) is not None:
            found[name] = found.get(name, Finish())._replace(rgba=(*rgb, 1.0))
        elif word == "map_Kd" and said:
            found[name] = found.get(name, Finish())._replace(image=said.split()[-1] if said.startswith("-") else said)
        elif word in ("d", "Tr"):
            shares.setdefault(name, {})[word] = said.split()
    return {name: _seen_through(finish, shares.get(name, {})) for name, finish in found.items()}


def _seen_through(finish: Finish, said: dict[str, list[str]]) -> Finish:
    if finish.rgba is None:
        return finish
    return finish._replace(rgba=(*finish.rgba[:3], opacity(said.get("d", ()), said.get("Tr", ()))))


def opacity(dissolve: Sequence[str], transparency: Sequence[str]) -> float:
    """How much a material hides of what is behind it, 0..1: what ``d`` says, else what ``Tr`` leaves of 1, by the words behind them.

    What nobody would see is opaque: files say `Tr 1` (MeshLab) or `d 0` (Blender) of robots that are there to be seen.
    """
    through = _share(transparency)
    found = _share(dissolve) or (None if through is None else round(1.0 - through, _DIGITS))
    return found or 1.0


def _share(words: Sequence[str]) -> float | None:
    """The number from 0 to 1 that comes first; None for anything else, such as a halo, of which each side hides another part."""
    try:
        value = float(words[0])
    except (ValueError, IndexError):
        return None
    return value if 0.0 <= value <= 1.0 else None


def _rgb(said: str) -> tuple[float, float, float] | None:
    try:
        values = [float(word) for word in said.split()]
    except ValueError:
        return None
    if len(values) != _SOLID or not all(0.0 <= value <= 1.0 for value in values):
        return None
    return values[0], values[1], values[2]
