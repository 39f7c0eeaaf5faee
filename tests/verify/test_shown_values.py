"""The two values of a finding, as people read them."""

from __future__ import annotations

import numpy as np

from hymeko_x.verify.checks.pair import both_shown


def test_rounding_beside_the_largest_number_of_both_values_is_printed_as_zero() -> None:
    assert both_shown([1.89187e-13, -9.70874e-05, 0.00968437], [0.0, -2.77556e-17, 0.201079]) == (
        "[0 -9.70874e-05 0.00968437]",
        "[0 0 0.201079]",
    )
    assert both_shown(-1.69181, -3.46945e-18) == ("-1.69181", "0")
    assert both_shown(1.03, 1e-9) == ("1.03", "1e-09")
    assert both_shown(-3e-18, 2e-18) == ("-3e-18", "2e-18")


def test_values_that_are_not_finite_hide_no_others() -> None:
    assert both_shown([-np.inf, 1e-12], [0.5, np.nan]) == ("[-inf 0]", "[0.5 nan]")
    assert both_shown(np.diag([1.0, 2.0, 3.0]), np.inf) == ("[1 2 3 0 0 0]", "inf")
