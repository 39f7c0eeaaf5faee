"""Which programs are compared, on which way from format to format."""

from __future__ import annotations

from importlib.metadata import version

from msgspec import Struct

from peers import (
    CYBERWAVE,
    HYMEKO_X,
    IDYNTREE,
    MJCF_URDF,
    MUJOCO,
    MUJOCO_USD_CONVERTER,
    SCIKIT_ROBOT,
    URDF2MJCF,
    URDF_TO_MJCF,
    URDF_USD_CONVERTER,
    YOURDFPY,
    Peer,
)


class Entrant(Struct, frozen=True):
    """A program on a way; ``measure`` asks ours for the ledger and the residue as well."""

    peer: Peer
    measure: bool = False

    @property
    def is_ours(self) -> bool:
        """Whether it is hymeko-x."""
        return self.peer is HYMEKO_X

    @property
    def name(self) -> str:
        """What it is called in the results."""
        if not self.is_ours:
            return self.peer.name
        return "hymeko-x, with ledger and residue" if self.measure else "hymeko-x"

    @property
    def version(self) -> str:
        """The release that is compared, as the peers pin it or our environment has it; ours is that of this repository."""
        if self.is_ours:
            return ""
        if self.peer.requirements:
            return self.peer.requirements[0].partition("==")[2]
        return version(self.peer.name)


class Way(Struct, frozen=True):
    """From a format to another one, or to nothing when files are only loaded. The first entrant is the measure of all."""

    source: str
    target: str
    entrants: tuple[Entrant, ...]

    @property
    def name(self) -> str:
        """What it is called in the results."""
        return f"{self.source} to {self.target}" if self.target else f"loading {self.source}"


_OURS = (Entrant(HYMEKO_X), Entrant(HYMEKO_X, measure=True))


def _way(source: str, target: str, *peers: Peer) -> Way:
    return Way(source, target, (*(_OURS if target else _OURS[:1]), *map(Entrant, peers)))


WAYS = (
    _way("urdf", "mjcf", MUJOCO, CYBERWAVE, SCIKIT_ROBOT, URDF2MJCF, URDF_TO_MJCF),
    _way("mjcf", "urdf", MJCF_URDF, CYBERWAVE),
    _way("urdf", "usd", URDF_USD_CONVERTER, CYBERWAVE, SCIKIT_ROBOT),
    _way("mjcf", "usd", MUJOCO_USD_CONVERTER, CYBERWAVE),
    _way("urdf", "urdf", IDYNTREE, CYBERWAVE),
    _way("urdf", "", YOURDFPY),
)
