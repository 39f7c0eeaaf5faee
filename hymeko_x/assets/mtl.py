"""Wavefront MTL libraries: what the materials of OBJ files look like."""

from __future__ import annotations

from hymeko_x.assets.part import Finish

_SOLID = 3


def finishes_of(library: bytes) -> dict[str, Finish]:
    """The colour and the image of each material of an MTL file that has some.

    Source: MTL material format (Lightwave, OBJ), Wavefront.
    """
    found: dict[str, Finish] = {}
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
    return found


def _rgb(said: str) -> tuple[float, float, float] | None:
    try:
        values = [float(word) for word in said.split()]
    except ValueError:
        return None
    if len(values) != _SOLID or not all(0.0 <= value <= 1.0 for value in values):
        return None
    return values[0], values[1], values[2]
