"""What `make docs` adds to the pages of this folder: the home page, pages from the code, and links that lead out of the folder.

A hook of MkDocs (https://www.mkdocs.org/user-guide/configuration/#hooks).
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from mkdocs.structure.files import File

import hymeko_x
from hymeko_x.codes import CODES
from hymeko_x.severities import reasons

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig
    from mkdocs.structure.files import Files
    from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[1]
OUTSIDE = {"README.md": "index.md", "CONTRIBUTING.md": "contributing.md", "CHANGELOG.md": "changelog.md"}
"""Pages that stand beside the folder, and their names in the site."""
FOUND_FIRST = {"questions.md": 8, "tasks/": 4, "command-line.md": 2, "targets.md": 2, "meshes.md": 2, "losses.md": 2}
FOUND_LAST = {
    "api.md": 0.2,
    "diagnostics.md": 0.2,
    "architecture.md": 0.2,
    "changelog.md": 0.1,
    "contributing.md": 0.2,
    "coverage.md": 0.1,
    "audit.md": 0.5,
    "mcp.md": 0.5,
}
"""By how much pages come before or behind others in the search: first what users ask, last what is about the program."""
_LINK = re.compile(r"\]\((?!https?:|#)([^)#]+)(#[^)]*)?\)")
_NAMED = re.compile(r"^```(\w+) ([\w.]+)$", re.MULTILINE)
"""A block of code with the name of its file."""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages from beside this folder and from the code, and the pictures that they show."""
    for source, name in OUTSIDE.items():
        text = _LINK.sub(_from_root, (ROOT / source).read_text("utf-8"))
        files.append(File.generated(config, name, content=text))
    files.append(File.generated(config, "api.md", content=api_page()))
    files.append(File.generated(config, "diagnostics.md", content=diagnostics_page()))
    for picture in sorted((ROOT / "corpus/results").glob("*.svg")):
        files.append(File.generated(config, f"corpus/results/{picture.name}", content=picture.read_bytes()))
    for name in ("LICENSE", "CITATION.cff", "hymeko_x/reporting/conversion.schema.json"):
        files.append(File.generated(config, f"files/{Path(name).name}", content=(ROOT / name).read_bytes()))
    return files


def on_page_markdown(markdown: str, page: Page, **_: object) -> str:
    """Links of a page to files beside this folder as the site has them, names of files as titles, and its place in the search."""
    boost = [factor for name, factor in (FOUND_FIRST | FOUND_LAST).items() if page.file.src_uri.startswith(name)]
    if boost:
        page.meta["search"] = {"boost": boost[0]}
    markdown = _NAMED.sub(r'```\1 title="\2"', markdown)
    for source, name in OUTSIDE.items():
        markdown = markdown.replace(f"](../{source})", f"]({name})")
    return markdown.replace("](../hymeko_x/reporting/conversion.schema.json)", "](files/conversion.schema.json)")


def _from_root(link: re.Match[str]) -> str:
    """A link of a page beside this folder."""
    path, anchor = link[1], link[2] or ""
    if path in OUTSIDE:
        path = OUTSIDE[path]
    elif path == "docs/mapping/":
        path = "mapping/urdf.md"
    elif path.startswith("docs/"):
        path = path.removeprefix("docs/")
    elif not path.startswith("corpus/results/"):
        path = f"files/{Path(path).name}"
    return f"]({path}{anchor})"


def api_page() -> str:
    """Every public name, with its docstring."""
    names = "\n".join(f"::: hymeko_x.{name}\n" for name in hymeko_x.__all__ if not name.startswith("_"))
    return f"# Python\n\n    import hymeko_x as hx\n\nEverything is loaded when it is first used.\n\n{names}"


def diagnostics_page() -> str:
    """Every code with its explanation and the reasons of its severities."""
    parts = ["# Diagnostics\n\n`hymeko-x explain CODE` prints the same.\n"]
    for code in sorted(CODES.values(), key=lambda code: code.id):
        why = "".join(f"* {severity.value}: {reason}\n" for severity, reason in reasons(code))
        parts.append(f"## {code.id}: {code.title}\n\n{_text(code.explanation)}\n" + (f"\n{_text(why)}" if why else ""))
    return "\n".join(parts)


def _text(words: str) -> str:
    return words.replace("<", "&lt;").replace("*.", "\\*.")
