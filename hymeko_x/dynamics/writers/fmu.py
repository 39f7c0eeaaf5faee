"""A Functional Mock-up Unit of FMI 3.0 for model exchange, with its sources: model description, build description and C."""

from __future__ import annotations

import hashlib
import io
import zipfile
from typing import TYPE_CHECKING, NamedTuple

from hymeko_x.dynamics.writers.modelica import identifier
from hymeko_x.dynamics.writers.program import description, program_of
from hymeko_x.ir.digits import number_text
from hymeko_x.xml.text import escaped

if TYPE_CHECKING:
    from hymeko_x.dynamics.system import System, Variable

_DATE = (1980, 1, 1, 0, 0, 0)
"""The time of every file in the archive: the same bytes for the same system."""


class _Entry(NamedTuple):
    name: str
    causality: str
    unit: str
    start: float | None
    derivative: int | None = None


def write_fmu(system: System) -> bytes:
    """The archive. It has no binary: a tool compiles ``sources/model.c``, or the compiler of the machine does."""
    name = identifier(system.name)
    code = _code(system)
    token = hashlib.sha256(code.encode()).hexdigest()
    files = {
        "modelDescription.xml": _description(system, name, token),
        "sources/buildDescription.xml": _build(name),
        "sources/model.c": code.replace("@TOKEN@", token),
    }
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, text in files.items():
            archive.writestr(zipfile.ZipInfo(path, _DATE), text, zipfile.ZIP_DEFLATED)
    return out.getvalue()


def _entries(system: System) -> list[_Entry]:
    """The variables in the order of their value references, which is their order in the C code's array."""
    count = len(system.states)
    entries = [_Entry("time", "independent", "s", None)]
    entries += [_Entry(v.name, "local", v.unit, v.value) for v in system.states]
    entries += [_Entry(f"der({v.name})", "local", f"{v.unit}/s" if v.unit else "1/s", None, k) for k, v in enumerate(system.states, 1)]
    entries += [_Entry(v.name, "input", v.unit, v.value) for v in system.inputs]
    entries += [_Entry(_output(v, system), "output", v.unit, None) for v in system.outputs]
    entries += [_Entry(v.name, "parameter", v.unit, v.value) for v in system.parameters]
    assert len(entries) == 1 + 2 * count + len(system.inputs) + len(system.outputs) + len(system.parameters)
    return entries


def _output(variable: Variable, system: System) -> str:
    taken = {other.name for part in (system.states, system.inputs, system.parameters) for other in part}
    return f"y.{variable.name}" if variable.name in taken else variable.name


def _description(system: System, name: str, token: str) -> str:
    entries = _entries(system)
    units = sorted({entry.unit for entry in entries if entry.unit})
    lines = ['<?xml version="1.0" encoding="UTF-8"?>']
    lines.append(f'<fmiModelDescription fmiVersion="3.0" modelName="{escaped(system.name)}" instantiationToken="{token}"')
    lines.append('  generationTool="hymeko-x" variableNamingConvention="flat">')
    lines.append(f'  <ModelExchange modelIdentifier="{name}"/>')
    if units:
        lines += ["  <UnitDefinitions>", *[f'    <Unit name="{escaped(unit)}"/>' for unit in units], "  </UnitDefinitions>"]
    lines.append("  <ModelVariables>")
    for reference, entry in enumerate(entries):
        words = f'name="{escaped(entry.name)}" valueReference="{reference}" causality="{entry.causality}"'
        words += ' variability="tunable"' if entry.causality == "parameter" else ' variability="continuous"'
        words += f' unit="{escaped(entry.unit)}"' if entry.unit else ""
        words += f' start="{number_text(entry.start)}"' if entry.start is not None else ""
        words += ' initial="exact"' if entry.causality == "local" and entry.start is not None else ""
        words += f' derivative="{entry.derivative}"' if entry.derivative is not None else ""
        lines.append(f"    <Float64 {words}/>")
    lines += ["  </ModelVariables>", "  <ModelStructure>"]
    count = len(system.states)
    first = 1 + 2 * count + len(system.inputs)
    lines += [f'    <Output valueReference="{first + k}"/>' for k in range(len(system.outputs))]
    lines += [f'    <ContinuousStateDerivative valueReference="{1 + count + k}"/>' for k in range(count)]
    lines += [f'    <InitialUnknown valueReference="{first + k}"/>' for k in range(len(system.outputs))]
    lines += [f'    <InitialUnknown valueReference="{1 + count + k}"/>' for k in range(count)]
    return "\n".join([*lines, "  </ModelStructure>", "</fmiModelDescription>"]) + "\n"


def _build(name: str) -> str:
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiBuildDescription fmiVersion="3.0">
  <BuildConfiguration modelIdentifier="{name}">
    <SourceFileSet language="C99">
      <SourceFile name="model.c"/>
    </SourceFileSet>
  </BuildConfiguration>
</fmiBuildDescription>
"""


_C_TEXTS = {"POW": "pow({0}, {1})", "CONSTPOW": "pow({0}, {1})", "FABS": "fabs({0})", "SIGN": "sign({0})"}


def _code(system: System) -> str:
    program = program_of(system, lambda letter, k: f"{letter}[{k}]", texts=_C_TEXTS)
    body = [f"    const double {target} = {text};" for target, text in program.assignments]
    body += [f"    dx[{k}] = {text};" for k, text in enumerate(program.rates)]
    body += [f"    y[{k}] = {text};" for k, text in enumerate(program.outputs)]
    counts = {"NX": len(system.states), "NU": len(system.inputs), "NY": len(system.outputs), "NP": len(system.parameters)}
    starts = [entry.start or 0.0 for entry in _entries(system)]
    return "\n".join(
        [
            *description(system, "//"),
            "#include <math.h>",
            "#include <stdbool.h>",
            "#include <stdint.h>",
            "#include <stdlib.h>",
            "#include <string.h>",
            *[f"enum {{ {name} = {value} }};" for name, value in counts.items()],
            f"static const double START[] = {{{', '.join(map(repr, starts))}}};",
            "static double sign(double a) { return (a > 0) - (a < 0); }",
            "static void evaluate(const double *x, double *dx, const double *u, double *y, const double *p) {",
            "    (void)x; (void)dx; (void)u; (void)y; (void)p; (void)sign;",
            *body,
            "}",
            _RUNTIME,
            "// Every function of the standard exists; these are of other types of FMUs and of other types of variables.",
            *[f"FMI3_Export int fmi3{name}(void) {{ return ERROR; }}" for name in _UNSUPPORTED],
            *[f"FMI3_Export void *fmi3Instantiate{kind}(void) {{ return NULL; }}" for kind in ("CoSimulation", "ScheduledExecution")],
            "",
        ]
    )


_UNSUPPORTED = (
    "ActivateModelPartition",
    "DeserializeFMUState",
    "DoStep",
    "EnterConfigurationMode",
    "EnterStepMode",
    "EvaluateDiscreteStates",
    "ExitConfigurationMode",
    "FreeFMUState",
    "GetAdjointDerivative",
    "GetBinary",
    "GetBoolean",
    "GetClock",
    "GetDirectionalDerivative",
    "GetFMUState",
    "GetFloat32",
    "GetInt16",
    "GetInt32",
    "GetInt64",
    "GetInt8",
    "GetIntervalDecimal",
    "GetIntervalFraction",
    "GetNumberOfVariableDependencies",
    "GetOutputDerivatives",
    "GetShiftDecimal",
    "GetShiftFraction",
    "GetString",
    "GetUInt16",
    "GetUInt32",
    "GetUInt64",
    "GetUInt8",
    "GetVariableDependencies",
    "SerializeFMUState",
    "SerializedFMUStateSize",
    "SetBinary",
    "SetBoolean",
    "SetClock",
    "SetFMUState",
    "SetFloat32",
    "SetInt16",
    "SetInt32",
    "SetInt64",
    "SetInt8",
    "SetIntervalDecimal",
    "SetIntervalFraction",
    "SetShiftDecimal",
    "SetShiftFraction",
    "SetString",
    "SetUInt16",
    "SetUInt32",
    "SetUInt64",
    "SetUInt8",
)

_RUNTIME = r"""
// The functions of FMI 3.0 for model exchange. Variables stand in one array in the order of their value references.
#ifndef FMI3_Export
#define FMI3_Export
#endif
typedef struct { double v[1 + 2 * NX + NU + NY + NP + 1]; bool stale; } Model;
enum { OK = 0, ERROR = 3, N = 1 + 2 * NX + NU + NY + NP };
static void refresh(Model *m) {
    if (m->stale) evaluate(m->v + 1, m->v + 1 + NX, m->v + 1 + 2 * NX, m->v + 1 + 2 * NX + NU, m->v + 1 + 2 * NX + NU + NY);
    m->stale = false;
}
FMI3_Export const char *fmi3GetVersion(void) { return "3.0"; }
FMI3_Export int fmi3SetDebugLogging(void *c, bool on, size_t n, const char *const names[]) {
    (void)c; (void)on; (void)n; (void)names;
    return OK;
}
FMI3_Export void *fmi3InstantiateModelExchange(const char *name, const char *token, const char *path, bool visible, bool logging,
                                               void *environment, void *log) {
    (void)name; (void)path; (void)visible; (void)logging; (void)environment; (void)log;
    if (strcmp(token, "@TOKEN@") != 0) return NULL;
    Model *m = malloc(sizeof(Model));
    if (m) { memcpy(m->v, START, N * sizeof(double)); m->stale = true; }
    return m;
}
FMI3_Export void fmi3FreeInstance(void *c) { free(c); }
FMI3_Export int fmi3EnterInitializationMode(void *c, bool given, double tolerance, double start, bool ends, double stop) {
    (void)given; (void)tolerance; (void)ends; (void)stop;
    ((Model *)c)->v[0] = start;
    return OK;
}
FMI3_Export int fmi3ExitInitializationMode(void *c) { (void)c; return OK; }
FMI3_Export int fmi3EnterEventMode(void *c) { (void)c; return OK; }
FMI3_Export int fmi3EnterContinuousTimeMode(void *c) { (void)c; return OK; }
FMI3_Export int fmi3Terminate(void *c) { (void)c; return OK; }
FMI3_Export int fmi3Reset(void *c) { Model *m = c; memcpy(m->v, START, N * sizeof(double)); m->stale = true; return OK; }
FMI3_Export int fmi3GetFloat64(void *c, const uint32_t vr[], size_t n, double values[], size_t count) {
    Model *m = c;
    if (n != count) return ERROR;
    refresh(m);
    for (size_t i = 0; i < n; i++) { if (vr[i] >= N) return ERROR; values[i] = m->v[vr[i]]; }
    return OK;
}
FMI3_Export int fmi3SetFloat64(void *c, const uint32_t vr[], size_t n, const double values[], size_t count) {
    Model *m = c;
    if (n != count) return ERROR;
    for (size_t i = 0; i < n; i++) { if (vr[i] == 0 || vr[i] >= N) return ERROR; m->v[vr[i]] = values[i]; }
    m->stale = true;
    return OK;
}
FMI3_Export int fmi3UpdateDiscreteStates(void *c, bool *again, bool *terminate, bool *nominals, bool *values, bool *next, double *time) {
    (void)c; (void)time;
    *again = *terminate = *nominals = *values = *next = false;
    return OK;
}
FMI3_Export int fmi3CompletedIntegratorStep(void *c, bool keep, bool *event, bool *terminate) {
    (void)c; (void)keep;
    *event = *terminate = false;
    return OK;
}
FMI3_Export int fmi3SetTime(void *c, double time) { ((Model *)c)->v[0] = time; return OK; }
FMI3_Export int fmi3SetContinuousStates(void *c, const double x[], size_t n) {
    Model *m = c;
    if (n != NX) return ERROR;
    memcpy(m->v + 1, x, n * sizeof(double));
    m->stale = true;
    return OK;
}
FMI3_Export int fmi3GetContinuousStates(void *c, double x[], size_t n) {
    if (n != NX) return ERROR;
    memcpy(x, ((Model *)c)->v + 1, n * sizeof(double));
    return OK;
}
FMI3_Export int fmi3GetContinuousStateDerivatives(void *c, double dx[], size_t n) {
    Model *m = c;
    if (n != NX) return ERROR;
    refresh(m);
    memcpy(dx, m->v + 1 + NX, n * sizeof(double));
    return OK;
}
FMI3_Export int fmi3GetNominalsOfContinuousStates(void *c, double x[], size_t n) {
    (void)c;
    for (size_t i = 0; i < n; i++) x[i] = 1.0;
    return OK;
}
FMI3_Export int fmi3GetEventIndicators(void *c, double z[], size_t n) { (void)c; (void)z; return n ? ERROR : OK; }
FMI3_Export int fmi3GetNumberOfEventIndicators(void *c, size_t *n) { (void)c; *n = 0; return OK; }
FMI3_Export int fmi3GetNumberOfContinuousStates(void *c, size_t *n) { (void)c; *n = NX; return OK; }
"""
