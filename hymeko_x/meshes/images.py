"""Images: whatever Pillow reads, as the PNG that every engine reads, or the JPEG that most do."""

from __future__ import annotations

import io

MOST_BYTES = 2**27
_PNG = b"\x89PNG\r\n\x1a\n"
_JPEG = b"\xff\xd8\xff"


class UnreadableImage(Exception):
    """The bytes are no image; the text is the reason."""


def png_bytes(data: bytes) -> bytes:
    """The image as PNG; one that is PNG already comes back bit by bit, after it was seen to decode.

    Raises: UnreadableImage.
    """
    return _encoded(data, (_PNG,), decode=True)


def shown_image(data: bytes) -> tuple[bytes, str]:
    """The image as PNG or JPEG, whichever it is already, with the suffix of that; other types become PNG.

    What stays as it is is looked through and not decoded, which takes far longer than all else that is done with it.

    Raises: UnreadableImage.
    """
    found = _encoded(data, (_PNG, _JPEG), decode=False)
    return found, ".jpg" if found.startswith(_JPEG) else ".png"


def _encoded(data: bytes, as_it_is: tuple[bytes, ...], *, decode: bool) -> bytes:
    from PIL import Image

    if len(data) > MOST_BYTES:
        raise UnreadableImage(f"it has {len(data)} bytes, at most {MOST_BYTES} are read")
    try:
        with Image.open(io.BytesIO(data)) as image:
            if data.startswith(as_it_is):
                (image.load if decode else image.verify)()
                return data
            out = io.BytesIO()
            image.convert("RGBA" if "A" in image.getbands() else "RGB").save(out, "PNG", compress_level=3)
            return out.getvalue()
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise UnreadableImage(str(error).split("\n")[0] or type(error).__name__) from error
