"""Images: whatever Pillow reads, as the PNG that every engine reads, or the JPEG that most do."""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.memory import remembered
from hymeko_x.meshes.png import SIGNATURE, png_fault, without_faulty_chunks

if TYPE_CHECKING:
    from PIL.Image import Image as PillowImage

MOST_BYTES = 2**27
_JPEG = b"\xff\xd8\xff"


class Pixels(NamedTuple):
    """The decoded points of an image, row by row, with 8 bits for each of red, green, blue and opacity."""

    size: tuple[int, int]
    data: bytes

    def rows(self) -> list[bytes]:
        """The points of each row."""
        width = 4 * self.size[0]
        return [self.data[start : start + width] for start in range(0, len(self.data), width)]

    def mean(self) -> tuple[float, float, float]:
        """The mean of red, green and blue from 0 to 1, whatever the opacity."""
        red, green, blue = (sum(self.data[channel::4]) / max(1, len(self.data) // 4) / 255.0 for channel in range(3))
        return red, green, blue


class UnreadableImage(Exception):
    """The bytes are no image; the text is the reason."""


@remembered
def png_bytes(data: bytes) -> bytes:
    """The image as a PNG that strict decoders read; one that is such already comes back bit by bit, after it was seen to decode.

    A PNG with faulty chunks beside its pixels loses these alone. Raises: UnreadableImage.
    """
    if png_fault(data) is None:
        return _encoded(data, (SIGNATURE,), decode=True)
    bare = without_faulty_chunks(data)
    return _encoded(data if bare is None else bare, () if bare is None else (SIGNATURE,), decode=True)


def shown_image(data: bytes) -> tuple[bytes, str]:
    """The image as PNG or JPEG, whichever it is already, with the suffix of that; other types become PNG.

    What stays as it is is looked through and not decoded, which takes far longer than all else that is done with it.

    Raises: UnreadableImage.
    """
    found = _encoded(data, (SIGNATURE, _JPEG), decode=False)
    return found, ".jpg" if found.startswith(_JPEG) else ".png"


def pixels(data: bytes) -> Pixels:
    """The points of an image. Raises: UnreadableImage."""
    from PIL import Image

    try:
        with Image.open(io.BytesIO(png_bytes(data))) as image:
            return Pixels(image.size, image.convert("RGBA").tobytes())
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise UnreadableImage(_reason(error)) from error


def _reason(error: Exception) -> str:
    """Why Pillow does not read an image, without the address of its bytes."""
    words = re.sub(r" <_io\.BytesIO object at \w+>", "", str(error).split("\n")[0]).replace("image file", "the type of the image")
    return words or type(error).__name__


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
            _in_bytes(image).save(out, "PNG", compress_level=3)
            return out.getvalue()
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise UnreadableImage(_reason(error)) from error


def _in_bytes(image: PillowImage) -> PillowImage:
    """The image with 8 bits for each sample; of deeper ones these are the upper 8."""
    if image.mode.startswith("I;16"):
        return image.convert("I").point(lambda value: value / 256, "L").convert("RGB")
    has_opacity = "A" in image.getbands() or "transparency" in image.info
    return image.convert("RGBA" if has_opacity else "RGB")
