"""Frequency responses and Bode plots."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import hymeko_x as hx
from hymeko_x.cli import main
from hymeko_x.dynamics.bode import frequencies, frequency_response
from tests.dynamics.networks import load
from tests.dynamics.test_lumped import LISTING
from tests.dynamics.test_mechanisms import CART_POLE


def test_the_frequency_response_is_the_transfer_function() -> None:
    """Of the quarter vehicle's road, a position and its rate; and of the forces of a cart-pole."""
    for found in (hx.dynamics(hx.load(LISTING).mechanism), hx.dynamics(load(CART_POLE))):
        space = found.state_space()
        w = frequencies(space)[::57]
        response, functions = frequency_response(space, w), space.transfer()
        for row, line in enumerate(functions):
            for column, function in enumerate(line):
                theirs = np.array([complex(function.subs("s", 1j * each)) for each in w])
                np.testing.assert_allclose(response[:, row, column], theirs, rtol=1e-9, atol=1e-12)


def test_a_suspension_passes_slow_roads_and_amplifies_at_its_natural_frequency() -> None:
    space = hx.dynamics(hx.load(LISTING).mechanism).state_space()
    gain = np.abs(frequency_response(space, np.array([1e-3, 31.6, 3000.0])))[:, 0, 0]
    assert abs(gain[0] - 1.0) < 1e-6
    assert gain[1] > 1.5
    assert gain[2] < 0.01


def test_a_bode_plot_is_a_file_with_the_names_of_its_curves(tmp_path: Path) -> None:
    for name in ("first.svg", "second.svg"):
        assert main(["dynamics", str(LISTING), "--bode", str(tmp_path / name), "-o", str(tmp_path / "page.txt")]) == 0
    text = (tmp_path / "first.svg").read_text()
    assert "link.position / chassis.position" in text
    assert "magnitude (dB)" in text
    assert text == (tmp_path / "second.svg").read_text()
    assert main(["dynamics", str(LISTING), "--bode", str(tmp_path / "bode.xyz")]) == 1
