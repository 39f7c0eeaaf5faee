"""Where the points of a closure are described, in a body or at a frame, is no loss; where they are is one."""

from __future__ import annotations

from pathlib import Path

import pytest

import hymeko_x as hx
from hymeko_x.compare.diff import Tolerance, diff
from hymeko_x.compare.relevance import relevant

LOOP = """r : robot {
  a { mass 1 inertia [1 1 1] } b { mass 1 inertia [1 1 1] } c { mass 1 inertia [1 1 1] }
  @j { + a - b axis=X } @k { [0 1 0] + b - c axis=X }
  @l : connect { [0 0.5 0] ~ a [0 0 0.25] ~ c }
}"""


def losses(folder: Path, edit: tuple[str, str] = ("", "")) -> set[str]:
    (folder / "r.hymeko").write_text(LOOP, "utf-8")
    hx.convert(folder / "r.hymeko", folder / "r.xml", base="fixed")
    text = (folder / "r.xml").read_text("utf-8")
    assert edit[0] in text
    (folder / "r.xml").write_text(text.replace(*edit), "utf-8")
    before, after = (hx.load(folder / name).mechanism for name in ("r.hymeko", "r.xml"))
    found = relevant(diff(before, after), before, after, Tolerance(1e-12))
    return {str(loss.element) for loss in found if loss.element.kind in ("loop", "frame", "mount")}


@pytest.mark.unread("HX101")
def test_a_closure_at_frames_of_its_own_is_the_same_closure(tmp_path: Path) -> None:
    assert losses(tmp_path) == set()
    frames = {f"{kind} '{name}'" for kind in ("frame", "mount") for name in ("l_a", "l_c")}
    assert losses(tmp_path, ('pos="0 0 0.25"', 'pos="0 0 0.26"')) == {"loop 'l'", *frames}
