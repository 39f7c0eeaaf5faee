"""What makes a mechanism legal in URDF."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.rewrite.joints import expand_screws
from hymeko_x.rewrite.names import make_names_usable
from hymeko_x.rewrite.shapes import drop_engine_shapes
from hymeko_x.rewrite.solids import fill_tensors
from hymeko_x.rewrite.subsets import part_meshes_by_looks
from hymeko_x.rewrite.urdf import chain_dofs, hold_or_free_open_bases, join_roots, make_world_a_link
from hymeko_x.rewrite.urdf_shapes import approximate_shapes, prefer_own_colours, split_shared_shapes

if TYPE_CHECKING:
    from hymeko_x.rewrite.context import Rule

RULES: tuple[Rule, ...] = (
    make_names_usable,
    drop_engine_shapes,
    fill_tensors,
    expand_screws,
    chain_dofs,
    hold_or_free_open_bases,
    make_world_a_link,
    join_roots,
    prefer_own_colours,
    approximate_shapes,
    split_shared_shapes,
    part_meshes_by_looks,
    make_names_usable,  # once more, for what the rules have added
)
