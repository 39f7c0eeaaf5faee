"""`hymeko-x dynamics` and `simulate`: the equations of a file, and its response over time."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.cli import exits
from hymeko_x.cli.exits import UsageError
from hymeko_x.cli.inputs import input_arguments, lenient_argument, read_input
from hymeko_x.cli.report import show_diagnostics
from hymeko_x.diagnostics import Report, refuse
from hymeko_x.disk import check_outputs, write_files

if TYPE_CHECKING:
    import argparse

    from hymeko_x.dynamics.lumped import Lumped
    from hymeko_x.dynamics.multibody import Multibody
    from hymeko_x.dynamics.signals import Signal

_FORMS = ("state-space", "second-order", "port-hamiltonian", "transfer-function")
_LANGUAGES = ("python", "sympy", "casadi", "c", "octave", "simulink", "modelica", "fmu")
_STYLES = ("text", "json", "latex", "markdown")


def dynamics_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `dynamics`."""
    parser.add_argument("input", metavar="FILE", help="a robot or a lumped network in any format; - is standard input")
    parser.add_argument("--form", choices=_FORMS, default=_FORMS[0], help="the form of the equations (default state-space)")
    where = "operating point of a mechanism: a named configuration, joint=value,..., or found (default: every joint at its reference)"
    parser.add_argument("--at", default="", metavar="WHERE", help=where)
    _mechanism_arguments(parser)
    parser.add_argument("--to", choices=_LANGUAGES, help="write the equations as a file of this kind (octave and simulink: linearised)")
    parser.add_argument("-o", "--output", type=Path, metavar="OUT", help="where to write (default: standard output)")
    parser.add_argument("--bode", type=Path, metavar="OUT", help="draw the linear system's frequency responses into OUT.png, .svg or .pdf")
    parser.add_argument("--symbolic", action="store_true", help="formulas in the parameters instead of numbers")
    parser.add_argument("--style", choices=_STYLES, default="text", help="how to print them (default text)")
    parser.add_argument("--json", action="store_const", dest="style", const="json", help="the same as --style json")
    input_arguments(parser)
    lenient_argument(parser)


def run_dynamics(chosen: argparse.Namespace) -> int:
    """Print the equations of motion."""
    from hymeko_x.dynamics.bode import draw_bode
    from hymeko_x.dynamics.linear import report_unstable
    from hymeko_x.dynamics.lumped import Lumped
    from hymeko_x.dynamics.pages import page_of, printed

    check_outputs(chosen.output, makes_folders=True)
    check_outputs(chosen.bode)
    report = Report()
    found = _dynamics(chosen, report)
    if chosen.to is not None:
        show_diagnostics(report, chosen)
        return _write(found, chosen)
    text = printed(page_of(found, chosen.form, symbolic=chosen.symbolic, at=chosen.at), chosen.style)
    if not chosen.symbolic or chosen.bode:
        space = found.state_space() if isinstance(found, Lumped) else found.state_space(chosen.at)
        report_unstable(space, report)
        if chosen.bode:
            draw_bode(space, found.system.name, chosen.bode)
    show_diagnostics(report, chosen)
    if chosen.output is None:
        print(text, end="")
    else:
        write_files({str(chosen.output): text.encode()})
    return exits.DONE


def _write(found: Lumped | Multibody, chosen: argparse.Namespace) -> int:
    """Write the generated file, whole or not at all."""
    from hymeko_x.dynamics.writers import written

    content = written(found, chosen.to, at=chosen.at)
    if chosen.output is None:
        sys.stdout.buffer.write(content)
    else:
        write_files({str(chosen.output): content})
    return exits.DONE


def _mechanism_arguments(parser: argparse.ArgumentParser) -> None:
    what = "inputs of a mechanism: forces of its joints, or controls of its actuators, which act by their laws (default joints)"
    parser.add_argument("--inputs", choices=("joints", "actuators"), default="joints", help=what)
    parser.add_argument("--base", choices=("fixed", "free"), help="what becomes of a base that the file leaves open (default fixed)")


def _dynamics(chosen: argparse.Namespace, report: Report) -> Lumped | Multibody:
    import hymeko_x as hx
    from hymeko_x.dynamics.lumped import Lumped

    given = read_input(chosen.input, chosen, report)
    found = hx.dynamics(given.mechanism, base=chosen.base, inputs=chosen.inputs, files=given.source.files, report=report)
    if chosen.at and isinstance(found, Lumped):
        name = given.mechanism.name
        raise refuse(codes.BAD_SIGNAL, f"{name} is a network, whose equations count from rest; --at is for mechanisms with joints")
    return found


# ---- simulate ------------------------------------------------------------------------------------------------------------


def simulate_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of `simulate`."""
    parser.add_argument("input", metavar="FILE", help="a robot or a lumped network in any format; - is standard input")
    _mechanism_arguments(parser)
    where = "where a mechanism starts: a named configuration or joint=value,... (default: every joint at its reference)"
    parser.add_argument("--at", default="", metavar="WHERE", help=where)
    parser.add_argument("--time", type=float, default=2.0, metavar="S", help="how long, in s (default 2)")
    parser.add_argument("--step", type=float, metavar="S", help="time between rows in s (default a thousandth of --time)")
    which = "scipy's solver, or rules of the port-Hamiltonian form that keep the power balance in every step (default scipy)"
    parser.add_argument("--integrator", choices=("scipy", "energy"), default="scipy", help=which)
    what = "a signal for an input, instead of the file's: pulse,period=2,duty=0.05 or table.csv:COLUMN (repeatable)"
    parser.add_argument("--input", dest="signals", action="append", default=[], metavar="NAME=SIGNAL", help=what)
    parser.add_argument(
        "-o", "--output", type=Path, metavar="OUT", help="write the table to OUT.csv or OUT.parquet (else CSV to standard output)"
    )
    parser.add_argument("--figure", type=Path, metavar="OUT", help="draw inputs and outputs into OUT.png, .svg or .pdf")
    input_arguments(parser)
    lenient_argument(parser)


def run_simulate(chosen: argparse.Namespace) -> int:
    """Write the response over time."""
    from hymeko_x.dynamics.balance import balanced_response
    from hymeko_x.dynamics.tables import csv_text, draw, write_table

    check_outputs(chosen.output, chosen.figure)
    report = Report()
    found = _dynamics(chosen, report)
    step = chosen.time / 1000 if chosen.step is None else chosen.step
    signals = dict(_signal(text, chosen.time) for text in chosen.signals)
    if chosen.integrator == "energy":
        response = balanced_response(found, chosen.time, step, signals, chosen.at)
    else:
        response = found.simulate(chosen.time, step, signals, at=chosen.at)
    show_diagnostics(report, chosen)
    if chosen.output is None:
        print(csv_text(response), end="")
    else:
        write_table(response, chosen.output)
    if chosen.figure is not None:
        draw(response, found.system.name, chosen.figure)
    return exits.DONE


def _signal(text: str, until: float) -> tuple[str, Signal]:
    """``NAME=KIND,key=value,...`` or ``NAME=FILE.csv:COLUMN``."""
    from hymeko_x.dynamics.signals import constant, signal_of
    from hymeko_x.dynamics.tables import read_signal

    name, equals, words = text.partition("=")
    if not (name and equals and words):
        raise UsageError(f"expected --input NAME=SIGNAL, found '{text}'")
    file, colon, column = words.rpartition(":")
    if colon and "," not in file:
        return name, read_signal(Path(file), column)
    kind, *pairs = words.split(",")
    try:
        if not pairs and _is_number(kind):
            return name, constant(float(kind))
        values = [(key, float(value)) for key, _, value in (pair.partition("=") for pair in pairs)]
    except ValueError as error:
        raise UsageError(f"'{words}' is no signal; pulse,period=2,duty=0.05 is one") from error
    return name, signal_of((("signal", kind), *values), until, name)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
