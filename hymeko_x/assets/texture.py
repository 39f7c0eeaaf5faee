"""Images: whatever Pillow reads, as the PNG that every engine reads."""

from __future__ import annotations

import io

MOST_BYTES = 2**27
_PNG = b"\x89PNG\r\n\x1a\n"


class UnreadableImage(Exception):
    """The bytes are no image; the text says why."""


def png_bytes(data: bytes) -> bytes:
    """The image as PNG; one that is PNG already comes back bit by bit, after it was seen to decode.

    Raises: UnreadableImage.
    """
    from PIL import Image

    if len(data) > MOST_BYTES:
        raise UnreadableImage(f"it has {len(data)} bytes, at most {MOST_BYTES} are read")
    try:
        with Image.open(io.BytesIO(data)) as image:
            image.load()
            if data.startswith(_PNG):
                return data
            out = io.BytesIO()
            image.convert("RGBA" if "A" in image.getbands() else "RGB").save(out, "PNG", compress_level=3)
            return out.getvalue()
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise UnreadableImage(str(error).split("\n")[0] or type(error).__name__) from error
