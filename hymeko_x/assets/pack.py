"""Between rewriting and printing: every mesh and texture gets the path under which the output refers to it.

What lies beside the output is returned as bytes or as the path to copy from; the mechanism that comes back names it by
relative paths with forward slashes. File names are built here from what is harmless in the source's names, so that
no output ever leads out of its folder.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from hymeko_x import formats
from hymeko_x.assets.refer import Keep, keep_references
from hymeko_x.assets.shelf import Shelf

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Report
    from hymeko_x.formats import Format
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.source import Files

Mode = Literal["copy", "reference"]


def pack(
    mechanism: Mechanism, format: Format, files: Files, mode: Mode | None, report: Report, *, out_dir: str | None = None, within: str = ""
) -> tuple[Mechanism, dict[str, bytes], dict[str, str]]:
    """The mechanism with its files' new paths, the new files by relative path, and the copies by relative path.

    ``mode`` copy puts files beside the output, reference refers to them where they are, relative to ``out_dir`` (the
    output's folder); None is the format's own default. ``within`` is the folder below ``out_dir`` for what is put there. A file that
    is not there is a warning. For MJCF its shapes are left out, since MuJoCo reads no model with a missing file; in the other
    formats the reference stays as it is.
    """
    shelf = Shelf(mode or format.assets, out_dir, within)
    if format.pack is None:
        packed = keep_references(mechanism, shelf, files, report, Keep.of(format, shelf.mode))
    else:
        packed = formats.loaded(format.pack)(mechanism, shelf, files, report)
    return packed, shelf.files, shelf.copies
