"""Actuators that are implied: of a transmission that names one which nothing else describes."""

from __future__ import annotations

from hymeko_x.ir.parts import Actuator

IMPLIED_ACTUATOR = Actuator("transmission")
TYPE = "type"
"""A drive with this field is a transmission, whose actuator need not be described."""
