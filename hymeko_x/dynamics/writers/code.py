"""Python, casadi, sympy and C."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from hymeko_x.dynamics.writers.program import description, graph_of, program_of

if TYPE_CHECKING:
    from hymeko_x.dynamics.system import System

_POWERS = {"POW": "{0} ** {1}", "CONSTPOW": "{0} ** {1}"}


def _names(letter: str, k: int) -> str:
    return f"{letter}[{k}]"


def _prefixed(module: str, renamed: dict[str, str]) -> dict[str, str]:
    """Python's texts of the operations, with the functions of a module."""
    functions = ("sin", "cos", "tan", "asin", "acos", "atan", "sqrt", "exp", "log", "tanh", "sign")
    texts = {name.upper(): f"{module}.{renamed.get(name, name)}({{0}})" for name in functions}
    texts["FABS"] = f"{module}.{renamed.get('abs', 'fabs')}({{0}})"
    texts["ATAN2"] = f"{module}.{renamed.get('atan2', 'atan2')}({{0}}, {{1}})"
    return {**texts, **_POWERS}


def _tables(system: System) -> list[str]:
    names = {"STATES": system.states, "INPUTS": system.inputs, "OUTPUTS": system.outputs, "PARAMETERS": system.parameters}
    lines = [f"{title} = {[v.name for v in variables]!r}" for title, variables in names.items()]
    values = {"X0": system.values("states"), "U0": system.values("inputs"), "P": system.values("parameters")}
    return lines + [f"{title} = {value!r}" for title, value in values.items()]


def write_python(system: System) -> str:
    """A Python module that needs numpy only: rates(x, u, p) and outputs(x, u, p), also over arrays (rows: variables)."""
    renamed = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "atan2": "arctan2", "abs": "abs"}
    program = program_of(system, _names, texts=_prefixed("np", renamed))
    body = [f"    {target} = {text}" for target, text in program.assignments]
    lines = [*description(system, "#"), "", "import numpy as np", "", *_tables(system), "", ""]
    for name, results, summary in (
        ("rates", program.rates, "The time derivatives of the states x under the inputs u."),
        ("outputs", program.outputs, "The outputs at the states x and inputs u."),
    ):
        lines += [f"def {name}(x, u, p=P):", f'    """{summary}"""', *body]
        lines += [f"    return np.array([{', '.join(results)}])", "", ""]
    return "\n".join(lines).rstrip("\n") + "\n"


def write_casadi(system: System) -> str:
    """A Python module that builds the casadi function ``dynamics`` (x, u, p) -> (rates, outputs) and its Jacobians."""
    program = program_of(system, _names, texts=_prefixed("casadi", {}))
    sizes = (len(system.states), len(system.inputs), len(system.parameters))
    x, u, p = (f'{letter} = casadi.SX.sym("{letter}", {size})' for letter, size in zip("xup", sizes, strict=True))
    lines = [*description(system, "#"), "", "import casadi", "", *_tables(system), "", x, u, p]
    lines += [f"{target} = {text}" for target, text in program.assignments]
    lines += [f"rates = casadi.vertcat({', '.join(program.rates)})", f"outputs = casadi.vertcat({', '.join(program.outputs)})"]
    lines.append('dynamics = casadi.Function("dynamics", [x, u, p], [rates, outputs], ["x", "u", "p"], ["rates", "outputs"])')
    jacobians = "[casadi.jacobian(rates, x), casadi.jacobian(rates, u), casadi.jacobian(outputs, x), casadi.jacobian(outputs, u)]"
    lines.append(f'linear = casadi.Function("linear", [x, u, p], {jacobians}, ["x", "u", "p"], ["A", "B", "C", "D"])')
    return "\n".join(lines) + "\n"


_LONG = 500
"""Operations beyond which formulas are written step by step: those of an arm of three joints without steps take seven megabytes."""


_STEPS = """# The formulas are long: rates and outputs are in the symbols of steps, as from sympy.cse, for
# lambdify((x, u, p), rates, cse=lambda found: (steps, found)) and the like.
steps = []


def step(name, value):
    steps.append((symbols(name, real=True), value))
    return steps[-1][0]

"""


def write_sympy(system: System, *, in_steps: bool = False) -> str:
    """A Python module with the rates and outputs as sympy matrices in the symbols x0, u0, p0, ...; numbers are exact fractions.

    Long formulas, and all of them if ``in_steps``, are written step by step, as ``sympy.cse`` gives them.
    """
    import sympy

    from hymeko_x.dynamics.numbers import symbols

    steps = program_of(system, "{}{}".format, texts=_SYMBOLIC, constant=_fraction)
    parts = (system.states, system.inputs, system.parameters)
    groups = [sympy.symbols(f"{letter}:{len(part)}", real=True) if part else () for letter, part in zip("xup", parts, strict=True)]
    used = "Abs, Matrix, S, acos, asin, atan, atan2, cos, exp, log, sign, sin, sqrt, symbols, tan, tanh"
    lines = [*description(system, "#"), "", f"from sympy import {used}  # noqa: F401", "", *_tables(system), ""]
    for letter, group in zip("xup", groups, strict=True):
        names = ", ".join(map(str, group))
        lines.append(f'{letter} = ({names},) = symbols("{letter}:{len(group)}", real=True)' if group else f"{letter} = ()")
    if in_steps or len(steps.assignments) > _LONG:
        lines += _STEPS.splitlines() + [f'{target} = step("{target}", {text})' for target, text in steps.assignments]
        lines += [f"rates = Matrix([{', '.join(steps.rates)}])", f"outputs = Matrix([{', '.join(steps.outputs)}])"]
        return "\n".join(lines) + "\n"
    for name, equations in (("rates", system.rates), ("outputs", system.measured)):
        x, u, p = groups
        texts = [sympy.sstr(sympy.sympify(value), sympy_integers=True) for value in equations(x, u, p, symbols())]
        lines.append(f"{name} = Matrix([{', '.join(texts)}])")
    return "\n".join(lines) + "\n"


_SYMBOLIC = {**_POWERS, "FABS": "Abs({0})"}
"""What sympy writes in another way than :mod:`hymeko_x.dynamics.writers.program`."""


def _fraction(number: float) -> str:
    """The fraction that a decimal stands for, as sympy reads it."""
    found = Fraction(repr(number))
    return f"S({found.numerator})" if found.denominator == 1 else f"(S({found.numerator})/{found.denominator})"


def write_c(system: System) -> str:
    """C99 by casadi's generator: dynamics(arg, res, iw, w, mem) with arg = {x, u, p} and res = {rates, outputs}."""
    import casadi

    generator = casadi.CodeGenerator("dynamics.c", {"with_header": False})
    generator.add(graph_of(system))
    arrays = "\n".join(f"/* {line} */" for line in description(system, ""))
    return f"{arrays}\n{generator.dump()}"
