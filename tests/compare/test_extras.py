"""Which extras two elements do not share."""

from __future__ import annotations

from hymeko_x.compare.extras import as_meant, as_written, unshared
from hymeko_x.ir.mechanism import Extra
from tests.pace import assert_at_most


def fragments(count: int, text: str = "<a n='{}'><b/></a>") -> list[Extra]:
    return [Extra("urdf", "gazebo", text.format(number), number) for number in range(count)]


def test_extras_are_shared_once_each_first_by_their_text_and_then_by_their_meaning() -> None:
    plain, commented, other = (Extra("urdf", "gazebo", text) for text in ("<a><b/></a>", "<a> <!-- c --> <b/></a>", "<c/>"))
    assert unshared([plain, plain], [plain], as_written) == ([plain], [])
    assert unshared([commented, other], [plain], as_written) == ([commented, other], [plain])
    assert unshared([commented, plain, other], [plain, plain], as_written, as_meant) == ([other], [])
    assert unshared([plain, commented], [commented], as_written, as_meant) == ([plain], [])
    assert unshared([plain], [Extra("urdf", "sensor", plain.text)], as_written, as_meant)[0] == [plain]


def test_an_extra_is_found_among_many_wherever_it_stands() -> None:
    many = fragments(50)
    assert unshared(fragments(50, "<a  n='{}'> <b/> </a>")[::-1], many, as_written, as_meant) == ([], [])


def test_many_extras_are_compared_in_linear_time() -> None:
    def compared(count: int) -> object:
        return unshared(fragments(count), fragments(count, "<a n='{}'><c/></a>"), as_written, as_meant)

    assert_at_most(3.0, lambda: compared(2000), lambda: compared(200), 10)
