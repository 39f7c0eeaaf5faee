"""Generated files: each stands alone and says where it comes from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import refuse

if TYPE_CHECKING:
    from hymeko_x.dynamics.lumped import Lumped
    from hymeko_x.dynamics.multibody import Multibody

LANGUAGES = ("python", "sympy", "casadi", "c", "octave", "simulink", "modelica", "fmu")
LINEAR = ("octave", "simulink")
"""Those that are given the linear system, of a mechanism at its operating point."""


def written(dynamics: Lumped | Multibody, language: str, *, at: str = "") -> bytes:
    """The equations as a file in a language of :data:`LANGUAGES`; those of :data:`LINEAR` are linear about ``at``.

    Raises: Refusal (HX407) for an operating point that is not known, HX408 for formulas of closed loops, which would fill books.
    """
    from hymeko_x.dynamics.lumped import Lumped
    from hymeko_x.dynamics.writers import code, fmu, matlab, modelica

    system = dynamics.system
    if language == "sympy" and not isinstance(dynamics, Lumped) and dynamics.closures:
        loop = dynamics.closures[0].id
        message = f"{loop} is closed by forces that follow from linear equations; their formulas would be too long"
        raise refuse(codes.NO_FORM, message, element=str(loop), hint="--to python or casadi")
    if language == "fmu":
        return fmu.write_fmu(system)
    if language in LINEAR:
        space = dynamics.state_space() if isinstance(dynamics, Lumped) else dynamics.state_space(at)
        return {"octave": matlab.write_octave, "simulink": matlab.write_simulink}[language](system, space).encode()
    write = {
        "python": code.write_python,
        "sympy": code.write_sympy,
        "casadi": code.write_casadi,
        "c": code.write_c,
        "modelica": modelica.write_modelica,
    }
    return write[language](system).encode()
