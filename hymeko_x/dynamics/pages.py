"""Equations on paper: the sections of each form, and how they are printed as text, JSON, LaTeX and Markdown."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from msgspec import Struct

from hymeko_x.dynamics.assembly import reduction
from hymeko_x.dynamics.hamilton import formulas_of, loop_formulas
from hymeko_x.dynamics.linear import complex_text
from hymeko_x.dynamics.loops import STABILISATION
from hymeko_x.dynamics.lumped import Lumped
from hymeko_x.dynamics.operating import sympy_matrix
from hymeko_x.dynamics.passive import rubbing

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from hymeko_x.dynamics.forms import PortHamiltonian, SecondOrder
    from hymeko_x.dynamics.linear import Pole, StateSpace
    from hymeko_x.dynamics.multibody import Multibody
    from hymeko_x.dynamics.operating import OperatingPoint
    from hymeko_x.dynamics.system import Variable

_NAMED = 3
"""Elements that a fact names at most."""
STYLES = ("text", "json", "latex", "markdown")


class MatrixBlock(Struct, frozen=True):
    """A matrix or a scalar with its name and the names of its rows and columns."""

    name: str
    value: Any
    rows: tuple[Variable, ...] = ()
    columns: tuple[Variable, ...] = ()


class FormPage(Struct, frozen=True):
    """A form of the equations: a sentence of formula, its variables, its blocks, and facts that follow."""

    name: str
    form: str
    formula: str
    variables: Mapping[str, tuple[Variable, ...]]
    blocks: tuple[MatrixBlock, ...]
    facts: Mapping[str, Any]


def page_of(dynamics: Lumped | Multibody, form: str, *, symbolic: bool = False, at: str = "") -> FormPage:
    """The equations in one form; those of a mechanism at an operating point (``Multibody.at``), in symbols everywhere.

    Raises: Refusal (HX408) when there is no such form.
    """
    if isinstance(dynamics, Lumped):
        return _lumped_page(dynamics, form, symbolic=symbolic)
    if form == "port-hamiltonian":
        return _energy_formulas(dynamics) if symbolic else _energy_at(dynamics, at)
    if symbolic:
        return _symbolic_page(dynamics)
    point = dynamics.at(at)
    space = dynamics.state_space(at)
    made = {
        "state-space": lambda: _state_space(space, None),
        "second-order": lambda: _second_order(dynamics.second_order(at)),
        "transfer-function": lambda: _transfer(space),
    }[form]()
    formula, variables, blocks, facts = made
    place = {
        "at": _where(dynamics, point.positions),
        "held by": _holding(dynamics, point),
        "equilibrium": "yes" if point.is_equilibrium else "no",
        **_left_out(dynamics),
    }
    return FormPage(dynamics.tree.name, form, formula, variables, blocks, {**place, **_loops(dynamics, point.positions), **facts})


def _holding(dynamics: Multibody, point: OperatingPoint) -> str:
    """The inputs and the states of actuators that hold a robot."""
    system, lagging = dynamics.system, len(point.activations)
    variables = [*system.inputs, *system.states[len(system.states) - lagging :]]
    values = [*point.inputs, *point.activations]
    return _pairs({variable.name: value for variable, value in zip(variables, values, strict=True) if value})


def _left_out(dynamics: Multibody) -> Mapping[str, str]:
    """What a linear system cannot have."""
    found = list(map(str, rubbing(dynamics.tree, dynamics.cables)))
    more = [f"and {len(found) - _NAMED} others"] if len(found) > _NAMED else []
    return {"without the Coulomb friction of": ", ".join([*found[:_NAMED], *more])} if found else {}


def _loops(dynamics: Multibody, positions: Sequence[float]) -> Mapping[str, str]:
    if not dynamics.closures:
        return {}
    width, freedom = reduction(dynamics, positions).basis.shape
    words = f"{len(dynamics.closures)} closed; {freedom} of {width} degrees of freedom remain"
    return {"loops": f"{words}; in simulations and generated files stabilised (Baumgarte) at {STABILISATION:g} 1/s"}


def _where(dynamics: Multibody, positions: Sequence[float]) -> str:
    names = [variable.name for variable in dynamics.system.states]
    return _pairs({name: value for name, value in zip(names, positions, strict=False) if value != float(name.endswith(".qw"))})


_ENERGY = "x' = (J - R) dH/dx + G u, y = G' dH/dx, x = (q, p), H = p' M(q)^-1 p / 2 + V(q)"


def _energy_formulas(dynamics: Multibody) -> FormPage:
    form = dynamics.port_hamiltonian()
    m, v, j, r, g = formulas_of(form)
    blocks: tuple[MatrixBlock, ...] = (
        MatrixBlock("M", m),
        MatrixBlock("V", v),
        MatrixBlock("J", j),
        MatrixBlock("R", r),
        MatrixBlock("G", g),
    )
    if dynamics.closures:
        blocks = (*blocks, *[MatrixBlock(name, value) for name, value in zip(("phi", "B"), loop_formulas(form), strict=True)])
    names = {"states": form.states, "inputs": dynamics.system.inputs}
    return FormPage(dynamics.tree.name, "port-hamiltonian", _formula(dynamics), names, blocks, {})


def _formula(dynamics: Multibody) -> str:
    return _ENERGY.replace(" u, y", " u + B f, 0 = B' dH/dx, phi(q) = 0, y") if dynamics.closures else _ENERGY


def _energy_at(dynamics: Multibody, at: str) -> FormPage:
    """The form at rest at an operating point."""
    import numpy as np

    form, positions = dynamics.port_hamiltonian(), dynamics.at(at).positions
    x = form.state(positions, [0.0] * (len(form.states) - len(positions)))
    energy, gradient, j, r, g = (np.array(value, dtype=float) for value in form.functions(x))
    matrices = [("dH/dx", gradient), ("J", j), ("R", r), ("G", g)]
    if dynamics.closures:
        slope = dynamics.closed_at(positions)[1]
        matrices.append(("B", np.vstack([np.zeros((len(positions), len(slope))), slope.T])))
    blocks = (MatrixBlock("H", sympy_matrix(energy)[0]), *[MatrixBlock(name, sympy_matrix(matrix)) for name, matrix in matrices])
    checks = {
        "antisymmetric J": bool((j == -j.T).all()),
        "positive semidefinite R": np.linalg.eigvalsh(r).min() >= -1e-12 * np.abs(r).max(),
    }
    facts = {
        "at": _where(dynamics, positions),
        **_loops(dynamics, positions),
        **{name: "yes" if holds else "no" for name, holds in checks.items()},
    }
    names = {"states": form.states, "inputs": dynamics.system.inputs}
    return FormPage(dynamics.tree.name, "port-hamiltonian", _formula(dynamics), names, blocks, facts)


def _pairs(values: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value:.9g}" for name, value in values.items()) or "zero"


def _symbolic_page(dynamics: Multibody) -> FormPage:
    found, words = dynamics.symbolic(), "M(q) v' + h(q, v) = tau"
    blocks = [MatrixBlock("M", found.mass), MatrixBlock("h", found.bias), MatrixBlock("g", found.gravity)]
    if dynamics.motors is not None:
        words += "(q, v, a, u)" if any(v.name.endswith(".activation") for v in dynamics.system.states) else "(q, v, u)"
        blocks.append(MatrixBlock("tau", found.driven))
    if any(found.passive):
        words += " + d(q, v)"
        blocks.append(MatrixBlock("d", found.passive))
    if dynamics.closures:
        words += " + J(q)' f, phi(q) = 0, J = dphi/dq"
        blocks += [MatrixBlock(name, value) for name, value in zip(("phi", "J"), dynamics.symbolic_loops(), strict=True)]
    names = {"states": dynamics.system.states, "inputs": dynamics.system.inputs}
    return FormPage(dynamics.tree.name, "second-order", f"{words}, h(q, 0) = g(q)", names, tuple(blocks), {})


def _lumped_page(dynamics: Lumped, form: str, *, symbolic: bool) -> FormPage:
    make: Mapping[str, Callable[[], tuple[str, Mapping[str, tuple[Variable, ...]], tuple[MatrixBlock, ...], Mapping[str, Any]]]] = {
        "state-space": lambda: _state_space(dynamics.state_space(symbolic=symbolic), dynamics.state_space() if symbolic else None),
        "second-order": lambda: _second_order(dynamics.second_order(symbolic=symbolic)),
        "port-hamiltonian": lambda: _port_hamiltonian(dynamics.port_hamiltonian(symbolic=symbolic)),
        "transfer-function": lambda: _transfer(dynamics.state_space(symbolic=symbolic)),
    }
    formula, variables, blocks, facts = make[form]()
    linear = {} if dynamics.is_linear else {"linearised at": "the initial state"}
    used = {"parameters": dynamics.system.parameters}
    return FormPage(dynamics.network.name, form, formula, {**variables, **used}, blocks, {**linear, **facts})


def _state_space(space: StateSpace, exact: StateSpace | None) -> Any:
    blocks = [
        MatrixBlock("A", space.A, space.states, space.states),
        MatrixBlock("B", space.B, space.states, space.inputs),
        MatrixBlock("C", space.C, space.outputs, space.states),
        MatrixBlock("D", space.D, space.outputs, space.inputs),
    ]
    if any(space.offset):
        blocks.append(MatrixBlock("offset", space.offset, space.states))
    numbers = exact or space
    n = len(space.states)
    facts = {
        "poles": numbers.poles,
        "controllable": f"{numbers.controllable} of {n}",
        "observable": f"{numbers.observable} of {n}",
    }
    names = {"states": space.states, "inputs": space.inputs, "outputs": space.outputs}
    formula = "x' = A x + B u" + (" + offset" if any(space.offset) else "") + ", y = C x + D u"
    return formula, names, tuple(blocks), facts


def _second_order(form: SecondOrder) -> Any:
    blocks = [
        MatrixBlock("M", form.M, form.coordinates, form.coordinates),
        MatrixBlock("C", form.C, form.coordinates, form.coordinates),
        MatrixBlock("K", form.K, form.coordinates, form.coordinates),
        MatrixBlock("F", form.F, form.coordinates, form.inputs),
    ]
    if any(form.offset):
        blocks.append(MatrixBlock("offset", form.offset, form.coordinates))
    formula = "M q'' + C q' + K q = F u" + (" + offset" if any(form.offset) else "")
    return formula, {"coordinates": form.coordinates, "inputs": form.inputs}, tuple(blocks), {}


def _port_hamiltonian(form: PortHamiltonian) -> Any:
    blocks = [
        MatrixBlock("H", form.energy),
        MatrixBlock("dH/dx", form.gradient, form.states),
        MatrixBlock("J", form.J, form.states, form.states),
    ]
    blocks += [MatrixBlock("R", form.R, form.states, form.states), MatrixBlock("G", form.G, form.states, form.inputs)]
    passed = any(form.P) or any(form.S)
    if passed:
        blocks += [MatrixBlock("P", form.P, form.states, form.inputs), MatrixBlock("S", form.S, form.outputs, form.inputs)]
    formula = "x' = (J - R) dH/dx + (G - P) u, y = (G + P)' dH/dx + S u" if passed else "x' = (J - R) dH/dx + G u, y = G' dH/dx"
    return formula, {"states": form.states, "inputs": form.inputs, "outputs": form.outputs}, tuple(blocks), {}


def _transfer(space: StateSpace) -> Any:
    functions = space.transfer()
    blocks = [
        MatrixBlock(f"{output.name} / {source.name}", functions[row][column])
        for row, output in enumerate(space.outputs)
        for column, source in enumerate(space.free_inputs)
    ]
    return "y(s) = G(s) u(s)", {"inputs": tuple(space.free_inputs), "outputs": space.outputs}, tuple(blocks), {}


# ---- printing ------------------------------------------------------------------------------------------------------------


def printed(page: FormPage, style: str) -> str:
    """The page in one style, ending with a line break."""
    return {"text": _text, "json": _json, "latex": _latex, "markdown": _markdown}[style](page)


def _text(page: FormPage) -> str:
    lines = [f"{page.name}: {page.formula}"]
    for title, variables in page.variables.items():
        lines += ["", title]
        valued = title == "parameters"
        width = max((len(variable.name) for variable in variables), default=0)
        lines += [f"  {v.name:<{width}}  " + (f"{v.value:.10g} {v.unit}".rstrip() if valued else v.unit) for v in variables] or ["  none"]
    for block in page.blocks:
        lines += ["", *_block_lines(block)]
    for name, value in page.facts.items():
        lines += ["", *(_pole_lines(value) if name == "poles" else [f"{name}: {value}"])]
    return "\n".join(lines) + "\n"


def _block_lines(block: MatrixBlock) -> list[str]:
    if not _is_matrix(block.value):
        return [f"{block.name} = {_entry(block.value)}"]
    if not block.value.cols or not block.value.rows:
        return [f"{block.name} = []"]
    rows = [[_entry(entry) for entry in block.value.row(i)] for i in range(block.value.rows)]
    widths = [max(len(row[j]) for row in rows) for j in range(block.value.cols)]
    lines = ["[" + "  ".join(f"{entry:>{width}}" for entry, width in zip(row, widths, strict=True)) + "]" for row in rows]
    indent = " " * (len(block.name) + 3)
    return [f"{block.name} = {lines[0]}", *[indent + line for line in lines[1:]]]


def _entry(value: Any) -> str:
    """A formula or a fraction as it is, a float with nine digits."""
    return f"{0.0 if abs(value) < 1e-13 else float(value):.9g}" if getattr(value, "is_Float", False) else str(value)


def _pole_lines(poles: Sequence[Pole]) -> list[str]:
    lines = ["poles (1/s)             natural frequency (rad/s)  damping ratio"]
    return lines + [f"  {complex_text(pole.value):<21} {pole.frequency:<27.6g}{pole.damping:.6g}" for pole in poles]


def _is_matrix(value: Any) -> bool:
    return hasattr(value, "rows")


def _json(page: FormPage) -> str:
    def entry(value: Any) -> Any:
        return float(value) if getattr(value, "is_number", False) else str(value)

    def block(value: Any) -> Any:
        return [[entry(cell) for cell in value.row(i)] for i in range(value.rows)] if _is_matrix(value) else entry(value)

    def fact(name: str, value: Any) -> Any:
        if name != "poles":
            return value
        keys = ("real", "imaginary", "frequency", "damping")
        return [dict(zip(keys, (p.value.real, p.value.imag, p.frequency, p.damping), strict=True)) for p in value]

    found = {
        "name": page.name,
        "form": page.form,
        "formula": page.formula,
        **{
            title: [
                {"name": v.name, "unit": v.unit, "element": v.element, **({"value": v.value} if title in ("parameters", "inputs") else {})}
                for v in variables
            ]
            for title, variables in page.variables.items()
        },
        "matrices": {item.name: block(item.value) for item in page.blocks},
        **{name: fact(name, value) for name, value in page.facts.items()},
    }
    return json.dumps(found, indent=2, ensure_ascii=False) + "\n"


def _latex(page: FormPage) -> str:
    lines = [f"% {page.name}: {page.formula}"]
    for title, variables in page.variables.items():
        if title != "parameters":
            lines.append(rf"% {title}: " + ", ".join(f"{v.name} in {v.unit}" for v in variables))
            lines.append(rf"\[ {_letter(title)} = \begin{{pmatrix}} " + r" \\ ".join(v.symbol for v in variables) + r" \end{pmatrix} \]")
    lines += [rf"\[ {_tex_name(block.name)} = {_tex(block.value, page)} \]" for block in page.blocks]
    return "\n".join(lines) + "\n"


def _letter(title: str) -> str:
    return {"states": "x", "inputs": "u", "outputs": "y", "coordinates": "q"}.get(title, title)


def _tex_name(name: str) -> str:
    if name == "dH/dx":
        return r"\frac{\partial H}{\partial x}"
    return rf"\mathrm{{{name}}}".replace("_", r"\_") if len(name) > 1 else name


def _tex(value: Any, page: FormPage) -> str:
    import sympy

    names = {sympy.Symbol(v.name): v.symbol for group in page.variables.values() for v in group}
    free = value.free_symbols if hasattr(value, "free_symbols") else set()
    shown = {symbol: names[sympy.Symbol(symbol.name)] for symbol in free if sympy.Symbol(symbol.name) in names}
    text: str = sympy.latex(value, symbol_names=shown, mat_delim="(", mat_str="matrix")
    return text


def _markdown(page: FormPage) -> str:
    lines = [f"# {page.name}", "", f"`{page.formula}`"]
    for title, variables in page.variables.items():
        valued = title == "parameters"
        lines += ["", f"| {title} | unit |{' value |' if valued else ''}", f"|---|---|{'---|' if valued else ''}"]
        lines += [f"| `{v.name}` | {v.unit} |{f' {v.value:.10g} |' if valued else ''}" for v in variables]
    for block in page.blocks:
        lines += ["", f"$${_tex_name(block.name)} = {_tex(block.value, page)}$$"]
    for name, value in page.facts.items():
        if name == "poles":
            lines += ["", "| pole (1/s) | natural frequency (rad/s) | damping ratio |", "|---|---|---|"]
            lines += [f"| {complex_text(p.value)} | {p.frequency:.6g} | {p.damping:.6g} |" for p in value]
        else:
            lines += ["", f"{name}: {value}"]
    return "\n".join(lines) + "\n"
