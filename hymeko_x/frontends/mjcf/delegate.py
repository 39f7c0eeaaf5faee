"""What only MuJoCo can expand: <replicate>, <attach> and <flexcomp>, replaced by what they stand for.

MuJoCo does so in a process of its own: a model that attaches itself overflows its stack, and copies may take for ever.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf.tree import parse_text, verbatim
from hymeko_x.formats.mjcf.words import DELEGATED
from hymeko_x.frontends.mjcf.handover import hand_over

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.formats.mjcf.tree import Element
    from hymeko_x.frontends.mjcf.handover import Handover
    from hymeko_x.source import Source

_CHILD = "hymeko_x.frontends.mjcf_child"
_REFUSED = 3
"""The exit code of the process when MuJoCo refuses the model, in the words that it wrote."""

MOST_COPIES = 4000
"""How many elements an expansion may make. MuJoCo's time grows with their square: this many take some seconds."""
MOST_SECONDS = 30
MOST_BYTES = 2**31
"""What the process may use."""


def expand_by_mujoco(root: Element, source: Source, report: Report) -> Element:
    """The tree as MuJoCo writes it when something in it has to be expanded; else the tree as it is.

    Raises: Refusal when MuJoCo refuses the file, or is not there; HX007 when the expansion exceeds a limit.
    """
    found = next((element for element in root.walk() if element.tag in DELEGATED), None)
    if found is None:
        return root
    _check_size(root)
    if find_spec("mujoco") is None:
        raise refuse(codes.ENGINE_MISSING, f"<{found.tag}> is expanded by MuJoCo, which is not installed", found.origin)
    handover = hand_over(root, source, report)
    code, text = _expanded(verbatim(root), handover)
    if code == _REFUSED:
        said = handover.in_own_words(" ".join(text.split()))
        raise refuse(codes.ENGINE_REFUSED, f"MuJoCo refuses to expand <{found.tag}>: {said}", found.origin)
    if code != 0:
        raise refuse(codes.TOO_LARGE, f"expanding <{found.tag}> ended MuJoCo ({text}): it has no end, or takes too much", found.origin)
    report.note(codes.REWRITTEN, f"<{found.tag}> was expanded by MuJoCo; lines after it are those of the expanded file", found.origin)
    expanded = parse_text(text)
    handover.restore(expanded)
    for element in expanded.walk():
        element.file = source.name
    return expanded


def _check_size(root: Element) -> None:
    """Refuse what would fill the memory: copies of copies of copies.

    Raises: Refusal HX007.
    """
    total = 0
    stack = [(root, 1)]
    while stack:
        element, copies = stack.pop()
        if element.tag in ("replicate", "flexcomp"):
            copies *= _count(element)
        total += copies if copies > 1 else 0
        if total > MOST_COPIES:
            said = f"<{element.tag}> would make more than {MOST_COPIES} elements"
            raise refuse(codes.TOO_LARGE, said, element.origin, hint="expand it with MuJoCo, and convert the result")
        stack.extend((child, copies) for child in element.children)


def _count(element: Element) -> int:
    """How often an element's content is made; 1 where the text says no number, about which MuJoCo will complain."""
    product = 1
    for word in element.attributes.get("count", "1").split()[:3]:
        product *= int(word) if word.isascii() and word.isdigit() and len(word) < 12 else MOST_COPIES if word.isdigit() else 1
    return product


def _expanded(text: str, handover: Handover) -> tuple[int, str]:
    """The exit code of the process, and what it wrote, or how it ended."""
    parts = [text.encode(), *handover.models.values(), *handover.assets.values()]
    job = {
        "models": {name: len(data) for name, data in handover.models.items()},
        "assets": {name: len(data) for name, data in handover.assets.items()},
        "text": len(parts[0]),
        "compile": handover.has_keyframes,
    }
    command = [sys.executable, "-S", "-P", "-m", _CHILD, str(MOST_SECONDS), str(MOST_BYTES)]
    given = json.dumps(job).encode() + b"\n" + b"".join(parts)
    try:
        ended = subprocess.run(command, input=given, env=_environment(), capture_output=True, timeout=2 * MOST_SECONDS, check=False)
    except subprocess.TimeoutExpired:
        return -1, f"it took more than {2 * MOST_SECONDS} s"
    if ended.returncode in (0, _REFUSED):
        return ended.returncode, ended.stdout.decode("utf-8", "replace")
    return -1, f"exit code {ended.returncode}"


def _environment() -> dict[str, str]:
    """Nothing that is the user's own: where the libraries are."""
    folders = [str(Path(spec.origin).parents[1]) for name in ("hymeko_x", "mujoco") if (spec := find_spec(name)) and spec.origin]
    kept = {name: os.environ[name] for name in ("SYSTEMROOT", "LD_LIBRARY_PATH") if name in os.environ}
    return {"PYTHONPATH": os.pathsep.join(dict.fromkeys(folders)), **kept}
