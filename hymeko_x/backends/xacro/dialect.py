"""What things cost in xacro, in characters without white space."""

from __future__ import annotations

from hymeko_x.factor import Dialect
from hymeko_x.formats.xacro import TAKEN, survives


def can_be_default(text: str) -> bool:
    """Whether a text can stand as the default of a parameter."""
    return not set(text) & set("'\"$\n\r\t")


def can_be_value(text: str) -> bool:
    """Whether a text can be that of a property, which xacro evaluates again wherever it is used."""
    return survives(text) and not set(text) & set("'\"$\n\r\t")


_LEAVES = {"xyz": "xyz", "rpy": "rpy", "value": "", "name": "", "link": "", "rgba": "rgba", "filename": "mesh"}


def _leaf_name(tag: str, leaf: str) -> str:
    return _LEAVES.get(leaf, leaf) or tag


DIALECT = Dialect(
    element=len("</>"),
    block=len("<></>") - len("</>"),
    closes_by_tag=True,
    leaf=len('=""'),
    macro=len('<xacro:macroname=""params=""></xacro:macro>'),
    parameter=0,
    default=len(":="),
    call=len("<xacro:/>"),
    argument=len('=""'),
    hole=len("${}"),
    value=len('<xacro:propertyname=""value=""/>'),
    leaf_name=_leaf_name,
    taken=TAKEN,
    can_be_default=can_be_default,
    values=True,
    can_be_value=can_be_value,
)
