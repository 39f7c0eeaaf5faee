"""Every generated file is run: by Python, gcc, Octave where it is installed, pymoca, fmpy; Simulink's script is parsed back."""

from __future__ import annotations

import ctypes
import io
import re
import shutil
import subprocess
import time
import zipfile
from pathlib import Path
from types import ModuleType

import fmpy
import fmpy.validation
import numpy as np
import pinocchio as pin
import pymoca.parser
import pytest
import sympy

import hymeko_x as hx
from hymeko_x.dynamics import writers
from hymeko_x.dynamics.numbers import floats
from hymeko_x.dynamics.signals import constant
from hymeko_x.dynamics.simulation import simulate
from hymeko_x.dynamics.writers import LANGUAGES
from tests.dynamics.networks import load
from tests.dynamics.test_lumped import CONTROLLED, LISTING, RACK
from tests.dynamics.test_mechanisms import CART_POLE, SPINNING

SYSTEMS = {
    "quarter_vehicle": LISTING.read_text(),
    "rack": RACK,
    "controlled": CONTROLLED,
    "duffing": 'd : robot { m : mass { mass 1 } w : ground {} k : spring { stiffness 2 law "k*x + 5*x**3" } f : force {}'
    ' c : damper { c 0.4 law "c*v*abs(v)" } @e : constitutive { + w - m ~ k ~ c ~ f } }',
    "cart_pole": CART_POLE,
    "top": SPINNING,
    "rubbed": "r : robot { world {} a { mass 1 com [0.1 0 0.2] inertia [0.1 0.2 0.3] } b { mass 1 com [0 0 0.2] inertia [0.1 0.1 0.1] }"
    " @hip : ball { + world - a stiffness 4 damping 0.1 } @knee : revolute { [0 0 0.4] + a - b axis=Y friction 0.3 stiffness 2 } }",
    "four_bar": (LISTING.parents[2] / "examples" / "four_bar.hymeko").read_text(),
}


def written(found: hx.dynamics.Lumped | hx.dynamics.Multibody, language: str) -> str:
    return writers.written(found, language).decode()


@pytest.fixture(params=SYSTEMS)
def found(request: pytest.FixtureRequest) -> hx.dynamics.Lumped | hx.dynamics.Multibody:
    return hx.dynamics(load(SYSTEMS[request.param]))


def samples(found: hx.dynamics.Lumped | hx.dynamics.Multibody) -> list[tuple[list[float], list[float], np.ndarray, np.ndarray]]:
    """States, inputs, and what the equations give there."""
    system = found.system
    rng = np.random.default_rng(1)
    p = system.values("parameters")
    drawn = [(rng.normal(size=len(system.states)).tolist(), rng.normal(size=len(system.inputs)).tolist()) for _ in range(3)]
    return [
        (x, u, *(np.array(equations(x, u, p, floats()), dtype=float).reshape(-1) for equations in (system.rates, system.measured)))
        for x, u in drawn
    ]


def run(text: str) -> ModuleType:
    module = ModuleType("generated")
    exec(compile(text, "generated.py", "exec"), module.__dict__)
    return module


def test_python_needs_numpy_only_and_computes_the_same(found: hx.dynamics.Lumped) -> None:
    text = written(found, "python")
    assert set(re.findall(r"^import (\w+)", text, re.MULTILINE)) == {"numpy"}
    module = run(text)
    for x, u, rates, outputs in samples(found):
        np.testing.assert_allclose(module.rates(x, u), rates, rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(module.outputs(x, u), outputs, rtol=1e-12, atol=1e-12)
    assert [variable.name for variable in found.system.states] == module.STATES


def test_casadi_computes_the_same_with_derivatives(found: hx.dynamics.Lumped) -> None:
    module = run(written(found, "casadi"))
    for x, u, rates, _ in samples(found):
        np.testing.assert_allclose(np.array(module.dynamics(x, u, module.P)[0])[:, 0], rates, rtol=1e-12, atol=1e-12)
        a = np.array(module.linear(x, u, module.P)[0])
        step = 1e-6 * np.eye(len(x))
        column = (np.array(module.dynamics(x + step[0], u, module.P)[0]) - np.array(module.dynamics(x - step[0], u, module.P)[0])) / 2e-6
        np.testing.assert_allclose(a[:, 0], column[:, 0], rtol=1e-6, atol=1e-6 * np.abs(a).max())


def test_sympy_has_the_same_formulas(found: hx.dynamics.Lumped) -> None:
    module = run(written(found, "sympy"))
    assert not getattr(found, "closures", ()) or module.steps
    steps = getattr(module, "steps", [])
    both = sympy.lambdify((module.x, module.u, module.p), (module.rates, module.outputs), cse=lambda formulas: (steps, formulas))
    for x, u, rates, outputs in samples(found):
        ours = [np.array(values, dtype=float).reshape(-1) for values in both(x, u, module.P)]
        np.testing.assert_allclose(ours[0], rates, rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(ours[1], outputs, rtol=1e-12, atol=1e-12)


def test_long_formulas_are_written_in_steps_that_sympy_takes() -> None:
    links = "".join(f"l{k} {{ mass 1.{k} com [0.1 0.02 0.3] inertia [0.13 0.07 0.11] }}\n" for k in range(4))
    joints = "".join(
        f"@j{k} : revolute {{ [0.1 0 0.3{k}] + {f'l{k - 1}' if k else 'world'} - l{k} axis={'XYZY'[k]} damping 0.{k + 1} }}\n"
        for k in range(4)
    )
    arm = hx.dynamics(load(f"arm : robot {{ world {{}}\n{links}{joints} }}"))
    text = written(arm, "sympy")
    assert len(text) < 100_000
    module = run(text)
    assert all(not value.has(sympy.Float) for _, value in module.steps)
    compute = sympy.lambdify((module.x, module.u), module.rates, cse=lambda found: (module.steps, found))
    for x, u, rates, _ in samples(arm):
        np.testing.assert_allclose(np.array(compute(x, u))[:, 0], rates, rtol=1e-9)


@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")
def test_c_compiles_and_computes_the_same(found: hx.dynamics.Lumped, tmp_path: Path) -> None:
    (tmp_path / "dynamics.c").write_text(written(found, "c"))
    subprocess.run(["gcc", "-std=c99", "-O2", "-shared", "-fPIC", "dynamics.c", "-o", "dynamics.so", "-lm"], cwd=tmp_path, check=True)
    library = ctypes.CDLL(str(tmp_path / "dynamics.so"))
    p = found.system.values("parameters")
    for x, u, rates, outputs in samples(found):
        arrays = [(ctypes.c_double * max(1, len(values)))(*values) for values in (x, u, p)]
        results = [(ctypes.c_double * max(1, len(values)))() for values in (rates, outputs)]
        pointer = ctypes.POINTER(ctypes.c_double)
        arguments = (pointer * 3)(*[ctypes.cast(array, pointer) for array in arrays])
        answers = (pointer * 2)(*[ctypes.cast(array, pointer) for array in results])
        work = (ctypes.c_double * 10_000)()
        assert library.dynamics(arguments, answers, None, work, 0) == 0
        np.testing.assert_allclose(list(results[0]), rates, rtol=1e-12, atol=1e-12)
        if len(outputs):
            np.testing.assert_allclose(list(results[1]), outputs, rtol=1e-12, atol=1e-12)


TIMED = """
#include <stdio.h>
#include <time.h>
int main(void) {
  double x[14], u[7], rates[14], y[7], work[10000], best = 1e9;
  const double *arg[3] = {x, u, 0};
  double *res[2] = {rates, y};
  for (int i = 0; i < 14; i++) x[i] = 0.1 * i;
  for (int i = 0; i < 7; i++) u[i] = 0.2 * i;
  for (int round = 0; round < 10; round++) {
    clock_t begin = clock();
    for (int i = 0; i < 20000; i++) { x[0] += 1e-9; dynamics(arg, res, 0, work, 0); }
    double each = (double)(clock() - begin) / CLOCKS_PER_SEC / 20000;
    if (each < best) best = each;
  }
  printf("%g %g", best, rates[7]);
  return 0;
}
"""


@pytest.mark.full
@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")
def test_the_c_code_of_a_seven_dof_arm_is_within_three_times_of_pinocchio(tmp_path: Path) -> None:
    """Forward dynamics per call, of processor time; the best of ten runs. Pinocchio is called from Python, which costs it some."""
    axes = ("Z", "Y", "Z", "-Y", "Z", "Y", "Z")
    lines = [f"l{k} {{ mass {4 - 0.5 * k} com [0.02 0.01 0.1] inertia [0.03 0.02 0.01] }}" for k in range(7)]
    lines += [
        f"@j{k} : revolute {{ [0.03 0 0.3] + {f'l{k - 1}' if k else 'base'} - l{k} axis={axis} limit [-170 170] }}"
        for k, axis in enumerate(axes)
    ]
    arm = load("arm : robot { base {} " + " ".join(lines) + " }")
    (tmp_path / "arm.c").write_text(written(hx.dynamics(arm), "c") + TIMED)
    subprocess.run(["gcc", "-std=c99", "-O2", "arm.c", "-o", "arm", "-lm"], cwd=tmp_path, check=True)
    ours, acceleration = map(float, subprocess.run([tmp_path / "arm"], capture_output=True, text=True, check=True).stdout.split())
    model = pin.buildModelFromXML(hx.dumps(arm, "urdf"))
    data, q, v, tau = model.createData(), 0.1 * np.arange(7), 0.1 * np.arange(7, 14), 0.2 * np.arange(7)
    theirs = []
    for _ in range(10):
        begin = time.process_time()
        for _ in range(2000):
            pin.aba(model, data, q, v, tau)
        theirs.append((time.process_time() - begin) / 2000)
    assert acceleration == pytest.approx(data.ddq[0], rel=1e-3)
    assert ours < 3 * min(theirs)


@pytest.mark.skipif(shutil.which("octave") is None, reason="Octave is not installed (Debian: apt install octave octave-control)")
def test_octave_computes_the_step_response(tmp_path: Path) -> None:
    if subprocess.run(["octave", "-q", "--eval", "pkg load control"], capture_output=True, check=False).returncode:
        pytest.skip("Octave has no control package (Debian: apt install octave-control)")
    car = hx.dynamics(hx.load(LISTING).mechanism)
    (tmp_path / "car.m").write_text(written(car, "octave") + "disp(y(end)); disp(poles');\n")
    out = subprocess.run(["octave", "-q", "car.m"], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert float(out.split()[0]) == pytest.approx(1.0, abs=1e-3)
    (tmp_path / "top.m").write_text(written(hx.dynamics(load(SPINNING)), "octave") + "disp(size(y));\n")
    out = subprocess.run(["octave", "-q", "top.m"], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    assert out.split()[-2:] == ["1001", "12"]  # neither inputs nor outputs


def matrix(text: str, name: str) -> np.ndarray:
    found = re.search(rf"^{name} = (.*);$", text, re.MULTILINE)
    assert found is not None
    if zeros := re.fullmatch(r"zeros\((\d+), (\d+)\)", found[1]):
        return np.zeros((int(zeros[1]), int(zeros[2])))
    return np.array([[float(x) for x in row.split()] for row in found[1].strip("[]").split(";")])


@pytest.mark.parametrize("language", ["octave", "simulink"])
def test_the_matrices_of_the_scripts_are_those_of_the_system(found: hx.dynamics.Lumped, language: str) -> None:
    text = written(found, language)
    for name, ours in zip("ABCD", found.state_space().floats, strict=True):
        np.testing.assert_array_equal(matrix(text, name), ours)


def test_the_wires_of_the_simulink_model_are_the_equations(found: hx.dynamics.Lumped) -> None:
    """Follow the wires back: the integrator gets A x + B u, the outputs C x + D u; every line joins blocks that exist."""
    text = written(found, "simulink")
    blocks = {block.replace("''", "'"): kind for kind, block in re.findall(r"add_block\('([^']*)', \[model '/((?:[^']|'')*)'\]", text)}
    lines = [
        (a.replace("''", "'"), b.replace("''", "'")) for a, b in re.findall(r"add_line\(model, '((?:[^']|'')*)', '((?:[^']|'')*)'", text)
    ]
    sources = {end: begin for begin, end in lines}
    assert len(sources) == len(lines)
    assert all(port.rpartition("/")[0] in blocks for line in lines for port in line)

    def formula(block: str) -> str:
        kind = blocks[block].rpartition("/")[2]
        if kind in ("Integrator", "Mux"):
            return block
        if kind == "Gain":
            return f"{block} {formula(sources[f'{block}/1'].rpartition('/')[0])}"
        assert kind == "Sum"
        return " + ".join(sorted(formula(sources[f"{block}/{k}"].rpartition("/")[0]) for k in (1, 2)))

    assert formula(sources["x/1"].rpartition("/")[0]) == "A x + B u"
    assert formula(sources["outputs/1"].rpartition("/")[0]) == "C x + D u"
    assert [sources[f"u/{k}"] for k, _ in enumerate(found.state_space().inputs, 1)] == [f"{v.name}/1" for v in found.state_space().inputs]


def test_modelica_is_parsed_and_has_the_variables(found: hx.dynamics.Lumped) -> None:
    tree = pymoca.parser.parse(written(found, "modelica"))
    (model,) = [found for found in tree.classes.values() if found.type == "model"]
    kinds = [{*symbol.prefixes} for symbol in model.symbols.values()]
    system = found.system
    assert sum("input" in kind for kind in kinds) == len(system.inputs)
    assert sum("output" in kind for kind in kinds) == len(system.outputs)
    assert sum("parameter" in kind for kind in kinds) == len(system.parameters)
    heads = [str(getattr(equation.left, "operator", "")) for equation in model.equations]
    assert heads.count("der") == len(system.states)


@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")
def test_an_fmu_is_valid_and_simulates_as_we_do(tmp_path: Path) -> None:
    found = hx.dynamics(load(SYSTEMS["duffing"]))
    (tmp_path / "source.fmu").write_bytes(writers.written(found, "fmu"))
    folder = Path(fmpy.extract(str(tmp_path / "source.fmu"), str(tmp_path / "unzipped")))
    assert fmpy.validation.validate_fmu(str(tmp_path / "source.fmu")) == []
    (model,) = [configuration.modelIdentifier for configuration in fmpy.read_model_description(str(folder)).buildConfigurations]
    binaries = folder / "binaries" / fmpy.platform_tuple
    binaries.mkdir(parents=True)
    warnings = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-O2", "-shared", "-fPIC"]
    subprocess.run(["gcc", *warnings, "sources/model.c", "-o", str(binaries / f"{model}.so"), "-lm"], cwd=folder, check=True)
    start, names = {"m.position": 0.3, "f.effort": 1.5}, ["m.position", "y.m.position"]
    result = fmpy.simulate_fmu(str(folder), start_values=start, stop_time=2.0, output_interval=0.5, relative_tolerance=1e-8, output=names)
    ours = simulate(found.system, {"f.effort": constant(1.5)}, 2.0, 0.5, [0.3, 0.0])
    np.testing.assert_allclose(result["m.position"], ours.states[:, 0], atol=1e-5)
    np.testing.assert_array_equal(result["m.position"], result["y.m.position"])


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_generated_file_says_where_it_comes_from_and_is_the_same_again(language: str) -> None:
    car = hx.dynamics(hx.load(LISTING).mechanism)
    content = writers.written(car, language)
    if language == "fmu":
        content = zipfile.ZipFile(io.BytesIO(content)).read("sources/model.c")
    assert b"quarter_vehicle_model: equations of motion, written by hymeko-x" in content
    assert writers.written(hx.dynamics(hx.load(LISTING).mechanism), language) == writers.written(car, language)


def test_the_sympy_file_is_exact() -> None:
    module = run(written(hx.dynamics(hx.load(LISTING).mechanism), "sympy"))
    values = dict(zip(module.p, map(sympy.Rational, map(str, module.P)), strict=True))
    assert sympy.Matrix([[0, 1], [-1000, -20]]) == module.rates.jacobian(module.x).subs(values)
