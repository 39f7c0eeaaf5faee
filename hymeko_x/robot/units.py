"""Units by which numbers are multiplied where they are written: ``30 * deg``, ``5 * mm``. Everything else is SI and radians."""

from __future__ import annotations

import math

deg = math.pi / 180.0
"""One degree in rad."""
mm = 1e-3
"""One millimetre in m."""
