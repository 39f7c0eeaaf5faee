"""One arm as people write it in each format, and as hymeko-x writes it from HyMeKo text: prints docs/same-arm.md.

python examples/same_arm.py > docs/same-arm.md
"""

from __future__ import annotations

from pathlib import Path

import hymeko_x as hx

ARM = Path(__file__).parent / "same_arm"
FORMATS = (("urdf", "arm.urdf"), ("xacro", "arm.xacro"), ("mjcf", "arm.xml"), ("sdf", "arm.sdf"), ("usd", "arm.usda"))

HEAD = """# One arm, written by hand and by hymeko-x

An arm of two joints, in five formats: first as a person writes it (`examples/same_arm/`), then as hymeko-x writes it from the HyMeKo text
below. `hymeko-x verify` says *same* of each pair. This page is the output of `python examples/same_arm.py`.

What differs: in URDF hymeko-x writes `rpy` and `friction` where they are zero, and joints after all links; in MJCF a person would put
`type` and `range` into the defaults as well, and the velocity limit is lost; in xacro a person would make a macro of two joints, and
`length/2` of the centre; in SDF joints stand after all links; in USD hymeko-x writes identity rotations, extents, and attributes that
Newton and MuJoCo read.

## HyMeKo

```text
{text}```
"""


def main() -> None:
    """Print the page."""
    print(HEAD.format(text=(ARM / "arm.hymeko").read_text("utf-8")), end="")
    robot = hx.load(ARM / "arm.hymeko").mechanism
    for name, file in FORMATS:
        language = "text" if name == "usd" else "xml"
        by_hand, written = (ARM / file).read_text("utf-8"), hx.dumps(robot, name)
        print(
            f"\n## {name}\n\nBy hand:\n\n```{language}\n{by_hand.rstrip()}\n```\n\nBy hymeko-x:\n\n```{language}\n{written.rstrip()}\n```"
        )


if __name__ == "__main__":
    main()
