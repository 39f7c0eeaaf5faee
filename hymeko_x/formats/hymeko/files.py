"""Names of files in HyMeKo text: ``~/`` stands for the folder that ``files`` names, and names without a dot get its ending.

With ``files "package://arm/meshes/*.stl"``, ``~/base`` is ``package://arm/meshes/base.stl``, and ``~/hand.obj`` is in the same folder.
"""

from __future__ import annotations

SHORT = "~/"
_ANY = "*"


def full_uri(uri: str, files: str) -> str:
    """The name of a file as its author wrote it."""
    if not files or not uri.startswith(SHORT):
        return uri
    folder, _, ending = files.partition(_ANY)
    name = uri.removeprefix(SHORT)
    return f"{folder}{name}{ending if _is_bare(name) else ''}"


def short_uri(uri: str, files: str) -> str:
    """The shortest name of a file that :func:`full_uri` reads as it is."""
    folder, _, ending = files.partition(_ANY)
    if not files or not uri.startswith(folder):
        return uri
    name = uri.removeprefix(folder)
    short = (f"{SHORT}{name.removesuffix(ending)}", f"{SHORT}{name}")
    return next((word for word in short if full_uri(word, files) == uri), uri)


def files_of(folder: str, uris: list[str]) -> str:
    """``files`` for a folder: with the commonest ending of the files in it, where that makes the text shorter."""
    names = [uri.removeprefix(folder) for uri in uris if uri.startswith(folder)]
    endings = [name[name.rindex(".") :] for name in names if "." in name]
    saved = {
        ending: len(ending) * sum(_is_bare(name.removesuffix(ending)) for name in names if name.endswith(ending)) for ending in endings
    }
    best = max(saved, key=lambda ending: (saved[ending], ending), default="")
    return f"{folder}{_ANY}{best}" if best and saved[best] > len(best) + 1 else folder


def _is_bare(name: str) -> bool:
    """Whether a name has no ending of its own."""
    last = name[name.rfind("/") + 1 :]
    return bool(last) and "." not in last
