"""Generated files: each stands alone and says where it comes from."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hymeko_x.dynamics.lumped import Lumped
    from hymeko_x.dynamics.multibody import Multibody

LANGUAGES = ("python", "sympy", "casadi", "c", "octave", "simulink", "modelica", "fmu")
LINEAR = ("octave", "simulink")
"""Those that are given the linear system, of a mechanism at its operating point."""


def written(dynamics: Lumped | Multibody, language: str, *, at: str = "") -> bytes:
    """The equations as a file in a language of :data:`LANGUAGES`; those of :data:`LINEAR` are linear about ``at``.

    Formulas of closed loops, whose forces follow from linear equations, are written in steps.

    Raises: Refusal (HX407) for an operating point that is not known.
    """
    from hymeko_x.dynamics.lumped import Lumped
    from hymeko_x.dynamics.writers import code, fmu, matlab, modelica

    system = dynamics.system
    if language == "sympy":
        return code.write_sympy(system, in_steps=not isinstance(dynamics, Lumped) and bool(dynamics.closures)).encode()
    if language == "fmu":
        return fmu.write_fmu(system)
    if language in LINEAR:
        space = dynamics.state_space() if isinstance(dynamics, Lumped) else dynamics.state_space(at)
        return {"octave": matlab.write_octave, "simulink": matlab.write_simulink}[language](system, space).encode()
    write = {
        "python": code.write_python,
        "casadi": code.write_casadi,
        "c": code.write_c,
        "modelica": modelica.write_modelica,
    }
    return write[language](system).encode()
