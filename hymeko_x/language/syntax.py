"""The syntax tree of the HyMeKo language: the items of a text before their meaning is known.

Lines and columns are one-based.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self, TypeGuard

from msgspec import Struct
from msgspec.structs import replace

from hymeko_x.diagnostics import Origin

if TYPE_CHECKING:
    from collections.abc import Container


class QuotedName(str):
    """A name that stood in backticks: never a keyword, a path or a word of the vocabulary."""

    __slots__ = ()


class Syntax(Struct, frozen=True, gc=False):
    """A piece of syntax. The collector of cycles need not look at it: a tree has none."""

    def _replace(self, **changes: Any) -> Self:
        """A copy with other values, as named tuples have it."""
        return replace(self, **changes)


class Ref(Syntax, frozen=True, gc=False):
    """A reference by path, with the direction it was written with: ``X``, ``- Z``, ``-> leg.foot``."""

    path: tuple[str, ...]
    direction: str = ""
    modifier: str = ""

    @property
    def dotted(self) -> str:
        """The path as one text, for messages."""
        return ".".join(self.path)


class Quantity(Syntax, frozen=True, gc=False):
    """A number with a unit: ``90deg``."""

    number: float
    unit: str


class Expression(Syntax, frozen=True, gc=False):
    """The text between ``${`` and ``}``."""

    text: str


class Query(Syntax, frozen=True, gc=False):
    """``<?>``: a value that is left open."""


class Parameter(Syntax, frozen=True, gc=False):
    """A template parameter; default None = required."""

    name: str
    default: Value | None = None


class Stereotype(Syntax, frozen=True, gc=False):
    """A type behind the colon, with arguments when it is a template."""

    ref: Ref
    arguments: tuple[tuple[str, Value], ...] | None = None


class Node(Syntax, frozen=True, gc=False):
    """A vertex, an edge, or a definition: ``name (parameters) : stereotypes use scope { items }``.

    ``edge`` is empty for a vertex, else the word that makes it an edge (``@``, ``rel``, ... or a quoted edge type).
    ``parameters`` is None where there were no parentheses; a node with parentheses is a template. ``within`` is the path of the
    group that holds the element, which then is only changed here. ``size`` makes an array of it.
    """

    name: str
    items: tuple[Item, ...] = ()
    stereotypes: tuple[Stereotype, ...] = ()
    parameters: tuple[Parameter, ...] | None = None
    uses: tuple[Ref, ...] = ()
    edge: str = ""
    line: int = 0
    column: int = 0
    within: tuple[str, ...] = ()
    size: tuple[Value, ...] | None = None


class Field(Syntax, frozen=True, gc=False):
    """``name value``, ``name = value``, or a bare ``name`` (value None)."""

    name: str
    value: Value | None = None
    type: str = ""
    line: int = 0
    column: int = 0


class ArcItem(Syntax, frozen=True, gc=False):
    """``[weight] role direction target { items }``. In a vertex's body this is a field that holds a reference."""

    ref: Ref
    role: str = ""
    weight: tuple[Value, ...] | None = None
    items: tuple[Item, ...] = ()
    line: int = 0
    column: int = 0


class Import(Syntax, frozen=True, gc=False):
    """``import "path" as alias``."""

    path: str
    alias: str = ""
    line: int = 0
    column: int = 0


class Using(Syntax, frozen=True, gc=False):
    """``using a.b as c``: a name that stands for a path."""

    ref: Ref
    alias: str
    line: int = 0
    column: int = 0


class Constant(Syntax, frozen=True, gc=False):
    """``const K = 2 * L;``: a name for a number, the text of an expression."""

    name: str
    text: str
    line: int = 0
    column: int = 0


class Comment(Syntax, frozen=True, gc=False):
    """A comment between the items of a block, or of the text itself."""

    text: str
    line: int = 0
    column: int = 0


Value = float | str | Ref | Quantity | Expression | Query | tuple["Value", ...]
"""Numbers are float, strings str, lists plain tuples (never named ones)."""
Item = Node | Field | ArcItem | Import | Using | Constant | Comment


class Document(Syntax, frozen=True, gc=False):
    """A whole text: the items at top level. ``header`` is the legacy ``[ name ]``."""

    items: tuple[Item, ...]
    header: str = ""


def is_list(value: Value | None) -> TypeGuard[tuple[Value, ...]]:
    """Whether the value is a list (and not a reference or a quantity, which are tuples as well)."""
    return type(value) is tuple


def is_field(item: Item, names: Container[str]) -> TypeGuard[Field]:
    """Whether it is a field of one of these names, unquoted."""
    return isinstance(item, Field) and item.name in names and not isinstance(item.name, QuotedName)


def origin_of(item: Item, file: str) -> Origin:
    """The place of an item in its file."""
    return Origin(file, item.line or None, item.column or None)
