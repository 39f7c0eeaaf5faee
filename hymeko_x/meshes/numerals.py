"""Numbers of texts as arrays."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_BLANKS_AS_COMMAS = bytes.maketrans(b" \t\n\v\f\r", b",,,,,,")


def numbers_in(text: str | bytes, kind: Any = np.float64) -> NDArray[Any]:
    """The numbers of a text, with blanks between them.

    Raises: ValueError where there is anything else.
    """
    data = text if isinstance(text, bytes) else text.encode()
    if not data or data.isspace():
        return np.zeros(0, dtype=kind)
    found = _decimals(data) if np.issubdtype(kind, np.floating) else None
    return _read_by_numpy(data, kind) if found is None else found.astype(kind)


def _decimals(data: bytes) -> NDArray[np.float64] | None:
    """The numbers of a text, read as an array of JSON, which takes two thirds of numpy's time; None where it is not one (``.5``, ``+1``).

    JSON's ``-0`` is a whole number, which has no sign; a zero of either sign is the same point, place or direction.
    """
    if b"," in data:
        return None
    array = b"[%b]" % data.strip().translate(_BLANKS_AS_COMMAS)
    numbers = _array_of_json(array)
    while numbers is None and b",," in array:
        array = array.replace(b",,", b",")
        numbers = _array_of_json(array)
    return None if numbers is None else np.fromiter(numbers, np.float64, len(numbers))


def _array_of_json(array: bytes) -> list[float] | None:
    try:
        return msgspec.json.decode(array, type=list[float])
    except msgspec.DecodeError:
        return None


def _read_by_numpy(data: bytes, kind: Any) -> NDArray[Any]:
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(data, dtype=kind, sep=" ")
        except DeprecationWarning as warned:  # older versions of numpy only warn
            raise ValueError(str(warned)) from warned
