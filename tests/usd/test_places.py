"""The lines of prims: of a text layer, of what comes from elsewhere, and none of a binary layer."""

from __future__ import annotations

import tracemalloc

from hymeko_x.frontends.usd.places import line_of, lines_of_prims

LAYER = b"""#usda 1.0
(
    defaultPrim = "a"
)

def Xform "a" (
    variants = { string size = "big" }
)
{
    def Cube "b"
    {
        double size = 1
    }

    over "c" (references = @other.usda@)
    {
    }
}

class "d"
{
}
"""


def test_prims_of_a_text_have_lines() -> None:
    lines = lines_of_prims(LAYER)
    assert [line_of(path, lines) for path in ("/a", "/a/b", "/a/c", "/d")] == [6, 10, 15, 20]


def test_lines_take_as_much_memory_as_the_text_however_deep_it_seems() -> None:
    layer = b"#usda 1.0\n" + b"".join(b" " * depth + b'def "' + b"x" * 1000 + b'"\n' for depth in range(2000))
    tracemalloc.start()
    lines = lines_of_prims(layer)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert len(lines) == 2000
    assert most < 2 * len(layer)


def test_a_prim_from_elsewhere_has_the_line_of_the_one_that_brings_it() -> None:
    lines = lines_of_prims(LAYER)
    assert (line_of("/a/b", lines), line_of("/a/c/link/shape", lines), line_of("/e", lines)) == (10, 15, None)


def test_a_binary_layer_has_no_lines() -> None:
    assert lines_of_prims(b"PXR-USDC\0" + LAYER) == {}
