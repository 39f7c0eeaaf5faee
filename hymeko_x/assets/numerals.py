"""Numbers of texts straight into arrays."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SHORT = 4096
"""So many letters are turned into numbers one by one before the arrangements for many of them are worth their time."""


def numbers_in(text: str | bytes, kind: Any = np.float64) -> NDArray[Any]:
    """The numbers of a text, with blanks between them.

    Raises: ValueError where there is anything else, OverflowError for whole numbers that are too large.
    """
    if len(text) < _SHORT:
        return _few_numbers(text if isinstance(text, bytes) else text.encode(), kind)
    if text.isspace():
        return np.zeros(0, dtype=kind)
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, dtype=kind, sep=" ")
        except DeprecationWarning as warned:  # as numpy said it before it was an error
            raise ValueError(str(warned)) from warned


def _few_numbers(text: bytes, kind: Any) -> NDArray[Any]:
    if b"_" in text:
        raise ValueError("an underscore is no part of a number")
    plain: type[int] | type[float] = int if np.issubdtype(kind, np.integer) else float
    return np.array(list(map(plain, text.split())), dtype=kind)
