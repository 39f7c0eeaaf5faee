"""Frozen dataclasses that are made quickly: the classes when the program starts, and their objects, thirty for each link of a robot."""

from __future__ import annotations

import sys
from dataclasses import MISSING, FrozenInstanceError, dataclass, field, fields
from operator import attrgetter
from typing import TYPE_CHECKING, Any, TypeVar, dataclass_transform, overload

if TYPE_CHECKING:
    from collections.abc import Callable
    from dataclasses import Field

T = TypeVar("T")


@overload
def frozen(kind: type[T], /) -> type[T]: ...


@overload
def frozen(*, eq: bool = True) -> Callable[[type[T]], type[T]]: ...


@dataclass_transform(frozen_default=True, field_specifiers=(field,))
def frozen(kind: type[T] | None = None, /, *, eq: bool = True) -> type[T] | Callable[[type[T]], type[T]]:
    """A class as ``dataclass(frozen=True, slots=True, eq=eq)`` makes it, in a fifth of the time; it is not there to be derived from.

    `dataclasses` compiles seven methods for each class, and its ``__init__`` goes around the frozen class for each field. Here one is
    compiled, which sets the fields of an object while that is still of a class which allows it; the other methods are shared.
    """
    if kind is None:
        return lambda kind: _frozen(kind, eq)
    return _frozen(kind, eq)


def _frozen(kind: type[T], eq: bool) -> type[T]:
    own = set(vars(kind))
    made: Any = dataclass(init=False, repr=False, eq=False, slots=True)(kind)
    known = fields(made)
    compared = getter([item.name for item in known if item.compare])
    methods = {
        "__new__": _maker(made, known),
        "__repr__": _representation([item.name for item in known if item.repr]),
        "__setattr__": _refuse_to_set,
        "__delattr__": _refuse_to_delete,
        "__reduce__": _reduction(getter([item.name for item in known])),
    }
    if eq:
        methods |= {"__eq__": _equality(compared), "__hash__": lambda self: hash(compared(self))}
    for name, method in methods.items():
        if name not in own:
            setattr(made, name, method)
    return made  # type: ignore[no-any-return]


def _maker(kind: Any, known: tuple[Field[Any], ...]) -> Callable[..., Any]:
    """``__new__`` with the fields as its parameters, which have their defaults."""
    twin = type(kind.__name__, kind.__bases__, {"__slots__": kind.__slots__, "__orig_bases__": getattr(kind, "__orig_bases__", ())})
    given: dict[str, object] = {"__twin__": twin, "__missing__": MISSING}
    parameters, lines = ["cls"], ["self = __twin__()"]
    for item in known:
        name, value, default = item.name, item.name, ""
        if item.default is not MISSING:
            given[f"_{name}"], default = item.default, f"=_{name}"
        elif item.default_factory is not MISSING:
            given[f"_{name}"], default = item.default_factory, "=__missing__"
            value = f"_{name}() if {name} is __missing__ else {name}"
        parameters.append(f"{name}{default}")
        lines.append(f"self.{name} = {value}")
    body = "\n".join([f"  {line}" for line in (*lines, "self.__class__ = cls", "return self")])
    text = f"def make({', '.join(given)}):\n def __new__({', '.join(parameters)}):\n{body}\n return __new__"
    scope: dict[str, Callable[..., Callable[..., Any]]] = {}
    exec(text, vars(sys.modules[kind.__module__]), scope)  # as `dataclasses` makes its own
    new = scope["make"](**given)
    new.__qualname__ = f"{kind.__qualname__}.__new__"
    new.__annotations__ = {item.name: item.type for item in known}
    return new


def getter(names: list[str]) -> Callable[[Any], tuple[Any, ...]]:
    """What gets these attributes of an object, as a tuple however many there are."""
    if len(names) > 1:
        return attrgetter(*names)
    if not names:
        return lambda value: ()
    one = attrgetter(names[0])
    return lambda value: (one(value),)


def _equality(compared: Callable[[Any], tuple[Any, ...]]) -> Callable[[Any, object], bool]:
    def __eq__(self: Any, other: object) -> bool:
        return compared(self) == compared(other) if other.__class__ is self.__class__ else NotImplemented

    return __eq__


def _representation(names: list[str]) -> Callable[[Any], str]:
    return lambda self: f"{type(self).__qualname__}({', '.join([f'{name}={getattr(self, name)!r}' for name in names])})"


def _reduction(values: Callable[[Any], tuple[Any, ...]]) -> Callable[[Any], tuple[type, tuple[Any, ...]]]:
    """For copies and pickles."""
    return lambda self: (type(self), values(self))


def _refuse_to_set(self: object, name: str, value: object) -> None:
    raise FrozenInstanceError(f"cannot assign to field {name!r}")


def _refuse_to_delete(self: object, name: str) -> None:
    raise FrozenInstanceError(f"cannot delete field {name!r}")
