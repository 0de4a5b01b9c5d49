"""A trial of the initial state of a program without a run, with the kernels of one evaluation."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from types import CodeType
from typing import Any

from lagc.base.records import once
from lagc.codegen.python.emit import evaluation
from lagc.host import cache as store
from lagc.lowering.program import Program
from lagc.simulation.backends.python import NumpyModel, compiled, executed
from lagc.simulation.global_error.equilibrium_start import locked
from lagc.simulation.initialization.initialize import NoStart, begin, strange_outputs, undetermined
from lagc.simulation.request import Request
from lagc.simulation.system import FAILED, System, idle_actuator

__all__ = ["NoStart", "try_start"]


class _Model(NumpyModel):
    """The module less what takes steps."""

    def __init__(self, program: Program):
        super().__init__(program.interface, {})
        self.program = program

    @once
    def module(self) -> dict[str, Any]:
        own, shared = evaluation(self.program)
        return executed([*compiled(own, "evaluation"), _code(shared)])


def try_start(program: Program, parameters: Sequence[float]) -> list[str]:
    """Return the outputs without a finite value at the start. Raises Refused as a run with the parameters p
    would before its first step: NoStart, LAG0617 or LAG0604."""
    request = Request().completed(program.interface.simulate)
    system = _Model(program).bind(parameters)
    x = begin(system, request).x
    if request.stop == 0.0 or (not system.interface.servos and locked(system, x, 0.0)):
        return _strange(system, x)
    equations: Any = system.equations()
    status = equations.first(0.0, x, [0.0] * system.nx, [0.0] * system.nc)
    if status in FAILED or idle_actuator(system, status, equations.culprit):
        raise undetermined(system, status, equations.culprit, x)
    return _strange(system, x)


def _strange(system: System, x: Sequence[float]) -> list[str]:
    return [system.interface.outputs[k].name for k in strange_outputs(system, x)]


@cache
def _code(text: str) -> CodeType:
    """Kernels are the same for many models."""
    return store.code(lambda: text, "evaluation", text)
