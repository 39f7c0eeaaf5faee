"""Octave and MATLAB: a script with the matrices and a response, and a script that builds the Simulink model block by block."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hymeko_x.dynamics.writers.program import description
from hymeko_x.ir.digits import number_text

if TYPE_CHECKING:
    from hymeko_x.dynamics.linear import StateSpace
    from hymeko_x.dynamics.system import System


def matrix_text(matrix: Any) -> str:
    """A matrix as MATLAB writes it."""
    rows, columns = matrix.shape
    if not rows or not columns:
        return f"zeros({rows}, {columns})"
    return "[" + "; ".join(" ".join(number_text(float(value)) for value in row) for row in matrix) + "]"


def _matrices(space: StateSpace) -> list[str]:
    lines = [f"{name} = {matrix_text(matrix)};" for name, matrix in zip("ABCD", space.floats, strict=True)]
    if any(space.offset):
        rest = "; ".join(number_text(float(value)) for value in space.offset)
        lines.insert(0, f"% The point is no equilibrium; what x' has besides A x + B u is left out: [{rest}]")
    return lines


def write_octave(system: System, space: StateSpace) -> str:
    """A script for Octave (package control) and MATLAB (Control System Toolbox): A, B, C, D, the system, and its step response."""
    names = [f"{name} = {{{', '.join(repr(v.name) for v in part)}}};" for name, part in _groups(space)]
    lines = [*description(system, "%"), "if exist('OCTAVE_VERSION', 'builtin'), pkg load control; end", *_matrices(space), *names]
    if not space.inputs:
        lines.append("B = zeros(size(A, 1), 1); D = zeros(size(C, 1), 1); % there is no input, and ss wants one")
    if not space.outputs:
        lines.append("C = eye(size(A)); D = zeros(size(A, 1), size(B, 2)); % there is no output, and ss wants one: all states")
    lines += [
        "model = ss(A, B, C, D);",
        "t = (0:1000)' / 500;",
        "u = zeros(numel(t), size(B, 2));",
        "if size(B, 2) > 0, u(:, 1) = 1; end",
        "[y, t, x] = lsim(model, u, t);",
        "poles = eig(A);",
    ]
    return "\n".join(lines) + "\n"


def _groups(space: StateSpace) -> list[tuple[str, Any]]:
    return [("states", space.states), ("inputs", space.inputs), ("outputs", space.outputs)]


def write_simulink(system: System, space: StateSpace) -> str:
    """A script that builds the Simulink model of x' = A x + B u, y = C x + D u: inputs, gains, sums, an integrator, outputs."""
    name = "".join(letter if letter.isascii() and letter.isalnum() else "_" for letter in system.name) or "model"
    name = name if name[0].isalpha() else f"m_{name}"
    many_in, many_out = len(space.inputs), len(space.outputs)
    lines = [*description(system, "%"), *_matrices(space), f"model = '{name}';", "new_system(model); open_system(model);"]
    blocks = [
        ("simulink/Signal Routing/Mux", "u", f"'Inputs', '{max(many_in, 1)}'"),
        ("simulink/Math Operations/Gain", "B", "'Gain', 'B', 'Multiplication', 'Matrix(K*u)'"),
        ("simulink/Math Operations/Sum", "rates", "'Inputs', '++'"),
        ("simulink/Continuous/Integrator", "x", f"'InitialCondition', 'zeros({len(space.states)}, 1)'"),
        ("simulink/Math Operations/Gain", "A", "'Gain', 'A', 'Multiplication', 'Matrix(K*u)'"),
        ("simulink/Math Operations/Gain", "C", "'Gain', 'C', 'Multiplication', 'Matrix(K*u)'"),
        ("simulink/Math Operations/Gain", "D", "'Gain', 'D', 'Multiplication', 'Matrix(K*u)'"),
        ("simulink/Math Operations/Sum", "y", "'Inputs', '++'"),
        ("simulink/Signal Routing/Demux", "outputs", f"'Outputs', '{max(many_out, 1)}'"),
        ("simulink/Sinks/Scope", "scope", ""),
    ]
    blocks += [("simulink/Sources/In1", _block(v.name), "") for v in space.inputs]
    blocks += [("simulink/Sinks/Out1", f"y {_block(v.name)}", "") for v in space.outputs]
    lines += [f"add_block('{kind}', [model '/{block}']{f', {options}' if options else ''});" for kind, block, options in blocks]
    wires = [(f"{_block(v.name)}/1", f"u/{k}") for k, v in enumerate(space.inputs, 1)]
    wires += [("u/1", "B/1"), ("B/1", "rates/1"), ("A/1", "rates/2"), ("rates/1", "x/1"), ("x/1", "A/1"), ("x/1", "C/1"), ("u/1", "D/1")]
    wires += [("C/1", "y/1"), ("D/1", "y/2"), ("y/1", "outputs/1"), ("y/1", "scope/1")]
    wires += [(f"outputs/{k}", f"y {_block(v.name)}/1") for k, v in enumerate(space.outputs, 1)]
    lines += [f"add_line(model, '{begin}', '{end}', 'autorouting', 'on');" for begin, end in wires]
    return "\n".join([*lines, "save_system(model);"]) + "\n"


def _block(name: str) -> str:
    """A name that a Simulink block may have: no slashes and no quotes."""
    return name.replace("/", "//").replace("'", "''")
