"""Why and where an expansion failed, from an exception and its stack."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x.frontends.xacro.child.channel import Trouble
from hymeko_x.frontends.xacro.child.dom import place_in, place_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from types import FrameType, TracebackType

    from hymeko_x.frontends.xacro.child.dom import SourcePlace

MOST_CALLS = 5
"""How many macro calls and includes a failure shows, from the inside."""


def failure(error: BaseException, trace: TracebackType | None, document: Any) -> dict[str, object]:
    """The facts for the parent's message: why and where the expansion failed."""
    facts = _facts(error)
    steps = [(frame, place) for frame in _traced(trace) if (place := place_in(frame))]
    if steps and "file" not in facts:
        facts |= {"file": steps[-1][1].file, "line": steps[-1][1].line}
    if facts["kind"] == "argument" and document is not None:
        facts |= _late_default(str(facts["name"]), document)
    return {**facts, "calls": list(_calls(steps))[-MOST_CALLS:][::-1]}


def _facts(error: BaseException) -> dict[str, object]:
    for cause in _causes(error):
        if isinstance(cause, Trouble):
            return dict(cause.facts)
        if isinstance(cause, RecursionError):
            return {"kind": "limit", "what": "depth"}
        if isinstance(cause, MemoryError):
            return {"kind": "limit", "what": "memory"}
    if isinstance(missing := getattr(error, "exc", None), FileNotFoundError):
        return {"kind": "file", "path": missing.filename, "reason": missing.strerror}
    if isinstance(error, ImportError):
        return {"kind": "import", "text": str(error)}
    return {"kind": "xacro", "text": _message(error) or type(error).__name__}


def _message(error: BaseException) -> str:
    """The message of an error. XacroException wraps others, and sometimes repeats their text."""
    if not hasattr(error, "exc") or not error.args:
        return str(error)
    own = "" if error.args[0] is None or str(error.args[0]).startswith("<class ") else str(error.args[0])
    inner = _message(error.exc) if error.exc is not None else ""
    return " ".join(part for part in (own, inner, getattr(error, "suffix", None)) if part)


def _causes(error: BaseException | None) -> Iterator[BaseException]:
    """An error and what it was raised from or during."""
    seen: set[int] = set()
    while error is not None and id(error) not in seen:
        seen.add(id(error))
        yield error
        error = error.__cause__ or error.__context__


def _traced(trace: TracebackType | None) -> Iterator[FrameType]:
    while trace is not None:
        yield trace.tb_frame
        trace = trace.tb_next


def _calls(steps: Iterable[tuple[FrameType, SourcePlace]]) -> Iterator[dict[str, object]]:
    """The macro calls and includes on the way to the failure, from the outside."""
    for frame, place in steps:
        if frame.f_code.co_name == "handle_macro_call":
            yield {"what": f"<{frame.f_locals['node'].tagName}>", "file": place.file, "line": place.line}
        elif frame.f_code.co_name == "process_include":
            yield {"what": "<xacro:include>", "file": place.file, "line": place.line}


def _late_default(name: str, document: Any) -> dict[str, object]:
    """The default of an argument that the main file declares too late."""
    for element in document.getElementsByTagName("xacro:arg"):
        if element.getAttribute("name") == name and (place := place_of(element)):
            return {"default": element.getAttribute("default"), "default_line": place.line}
    return {}
