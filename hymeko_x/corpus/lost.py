"""The table of docs/losses.md: what the robots of a run lose on their way from one format into another one."""

from __future__ import annotations

from collections import Counter
from itertools import groupby
from typing import TYPE_CHECKING

from hymeko_x.corpus.report import table
from hymeko_x.corpus.rows import DONE

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from typing import Any

    from hymeko_x.corpus.rows import Tables

_WORDS = {
    "actuator dropped": "actuators",
    "sensor dropped": "sensors",
    "tendon dropped": "tendons",
    "loop dropped": "loops",
    "coupling dropped": "couplings",
    "contact dropped": "contact pairs and exclusions",
    "stance dropped": "keyframes",
    "frame dropped": "sites and frames",
    "camera dropped": "cameras",
    "light dropped": "lights",
    "texture dropped": "textures",
    "joint dofs.limits.lower approximated": "position limits",
    "joint dofs.limits.velocity approximated": "velocity limits",
    "joint dofs.limits.effort approximated": "effort limits",
    "joint dofs.armature approximated": "armature",
    "joint dofs.stiffness approximated": "springs",
    "joint dofs.damping approximated": "damping",
    "joint dofs.friction approximated": "friction",
    "shape friction approximated": "friction of contacts",
}
"""What a person looks for, by its kind in the report; edges and names, forms and appearance are left out."""


def losses(tables: Tables) -> str:
    """Per target and source what gets lost, with the share of the robots that have it; conversions into the same format are left out."""
    legs = tables.legs.filter((tables.legs["status"] == DONE) & (tables.legs["source"] != tables.legs["target"]))
    rows = sorted(legs.iter_rows(named=True), key=lambda row: (row["target"], row["source"]))
    sections = []
    for target, into in groupby(rows, key=lambda row: str(row["target"])):
        lines = [_line(source, list(group)) for source, group in groupby(into, key=lambda row: str(row["source"]))]
        sections.append(f"### Into {target}\n\n{table(['from', 'robots', 'lose'], lines)}")
    return "\n\n".join(sections)


def _line(source: str, legs: list[Mapping[str, Any]]) -> list[str]:
    counts = Counter(kind for leg in legs for kind in set(_kinds(leg)))
    shares = [f"{kind} {_percent(count, len(legs))}" for kind, count in sorted(counts.items(), key=lambda item: (-item[1], item[0]))]
    return [source, str(len(legs)), ", ".join(shares) or "nothing of these"]


def _percent(count: int, of: int) -> str:
    share = 100 * count / of
    return f"{share:.0f} %" if share >= 1 else "< 1 %"


def _kinds(leg: Mapping[str, Any]) -> Iterator[str]:
    return (_WORDS[entry["name"]] for entry in leg["lost"] or () if entry["name"] in _WORDS)
