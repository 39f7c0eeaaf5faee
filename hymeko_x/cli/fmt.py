"""`hymeko-x fmt`: HyMeKo text in its usual layout, in place."""

from __future__ import annotations

import difflib
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from hymeko_x import disk, formats
from hymeko_x.cli import exits
from hymeko_x.cli.exits import UsageError
from hymeko_x.cli.terminal import show
from hymeko_x.diagnostics import Refusal
from hymeko_x.language.formatting import format_text
from hymeko_x.language.templates import decode

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator


def fmt_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `fmt`."""
    parser.add_argument("files", nargs="+", metavar="FILE", help="files or folders; - reads standard input and prints")
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 if a file has another layout")
    parser.add_argument("--diff", action="store_true", help="write nothing; print what would change, and exit 1 if anything would")


def run_fmt(chosen: argparse.Namespace) -> int:
    """Format every file; a file that is not HyMeKo is reported, and the others are formatted all the same."""
    changed = same = failed = 0
    for name in _names(chosen.files):
        try:
            is_changed = _format(name, check=chosen.check, diff=chosen.diff)
        except Refusal as refusal:
            show(refusal.diagnostics)
            failed += 1
            continue
        changed += is_changed
        same += not is_changed
    if chosen.files != ["-"]:
        print(_summary(changed, same, failed, would=chosen.check or chosen.diff), file=sys.stderr)
    return exits.FAILED if failed or (changed and (chosen.check or chosen.diff)) else exits.DONE


def _names(given: list[str]) -> Iterator[str]:
    """The files, and those in folders, hidden ones aside. Raises: UsageError for a folder without any, or a file of another format."""
    suffixes = formats.OWN.suffixes
    for name in given:
        row = formats.of_file(name)
        if row is not None and row is not formats.OWN:
            raise UsageError(f"it is for HyMeKo text, and {name} is {row.name}; `hymeko-x import {name}` prints it as HyMeKo")
        if name == "-" or not Path(name).is_dir():
            yield name
            continue
        found = sorted(path for path in Path(name).rglob("*") if path.name.endswith(suffixes) and path.is_file())
        found = [path for path in found if not any(part.startswith(".") for part in path.relative_to(name).parts)]
        if not found:
            raise UsageError(f"no file in '{name}' ends in {' or '.join(suffixes)}")
        yield from map(str, found)


def _format(name: str, *, check: bool, diff: bool) -> bool:
    """Format one file; whether its layout was another one. Raises: Refusal HX001, HX002, HX060."""
    data = sys.stdin.buffer.read() if name == "-" else disk.open_source(name).data
    shown = "<stdin>" if name == "-" else name
    text = decode(data, shown)
    new = format_text(text, shown)
    is_changed = new.encode() != data
    if diff and is_changed:
        lines = difflib.unified_diff(text.splitlines(), new.splitlines(), shown, shown, lineterm="")
        print("\n".join(lines) or f"{shown}: only line ends differ")
    elif check:
        if is_changed:
            print(f"would reformat {shown}")
    elif not diff and name == "-":
        sys.stdout.write(new)
    elif not diff and is_changed:
        disk.write_files({name: new.encode()})
    return is_changed


def _summary(changed: int, same: int, failed: int, *, would: bool) -> str:
    parts = [(changed, "would be reformatted" if would else "reformatted"), (same, "left unchanged"), (failed, "could not be read")]
    counts = [f"{count} {'file' if count == 1 else 'files'} {words}" for count, words in parts if count]
    return ", ".join(counts)
