"""Results of slow functions, remembered for the time of one task that asks for the same ones again and again."""

from __future__ import annotations

from contextlib import contextmanager, suppress
from contextvars import ContextVar
from functools import wraps
from typing import TYPE_CHECKING, NamedTuple, ParamSpec, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

P = ParamSpec("P")
R = TypeVar("R")

_RESULTS: ContextVar[dict[tuple[object, ...], object] | None] = ContextVar("results", default=None)
"""The results so far of the task that remembers them; None outside of one."""


class _Read(NamedTuple):
    """What a reader made of a file, and of those that it fetched: None where there was none."""

    result: object
    fetched: Mapping[str, bytes | None]


@contextmanager
def remembering() -> Iterator[None]:
    """With a memory for the functions that have one, which ends with the task; also a decorator. A task within another shares its memory.

    An update converts its original about four times, and the guess of a target packs it twice more. ANYmal with a Kinova arm, to MJCF:
    15 s without a memory, of which 13 s are meshes, and 5 s with it.
    """
    if _RESULTS.get() is not None:
        yield
        return
    token = _RESULTS.set({})
    try:
        yield
    finally:
        _RESULTS.reset(token)


def remembered(function: Callable[P, R]) -> Callable[P, R]:
    """The function, which is called once for the same arguments: values, or objects that nothing changes. Errors are not remembered."""

    @wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        results = _RESULTS.get()
        if results is None:
            return function(*args, **kwargs)
        key = (function, *args, *kwargs.items())
        if key not in results:
            results[key] = function(*args, **kwargs)
        return results[key]  # type: ignore[return-value]

    return call


def remembered_reader(function: Callable[[bytes, str, Callable[[str], bytes]], R]) -> Callable[[bytes, str, Callable[[str], bytes]], R]:
    """The reader ``(data, suffix, fetch)``, which reads the same file once, as long as what it fetched is the same too."""

    @wraps(function)
    def read(data: bytes, suffix: str, fetch: Callable[[str], bytes]) -> R:
        results = _RESULTS.get()
        if results is None:
            return function(data, suffix, fetch)
        known = results.get((function, data, suffix))
        if isinstance(known, _Read) and all(_content(name, fetch) == content for name, content in known.fetched.items()):
            return known.result  # type: ignore[return-value]
        fetched: dict[str, bytes | None] = {}

        def noted(name: str) -> bytes:
            fetched[name] = None
            fetched[name] = content = fetch(name)
            return content

        result = function(data, suffix, noted)
        results[function, data, suffix] = _Read(result, fetched)
        return result

    return read


def _content(name: str, fetch: Callable[[str], bytes]) -> bytes | None:
    """The content of a file, or None where there is none."""
    with suppress(OSError):
        return fetch(name)
    return None
