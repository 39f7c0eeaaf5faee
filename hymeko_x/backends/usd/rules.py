"""The rules that make a mechanism representable in USD: the world, loops, and collision groups that still hold."""

from __future__ import annotations

from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import codes
from hymeko_x.backends.usd.grounds import report_planes_that_move
from hymeko_x.formats.usd.contacts import GROUP, GROUPED, GROUPS, pairs_digest
from hymeko_x.ir.mechanism import ROOT, WORLD
from hymeko_x.ir.parts import Contact, Loop
from hymeko_x.rewrite.differentials import drive_by_differentials
from hymeko_x.rewrite.fragments import mount_sensors_of_fragments
from hymeko_x.rewrite.joints import expand_screws
from hymeko_x.rewrite.loops import close_in_pairs, leave_screws_open
from hymeko_x.rewrite.names import make_names_usable
from hymeko_x.rewrite.roots import put_world_link_into_world
from hymeko_x.rewrite.shapes import drop_unused_assets
from hymeko_x.rewrite.transmissions import drive_by_transmissions

if TYPE_CHECKING:
    from hymeko_x.ir.mechanism import Extra, Mechanism
    from hymeko_x.rewrite.context import Context, Rule


# ---- limits of UsdPhysics --------------------------------------------------------------------------------------------------------


def drop_loops_without_bodies(mechanism: Mechanism, context: Context) -> Mechanism:
    """A closure of the world with itself holds nothing; a joint of UsdPhysics needs a body."""
    frames = {view.mounted: view.body for views in mechanism.mounts.values() for view in views}
    gone = [key for key, _, arcs in mechanism.edges(Loop) if all(frames.get(arc.target, arc.target) == WORLD for arc in arcs)]
    for key in gone:
        context.report.warn(codes.NOT_REPRESENTED, f"{key} is left out: it joins no body", mechanism.origin(key), element=str(key))
    return mechanism.replace(without=gone)


def drop_stale_groups(mechanism: Mechanism, context: Context) -> Mechanism:
    """Remove collision groups that contradict the exclusions, which then are all written as pairs."""
    noted = mechanism.notation(ROOT, GROUPS)
    if noted is None:
        return mechanism
    marked = [(key, arcs) for key, _, arcs in mechanism.edges(Contact) if mechanism.notation(key, GROUPED) is not None]
    if pairs_digest((arcs[0].target, arcs[-1].target) for _, arcs in marked) == noted:
        return mechanism
    message = "exclusions have changed, so that the collision groups for them are left out; exclusions are written as pairs"
    context.report.note(codes.REWRITTEN, message)
    gone = (GROUPS.name, GROUPED.name)
    notations = {key: {name: text for name, text in own.items() if name not in gone} for key, own in mechanism.notations.items()}
    extras = {key: tuple(extra for extra in found if not _is_group(extra)) for key, found in mechanism.extras.items()}
    return replace(mechanism, notations=notations, extras=extras)


def _is_group(extra: Extra) -> bool:
    return extra.format == "usd" and extra.text.startswith(f"def {GROUP} ")


RULES: tuple[Rule, ...] = (
    mount_sensors_of_fragments,
    make_names_usable,
    put_world_link_into_world,
    expand_screws,
    close_in_pairs,
    leave_screws_open,
    drop_loops_without_bodies,
    drive_by_transmissions,
    drive_by_differentials,
    drop_stale_groups,
    drop_unused_assets,
    report_planes_that_move,
)
NATIVE: tuple[Rule, ...] = tuple(rule for rule in RULES if rule is not put_world_link_into_world)
"""The rules for what came from USD, where a body may be called as the world."""
