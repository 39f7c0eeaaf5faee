"""One number in other digits, and several of them between other blanks."""

from __future__ import annotations

from random import Random

BLANKS = ("\t", "\n ", " \n\t")
"""Blanks of XML beside the space, which is the only one that urdfdom knows."""


def digits(word: str, chance: Random) -> str:
    """The same double in other decimal digits."""
    value = float(word)
    sign, plain = ("-" if word.startswith("-") else chance.choice(["", "+"])), word.lstrip("+-")
    forms = [plain, f"{abs(value):.17e}", f"{abs(value):.17e}".upper(), f"0{plain}"]
    if "e" not in plain.lower():
        forms += [f"{plain}00", plain.removeprefix("0")] if "." in plain else [f"{plain}.", f"{plain}.0", f"{plain}e0", f"{plain}e+00"]
    return sign + chance.choice([form for form in forms if form not in ("", ".")])


def apart(words: list[str], chance: Random, blanks: tuple[str, ...] = ()) -> str:
    """Words between spaces or other blanks, and some before and after them; to urdfdom a number alone has none around it."""
    if len(words) == 1 and not blanks:
        return words[0]
    between = (" ", "  ", *blanks)
    ends = ("", "", *between)
    return chance.choice(ends) + "".join(f"{word}{chance.choice(between)}" for word in words).rstrip() + chance.choice(ends)


def numbers(text: str, chance: Random, blanks: tuple[str, ...] = ()) -> str:
    """The same numbers in other digits and between other blanks."""
    return apart([digits(word, chance) for word in text.split()], chance, blanks)


def joined(values: object) -> str:
    """Numbers as they are, between blanks."""
    return " ".join(repr(float(value)) for value in values)  # type: ignore[attr-defined]
