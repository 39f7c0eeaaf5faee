"""The tokens of HyMeKo text: the language's terminals, in the order in which its lexer tries them; a list of numbers is one token."""

from __future__ import annotations

import json
import re
from functools import cache
from importlib.resources import files


def tokens(text: str) -> list[str]:
    """The tokens of a text, without comments and white space."""
    return [match[0] for match in _pattern().finditer(text) if match.lastgroup == "token"]


@cache
def _pattern() -> re.Pattern[str]:
    tables = json.loads(files("hymeko_x.language").joinpath("tables.json").read_text(encoding="utf-8"))
    comment, space = tables["ignored"]
    terminals = "|".join(f"(?:{pattern})" for name, pattern in tables["terminals"] if name not in tables["opening"])
    return re.compile(f"(?P<space>{space})|(?P<comment>{comment})|(?P<token>{terminals}|.)", re.DOTALL)
