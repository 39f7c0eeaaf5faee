"""Equations as a program of single assignments, which every language with arithmetic can be given."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from msgspec import Struct

from hymeko_x.dynamics.numbers import graphs

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from hymeko_x.dynamics.system import System


class Program(Struct, frozen=True):
    """Assignments ``target = text``, and the texts of the rates and outputs at their end."""

    assignments: tuple[tuple[str, str], ...]
    rates: tuple[str, ...]
    outputs: tuple[str, ...]


def graph_of(system: System) -> Any:
    """The casadi function (x, u, p) -> (rates, outputs)."""
    import casadi

    x, u, p = (casadi.SX.sym(letter, len(part)) for letter, part in (("x", system.states), ("u", system.inputs), ("p", system.parameters)))
    states, inputs, parameters = ([part[k] for k in range(part.numel())] for part in (x, u, p))
    found = [casadi.vertcat(*equations(states, inputs, parameters, graphs())) for equations in (system.rates, system.measured)]
    return casadi.Function("dynamics", [x, u, p], found, ["x", "u", "p"], ["rates", "outputs"])


_TEXTS: Mapping[str, str] = MappingProxyType(
    {
        "ADD": "{0} + {1}",
        "SUB": "{0} - {1}",
        "MUL": "{0} * {1}",
        "DIV": "{0} / {1}",
        "NEG": "-{0}",
        "SQ": "{0} * {0}",
        "TWICE": "2 * {0}",
        "INV": "1 / {0}",
        "ASSIGN": "{0}",
        **{name.upper(): name + "({0})" for name in ("sin", "cos", "tan", "asin", "acos", "atan", "sqrt", "exp", "log", "tanh", "sign")},
        "FABS": "abs({0})",
        "ATAN2": "atan2({0}, {1})",
        "POW": "{0} ^ {1}",
        "CONSTPOW": "{0} ^ {1}",
    }
)
"""Each operation of casadi as text in Modelica and Octave; other languages replace what they write otherwise."""


def program_of(
    system: System, names: Callable[[str, int], str], *, texts: Mapping[str, str] | None = None, constant: Callable[[float], str] = repr
) -> Program:
    """The program of a system.

    ``names`` gives the text of the k-th of x, u or p, ``constant`` that of a number; ``texts`` replaces operations.
    """
    import casadi

    graph = graph_of(system)
    known = {getattr(casadi, f"OP_{name}"): text for name, text in {**_TEXTS, **(texts or {})}.items()}
    current: dict[int, str] = {}
    assignments: list[tuple[str, str]] = []
    results: tuple[dict[int, str], dict[int, str]] = ({}, {})
    for k in range(graph.n_instructions()):
        operation, inputs, outputs = graph.instruction_id(k), graph.instruction_input(k), graph.instruction_output(k)
        if operation == casadi.OP_CONST:
            value = graph.instruction_constant(k)
            current[outputs[0]] = constant(value) if value >= 0 else f"({constant(value)})"
        elif operation == casadi.OP_INPUT:
            current[outputs[0]] = names("xup"[inputs[0]], inputs[1])
        elif operation == casadi.OP_OUTPUT:
            results[outputs[0]][outputs[1]] = current[inputs[0]]
        else:
            target = f"t{len(assignments) + 1}"
            assignments.append((target, known[operation].format(*[current[place] for place in inputs])))
            current[outputs[0]] = target
    rates, measured = (
        tuple(found.get(k, constant(0.0)) for k in range(count))
        for found, count in zip(results, (len(system.states), len(system.outputs)), strict=True)
    )
    return Program(tuple(assignments), rates, measured)


def description(system: System, mark: str) -> list[str]:
    """Comment lines that say where a generated file comes from and what its variables are."""
    lines = [f"{mark} {system.name}: equations of motion, written by hymeko-x. SI units and rad."]
    for letter, variables in (("x", system.states), ("u", system.inputs), ("y", system.outputs), ("p", system.parameters)):
        if variables:
            lines.append(f"{mark} {letter}: " + ", ".join(f"{v.name} ({v.unit})" if v.unit else v.name for v in variables))
    return lines
