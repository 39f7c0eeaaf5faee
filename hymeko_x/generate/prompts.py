"""The questions to the model, and the feedback on its answers."""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hymeko_x.formats import Format

PROMPTS = ("paper", "card")
_MOST_FAULTS = 20


def first_prompt(kind: str, format: Format, text: str, links: int, joints: int) -> str:
    """The request for a file: as in the paper (listings 6 and 7), or with the language on one page and the numbers of elements."""
    if kind == "paper" and format.prompt is not None:
        return f"{format.prompt}{text}"
    card = files("hymeko_x.language.models").joinpath("card.md").read_text("utf-8")
    return (
        f"{card}\nWrite the robot below as one file in the format {format.title}. Keep every name and every number; angles are written "
        f"in the units of that format. The file has {links} links and {joints} joints, and each link has a visual, a collision shape and "
        f"an inertia where the text gives them. Answer with the file alone.\n\n{text}"
    )


def feedback(faults: list[str]) -> str:
    """What is wrong with an answer."""
    shown = "\n".join(f"- {fault}" for fault in faults[:_MOST_FAULTS])
    more = f"\n- and {len(faults) - _MOST_FAULTS} more" if len(faults) > _MOST_FAULTS else ""
    return f"The file is not yet the robot of the description:\n{shown}{more}\nAnswer with the whole corrected file alone."
