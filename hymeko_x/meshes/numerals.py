"""Numbers of texts straight into arrays."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SHORT = 4096
"""So many letters are turned into numbers one by one before the arrangements for many of them are worth their time."""
_OF_NUMBERS = b"0123456789+-.eE \t\n\v\f\r"
_EVERY_BLANK = bytes.maketrans(b"\t\n\v\f\r", b"     ")
_WORD, _AT_ONCE = 8, 8192
_BLANK = ord(" ")
_ZEROS, _NOT_DIGITS, _TOP_BITS = np.uint64(0x3030303030303030), np.uint64(0x7676767676767676), np.uint64(0x8080808080808080)
_STEPS = (
    (np.uint64(10), np.uint64(8), np.uint64(0x00FF00FF00FF00FF)),
    (np.uint64(100), np.uint64(16), np.uint64(0x0000FFFF0000FFFF)),
    (np.uint64(10000), np.uint64(32), np.uint64(0xFFFFFFFF)),
)


def numbers_in(text: str | bytes, kind: Any = np.float64) -> NDArray[Any]:
    """The numbers of a text, with blanks between them.

    Raises: ValueError where there is anything else, OverflowError for whole numbers that are too large.
    """
    data = text if isinstance(text, bytes) else text.encode()
    if len(data) < _SHORT:
        return _few_numbers(data, kind)
    found = None if np.issubdtype(kind, np.integer) else _decimals(data)
    return _many_numbers(data, kind) if found is None else found.astype(kind)


def _decimals(text: bytes) -> NDArray[np.float64] | None:
    """The numbers of a text that, with commas between them, is an array of JSON, whose readers are much faster than all others.

    None where it is not, or where there is no such reader for this Python.
    """
    try:
        import simdjson
    except ImportError:
        return None
    if text.translate(None, _OF_NUMBERS):
        return None
    text = text.translate(_EVERY_BLANK)
    while b"  " in text:
        text = text.replace(b"  ", b" ")
    try:
        found = simdjson.Parser().parse(b"[%b]" % text.strip().replace(b" ", b","))
        return np.frombuffer(found.as_buffer(of_type="d")) if isinstance(found, simdjson.Array) else None
    except (ValueError, RuntimeError):  # such as `.5`, `+1` and what is larger than any number
        return None


def _few_numbers(text: bytes, kind: Any) -> NDArray[Any]:
    if b"_" in text:
        raise ValueError("an underscore is no part of a number")
    plain: type[int] | type[float] = int if np.issubdtype(kind, np.integer) else float
    return np.array(list(map(plain, text.split())), dtype=kind)


def _many_numbers(text: bytes, kind: Any) -> NDArray[Any]:
    if text.isspace():
        return np.zeros(0, dtype=kind)
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, dtype=kind, sep=" ")
        except DeprecationWarning as warned:  # as numpy said it before it was an error
            raise ValueError(str(warned)) from warned


def words_in(text: NDArray[np.uint8]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Where the words of a text begin and end that itself begins and ends with a blank."""
    is_blank = text <= _BLANK
    return np.flatnonzero(is_blank[:-1] > is_blank[1:]) + 1, np.flatnonzero(is_blank[:-1] < is_blank[1:]) + 1


# ---- whole numbers -----------------------------------------------------------------------------------------------------------


def columns_in(text: str, width: int, columns: list[int]) -> NDArray[np.int64]:
    """Some columns of a table of whole numbers without signs, given by all its numbers, row after row; the others are not read.

    Raises: ValueError where there is anything else in these columns, or the last row is not a whole one.
    """
    if len(text) < _SHORT:
        return numbers_in(text, np.int64).reshape(-1, width)[:, columns]
    padded = np.frombuffer(f" {text} ".encode(), dtype=np.uint8)
    begins, ends = (places.reshape(-1, width)[:, columns].ravel() for places in words_in(padded))
    return whole_numbers_at(padded, begins, ends).reshape(-1, len(columns))


def whole_numbers_at(text: NDArray[np.uint8], begins: NDArray[np.intp], ends: NDArray[np.intp]) -> NDArray[np.int64]:
    """The whole numbers, without signs, that begin and end at these places of a text.

    Raises: ValueError where there is anything else, or a number has more than eight digits.
    """
    lengths = ends - begins
    if len(lengths) and (lengths.min() < 1 or lengths.max() > _WORD):
        raise ValueError(f"a number has 1 to {_WORD} digits")
    eights = _eights(text)
    found = np.empty(len(ends), dtype=np.uint64)
    for start in range(0, len(ends), _AT_ONCE):
        some = slice(start, start + _AT_ONCE)
        found[some] = _joined_digits(eights[ends[some]], lengths[some])
    return found.view(np.int64)


def _eights(text: NDArray[np.uint8]) -> NDArray[np.uint64]:
    """For each place of a text the eight letters in front of it as one word, the last letter in its highest byte."""
    padded = np.concatenate((np.zeros(_WORD, dtype=np.uint8), text))
    return np.ndarray((len(text) + 1,), dtype="<u8", buffer=padded, strides=(1,))


def _joined_digits(words: NDArray[np.uint64], lengths: NDArray[np.intp]) -> NDArray[np.uint64]:
    """The numbers whose digits are the last letters of words of eight: digits become pairs, pairs become fours, those the number.

    Raises: ValueError. Source: D. Lemire, "Quickly parsing eight digits" (2018).
    """
    other = ((_WORD - lengths) * 8).astype(np.uint64)
    words = (words ^ _ZEROS) >> other << other
    if (((words + _NOT_DIGITS) | words) & _TOP_BITS).any():
        raise ValueError("a letter is no part of a number")
    for factor, shift, kept in _STEPS:
        words = (words * factor + (words >> shift)) & kept
    return words
