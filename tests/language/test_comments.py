"""Comments on the way from HyMeKo text through a mechanism to HyMeKo text: none is lost, none changes the robot."""

from __future__ import annotations

import random
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest
from msgspec.structs import replace

from hymeko_x.backends.hymeko import write
from hymeko_x.diagnostics import Report
from hymeko_x.frontends.hymeko import read
from hymeko_x.ir.mechanism import Extra, Mechanism
from hymeko_x.language.comments import comments_in
from hymeko_x.language.grammar import tokens
from hymeko_x.language.parser import parse
from hymeko_x.rewrite.context import Options
from hymeko_x.source import Source

ROOT = Path(__file__).parents[2]
EXAMPLES = re.findall(r"```hymeko\n(.*?)```", (ROOT / "docs" / "language.md").read_text(encoding="utf-8"), re.DOTALL)
NOTES = (" // {} }}\n", " # {} [\n", " /* {}\n two */ ", "/*{}*/", "\n// {}\n", "\n\n\n  # {}\n\n")
EVERYWHERE = """
/* head
   two */
import "std/x" // imported
arm : robot { // in the root
  units { /* mine */ angle rad } // behind a block
  leg(h=1 /* parameter */) : link { mass ${h} /* in a template */ }
  base {
    // torso
    mass 2 // weighed
    visual { box [1 1 /* z */ 1] // size
    }
    mjcf { /* why */ condim 4 }
  }
  SLANT { /* axis */ direction [0 1 1] }
  left : assembly {
    // the left
    arm { mass 1 shape { sphere 1 /* deep */ } }
    foot : assembly { toe { /* deepest */ mass 1 } }
    @s { + base /* arc */ - arm safety { /* careful */ k_velocity 1 } axis=SLANT }
    @t { + arm - foot.toe }
  }
  x : leg { /* instance */ }
  @f : fixed { (+ base /* place */ [[0 0 1] /* rpy */ [0 0 0]], - x) }
  mjcf { option { /* step */ timestep 0.1 } }
}
# tail
"""
WHERE = {
    "<before>": ["head\n   two", "imported", "axis"],
    "arm": ["in the root", "mine", "behind a block", "parameter", "in a template", "the left"],
    "base": ["torso", "weighed", "why"],
    "visual": ["z", "size"],
    "shape": ["deep"],
    "left_foot_toe": ["deepest"],
    "left_s": ["arc", "careful"],
    "x": ["instance"],
    "f": ["place", "rpy"],
    "option": ["step"],
    "<behind>": ["tail"],
}


def read_text(text: str) -> Mechanism:
    return read(Source("robot.hymeko", text.encode()), Report()).mechanism


def canonical(text: str) -> str:
    return write(read_text(text), Options(), Report()).main.decode()


def texts_of(text: str) -> Counter[str]:
    return Counter(comment.text for comment in comments_in(parse(text).items))


def without_comments(mechanism: Mechanism) -> Mechanism:
    """The mechanism without comments, which take places among its other extras, also without those in elements of other formats."""

    def others(extras: tuple[Extra, ...]) -> Iterator[Extra]:
        return (replace(extra, index=0, text=bare(extra.text)) for extra in extras if extra.format != "comment")

    def bare(text: str) -> str:
        return re.sub(r"></\w+>", "/>", re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL))

    kept = {key: tuple(others(extras)) for key, extras in mechanism.extras.items()}
    return replace(mechanism, extras={key: extras for key, extras in kept.items() if extras})


def test_a_comment_stands_in_the_block_of_its_element_or_before_it() -> None:
    document = parse(canonical(EVERYWHERE))
    found: dict[str, list[str]] = {}

    def collect(name: str, items: tuple[object, ...]) -> None:
        for item in items:
            if type(item).__name__ == "Comment":
                found.setdefault(name, []).append(item.text)  # type: ignore[attr-defined]
            elif type(item).__name__ == "Node":
                collect(item.name, item.items)  # type: ignore[attr-defined]
                name = "<behind>" if name == "<before>" else name

    collect("<before>", document.items)
    assert found == WHERE


@pytest.mark.parametrize("text", [EVERYWHERE, *EXAMPLES], ids=lambda text: re.search(r"\w+(?= .*\{)", text)[0])  # type: ignore[index]
def test_no_comment_is_lost_and_none_changes_the_robot(text: str) -> None:
    chance = random.Random(text)
    pieces = [
        piece
        for number, word in enumerate(tokens(text))
        for piece in (chance.choice(NOTES).format(number) if chance.random() < 0.3 else " ", word)
    ]
    noted = "".join(pieces)
    assert without_comments(read_text(noted)) == without_comments(read_text(text))
    printed = canonical(noted)
    assert texts_of(printed) == texts_of(noted)
    assert canonical(printed) == printed


def test_a_comment_between_carriage_returns_and_line_feeds_stays_a_comment() -> None:
    assert (
        canonical("a : robot {\r\n  /* one\r\n  two */\r\n  b {} // three\r\n}\r\n")
        == "a : robot {\n  /* one\n  two */\n  b {}\n  // three\n}\n"
    )
