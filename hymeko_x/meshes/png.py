"""PNG files chunk by chunk: which of them a strict decoder refuses, and the same pixels without what it refuses.

Source: PNG (Third Edition), W3C, chapters 5 and 11; the checks of lodepng, which MuJoCo decodes with.
"""

from __future__ import annotations

import struct
import zlib
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

SIGNATURE = b"\x89PNG\r\n\x1a\n"
_CRITICAL = frozenset((b"IHDR", b"PLTE", b"IDAT", b"IEND"))
_SIZES: Mapping[bytes, int] = MappingProxyType(
    {b"sRGB": 1, b"gAMA": 4, b"cHRM": 32, b"pHYs": 9, b"tIME": 7, b"cICP": 4, b"mDCV": 24, b"cLLI": 8}
)
"""The chunks that have one size."""
_SAMPLES: Mapping[int, int] = MappingProxyType({0: 1, 2: 3, 3: 3, 4: 2, 6: 4})
"""By colour type, for how many samples sBIT has a byte."""
_BACKGROUNDS: Mapping[int, int] = MappingProxyType({0: 2, 2: 6, 3: 1, 4: 2, 6: 6})
_TRANSPARENT: Mapping[int, int] = MappingProxyType({0: 2, 2: 6})
_LONGEST_KEYWORD = 79
_MOST_TEXT = 2**24
_PALETTE = 3


class _Chunk(NamedTuple):
    kind: bytes
    data: bytes
    whole: bytes


class _Broken(Exception):
    """The file is no sequence of chunks; the text is the reason."""


def png_fault(data: bytes) -> str | None:
    """Why a strict decoder refuses the file, as far as its chunks tell; None where they are in order."""
    try:
        chunks = list(_chunks(data))
    except _Broken as broken:
        return str(broken)
    header = chunks[0].data
    return next((fault for chunk in chunks if (fault := _fault(chunk, header)) is not None), None)


def without_faulty_chunks(data: bytes) -> bytes | None:
    """The file without the chunks beside its pixels that a strict decoder refuses; None where its pixels are damaged themselves."""
    try:
        chunks = list(_chunks(data))
    except _Broken:
        return None
    header = chunks[0].data
    good = [chunk for chunk in chunks if _fault(chunk, header) is None]
    return SIGNATURE + b"".join([chunk.whole for chunk in good]) if _CRITICAL & {c.kind for c in chunks} <= {c.kind for c in good} else None


def _chunks(data: bytes) -> Iterator[_Chunk]:
    """All chunks up to the last one. Raises: _Broken."""
    if not data.startswith(SIGNATURE):
        raise _Broken("it is no PNG file")
    place = len(SIGNATURE)
    while True:
        if place + 12 > len(data):
            raise _Broken("it ends before its last chunk")
        (size,) = struct.unpack_from(">I", data, place)
        end = place + 12 + size
        kind = data[place + 4 : place + 8]
        if end > len(data) or (place == len(SIGNATURE) and (kind != b"IHDR" or size != 13)):
            raise _Broken("a chunk is longer than the file" if end > len(data) else "it begins with no header")
        yield _Chunk(kind, data[place + 8 : end - 4], data[place:end])
        if kind == b"IEND":
            return
        place = end


def _fault(chunk: _Chunk, header: bytes) -> str | None:
    """Why a decoder refuses a chunk."""
    kind, name = chunk.kind, chunk.kind.decode("latin-1")
    depth, colours = header[8], header[9]
    if zlib.crc32(chunk.whole[4:-4]) != int.from_bytes(chunk.whole[-4:]):
        return f"the checksum of its chunk {name} is wrong"
    if not kind[0] & 32:
        return None if kind in _CRITICAL else f"it has an unknown critical chunk {name}"
    size = _SIZES.get(kind)
    if kind == b"sBIT":
        size = _SAMPLES.get(colours)
        deepest = 8 if colours == _PALETTE else depth
        if size == len(chunk.data) and not all(0 < bits <= deepest for bits in chunk.data):
            return "its chunk sBIT has a value out of range"
    if kind == b"bKGD":
        size = _BACKGROUNDS.get(colours)
    if kind == b"tRNS":
        size = _TRANSPARENT.get(colours)
    if size is not None and len(chunk.data) != size:
        return f"its chunk {name} has {len(chunk.data)} bytes, and an image of its type needs {size}"
    if kind in (b"tEXt", b"zTXt", b"iTXt", b"iCCP") and not _is_text(kind, chunk.data):
        return f"its chunk {name} is damaged"
    return None


def _is_text(kind: bytes, data: bytes) -> bool:
    """Whether a chunk is a keyword with a text, compressed or not."""
    keyword, _, rest = data.partition(b"\0")
    if not 1 <= len(keyword) <= _LONGEST_KEYWORD or (kind != b"tEXt" and b"\0" not in data):
        return False
    if kind == b"tEXt":
        return True
    if kind == b"iTXt":
        words = rest[2:].split(b"\0", 2)
        return len(rest) > 1 and len(words) == 3 and rest[1] == 0 and (rest[0] == 0 or _is_compressed(words[2]))
    return rest[:1] == b"\0" and _is_compressed(rest[1:])


def _is_compressed(data: bytes) -> bool:
    unpacker = zlib.decompressobj()
    try:
        unpacker.decompress(data, _MOST_TEXT)
    except zlib.error:
        return False
    return unpacker.eof
