"""`hymeko-x schema`: the JSON Schema of robots in JSON."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from hymeko_x import formats
from hymeko_x.cli import exits

if TYPE_CHECKING:
    import argparse


def schema_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `schema`: none of its own."""


def run_schema(chosen: argparse.Namespace) -> int:
    """Print the schema."""
    made = next(row.schema for row in formats.FORMATS if row.schema)
    print(json.dumps(formats.loaded(made)(), indent=2))
    return exits.DONE
