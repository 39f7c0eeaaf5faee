"""The fields of elements: read from the parts that the elements carry, and in an editing session assigned, checked and normalised."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Generic, TypeVar, overload

from msgspec.structs import replace

from hymeko_x.ir.mechanism import pose_weight
from hymeko_x.ir.parts import Body, Dof, Inertial, Joint, Limits, Plane
from hymeko_x.ir.types import fits, hints_of, settled
from hymeko_x.ir.values import IDENTITY, unit
from hymeko_x.robot.errors import EditError
from hymeko_x.robot.values import as_pose, plain_value
from hymeko_x.validation import tensor_fault

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.ir.parts import Geometry
    from hymeko_x.ir.values import Pose, Vec3
    from hymeko_x.robot.element import Element

T = TypeVar("T")


class PartField(Generic[T]):
    """A field of the part itself, by its own name."""

    def __init__(self, check: Callable[[Any], str | None] | None = None) -> None:
        self.check = check

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, element: None, owner: type) -> PartField[T]: ...
    @overload
    def __get__(self, element: Element, owner: type) -> T: ...
    def __get__(self, element: Element | None, owner: type) -> T | PartField[T]:
        if element is None:
            return self
        value: T = getattr(self.carrier(element), self.name)
        return value

    def __set__(self, element: Element, value: T) -> None:
        element.draft.check_open(element.id)
        carrier = self.carrier(element)
        plain = fitting(element, type(carrier), self.name, value)
        if self.check is not None and (reason := self.check(plain)):
            raise EditError(f"{element.id}: {self.name} {reason}, found {value!r}")
        self.store(element, replaced(carrier, self.name, plain))

    def carrier(self, element: Element) -> Any:
        """The value that has the field."""
        return element.part

    def store(self, element: Element, carrier: Any) -> None:
        """Put the changed value back."""
        element.draft.set_part(element.id, carrier)


class InertialField(PartField[T]):
    """A field of a body's inertial, or of that which the engine of the robot's format computes; None where there is neither."""

    def __get__(self, element: Any, owner: type) -> Any:
        if element is None:
            return self
        inertial = self._inertial(element)
        return None if inertial is None else getattr(inertial, self.name)

    def carrier(self, element: Element) -> Inertial:
        """The inertial; that which the engine of the robot's format computes where the body has none."""
        return self._inertial(element) or Inertial()

    @staticmethod
    def _inertial(element: Element) -> Inertial | None:
        part = element.part
        if not isinstance(part, Body):
            return None
        return part.inertial or element.draft.computed_inertial(element.id)

    def store(self, element: Element, carrier: Inertial) -> None:
        """Put the changed inertial back."""
        element.draft.set_part(element.id, replace(element.part, inertial=carrier))


class TensorField(InertialField[T]):
    """The tensor of a body's inertial: one that a body can have."""

    def store(self, element: Element, carrier: Inertial) -> None:
        """Put the changed inertial back. Raises: EditError where a principal moment is negative, or exceeds the sum of the others."""
        fault = tensor_fault(replace(carrier, mass=None))
        if fault is not None:
            raise EditError(fault.format(element.id))
        super().store(element, carrier)


class DofField(PartField[T]):
    """A field of the only dof of a joint."""

    def carrier(self, element: Element) -> Dof:
        """The dof. Raises: EditError for a joint with none or several."""
        joint: Joint = element.part
        if len(joint.dofs) != 1:
            count = "is fixed and has no" if not joint.dofs else f"has {len(joint.dofs)} dofs and not one"
            raise EditError(f"{element.id} {count} {self.name}; see its dofs")
        return joint.dofs[0]

    def store(self, element: Element, carrier: Dof) -> None:
        """Put the changed dof back."""
        element.draft.set_part(element.id, replace(element.part, dofs=(carrier,)))


class LimitsField(DofField[Limits]):
    """The limits of the only dof of a joint; a pair of numbers or None is assigned as well."""

    name = "limits"

    def __set__(self, element: Element, value: Limits | tuple[float | None, float | None]) -> None:
        if not isinstance(value, Limits):
            lower, upper = _pair(element, value)
            value = replace(self.carrier(element).limits, lower=lower, upper=upper)
        super().__set__(element, value)


class PoseField:
    """The pose on the first arc of a sign, of the edge that has the element's poses; a position in m can be assigned."""

    def __init__(self, sign: int) -> None:
        self.sign = sign

    @overload
    def __get__(self, element: None, owner: type) -> PoseField: ...
    @overload
    def __get__(self, element: Element, owner: type) -> Pose: ...
    def __get__(self, element: Element | None, owner: type) -> Pose | PoseField:
        if element is None:
            return self
        arc = element.arc(element.posed, self.sign)
        return IDENTITY if arc is None else pose_weight(arc)

    def __set__(self, element: Element, value: Pose | Vec3) -> None:
        element.draft.check_open(element.id)
        new = as_pose(element.id, value)
        arc = element.arc(element.posed, self.sign)
        found = element.draft.edges[element.posed]
        weight = None if new == IDENTITY and new.written is None else new
        arcs = tuple([replace(other, weight=weight) if other is arc else other for other in found.arcs])
        element.draft.set_edge(element.posed, replace(found, arcs=arcs))


def _pair(element: Element, value: Iterable[float | None]) -> tuple[float | None, float | None]:
    given = tuple(value) if isinstance(value, Iterable) else (value,)
    if len(given) != 2:
        raise EditError(f"{element.id}: limits are a lower and an upper bound, or Limits; found {value!r}")
    lower, upper = (None if bound is None or math.isinf(bound) else float(bound) for bound in given)
    return lower, upper


# ---- values ------------------------------------------------------------------------------------------------------------------


def fitting(element: Element, owner: type, name: str, value: object) -> Any:
    """A value as the field of a part has it: whole numbers as floats, sequences as tuples.

    Raises: EditError when the field cannot have it.
    """
    plain = settled(owner, name, plain_value(value))
    hint = hints_of(owner)[name]
    if not fits(plain, hint) or not _is_finite(plain):
        expected = str(hint.__name__ if isinstance(hint, type) else hint).replace("hymeko_x.ir.", "").replace("parts.", "")
        raise EditError(f"{element.id}: {name} is of the type {expected}, found {value!r}")
    return unit_axis(element, plain) if name == "axis" else plain


def unit_axis(element: Element, axis: Any) -> Any:
    """The axis with length 1. Raises: EditError when it has no direction."""
    try:
        return unit(axis)
    except ZeroDivisionError:
        raise EditError(f"{element.id}: axis has no direction, found {axis!r}") from None


def _is_finite(value: object) -> bool:
    if isinstance(value, float):
        return math.isfinite(value)
    return all(map(_is_finite, value)) if isinstance(value, tuple) else True


def replaced(carrier: Any, name: str, value: object) -> Any:
    """A part with another value of a field; how its author wrote the old one is forgotten."""
    if "written" in type(carrier).__struct_fields__ and name in ("axis", "tensor", "com"):
        return replace(carrier, **{name: value, "written": None})
    return replace(carrier, **{name: value})


# ---- checks: what a value must be, or None where it is ----------------------------------------------------------------------


def not_negative(value: float | None) -> str | None:
    """Masses, lengths and coefficients."""
    return "must not be negative" if value is not None and value < 0 else None


def ordered(limits: Limits) -> str | None:
    """Bounds in their order."""
    if limits.lower is not None and limits.upper is not None and limits.lower > limits.upper:
        return "have a lower bound above the upper one"
    return None


def with_sizes(geometry: Geometry) -> str | None:
    """Geometries, whose sizes are more than 0; a plane without an end has the sizes 0."""
    sizes = [getattr(geometry, field) for field in geometry.__struct_fields__]
    numbers = [number for size in sizes for number in (size if isinstance(size, tuple) else (size,))]
    is_open = isinstance(geometry, Plane)
    return "has a size that is not more than 0" if any(number < 0 or (number == 0 and not is_open) for number in numbers) else None


def between_zero_and_one(rgba: tuple[float, ...] | None) -> str | None:
    """Colours."""
    return "has numbers from 0 to 1" if rgba is not None and not all(0 <= part <= 1 for part in rgba) else None
