"""USD in memory."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pxr import Sdf, Usd

if TYPE_CHECKING:
    from collections.abc import Mapping


def load(main: bytes, contents: Mapping[str, bytes]) -> Any:
    """The stage of a text; images keep the paths beside which the text would stand. Raises: ValueError when it is no USD."""
    layer = Sdf.Layer.CreateAnonymous(".usda")
    if not layer.ImportFromString(main.decode()):
        raise ValueError("USD does not read the text")
    return Usd.Stage.Open(layer)
