"""Pictures as files: PNG, several in one, and films."""

from __future__ import annotations

import io
import math
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    Picture = NDArray[np.uint8]

_RATE = 24
"""Pictures in a second."""


def png(picture: Picture) -> bytes:
    """A picture as a PNG file."""
    out = io.BytesIO()
    Image.fromarray(picture).save(out, "PNG")
    return out.getvalue()


def grid(pictures: list[Picture]) -> Picture:
    """Pictures of one size side by side, in rows and columns of about the same number; what is left over is white."""
    columns = math.ceil(math.sqrt(len(pictures)))
    rows = math.ceil(len(pictures) / columns)
    height, width, _ = pictures[0].shape
    whole = np.full((rows * height, columns * width, 3), 255, np.uint8)
    for number, picture in enumerate(pictures):
        row, column = divmod(number, columns)
        whole[row * height : (row + 1) * height, column * width : (column + 1) * width] = picture
    return whole


def film(pictures: Iterable[Picture], suffix: str) -> bytes:
    """A film as a file: ``.gif`` repeats for ever, ``.mp4`` is H.264."""
    return _gif(pictures) if suffix == ".gif" else _mp4(pictures)


def _gif(pictures: Iterable[Picture]) -> bytes:
    images = [Image.fromarray(picture).quantize(128) for picture in pictures]
    out = io.BytesIO()
    images[0].save(out, "GIF", save_all=True, append_images=images[1:], duration=1000 // _RATE, loop=0)
    return out.getvalue()


def _mp4(pictures: Iterable[Picture]) -> bytes:
    import imageio_ffmpeg

    with TemporaryDirectory(prefix="hymeko-x-") as folder:
        path = Path(folder) / "film.mp4"
        writer = None
        for picture in pictures:
            if writer is None:
                writer = imageio_ffmpeg.write_frames(str(path), (picture.shape[1], picture.shape[0]), fps=_RATE, macro_block_size=2)
                writer.send(None)
            writer.send(np.ascontiguousarray(picture))
        assert writer is not None, "a film has at least one picture"
        writer.close()
        return path.read_bytes()
