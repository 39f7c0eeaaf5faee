"""The names of other frames in the notations of elements from SDF."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x.formats import sdf as words
from hymeko_x.formats.sdf import notations

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.ir.mechanism import Id

FRAMES = frozenset({"body", "joint", "frame"})
"""The kinds of elements that others name as frames."""
_EXPRESSED_IN = "/@expressed_in"


def renamed(table: Mapping[Id, Mapping[str, str]], names: Mapping[Id, Id]) -> dict[Id, Mapping[str, str]]:
    """The notations, by the present ids of their elements, with the new names of frames; ``names`` has the new id by the old one."""
    frames = {old.name: new.name for old, new in names.items() if old.kind in FRAMES}
    olds = {new: old for old, new in names.items()}
    return {key: _element(texts, _follower(olds.get(key, key), key, frames)) for key, texts in table.items()}


def _follower(was: Id, now: Id, frames: Mapping[str, str]) -> Callable[[str], str]:
    """The function that gives the present name of a frame, as the element refers to it."""
    before, after = _scope(was), _scope(now)

    def follow(name: str) -> str:
        full = words.scoped(before, name)
        return frames[full].removeprefix(after) if full in frames else name

    return follow


def _scope(key: Id) -> str:
    """The scope in which the element names frames: that of its model; that around it for a model."""
    scope, own = words.split_scope(key.name)
    return words.scope_around(scope) if own == words.MODEL_FRAME else scope


def _element(texts: Mapping[str, str], follow: Callable[[str], str]) -> Mapping[str, str]:
    return {name: _CHANGES[name](text, follow) if name in _CHANGES else text for name, text in texts.items()}


def _pose(text: str, follow: Callable[[str], str]) -> str:
    pose = notations.POSE.read(text)
    return text if pose is None or not pose.relative_to else notations.POSE.write(replace(pose, relative_to=follow(pose.relative_to)))


def _ends(text: str, follow: Callable[[str], str]) -> str:
    return " ".join(follow(name[:-1]) + "*" if name.endswith("*") else name for name in text.split(" "))


def _gearbox(text: str, follow: Callable[[str], str]) -> str:
    return notations.GEARBOX.write(tuple(follow(name) for name in notations.GEARBOX.read(text) or ()))


def _written(text: str, follow: Callable[[str], str]) -> str:
    texts = notations.WRITTEN.read(text) or {}
    return notations.WRITTEN.write({path: follow(value) if path.endswith(_EXPRESSED_IN) else value for path, value in texts.items()})


_CHANGES: Mapping[str, Callable[[str, Callable[[str], str]], str]] = {
    notations.POSE.name: _pose,
    notations.ATTACHED.name: lambda text, follow: follow(text),
    notations.ENDS.name: _ends,
    notations.GEARBOX.name: _gearbox,
    notations.WRITTEN.name: _written,
}
