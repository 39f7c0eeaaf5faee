"""`hymeko-x update`: what was edited in a converted file, in the text of the file that it was converted from."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING

from msgspec.structs import replace

from hymeko_x import disk, formats
from hymeko_x.cli import exits
from hymeko_x.cli.exits import UsageError
from hymeko_x.cli.inputs import input_arguments, shape_arguments, source_of
from hymeko_x.cli.report import show_diagnostics
from hymeko_x.diagnostics import Report
from hymeko_x.edits.updating import update
from hymeko_x.rewrite import Options

if TYPE_CHECKING:
    import argparse

    from hymeko_x.edits.updating import Updated

_MOST_EDITS = 40
"""How many edits are shown; `--json` has all."""
_LONGEST = 160


def update_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `update`."""
    parser.add_argument("original", metavar="ORIGINAL", help="the file that is to get the edits")
    parser.add_argument("edited", metavar="EDITED", help="the file that was converted from it, and edited since")
    parser.add_argument("-o", "--output", metavar="OUT", help="where to write (default: ORIGINAL itself)")
    parser.add_argument("--dry-run", action="store_true", help="print what would change in the text, and write nothing")
    parser.add_argument("--edited-from", metavar="FORMAT", help="the format of EDITED, where suffix and content do not tell")
    parser.add_argument("--base", choices=("fixed", "free"), help="as in the conversion (default: found out)")
    parser.add_argument("--actuators", choices=("none", "motor", "position", "velocity"), help="as in the conversion (default: found out)")
    shape_arguments(parser)
    parser.add_argument("--for", dest="target", metavar="TARGET", help="as in the conversion (default: found out)")
    parser.add_argument("--json", action="store_true", help="print edits, changed files and diagnostics as JSON")
    input_arguments(parser)


def run_update(chosen: argparse.Namespace) -> int:
    """Bring the edits home, show them, and write the files unless it is a rehearsal."""
    if "-" in (chosen.original, chosen.edited, chosen.output):
        raise UsageError("update reads and writes files, and no pipes")
    if not chosen.dry_run:
        disk.check_outputs(chosen.output or chosen.original, makes_folders=True)
    report = Report()
    original, edited = source_of(chosen.original, chosen), source_of(chosen.edited, chosen)
    format = formats.by_name(chosen.from_format) if chosen.from_format else formats.of_input(original.name, original.data)
    named = formats.by_name(chosen.edited_from) if chosen.edited_from else formats.of_input(edited.name, edited.data)
    original = replace(original, variants=dict(chosen.variant), arguments=dict(chosen.arg), environment=dict(chosen.env))
    options = Options(chosen.base, chosen.actuators, target=chosen.target, density=chosen.density, inertia_from=chosen.inertia_from)
    options = replace(options, collision=chosen.collision)
    found = update(original, format, edited, named, options, report)
    files = found.files(chosen.original, chosen.output)
    if not chosen.dry_run:
        disk.write_files(files)
    show_diagnostics(report, chosen)
    _show_edits(found)
    if chosen.json:
        print(_as_json(found, list(files)))
    elif chosen.dry_run:
        sys.stdout.write(found.diff)
    else:
        print("\n".join(f"written: {path}" for path in files), file=sys.stderr)
    return exits.DONE


def _show_edits(found: Updated) -> None:
    for edit in found.edits[:_MOST_EDITS]:
        origin = found.mechanism.origin(edit.element)
        line = f"{f'{origin}: ' if origin else ''}edit: {edit}"
        print(line if len(line) <= _LONGEST else f"{line[:_LONGEST]}...", file=sys.stderr)
    if len(found.edits) > _MOST_EDITS:
        print(f"... and {len(found.edits) - _MOST_EDITS} more edits (--json lists all)", file=sys.stderr)
    if not found.edits:
        print("no edits: the file is what its original is converted to", file=sys.stderr)


def _as_json(found: Updated, files: list[str]) -> str:
    edits = [{"element": str(edit.element), "field": edit.field, "before": edit.before, "after": edit.after} for edit in found.edits]
    document = {"edits": edits, "files": files, "diff": found.diff, "diagnostics": [diagnostic.as_json() for diagnostic in found.report]}
    return json.dumps(document, indent=2, ensure_ascii=False)
