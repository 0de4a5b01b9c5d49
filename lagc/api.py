"""The Python interface: load a model file, compile a scene of it, simulate.

    model = lagc.load("pendulum.lag")
    system = model.compile(scene="room", backend="c")
    run = system.simulate(stop=10, accuracy=1e-8, parameters={"l": 0.7})
    run.t, run["theta"], run.plot(), run.save("run.npz")

Numbers are in SI; a pair (70, "cm") is a number with its unit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from time import perf_counter
from typing import TYPE_CHECKING, TypeAlias

from lagc.api_derivatives import Differentiable
from lagc.api_values import Input, Value, condition, parted, quantities, real, reals, seconds, word, words
from lagc.base.records import dataclass, names, replace
from lagc.compiler.loaded import Loaded
from lagc.compiler.pipeline import Choice, Compilation
from lagc.diagnostics.faults import Fault, Refused, Source
from lagc.host import model_library
from lagc.host.budgets import of_this_machine, running
from lagc.simulation.request import Quantity, Request, bound_parameters, bound_starts, keep_limits
from lagc.simulation.solution import Solution
from lagc.simulation.supervision import check_memory
from lagc.simulation.system import System

if TYPE_CHECKING:
    from lagc.compiler.artifact import Artifact
    from lagc.lowering.program import Interface, Program
    from lagc.mechanics.formulation.equations import EquationsOfMotion
    from lagc.reports.equations.matrices import Matrices
    from lagc.semantics.model import Model
    from lagc.semantics.scenes.choice import Inputs
    from lagc.simulation.initialization.initialize import NoStart
    from lagc.simulation.initialization.result import Start
    from lagc.simulation.solution import Array

Progress: TypeAlias = Callable[[float], None]


def load(path: str) -> ModelFile:
    """The model file `path`, or a model of the library by its name (`simple_pendulum`).

    Raises Refused where it cannot be read; what is wrong inside it is found by `compile` and `check`.
    """
    return ModelFile(model_library.read(str(path)))


def loads(text: str, name: str = "<text>") -> ModelFile:
    """A model from its text; faults call it `name`."""
    return ModelFile(Source(name, text))


@dataclass(frozen=True)
class ModelFile:
    """A model text, not yet compiled."""

    source: Source

    def compile(
        self,
        scene: str | None = None,
        *,
        model: str | None = None,
        use: str | Sequence[str] = (),
        without: str | Sequence[str] = (),
        parameters: Mapping[str, Value] | None = None,
        inputs: Mapping[str, Input] | None = None,
        until: str | None = None,
        backend: str = "auto",
    ) -> CompiledModel:
        """One scene of one model (the first where none is named), with the effects `use` added and
        `without` left out.

        `parameters` here are the values for every run, unless a run gives others; structural
        integers are built in.  An input is a number, the text of an expression, `drive.csv:u`, or
        points over time, `(t, values)` or `(t, values, "cubic")` in SI; all but numbers are built in.
        `until` is a condition, as "x > 3 [m]", that ends a run where it becomes true.
        `backend` is "c", "numpy" or "auto" (C where a compiler is found and it pays).  Raises Refused with
        all faults.
        """
        if backend not in ("auto", "c", "numpy"):
            raise ValueError(f"there is no backend {backend!r}: auto, c or numpy")
        given = quantities("parameters", parameters)
        numbers, courses = parted(inputs)
        choice = Choice(
            word("model", model), word("scene", scene), words("use", use), words("without", without),
            {**given, **numbers}, courses, condition(until),
        )  # fmt: skip
        return CompiledModel(Compilation(self.source, choice), backend)

    def check(self) -> list[Fault]:
        """The faults of the text, in all its scenes: of its syntax or, without such, of its names and
        dimensions; without these of its equations, then of its starts."""
        from lagc.compiler.checking import check

        return check(self.source, Choice())

    def _repr_latex_(self) -> str:
        return self.compile()._repr_latex_()


class Run(Solution):
    """A Solution that can be looked at."""

    def plot(self, *names: str, path: str | None = None) -> object:
        """Draw the named columns over time (the coordinates without a name), into the file `path`
        where one is given.  Raises ImportError where matplotlib is not installed."""
        from lagc.reports.plots.plot import plot

        return plot(self, names=names, path=path)

    def save(self, path: str, units: bool = False) -> None:
        """Write the recorded times and columns; the ending says how: .csv .npz .parquet.

        `units` writes them into the header of a CSV file, `theta [rad]`; the other formats, and the
        file `PATH.json` beside a CSV file, carry them in any case, with what else is known of the run.
        Raises `lagc.simulation.formats.CannotSave` where the ending is none of these, a package is missing
        or the file cannot be written.
        """
        from lagc.simulation.formats import save

        save(self, path, units)

    def _repr_html_(self) -> str:
        from lagc.reports.plots.html import solution_html

        return solution_html(self)


class CompiledModel(Differentiable):
    """One scene of a model: equations, program, and what simulates it.

    What was compiled before comes out of the cache, stages that nobody asks for are not run.  Nothing
    that is done with it changes its answers: parameters belong to a run, or are bound by `bind`.  Any
    number of threads may use one at the same time, and it pickles.
    """

    def __init__(self, compilation: Compilation, backend: str = "auto"):
        self._loaded = Loaded(compilation, backend)
        self._given = compilation.choice.parameters
        self._own: dict[str, System] = {}
        self._recent: System | None = None
        self._driven: tuple[object, CompiledModel] | None = None

    def bind(self, parameters: Mapping[str, Value]) -> CompiledModel:
        """This model with other values of parameters, for every run that does not give its own; nothing is
        compiled again.  Raises Refused where one is unknown or out of its bounds."""
        bound = CompiledModel.__new__(CompiledModel)
        bound._loaded = self._loaded
        bound._given = self._with_given(parameters)
        bound._own, bound._recent, bound._driven = {}, None, None
        bound_parameters(self.interface, bound._given, self.artifact.unused, demanding=False)
        if self.interface.limits:
            keep_limits(bound.system)
        return bound

    def __getstate__(self) -> dict[str, object]:
        return {
            "_loaded": self._loaded,
            "_given": dict(self._given),
            "_own": {},
            "_recent": None,
            "_driven": None,
        }

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {self.interface.model}, scene {self.interface.scene}>"

    def __copy__(self) -> CompiledModel:
        return self

    def __deepcopy__(self, _: object) -> CompiledModel:
        return self

    @property
    def compilation(self) -> Compilation:
        return self._loaded.compilation

    @property
    def asked_backend(self) -> str:
        return self._loaded.asked

    @property
    def artifact(self) -> Artifact:
        return self._loaded.artifact

    @property
    def compile_s(self) -> float:
        """What compiling has taken so far, s."""
        return self._loaded.seconds

    @property
    def model(self) -> Model:
        """The model with its names resolved."""
        return self.compilation.model

    @property
    def equations(self) -> EquationsOfMotion:
        return self.compilation.equations

    @property
    def program(self) -> Program:
        """What the backends print: straight-line functions, with their operation counts."""
        return self.compilation.program

    @property
    def interface(self) -> Interface:
        """Names, units, sizes."""
        return self.artifact.interface

    @property
    def operations(self) -> int:
        """Arithmetic operations of one right-hand side."""
        return self.interface.operations

    @property
    def backend(self) -> str:
        """The backend that is loaded, or will be first."""
        return self._loaded.backend

    @property
    def system(self) -> System:
        """The loaded system, with the parameters of this model; NaN for those without a value."""
        return self.load(self.backend)

    def load(self, backend: str) -> System:
        """The system of `backend`, compiled where it is not yet, with the parameters of this model."""
        found = self._own.get(backend)
        if found is None:
            values = self._bound(None, demanding=False)
            found = self._own.setdefault(backend, self._loaded.system(backend).bind(values))
        return found

    def _with(self, parameters: Mapping[str, Value] | None) -> System:
        """The system for one call, with `parameters` in place of this model's."""
        own, given = self.system, quantities("parameters", parameters)
        if not given and not any(v != v for v in own.parameters):
            return own
        values, recent = self._bound(given), self._recent
        if recent is None or recent.backend != own.backend or repr(recent.parameters) != repr(tuple(values)):
            recent = own.bind(values)
            keep_limits(recent)
            self._recent = recent
        return recent

    def simulate(
        self,
        stop: Value | None = None,
        *,
        accuracy: float | None = None,
        method: str | None = None,
        rtol: float | None = None,
        atol: float | None = None,
        step: Value | None = None,
        max_step: Value | None = None,
        every: Value | None = None,
        points: int | None = None,
        parameters: Mapping[str, Value] | None = None,
        inputs: Mapping[str, Input] | None = None,
        until: str | None = None,
        starts: Mapping[str, Value] | None = None,
        sensitivity: str | Sequence[str] = (),
        progress: Progress | None = None,
    ) -> Run:
        """Simulate to `stop` (s), to the global relative error `accuracy`, or by hand with
        `method` and tolerances or a fixed `step`; see `lagc.simulation.request.Request`.

        `inputs` and `until` as for `compile`: a number costs nothing, anything else is compiled, unless it
        was for the last run too.  `sensitivity` names parameters, inputs and starts, `start(theta)`, by which
        the motion is differentiated.  What is not said is the scene's, then the default's.  A failed run
        keeps what was computed and says why in `status` and `message`.  Raises Refused for wrong requests.
        """
        if inputs is not None or until is not None:
            numbers, courses = parted(inputs)
            driven = self._with_courses(numbers, courses, condition(until))
            return driven.simulate(
                stop, accuracy=accuracy, method=method, rtol=rtol, atol=atol, step=step, max_step=max_step,
                every=every, points=points, parameters={**quantities("parameters", parameters), **numbers},
                starts=starts, sensitivity=sensitivity, progress=progress,
            )  # fmt: skip
        times = {"stop": stop, "step": step, "max_step": max_step, "every": every}
        request = Request(
            accuracy=accuracy, method=method, rtol=rtol, atol=atol, points=points,
            starts=bound_starts(self.interface, quantities("starts", starts)),
            sensitivity=words("sensitivity", sensitivity),
            **{name: seconds(name, value) for name, value in times.items()},
        )  # fmt: skip
        complete = request.completed(self.interface.simulate)
        check_memory(complete, self.interface.nx, of_this_machine(), "record fewer points")
        return self.run(request, self._bound(parameters), progress)

    def _with_courses(
        self, numbers: Mapping[str, float | Quantity], courses: Inputs, until: str | None
    ) -> CompiledModel:
        """This model with other inputs and another end built in, and with numbers in the place of those that
        are."""
        choice, built_in = self.compilation.choice, self.artifact.built_in
        fixed = {name: value for name, value in numbers.items() if name in built_in}
        if not courses and not fixed and until is None:
            return self
        wanted = (dict(courses), fixed, until)
        recent = self._driven  # another thread may put its own there at any time
        if recent is None or recent[0] != wanted or not recent[1].compilation.is_current:
            kept = {name: given for name, given in choice.inputs.items() if name not in numbers}
            given = {name: value for name, value in self._given.items() if name not in courses}
            chosen = replace(choice, parameters={**given, **fixed}, inputs={**kept, **courses},
                             until=choice.until if until is None else until)  # fmt: skip
            made = Compilation(self.compilation.source, chosen, self.compilation.roots)
            recent = self._driven = wanted, CompiledModel(made, self.asked_backend)
        return recent[1]

    def run(self, request: Request, parameters: Sequence[float], progress: Progress | None = None) -> Run:
        """Simulate with the array p given."""
        parameters = [float(value) for value in parameters]
        if not request.sensitivity:
            return self._moved(request, parameters, progress)
        from lagc.simulation.sensitivity.sensitivities import directions
        from lagc.simulation.sensitivity.sensitivity import sensitivities

        artifact = self.artifact
        wanted = directions(self.interface, request.sensitivity, artifact.unused, artifact.built_in)
        system = self._loaded.differentiated.model.bind(parameters)
        found = self._moved(request, parameters, progress)
        complete = request.completed(self.interface.simulate)
        sensitivities(system, found, complete, wanted, running(progress))
        return found

    def _moved(self, request: Request, parameters: Sequence[float], progress: Progress | None) -> Run:
        """The motion; with `auto`, begin in NumPy and change to C where that takes longer than compiling
        would."""
        request.completed(self.interface.simulate)
        if self.asked_backend != "auto":
            return self._run(self.asked_backend, request, parameters, progress)
        from lagc.simulation.backends.compile import CannotCompile

        if self.backend == "c":
            try:
                return self._run("c", request, parameters, progress, "compiled before")
            except CannotCompile as error:
                return self._run("numpy", request, parameters, progress, str(error))
        from lagc.simulation.supervision import CompileTimer, SlowRun, compile_time

        system = self._loaded.system("numpy").bind(parameters)
        began = perf_counter()
        start = self._begun(system, request)
        timer = CompileTimer(compile_time(self.interface), progress)
        try:
            reason = "done sooner than C compiles"
            return self._run("numpy", request, parameters, timer, reason, start, perf_counter() - began)
        except SlowRun:
            spent = perf_counter() - began
            if progress is not None:
                progress(0.0)  # it begins again: nothing is kept of what was computed
            try:
                self._loaded.system("c")
            except (CannotCompile, Refused) as error:  # a file that it was made of has changed
                return self._run("numpy", request, parameters, progress, str(error), start, spent)
            return self._run("c", request, parameters, progress, "a long run", start, spent)

    def _run(
        self,
        backend: str,
        request: Request,
        parameters: Sequence[float],
        progress: Progress | None,
        reason: str = "",
        start: Start | None = None,
        spent: float = 0.0,
    ) -> Run:
        from lagc.simulation.initialization.initialize import NoStart
        from lagc.simulation.simulate import simulate

        system = self._loaded.system(backend).bind(parameters)
        try:
            found = simulate(system, request, self.compile_s, running(progress), start, spent)
        except NoStart as none:
            raise self._placed(none) from None
        found.backend_reason = reason
        return Run(**{name: getattr(found, name) for name in names(Solution)})

    def _begun(self, system: System, request: Request) -> Start:
        """Where a run begins, in any backend: they agree bitwise."""
        from lagc.simulation.initialization.initialize import NoStart, begin

        try:
            return begin(system, request)
        except NoStart as none:
            raise self._placed(none) from None

    def rhs(self, t: float, x: Sequence[float], parameters: Mapping[str, Value] | None = None) -> Array:
        """dx/dt at (t, x), x = (q, v) or (q, v, z) with the work integral z: for other integrators.

        Raises ValueError where x has another length, ArithmeticError where the motion is not
        determined there.
        """
        import numpy

        interface, system = self.interface, self._with(parameters)
        state = reals("x", x)
        wanted = interface.nq + interface.nv
        if len(state) not in (wanted, interface.nx):
            raise ValueError(f"x has {len(state)} entries, not {wanted}: {', '.join(self.state_names)}")
        xdot, lam = [0.0] * interface.nx, [0.0] * interface.nc
        full = state + [0.0] * (interface.nx - len(state))
        status = system.rhs(real("t", t), full, xdot, lam)
        if status not in (0, 2):
            raise ArithmeticError(f"the right-hand side has no value at t = {t:g} (status {status})")
        return numpy.array(xdot[: len(state)])

    def start(self, parameters: Mapping[str, Value] | None = None, **starts: Value) -> Array:
        """A consistent start x = (q, v), for other integrators.  Raises Refused where there is none."""
        import numpy

        wanted = Request(starts=bound_starts(self.interface, quantities("starts", starts)))
        found = self._begun(self._with(parameters), wanted)
        return numpy.array(found.x[: self.interface.nq + self.interface.nv])

    def _placed(self, none: NoStart) -> Refused:
        """With its places in the text."""
        from lagc.simulation.initialization.source_spans import placed

        with self.compilation.lock:
            return placed(self.equations, none)

    def matrices(self) -> Matrices:
        """M, h, tau, G, gamma and qdot as SymPy matrices.  Raises ImportError where SymPy is missing."""
        from lagc.reports.equations.matrices import matrices

        with self.compilation.lock:
            return matrices(self.equations)

    @property
    def state_names(self) -> tuple[str, ...]:
        """What x = (q, v) holds."""
        return self.interface.state_names

    def _bound(self, parameters: Mapping[str, Value] | None, demanding: bool = True) -> list[float]:
        given = self._with_given(parameters) if parameters is not None else self._given
        return bound_parameters(self.interface, given, self.artifact.unused, demanding)

    def _with_given(self, parameters: Mapping[str, Value]) -> dict[str, float | Quantity]:
        """The values of this model, with those of `parameters` in their place."""
        more = quantities("parameters", parameters)
        for name in self.artifact.built_in:
            if name in more and more[name] != self._given.get(name):
                fault = Fault("LAG0607", f"`{name}` is built into the compiled model: no run can change it",
                              remedy="give it to `compile(parameters=...)`")  # fmt: skip
                raise Refused([fault])
        return {**self._given, **more}

    def _repr_latex_(self) -> str:
        from lagc.reports.equations.latex import equations_latex

        with self.compilation.lock:
            return equations_latex(self.equations)
