"""What is done with every file of a run: the pairs of formats, verification, and the limits of one process."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from msgspec import Struct
from msgspec.structs import asdict

from hymeko_x import formats

if TYPE_CHECKING:
    from collections.abc import Iterator

READ, ENGINE, CONVERT, VERIFY = "read", "engine", "convert", "verify"
"""The steps of one file: our reader, the format's reference reader, and for each target a conversion and its verification."""


class Limits(Struct, frozen=True):
    """What one process may use: wall-clock seconds, and bytes of memory, of which MuJoCo reserves some that it never touches."""

    seconds: float = 180.0
    bytes: int = 5 * 2**30


class Plan(Struct, frozen=True):
    """``pairs`` are (source, target) formats; ``samples`` and ``meshes`` go to the verifier."""

    pairs: tuple[tuple[str, str], ...]
    verify: bool = True
    samples: int = 20
    meshes: bool = True
    limits: Limits = Limits()

    def steps(self, source: str) -> tuple[str, ...]:
        """The steps of a file of this format, in order: ``read``, ``engine``, then ``convert:TARGET`` and ``verify:TARGET``."""
        return (READ, *self._steps(source))

    def _steps(self, source: str) -> Iterator[str]:
        if self.verify:
            yield ENGINE
        for target in self.targets(source):
            yield f"{CONVERT}:{target}"
            if self.verify:
                yield f"{VERIFY}:{target}"

    def targets(self, source: str) -> tuple[str, ...]:
        """The formats into which a file of this format is converted."""
        return tuple(target for start, target in self.pairs if start == source)

    def as_json(self) -> dict[str, Any]:
        """What two runs must have in common for the one to continue the other. The limits may differ."""
        return {key: value for key, value in asdict(self).items() if key != "limits"}


def pairs_of(words: str) -> tuple[tuple[str, str], ...]:
    """The pairs named by ``urdf:mjcf,mjcf:usd`` or by ``all``, from the table of formats.

    ``all`` is every format that can be read times every format that can be written; the containers of one format
    are one.

    Raises: Refusal HX003 when a format is not known; ValueError when the words are no pairs.
    """
    if words == "all":
        rows = formats.families()
        return tuple((a.name, b.name) for a in rows if a.frontend for b in rows if b.backend)
    found = []
    for word in words.split(","):
        source, colon, target = word.partition(":")
        if not (source and colon and target):
            raise ValueError(f"expected pairs such as urdf:mjcf, found '{word}'")
        found.append((formats.by_name(source).name, formats.by_name(target).name))
    return tuple(dict.fromkeys(found))
