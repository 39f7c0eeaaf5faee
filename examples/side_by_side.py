"""One real quadruped in four formats: prints docs/side-by-side.md. Needs the corpus (`hymeko-x corpus fetch newton`).

python examples/side_by_side.py > docs/side-by-side.md
"""

from __future__ import annotations

import os
import re

import hymeko_x as hx
from hymeko_x.corpus import cache, catalog

FORMATS = (("urdf", "xml"), ("xacro", "xml"), ("mjcf", "xml"), ("hymeko", "text"))
LINES = 26

HEAD = """# One quadruped, four formats

The file is `{path}` of the package `{package}`, read once and written four times; this page is the output of
`python examples/side_by_side.py`. Each excerpt begins where the text comes to the first leg.

| format | characters | of URDF |
|---|---|---|
"""


def main() -> None:
    """Print the page."""
    file = next(file for file in catalog.development_files("urdf") if file.path.endswith("newton/examples/assets/quadruped.urdf"))
    robot = hx.load(cache.fetch(file.package, cache.cache_root(os.environ)) / file.path).mechanism
    texts = {name: hx.dumps(robot, name) for name, _ in FORMATS}
    print(HEAD.format(path=file.path, package=file.package.name), end="")
    for name, text in texts.items():
        print(f"| {name} | {characters(text)} | {characters(text) / characters(texts['urdf']):.0%} |")
    print("\nCharacters are counted without white space and comments.")
    for name, language in FORMATS:
        print(f"\n## {name}\n\n```{language}\n{excerpt(texts[name])}\n```")


def characters(text: str) -> int:
    """How many characters count."""
    return len(re.sub(r"<!--.*?-->|//[^\n]*|\s+", "", text, flags=re.DOTALL))


def excerpt(text: str) -> str:
    """The lines from the first leg on; in xacro and HyMeKo what stands for all of them, and then its uses."""
    lines = [line if len(line) <= 160 else f"{line[:157]}..." for line in text.splitlines()]
    start = next(number for number, line in enumerate(lines) if "HAA" in line)
    shown = lines[max(0, start - 1) : start + LINES]
    calls = [line for line in lines[start + LINES :] if re.match(r"\s*<xacro:.*(LF|RF|LH|RH)", line)]
    return "\n".join([*shown, *(["  ..."] if start + LINES < len(lines) else []), *calls])


if __name__ == "__main__":
    main()
