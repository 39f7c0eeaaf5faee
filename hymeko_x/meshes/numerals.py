"""Numbers of texts as arrays."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def numbers_in(text: str | bytes, kind: Any = np.float64) -> NDArray[Any]:
    """The numbers of a text, with blanks between them.

    Raises: ValueError where there is anything else.
    """
    data = text if isinstance(text, bytes) else text.encode()
    if not data or data.isspace():
        return np.zeros(0, dtype=kind)
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(data, dtype=kind, sep=" ")
        except DeprecationWarning as warned:  # older versions of numpy only warn
            raise ValueError(str(warned)) from warned
