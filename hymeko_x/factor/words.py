"""Names for what several elements share, from the words of their own names: ``hip`` of ``left_hip_pitch`` and ``right_hip_roll``."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Sequence

_SIDES = "left right l r front rear hind back middle mid fl fr rl rr hl hr bl br ml mr lf rf lr lh rh lb rb lm rm"
_KINDS = "joint link body geom shape mesh part visual collision frame robot motor actuator act jnt torq mat"
_PLAIN: frozenset[str] = frozenset(f"{_SIDES} {_KINDS}".split())
"""Words that say on which side an element is, or of which kind; they tell nothing of what it is."""

_WORD = re.compile(r"[^\W_\d]+")
_HUMP = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
_SIDE = re.compile(r"(?:left|right)(?=[a-z]{3})", re.IGNORECASE)
_LIMBS = {
    "leg": "leg hip thigh knee shin shank calf ankle foot toe femur tibia",
    "arm": "arm shoulder elbow wrist forearm upperarm",
    "finger": "finger thumb index ring little pinky ffj mfj rfj lfj thj",
}
_LIMB_OF = {word: limb for limb, words in _LIMBS.items() for word in words.split()}


def words_of(name: str) -> list[str]:
    """The words of a name in order, each once: those between signs and digits, as they are written."""
    return list(dict.fromkeys(_WORD.findall(name)))


def telling_words(name: str) -> list[str]:
    """The words of a name that tell what it is: ``finger`` of ``left_finger1`` and of ``leftFinger``."""
    return _telling(_WORD.findall(name), ())


def distinguishing_words(names: Sequence[str]) -> list[list[str]]:
    """The telling words of each of these names, without the words that all of them have."""
    split = [tuple(_WORD.findall(name)) for name in names]
    of_all = frozenset(split[0]).intersection(*split[1:])
    telling = {words: _telling(words, of_all) for words in frozenset(split)}
    return [telling[words] for words in split]


def _telling(words: Sequence[str], plain: Collection[str]) -> list[str]:
    """Those of a name's words that tell what it is, without ``plain`` ones."""
    text = " ".join(words)
    parts = _SIDE.sub("", text if text.islower() else _HUMP.sub(" ", text)).split()
    return [word for word in dict.fromkeys(parts) if len(word) > 2 and word.lower() not in _PLAIN and word not in plain]


def limb(names: Iterable[str]) -> str:
    """``leg``, ``arm`` or ``finger`` where each of these names has a word for a part of that; empty otherwise."""
    limbs = {next((_LIMB_OF[word] for word in map(str.lower, telling_words(name)) if word in _LIMB_OF), "") for name in names}
    return limbs.pop() if len(limbs) == 1 else ""


def limb_of_most(names: Sequence[str]) -> str:
    """The limb of which more than half of these names have a part, if none is of another one; empty otherwise."""
    limbs = Counter(found for name in names if (found := limb([name])))
    return next(iter(limbs)) if len(limbs) == 1 and 2 * limbs.total() > len(names) else ""


_LEFT = frozenset(["left", "l", "fl", "rl", "hl", "bl", "ml", "lf", "lr", "lh", "lb", "lm"])
_RIGHT = frozenset(["right", "r", "fr", "rr", "hr", "br", "mr", "rf", "rh", "rb", "rm"])


def side(names: Iterable[str]) -> str:
    """The side on which all of these are, by a word of their names: ``left`` or ``right``; empty where that is not known."""
    sides = {next((here for word in words_of(name) if (here := _side(word.lower()))), "") for name in names}
    return sides.pop() if len(sides) == 1 else ""


def _side(word: str) -> str:
    return "left" if word in _LEFT else "right" if word in _RIGHT else ""


def common_words(names: Sequence[str]) -> str:
    """The words that all names share, in the order of the first: ``hip_joint`` of ``left_hip_joint`` and ``right_hip_joint``."""
    shared = _shared([words_of(name) for name in names])
    return shared if any(len(word) > 2 for word in shared.split("_")) else ""


def meaning(names: Sequence[str]) -> str:
    """What all of these are, by the telling words that their names share; empty for none."""
    return _shared([telling_words(name) for name in names])


def _shared(split: Sequence[Sequence[str]]) -> str:
    """The words that all of these have, in the order of the first."""
    shared = set(split[0]).intersection(*split[1:])
    return "_".join([word for word in split[0] if word in shared])


def by_meaning(split: Sequence[Sequence[str]], least: int) -> list[tuple[str, list[int]]]:
    """Groups of at least so many names with a meaning, by their places: all of them, or those that share a telling word.

    ``split`` are the telling words of each name. A name is in one group at most; the largest groups come first.
    """
    if len(split) >= least and (found := _shared(split)):
        return [(found, list(range(len(split))))]
    left = dict(enumerate(split))
    groups: list[tuple[str, list[int]]] = []
    while True:
        counts = Counter(word for words in left.values() for word in words)
        word = max(counts, key=lambda word: (counts[word], word), default="")
        if counts[word] < least:
            return groups
        places = [place for place, words in left.items() if word in words]
        groups.append((_shared([split[place] for place in places]), places))
        left = {place: words for place, words in left.items() if word not in words}
