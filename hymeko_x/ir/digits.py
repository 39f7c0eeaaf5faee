"""Numbers as text: the fewest digits that read back to the same double."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import TYPE_CHECKING

from msgspec.json import encode

if TYPE_CHECKING:
    from collections.abc import Mapping

_FLOATS = {float}
_FEW = 16
"""Rows of up to so many numbers keep their text; longer ones, such as the points of a mesh, hardly come twice."""
_WITH_EXPONENT = re.compile(r"([\[,-])0\.0000([1-9])(\d*)")
"""A number from 1e-5 to 1e-4 in a list as a writer of JSON has it, with the sign before it; Python writes it with an exponent."""


def number_text(value: float) -> str:
    """The shortest decimal text that reads back to the same double: ``0.1``, ``2``, ``-1e-7``."""
    text = repr(value) if type(value) is float else repr(float(value))
    return text.replace("e-0", "e-").replace("e+", "e") if "e" in text else text.removesuffix(".0")


def numbers_text(values: tuple[float, ...]) -> str:
    """Numbers separated by blanks, each as :func:`number_text` writes it.

    A writer of JSON finds the digits in a tenth of the time; where it cannot represent a value, Python is asked.
    """
    count = len(values)
    try:
        data = encode(values)
    except TypeError:  # a number that is no plain one of Python
        return " ".join(map(number_text, values))
    text = _text_of_few(data, count) if count <= _FEW else None
    if text is None:
        is_plain = data.count(b".") == count or (b"null" not in data and are_numbers(values))
        text = _text_of(data) if is_plain else " ".join(map(number_text, values))
    return text


@lru_cache(4096)  # mirrored parts have the same numbers, and what was written is printed again when it is read back
def _text_of_few(data: bytes, count: int) -> str | None:
    """The text of so many numbers in JSON; None where one of them has no point, as whole numbers and very large ones."""
    return _text_of(data) if data.count(b".") == count else None


def _text_of(data: bytes) -> str:
    """The text of a list of floats in JSON."""
    text = data.decode()
    if "0.0000" in text:
        text = _WITH_EXPONENT.sub(lambda found: f"{found[1]}{found[2]}.{found[3]}e-5" if found[3] else f"{found[1]}{found[2]}e-5", text)
    return text[1:-1].replace(".0,", " ").replace(",", " ").removesuffix(".0")


def number_texts(values: Mapping[str, float]) -> dict[str, str]:
    """What :func:`number_text` writes of each, sooner than one by one."""
    return dict(zip(values, numbers_text(tuple(values.values())).split(" "), strict=True)) if values else {}


def are_numbers(values: tuple[object, ...]) -> bool:
    """Whether these are floating-point numbers and nothing else, as :func:`numbers_text` writes them fastest."""
    return {*map(type, values)} == _FLOATS
