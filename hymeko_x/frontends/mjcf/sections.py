"""The sections that say something about the whole: <compiler> gives numbers their meaning, others go along as they are."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse
from hymeko_x.formats.mjcf.tree import COMMENT
from hymeko_x.formats.mjcf.words import ASIDE, settings_of

if TYPE_CHECKING:
    from hymeko_x.formats.mjcf.codec import Settings
    from hymeko_x.formats.mjcf.tree import Element
    from hymeko_x.frontends.mjcf.draft import Draft


def read_settings(root: Element) -> Settings:
    """What all <compiler> elements say together; a later one wins."""
    compilers = [child for child in root.children if child.tag == "compiler"]
    for compiler in compilers:
        if compiler.attributes.get("coordinate") == "global":
            message = '<compiler coordinate="global"> was removed in MuJoCo 2.3.4'
            hint = "load and save the file once with MuJoCo 2.3.3, which rewrites it in local coordinates"
            raise refuse(codes.UNKNOWN_WORD, message, compiler.origin, hint=hint)
    return settings_of([compiler.attributes for compiler in compilers])


def keep_sections(root: Element, draft: Draft) -> None:
    """Everything at top level that has no word in the IR and that others refer to, and comments, in order."""
    for child in root.detach(COMMENT, *ASIDE):
        draft.keep_at_root(child)
