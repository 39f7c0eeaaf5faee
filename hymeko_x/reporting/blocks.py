"""Blocks of a page between two marks, which a program writes and nothing else changes."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable


def renewed_blocks(text: str, by: str, content: Callable[[str], str]) -> str:
    """The text with new content in every block of the program that is called ``by``; ``content`` is asked by the block's name.

    Raises: ValueError when there is no such block.
    """
    mark = f": written by `{by}` -->"
    pattern = re.compile(rf"<!-- (?P<name>[a-z]+){re.escape(mark)}\n.*?<!-- end of (?P=name) -->", re.DOTALL)
    if not pattern.search(text):
        raise ValueError(f"the page has no block <!-- NAME{mark} ... <!-- end of NAME -->")
    return pattern.sub(lambda found: f"<!-- {found['name']}{mark}\n\n{content(found['name'])}\n\n<!-- end of {found['name']} -->", text)
