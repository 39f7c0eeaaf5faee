"""Parts that are made quickly: reading and writing a robot makes some thirty of them for each link."""

from __future__ import annotations

import sys
from dataclasses import MISSING, fields
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

T = TypeVar("T")


def quick(kind: type[T]) -> type[T]:
    """A frozen dataclass with slots whose fields are set by their slots at once.

    What `dataclasses` generates looks for the slot of each field whenever an object is made, which takes twice as long.
    """
    made = fields(kind)  # type: ignore[arg-type]
    slots = {f"_set_{item.name}": getattr(kind, item.name).__set__ for item in made}
    defaults = {f"_{item.name}": item.default for item in made if item.default is not MISSING}
    said = [f"{item.name}=_{item.name}" if f"_{item.name}" in defaults else item.name for item in made]
    body = "\n".join([f"  _set_{item.name}(self, {item.name})" for item in made])
    given = ", ".join([*slots, *defaults])
    text = f"def maker({given}):\n def __init__(self, {', '.join(said)}):\n{body}\n return __init__"
    scope: dict[str, Callable[..., Any]] = {}
    exec(text, vars(sys.modules[kind.__module__]), scope)  # as `dataclasses` makes its own
    init = scope["maker"](**slots, **defaults)
    init.__qualname__ = f"{kind.__qualname__}.__init__"
    init.__annotations__ = kind.__init__.__annotations__
    kind.__init__ = init  # type: ignore[method-assign]
    return kind
