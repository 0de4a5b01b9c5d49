"""The generated Python module as a `System`.

Single states are Python floats, which are faster than NumPy scalars; the module uses NumPy for many states
at once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from time import perf_counter
from types import CodeType
from typing import Any

from lagc.base.records import once
from lagc.codegen.python.support.contacts import ContactTrajectory
from lagc.lowering.program import Interface
from lagc.simulation.backends.base import Branch, Compiled, CompiledSystem
from lagc.simulation.backends.checked import checked, run_in_slices
from lagc.simulation.backends.event_log import EventLog
from lagc.simulation.system import OK, Checked, Options, Trajectory, Vector

_PART = 20_000  # characters
_BETWEEN = "\n\n\n"  # separates the definitions of a module


def compiled(text: str, name: str) -> tuple[CodeType, ...]:
    """Compile the text of a module in parts, which takes half the memory and three quarters of the time."""
    parts, flags = [""], annotations.compiler_flag
    for definition in text.split(_BETWEEN):
        if len(parts[-1]) > _PART:
            parts.append("")
        parts[-1] += definition + _BETWEEN
    return tuple([compile(part, name, "exec", flags, dont_inherit=True) for part in parts])


def executed(code: Sequence[CodeType]) -> dict[str, Any]:
    """Execute the code of a module and return its namespace."""
    space: dict[str, Any] = {"__name__": __name__}
    for part in code:
        exec(part, space)
    return space


# Largest number of directions times operations of a right-hand side, for derivatives computed at once.
ROOM = 2**21


class NumpyModel(Compiled):
    """The generated module; `code` is its compiled text, if it is known."""

    backend = "numpy"

    def __init__(self, interface: Interface, sources: Mapping[str, str], code: Sequence[CodeType] = ()):
        super().__init__(interface, sources)
        self.code = code

    @once
    def module(self) -> dict[str, Any]:
        ((name, text),) = self.sources.items()
        return executed(self.code or compiled(text, name))

    @once
    def rows(self) -> dict[str, range]:
        """The rows of each part of the differentiated stack."""
        return self.interface.stack

    @once
    def places(self) -> dict[str, Any]:
        """Rows and columns of the derivatives by each group, as arrays."""
        import numpy

        found = self.interface.derivatives
        return {group: numpy.array(places, dtype=int).reshape(-1, 2).T for group, places in found.items()}

    def bind(self, values: Sequence[float], branch: Branch | None = None) -> NumpySystem:
        return NumpySystem(self, values, branch)


class _Workspace:
    """The equations of one thread, and the functions of the program with their argument names."""

    __slots__ = ("equations", "functions", "rhs")

    def __init__(self, model: NumpyModel, values: Sequence[float]):
        self.equations: Any = model.module["Equations"](values)
        self.functions: dict[str, tuple[Any, tuple[str, ...]]] = {}
        self.rhs: Any = self.equations.rhs


class NumpySystem(CompiledSystem):
    backend = "numpy"

    def __init__(self, model: NumpyModel, values: Sequence[float], branch: Branch | None = None):
        super().__init__(model, values, branch, _Workspace, tuple(values))
        self.model = model

    def _branch(self, t: float, x: Vector) -> Branch:
        return tuple(self.modes(t, x))

    def _set_branch(self, workspace: _Workspace, branch: Branch) -> None:
        work = workspace.equations.work
        work.modes[:], work.modes_fixed = branch, True

    @once
    def _p(self) -> list[float]:
        """The array p with all derived values."""
        p: list[float] = self.equations().p
        return p

    def equations(self) -> Any:
        """New equations for one trajectory; they remember which constraints depended on others."""
        return self.model.module["Equations"](self._values)

    @property
    def culprit(self) -> int:
        found: int = self._thread.workspace.equations.culprit
        return found

    @property
    def contact_forces(self) -> list[float]:
        """The forces along the rows of the contacts at the last evaluation of this thread."""
        found: list[float] = self._thread.workspace.equations.work.contacts.forces
        return found

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        status: int = self._thread.workspace.rhs(t, x, xdot, lam)
        return status

    def seated(self, t: float, x: Vector) -> list[float]:
        found = [*x]
        self.model.module["seated"](self._p, t, found, self._thread.workspace.equations.work)
        return found

    def assemble(self, t: float, x: Vector) -> int:
        work = self._thread.workspace.equations.work
        work.rank_deficient = False
        status: int = self.model.module["assemble_at"](self._p, t, x, work)
        return status

    def solve(self, r: Vector) -> list[float]:
        found = [0.0] * (self.nv + self.nc)
        self.model.module["solve_at"](r, found, self._thread.workspace.equations.work)
        return found

    def factors(self, t: float, x: Vector, modes: Vector | None = None) -> list[float] | None:
        """The factors of [M -G^T; G 0] at a state, for a program with derivatives; None if unavailable or
        inaccurate. Without `modes`, on the branch of the state."""
        if "solve" not in self.interface.functions:
            return None
        work = self._thread.workspace.equations.work
        on = () if not self.interface.relations else (self.modes(t, x) if modes is None else modes,)
        if not self.nc:
            module = self.model.module
            module["fn_assemble_on" if on else "fn_assemble"](self._p, t, x, *on, work.kkt_entries)
            module["fn_factor"](work.kkt_entries, work.health)
            return work.kkt_entries[:] if work.health[0] >= module["SINGULAR"] else None
        with self._on(*on):
            safely = work.fallbacks
            status = self.assemble(t, x)
        return work.kkt_entries[:] if status == OK and work.fallbacks == safely else None

    def solved(self, factors: Vector, right: Any) -> Any:
        """Solve M s1 - G^T s2 = r1, G s1 = r2 for the columns of `right`, with one refinement step if there
        are constraints."""
        import numpy

        module, found = self.model.module, [0.0] * len(right)
        module["fn_solve"](factors, list(right), found)
        if "refine" in self.interface.functions:
            module["fn_refine"](factors, list(right), found)
        elif self.nc:
            rest, change = [0.0] * len(right), [0.0] * len(right)
            module["fn_rest"](factors, list(right), found, rest)
            module["fn_solve"](factors, rest, change)
            found = [s + d for s, d in zip(found, change)]
        return numpy.array([numpy.broadcast_to(s, right.shape[1]) for s in found])

    def displace(self, t: float, x: Vector, d: Vector) -> list[float]:
        if "displace" not in self.interface.functions:
            return list(d)
        dq = [0.0] * self.nq
        self.model.module["fn_displace"](self._p, t, x, d, dq)
        return dq

    def modes(self, t: float, x: Vector) -> list[float]:
        """The branch of a state: the mode of each relation."""
        found = [0.0] * len(self.interface.relations)
        if found:
            self.model.module["fn_modes"](self._p, t, x, found)
        return found

    def indicators(self, t: float, x: Vector) -> list[float]:
        """The event indicator of each relation."""
        found = [0.0] * len(self.interface.relations)
        if found:
            self.model.module["fn_indicators_on"](self._p, t, x, self.modes(t, x), found)
        return found

    def holds(self, modes: Vector, t: float, x: Vector) -> list[float]:
        """Return 1 for each clause `when` whose condition holds on a branch, else 0."""
        found = [0.0] * len(self.interface.whens)
        if found:
            self.model.module["fn_holds_on"](self._p, t, x, modes, found)
        return found

    def rhs_on(self, modes: Vector, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        with self._on(modes):
            return self.rhs(t, x, xdot, lam)

    @contextmanager
    def _on(self, modes: Vector = ()) -> Iterator[None]:
        """A block whose evaluations are on the branch `modes`, if it is not empty."""
        if not modes:
            yield
            return
        work = self._thread.workspace.equations.work
        before, held = work.modes[:], work.modes_fixed
        work.modes[:], work.modes_fixed = modes, True
        yield
        work.modes[:], work.modes_fixed = before, held

    def stack(self, t: float, x: Vector, a: Vector, lam: Vector, modes: Vector | None = None) -> list[float]:
        """The values of all differentiated expressions (`lagc.lowering.jacobians`), for a program with
        derivatives. Without `modes`, on the branch of the state."""
        found = [0.0] * max([part.stop for part in self.interface.stack.values()])
        self._differentiated("stack", t, x, a, lam, modes, found)
        return found

    def derivatives(
        self, group: str, t: float, x: Vector, a: Vector, lam: Vector, modes: Vector | None = None
    ) -> Any:
        """The derivatives of the stack by one group of variables, as a matrix."""
        import numpy

        height, columns = max(rows.stop for rows in self.model.rows.values()), self.interface.groups[group]
        table = numpy.zeros((height, len(columns)))
        if "along" in self.interface.functions:
            together = max(ROOM // max(self.interface.operations, 1), 1)
            for first in range(0, len(columns), together):
                directions = range(columns.start, columns.stop)[first : first + together]
                changes: list[Any] = [0.0] * height
                self._differentiated("along", t, x, a, lam, modes, self._seeds(directions), changes)
                for k, change in enumerate(changes):
                    table[k, first : first + together] = change
        elif pattern := self.interface.derivatives[group]:
            found = [0.0] * len(pattern)
            self._differentiated(f"by_{group}", t, x, a, lam, modes, found)
            table[tuple(self.model.places[group])] = found
        return table

    def _seeds(self, directions: range) -> list[Any]:
        """Unit directions, one array for each entry; 0 for entries that are zero in all directions."""
        import numpy

        found: list[Any] = [0.0] * max(group.stop for group in self.interface.groups.values())
        found[directions.start : directions.stop] = list(numpy.eye(len(directions)))
        return found

    def _differentiated(
        self, name: str, t: float, x: Vector, a: Vector, lam: Vector, modes: Vector | None, *last: list[Any]
    ) -> None:
        module = self.model.module
        if not self.interface.relations:
            module[f"fn_{name}"](self._p, t, x, a, lam, *last)
        else:
            on = self.modes(t, x) if modes is None else modes
            module[f"fn_{name}_on"](self._p, t, x, on, a, lam, *last)

    def start(self) -> list[float]:
        x = [0.0] * self.nx
        self.model.module["fn_start"](self._p, x)
        return x

    def integrate(
        self,
        options: Options,
        t0: float,
        x0: Vector,
        times: Sequence[float],
        progress: Callable[[float], None] | None = None,
    ) -> Trajectory:
        other = self.compiled.for_method(options.method, self._values)
        if other is not None:
            return other.integrate(options, t0, x0, times, progress)
        integrate, equations = self.model.module["_integrate"], self.equations()
        done: Trajectory = integrate(equations, options, t0, list(x0), list(times), progress, perf_counter)
        return done

    def verify(
        self, options: Options, x0: Vector, times: Sequence[float], accuracy: float, scales: Vector,
        progress: Callable[[float], None] | None = None,
    ) -> Checked:  # fmt: skip
        other = self.compiled.for_method(options.method, self._values)
        if other is not None:
            return other.verify(options, x0, times, accuracy, scales, progress)
        return verify(self.model.module, self.interface, self.equations().p, options, list(x0), list(times),
                      accuracy, list(scales), progress)  # fmt: skip

    def _ask(self, name: str, length: int, t: float, x: Vector) -> list[float]:
        """Call the function `name` of the program with those of p t x e a lam that it reads."""
        result = [0.0] * length
        if length:
            workspace = self._thread.workspace
            if name not in workspace.functions:
                found = self.model.module[f"fn_{name}"]
                workspace.functions[name] = (
                    found,
                    found.__code__.co_varnames[: found.__code__.co_argcount - 1],
                )
            function, names = workspace.functions[name]
            given: dict[str, Any] = {"p": self._p, "t": t, "x": x}
            if "e" in names:
                given["e"] = self.energies(t, x)
            if "a" in names or "lam" in names:
                given["a"], given["lam"] = self.accelerations(t, x)
                if self.interface.contacts:
                    given["contact_forces"] = self.contact_forces
            function(*(given[n] for n in names), result)
        return result

    def conditions(self, t: float, x: Vector) -> tuple[list[float], list[float], list[float]]:
        found = super().conditions(t, x)
        if self.interface.part_ends:
            self.model.module["assemble_slopes"](found[1])
        return found

    def _fill(self, name: str, lengths: tuple[int, ...], t: float = 0.0, x: Vector = ()) -> list[list[float]]:
        arrays = [[0.0] * length for length in lengths]
        if name in self.interface.functions:
            state = (t, x) if x else ()
            self.model.module[f"fn_{name}"](self._p, *state, *arrays)
        return arrays


def verify(
    module: Mapping[str, Any], interface: Interface, p: list[float], options: Options, x0: list[float],
    times: list[float], accuracy: float, scales: list[float], progress: Callable[[float], None] | None,
) -> Checked:  # fmt: skip
    """Return a verified run of a generated module."""
    goal, report, v = module["Goal"](), module["Report"](), module["Verification"]()
    asked, log = module["KernelOptions"](options), EventLog(interface, v.run, options.report)
    goal.accuracy = accuracy
    states = [[0.0] * interface.nx for _ in times]
    outputs = [[0.0] * len(interface.outputs) for _ in times]

    def advance(steps: int) -> int:
        goal.slice, asked.report = steps, log.open
        status: int = module["verified"](
            p, x0, times, len(times), goal, scales, asked, states, outputs, report, v
        )
        return status

    def result(status: int) -> Trajectory:
        run, work, done = v.run, v.run_work, report.done
        rows = work.redundant if interface.nc else ()
        make = ContactTrajectory if interface.contacts else Trajectory
        return make(
            times=times[:done], states=[x[:] for x in states[:done]], t=run.t, x=run.x[:], status=status,
            culprit=-1 if status == OK else run.culprit, steps=run.steps, rejected=run.rejected, rhs=run.rhs,
            stiff=run.stiff, step=run.t - run.t_old, fallbacks=work.fallbacks,
            redundant_rows=tuple([i for i, lost in enumerate(rows) if lost]),
            shared_contacts=tuple([i for i, shares in enumerate(getattr(work, "shared", ())) if shares]),
            position_drift=run.position_drift, velocity_drift=run.velocity_drift, sizes=run.sizes[:],
            lowest=run.lowest[:], highest=run.highest[:],
            changes=run.changes if interface.relations else 0, **log.known(),
        )  # fmt: skip

    status = run_in_slices(advance, log, lambda: int(report.attempts), result, options, progress)
    return checked(result(status), v, report, asked)
