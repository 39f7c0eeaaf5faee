"""The root element of an XML text, by which its format is recognised."""

from __future__ import annotations

import re

_BEFORE_ROOT = re.compile(rb"\s+|<\?.*?\?>|<!--.*?-->|<!DOCTYPE[^>\[]*(?:\[.*?\]\s*)?>", re.DOTALL)
_ROOT = re.compile(rb"<([A-Za-z_][\w.:-]*)")


def xml_root(data: bytes) -> str | None:
    """The name of the root element without its prefix, or None when the data does not begin like XML."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        data = data.decode("utf-16", "replace").encode()
    position = 3 if data.startswith(b"\xef\xbb\xbf") else 0
    while skipped := _BEFORE_ROOT.match(data, position):
        position = skipped.end()
    root = _ROOT.match(data, position)
    return root[1].decode("utf-8", "replace").rpartition(":")[2] if root else None
