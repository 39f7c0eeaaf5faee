"""`hymeko-x corpus stats`: tables and figures of a run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.cli import exits

if TYPE_CHECKING:
    import argparse


def arguments(parser: argparse.ArgumentParser) -> None:
    """The words of `corpus stats`."""


def run(chosen: argparse.Namespace) -> int:
    """Write tables and figures."""
    return exits.DONE
