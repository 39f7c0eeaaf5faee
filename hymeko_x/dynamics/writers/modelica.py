"""Modelica: a model with the states as variables, in the order of assignments."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from hymeko_x.dynamics.writers.program import description, program_of
from hymeko_x.ir.digits import number_text

if TYPE_CHECKING:
    from hymeko_x.dynamics.system import System

_WORDS = frozenset(
    [
        "algorithm",
        "and",
        "annotation",
        "block",
        "break",
        "class",
        "connect",
        "connector",
        "constant",
        "der",
        "discrete",
        "each",
        "else",
        "end",
        "enumeration",
        "equation",
        "expandable",
        "extends",
        "external",
        "false",
        "final",
        "flow",
        "for",
        "function",
        "if",
        "import",
        "in",
        "initial",
        "inner",
        "input",
        "loop",
        "model",
        "not",
        "operator",
        "or",
        "outer",
        "output",
        "package",
        "parameter",
        "partial",
        "protected",
        "public",
        "pure",
        "record",
        "redeclare",
        "replaceable",
        "return",
        "stream",
        "then",
        "true",
        "type",
        "when",
        "while",
        "within",
        "time",
    ]
)


def identifier(name: str) -> str:
    """A name as an identifier of Modelica: letters, digits and underscores."""
    plain = re.sub(r"[^A-Za-z0-9_]", "_", name)
    return plain if plain and not plain[0].isdigit() and plain not in _WORDS else f"v_{plain}"


def write_modelica(system: System) -> str:
    """A Modelica model: inputs and outputs are its connectors, parameters may be changed, states start where the file has them."""
    groups = {"x": system.states, "u": system.inputs, "y": system.outputs, "p": system.parameters}
    taken: set[str] = {f"t{k}" for k in range(1, 2)}
    names: dict[str, list[str]] = {}
    for letter, variables in groups.items():
        prefix = "y_" if letter == "y" else ""
        names[letter] = [_free(identifier(prefix + variable.name), taken) for variable in variables]
    program = program_of(system, lambda letter, k: names[letter][k])
    model = _free(identifier(system.name), taken)
    unit = {v.name: f'(unit="{_unit(v.unit)}"' if v.unit else "(" for group in groups.values() for v in group}
    lines = [*description(system, "//"), f"model {model}"]
    for name, v in zip(names["p"], system.parameters, strict=True):
        lines.append(f"  parameter Real {name}{_closed(unit[v.name])} = {number_text(v.value)};")
    for name, v in zip(names["u"], system.inputs, strict=True):
        lines.append(f"  input Real {name}{_closed(unit[v.name])};")
    for name, v in zip(names["y"], system.outputs, strict=True):
        lines.append(f"  output Real {name}{_closed(unit[v.name])};")
    for name, v in zip(names["x"], system.states, strict=True):
        comma = ", " if v.unit else ""
        lines.append(f"  Real {name}{unit[v.name]}{comma}start={number_text(v.value)}, fixed=true);")
    if program.assignments:
        lines += ["protected", *[f"  Real {target};" for target, _ in program.assignments]]
    lines.append("equation")
    lines += [f"  {target} = {text};" for target, text in program.assignments]
    lines += [f"  der({name}) = {rate};" for name, rate in zip(names["x"], program.rates, strict=True)]
    lines += [f"  {name} = {output};" for name, output in zip(names["y"], program.outputs, strict=True)]
    return "\n".join([*lines, f"end {model};"]) + "\n"


def _free(name: str, taken: set[str]) -> str:
    while name in taken or re.fullmatch(r"t\d+", name):
        name += "_"
    taken.add(name)
    return name


def _unit(unit: str) -> str:
    """A unit as Modelica writes it: products with points, powers without signs."""
    return unit.replace("*", ".").replace("^", "")


def _closed(text: str) -> str:
    return "" if text == "(" else f"{text})"
