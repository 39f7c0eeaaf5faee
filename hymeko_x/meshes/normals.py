"""Normals of OBJ files: MuJoCo refuses a model when the file has some, and not one for every corner of its first object."""

from __future__ import annotations

import re

from hymeko_x.meshes.tables import faces_of_first_object

_INCOMPLETE = re.compile(rb"^[ \t]*f(?:[ \t]+-?\d+/-?\d*/-?\d+)*[ \t]+(?!-?\d+/-?\d*/-?\d+(?:\s|\Z))[^\s#]", re.MULTILINE)
_NUMBER = re.compile(rb"/(-?\d+)(?=[ \t\r\n]|\Z)")


def lacks_normals(data: bytes) -> bool:
    """Whether an OBJ file has normals, and a corner of its first object has none of them."""
    count = data.count(b"\nvn") + data.startswith(b"vn")
    if not count or not _lacks(data, count):
        return False
    return _lacks(b"\n".join(b"f " + row for row in faces_of_first_object(data)), count)


def _lacks(data: bytes, count: int) -> bool:
    """Whether a corner has no number of a normal, or one that the file does not have."""
    return bool(_INCOMPLETE.search(data)) or any(not 0 < abs(int(number)) <= count for number in {*_NUMBER.findall(data)})
