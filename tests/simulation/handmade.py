"""The runtime of generated modules with systems written by hand, and single kernels."""

from collections.abc import Callable, Sequence
from functools import cache
from types import CodeType, ModuleType
from typing import Any

from lagc.base.records import replace
from lagc.codegen.python.emit import render
from lagc.lowering.program import Program
from lagc.simulation.backends.python import verify as verify_module
from lagc.simulation.error_measure import quantity_names
from lagc.simulation.system import FAILED, Checked, Options, Trajectory, Vector


@cache
def _code(text: str) -> CodeType:
    return compile(text, "generated", "exec", dont_inherit=True)


def module(program: Program) -> Any:
    """The generated module."""
    ((_, text),) = render(program, complete=False).items()
    found = ModuleType("generated")
    exec(_code(text), vars(found))
    return found


def of_system(system: Any) -> Any:
    """The module of a model of these sizes, with the methods of `system` in place of the kernels that solve
    the equations of motion and of the model's functions.  What errors of rounding do to them is not asked."""
    found = module(Program(replace(system.interface, solve="dense", prepared=0, read=(), outputs=()), {}))

    def rhs_at(p: Vector, t: float, x: Vector, xdot: list[float], lam: list[float], w: Any) -> int:
        status: int = system.rhs(t, x, xdot, lam)
        if status in FAILED:
            w.culprit = system.culprit
        return status

    def writes(name: str) -> Callable[..., None]:
        """The function of a Program that a method is: it writes to its last argument."""

        def function(p: Vector, *given: Any) -> None:
            values = getattr(system, name)(*given[:-1])
            given[-1][: len(values)] = values

        return function

    found.rhs_at = found.rhs_any_rank = rhs_at  # without constraints the first is a call of the second
    found.error_without_roundoff = lambda p, s, t, h, o, before, w: before
    found.assemble_at = lambda p, t, x, w: system.assemble(t, x)
    for name in ("position", "velocity", "scales", "reaches", "displace"):
        setattr(found, f"fn_{name}", writes(name))

    def solve_at(r: Vector, s: list[float], w: Any) -> None:
        s[:] = system.solve(r)

    found.solve_at = solve_at
    return found


def integrator(system: Any, options: Options, t: float, x: Sequence[float]) -> Any:
    found = of_system(system)
    return found.Integrator(found.Equations(list(system.parameters)), options, t, x)


def integrate(
    system: Any,
    options: Options,
    t0: float,
    x0: Sequence[float],
    times: Sequence[float],
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    found = of_system(system)
    equations = found.Equations(list(system.parameters))
    done: Trajectory = found._integrate(equations, options, t0, list(x0), list(times), progress)
    return done


def verify(
    system: Any,
    options: Options,
    x0: Sequence[float],
    times: Sequence[float],
    accuracy: float,
    scales: Sequence[float],
    progress: Callable[[float], None] | None = None,
) -> Checked:
    """A verified run; outputs are left out."""
    names = len(quantity_names(system.interface))
    bare = replace(system.interface, outputs=())
    found = verify_module(vars(of_system(system)), bare, list(system.parameters), options, list(x0),
                          list(times), accuracy, list(scales), progress)  # fmt: skip
    rest = [0.0] * (names - len(found.errors))
    return replace(found, errors=found.errors + rest, scales=found.scales + rest, sizes=found.sizes + rest,
                   constant=found.constant + [False] * len(rest))  # fmt: skip


def project(system: Any, t: float, x: list[float], sizes: list[float]) -> tuple[int, float, float]:
    """Status, and the scaled residuals of positions and speeds that remain."""
    found = of_system(system)
    work = found.Work()
    return (
        found.project(list(system.parameters), t, x, sizes, work),
        work.position_residual,
        work.velocity_residual,
    )
