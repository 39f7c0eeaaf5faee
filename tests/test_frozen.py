"""Frozen classes: they behave as `dataclasses` makes them, apart from how soon they are there."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from dataclasses import FrozenInstanceError, dataclass, field, fields, replace
from typing import Any, Generic, TypeVar

import pytest

from hymeko_x.frozen import frozen
from tests.pace import assert_at_most

T = TypeVar("T")


def sample(make: Callable[[type], type], own: str) -> Any:
    """A class with a field of every kind, made so and called so."""

    class Sample(Generic[T]):
        name: str
        number: float = 0.5
        table: dict[str, object] = field(default_factory=dict)
        note: T | None = field(default=None, compare=False)
        secret: int = field(default=1, repr=False)
        open: bool = False
        missing: bool = True

    Sample.__qualname__ = own
    return make(Sample)


Quick = sample(frozen, "Quick")
Usual = sample(dataclass(frozen=True, slots=True), "Usual")


@frozen
class Nothing:
    """Without fields."""


@frozen
class Single:
    """With one."""

    value: float


@frozen(eq=False)
class Itself:
    """Equal to itself alone."""

    value: float


@frozen
class Spoken:
    """With words of its own."""

    value: float

    def __repr__(self) -> str:
        return f"<{self.value}>"

    @property
    def double(self) -> float:
        """Twice the value."""
        return 2.0 * self.value


MAKERS: tuple[Callable[[Any], Any], ...] = (
    lambda kind: kind("a"),
    lambda kind: kind("a", 1.0),
    lambda kind: kind("a", table={}, note="written", secret=2, open=True),
    lambda kind: replace(kind("a"), name="b"),
)


@pytest.mark.parametrize("make", MAKERS)
def test_it_holds_what_a_dataclass_holds(make: Callable[[Any], Any]) -> None:
    quick, usual = make(Quick), make(Usual)
    assert [(item.name, getattr(quick, item.name)) for item in fields(quick)] == [
        (item.name, getattr(usual, item.name)) for item in fields(usual)
    ]
    assert repr(quick) == repr(usual).replace("Usual", "Quick")


@pytest.mark.parametrize(
    "wrong",
    [
        pytest.param(lambda kind: kind(), id="nothing given"),
        pytest.param(lambda kind: kind("a", nobody=1), id="an unknown name"),
        pytest.param(lambda kind: kind("a", 1.0, {}, None, 1, True, True, 2), id="too many"),
        pytest.param(lambda kind: kind("a", name="b"), id="twice"),
    ],
)
def test_it_refuses_what_a_dataclass_refuses(wrong: Callable[[Any], Any]) -> None:
    for kind in (Usual, Quick):
        with pytest.raises(TypeError):
            wrong(kind)


def test_fields_cannot_be_set_nor_deleted_and_there_are_no_others() -> None:
    value = Single(1.0)
    for name in ("value", "other", "__class__"):
        with pytest.raises(FrozenInstanceError):
            setattr(value, name, 2.0)
        with pytest.raises(FrozenInstanceError):
            delattr(value, name)
    assert value.value == 1.0
    assert not hasattr(value, "__dict__")


def test_every_object_has_a_table_of_its_own() -> None:
    first, second = Quick[str]("a"), Quick[str]("a")
    assert first == second
    assert first.table is not second.table


def test_equal_are_objects_of_one_class_whose_fields_that_count_are_equal() -> None:
    assert Quick("a", note=1) == Quick("a", note=2)
    assert Quick[int]("a") != Quick[int]("b")
    assert Single(1.0) != Spoken(1.0)
    assert Single(1.0) != 1.0
    assert Nothing() == Nothing()
    nan = float("nan")
    assert Single(nan) == Single(nan)
    assert Single(nan) != Single(float("nan"))


def test_equal_objects_have_the_same_hash() -> None:
    assert len({Single(1.0), Single(1.0), Single(2.0), Nothing(), Nothing()}) == 3


def test_without_equality_each_is_equal_to_itself_alone() -> None:
    value = Itself(1.0)
    assert value == value
    assert value != Itself(1.0)
    assert len({value, Itself(1.0)}) == 2


def test_what_a_class_says_itself_stays() -> None:
    assert repr(Spoken(1.0)) == "<1.0>"
    assert Spoken(1.5).double == 3.0


@pytest.mark.parametrize("value", [Quick("a", 2.0, {"b": [1]}, "c", 3), Nothing(), Single(1.0)], ids=["several", "none", "one"])
def test_copies_and_pickles_are_equal(value: object) -> None:
    for other in (copy.copy(value), copy.deepcopy(value), pickle.loads(pickle.dumps(value))):
        assert other == value
        assert type(other) is type(value)


def test_patterns_match_by_place() -> None:
    match Quick("a", 2.0):
        case Quick(name, number):
            assert (name, number) == ("a", 2.0)
        case _:
            pytest.fail("it does not match")


def test_a_class_is_made_in_half_the_time() -> None:
    body = {"__annotations__": {"a": "float", "b": "float", "c": "str"}, "__doc__": "Doc.", "__module__": __name__, "c": ""}

    def classes(make: Callable[[type], type]) -> Callable[[], object]:
        return lambda: [make(type("Made", (), dict(body))) for _ in range(20)]

    assert_at_most(0.5, classes(frozen), classes(dataclass(frozen=True, slots=True)))
