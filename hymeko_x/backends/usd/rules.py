"""What makes a mechanism legal in USD."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.rewrite.joints import expand_screws
from hymeko_x.rewrite.names import make_names_usable
from hymeko_x.rewrite.native import say_what_cameras_see
from hymeko_x.rewrite.urdf import hold_or_free_open_bases
from hymeko_x.rewrite.usd import choose_layout, drop_loops_without_bodies, drop_stale_groups

if TYPE_CHECKING:
    from hymeko_x.rewrite import Rule

RULES: tuple[Rule, ...] = (
    make_names_usable,
    hold_or_free_open_bases,
    expand_screws,
    drop_loops_without_bodies,
    drop_stale_groups,
    say_what_cameras_see,
    choose_layout,
)
