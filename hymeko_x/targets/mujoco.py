"""MuJoCo: a model that runs as it is. docs/targets.md lists what MuJoCo Menagerie's models have, and where each rule is from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.backends.mjcf.steady import integrate_implicitly

if TYPE_CHECKING:
    from hymeko_x.rewrite.context import Rule

RULES: tuple[Rule, ...] = (integrate_implicitly,)
