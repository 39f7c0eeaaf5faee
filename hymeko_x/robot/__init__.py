"""The object model: a robot whose elements are found by name, changed in editing sessions, and composed with other robots."""

from __future__ import annotations

from hymeko_x.robot.composing import compose_scene as compose
from hymeko_x.robot.errors import EditError as EditError
from hymeko_x.robot.errors import UnknownName as UnknownName
from hymeko_x.robot.robot import Robot as Robot

__all__ = ["EditError", "Robot", "UnknownName", "compose"]
