"""Numbers of texts are what Python itself reads in their words."""

from __future__ import annotations

import numpy as np
import pytest

from hymeko_x.meshes.numerals import numbers_in

FORMS = ("{:.6f}", "{:.7g}", "{:.9g}", "{:.17e}", "{!r}", "{:.0f}", "{:.1f}")
BLANKS = (" ", "\n", "  \n", " \t\r\n", "   ")
ODD = ("nan", "inf", ".5", "1.", "+1", "1e400", "99999999999999999999999", "-0")


def words(form: str, count: int = 3000) -> list[str]:
    source = np.random.default_rng(7)
    values = source.normal(size=count) * 10.0 ** source.integers(-9, 9, size=count)
    return [form.format(value) for value in values.tolist()]


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("blank", BLANKS)
def test_many_decimals_are_rounded_as_python_rounds_each(form: str, blank: str) -> None:
    numerals = words(form)
    text = blank + blank.join(numerals) + blank
    assert np.array_equal(numbers_in(text), np.array([float(word) for word in numerals]))
    assert np.array_equal(numbers_in(text.encode(), np.float32), np.array([float(word) for word in numerals]).astype(np.float32))


@pytest.mark.parametrize("odd", ODD)
def test_numbers_of_every_form_are_read(odd: str) -> None:
    numerals = [*words("{:.6f}"), odd]
    assert np.array_equal(numbers_in(" ".join(numerals)), np.array([float(word) for word in numerals]), equal_nan=True)


@pytest.mark.parametrize("wrong", ["x", "1,2", "[1]", "1-2", "1.2.3", "--1", "true", "1_000", "0x1f", '"1"', "[", "1e"])
@pytest.mark.parametrize("count", [3, 3000])
def test_what_is_no_number_is_refused(wrong: str, count: int) -> None:
    with pytest.raises(ValueError):  # noqa: PT011 - versions of numpy have different messages
        numbers_in(" ".join([*words("{:.6f}", count), wrong]))
    with pytest.raises(ValueError):  # noqa: PT011
        numbers_in(" ".join(["12"] * count + [wrong]), np.int64)
