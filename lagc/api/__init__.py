"""The Python interface: load a model, compile a scene, simulate.

    model = lagc.load("pendulum.lag")
    system = model.compile(scene="room", backend="c")
    run = system.simulate(stop=10, accuracy=1e-8, parameters={"l": 0.7})
    run.t, run["theta"], run.plot(), run.save("run.npz")

Numbers are in SI units; a pair such as (70, "cm") is a number with a unit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from lagc.api.cost import Measurable
from lagc.api.derivatives import Differentiable
from lagc.api.effects import Comparable, without
from lagc.api.fit import Fittable
from lagc.api.run import Run
from lagc.api.stepper import Steppable
from lagc.api.sweep import Sweepable
from lagc.api.values import Input, Value, condition, quantities, real, reals, seconds, separate, word, words
from lagc.base.records import dataclass, names, replace
from lagc.base.text import Quantity
from lagc.compiler.loaded import Loaded
from lagc.compiler.pipeline import Compilation
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Fault, Source
from lagc.host import model_library
from lagc.host.budgets import of_this_machine, running
from lagc.simulation.request import (
    Request,
    bound_guesses,
    bound_parameters,
    bound_scales,
    bound_starts,
    keep_limits,
)
from lagc.simulation.solution import Solution
from lagc.simulation.supervision import check_memory
from lagc.simulation.system import System

if TYPE_CHECKING:
    from lagc.lowering.program import Program
    from lagc.mechanics.formulation.equations import EquationsOfMotion
    from lagc.reports.derivation.derivation import Derivation
    from lagc.reports.equations.script import Matrices
    from lagc.semantics.model import Model
    from lagc.semantics.scenes import Inputs
    from lagc.simulation.solution import Array

Progress: TypeAlias = Callable[[float], None]

LONGEST = 4000  # characters of LaTeX that a notebook shows; browsers hang on many more


def load(path: str) -> ModelFile:
    """Read the model file `path`, or the library model of that name (such as `simple_pendulum`).

    Raises Refused if the file cannot be read.  `ModelFile.compile` and `ModelFile.check` report errors in
    the text."""
    return ModelFile(model_library.read(str(path)))


def loads(text: str, name: str = "<text>") -> ModelFile:
    """Return a model from its text; messages call it `name`."""
    return ModelFile(Source(name, text))


@dataclass(frozen=True)
class ModelFile:
    """The text of a model, not yet compiled."""

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
        outputs: str | Sequence[str] | None = None,
        backend: str = "auto",
    ) -> CompiledModel:
        """Compile one scene of one model and return it.

        scene, model: their names; the first scene and the only model by default.
        use, without: names of effects that are added to the scene or left out.
        parameters: values for every run, unless a run gives others: SI numbers, or pairs such as (70,
            "cm").  Structural parameters (integers that set sizes) become part of the code.
        inputs: for each input a number, the text of an expression, a column of a file ("drive.csv:u"), or
            points over time in SI units: (t, values) or (t, values, "cubic").  All but numbers become part
            of the code.
        until: a condition such as "x > 3 [m]" that ends a run when it becomes true.
        outputs: names of outputs and coordinates; what none of them depends on is left out.
        backend: "c", "numpy", or "auto" (C if a compiler is found and the run is long enough).

        Raises Refused with all errors of the model or of the arguments, ValueError for an unknown backend.
        """
        # Words and numbers are checked here; names of the model are not known before it is resolved, and are
        # refused then.
        if backend not in ("auto", "c", "numpy"):
            raise ValueError(f"there is no backend {backend!r}: auto, c or numpy")
        given = quantities("parameters", parameters)
        numbers, courses = separate(inputs)
        choice = Choice(
            word("model", model), word("scene", scene), words("use", use), words("without", without),
            {**given, **numbers}, courses, condition(until),
            None if outputs is None else words("outputs", outputs),
        )  # fmt: skip
        return CompiledModel(Compilation(self.source, choice), backend)

    def derivation(self, language: str = "en", *, full: bool = False) -> Derivation:
        """Return the worked solution of the first scene; see `CompiledModel.derivation`."""
        return self.compile().derivation(language, full=full)

    def check(self) -> list[Fault]:
        """Return the errors and warnings of the text, for all its models and scenes.

        If a stage finds errors, later stages are not checked.  The stages are the syntax, names and
        dimensions, the equations, and the initial conditions."""
        from lagc.compiler.checking import check

        return check(self.source, Choice())

    def _repr_latex_(self) -> str:
        return self.compile()._repr_latex_()


class CompiledModel(Differentiable, Measurable, Comparable, Sweepable, Fittable, Steppable):
    """A compiled scene of a model: its equations, its code, and the methods that simulate and linearize it.

    Compiled code comes from the cache if it is there; other stages run only if they are needed.  An
    instance never changes: parameters belong to a run, or to a new instance made by `bind`.  Any number of
    threads may use one instance.  It can be pickled."""

    def __init__(self, compilation: Compilation, backend: str = "auto"):
        self._loaded = Loaded(compilation, backend)
        self._given = compilation.choice.parameters
        self._own: dict[System, System] = {}  # with the parameters of this model
        self._recent: System | None = None
        self._driven: tuple[object, CompiledModel] | None = None

    def bind(self, parameters: Mapping[str, Value]) -> CompiledModel:
        """Return this model with other default values of parameters; nothing is compiled again.

        Raises Refused if a name is unknown, or a value is out of its bounds or part of the code.
        """
        bound = CompiledModel.__new__(CompiledModel)
        bound._loaded = self._loaded
        bound._given = self._with_given(parameters)
        bound._own, bound._recent, bound._driven = {}, None, None
        bound_parameters(self.interface, bound._given, self.artifact.unused, demanding=False)
        if self.interface.limits:
            keep_limits(bound.system)
        return bound

    def without(self, effects: Sequence[str]) -> CompiledModel:
        """Return the scene without these effects; parameters that it does not have are dropped.

        Raises Refused if there is no such effect, or if the scene needs one of them."""
        made = CompiledModel.__new__(CompiledModel)
        made._loaded, made._given = without(self._loaded, self._given, effects)
        made._own, made._recent, made._driven = {}, None, None
        return made

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
        """The stages of the compiler, from the text to the code."""
        return self._loaded.compilation

    @property
    def asked_backend(self) -> str:
        """The backend as it was asked for: "auto", "c" or "numpy"."""
        return self._loaded.asked

    @property
    def compile_s(self) -> float:
        """The time of compilation so far, in s."""
        return self._loaded.seconds

    @property
    def model(self) -> Model:
        """The model with all names resolved."""
        return self.compilation.model

    @property
    def equations(self) -> EquationsOfMotion:
        """The equations of motion as expressions."""
        return self.compilation.equations

    @property
    def program(self) -> Program:
        """The functions that the code generators print, with their operation counts."""
        return self.compilation.program

    @property
    def operations(self) -> int:
        """The number of arithmetic operations of one right-hand side."""
        return self.interface.operations

    @property
    def backend(self) -> str:
        """The backend that is loaded, or that will be loaded first: "c" or "numpy"."""
        return self._loaded.backend

    @property
    def state_names(self) -> tuple[str, ...]:
        """The names of the entries of x = (q, v): coordinates, then speeds."""
        return self.interface.state_names

    @property
    def system(self) -> System:
        """The loaded system with the parameters of this model; NaN for parameters without a value."""
        return self._with_own(self._loaded.evaluating(self.backend))

    def load(self, backend: str) -> System:
        """Return the system of `backend` ("c" or "numpy") with the parameters of this model; compile it if
        needed."""
        return self._with_own(self._loaded.system(backend))

    def _with_own(self, system: System) -> System:
        found = self._own.get(system)
        if found is None:
            found = self._own.setdefault(system, system.bind(self._bound(None, demanding=False)))
        return found

    def _with(self, parameters: Mapping[str, Value] | None) -> System:
        """Return the system for one call, with `parameters` in place of those of this model."""
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
        method: str | None = None, rtol: float | None = None, atol: float | None = None,
        step: Value | None = None, max_step: Value | None = None,
        every: Value | None = None, points: int | None = None,
        parameters: Mapping[str, Value] | None = None,
        inputs: Mapping[str, Input] | None = None, until: str | None = None,
        starts: Mapping[str, Value] | None = None, guesses: Mapping[str, Value] | None = None,
        scales: Mapping[str, Value] | None = None, sensitivity: str | Sequence[str] = (),
        progress: Progress | None = None) -> Run:  # fmt: skip
        """Simulate from t = 0 to `stop` and return the motion.

        stop: the end time in s.
        accuracy: the global relative error of each coordinate, speed and output at the recorded times
            (default 1e-6).  Method and tolerance are chosen, and the error is estimated by comparing runs.
        method, rtol, atol, step: choose the integration method and its tolerances, or a fixed step in s,
            instead of an accuracy; the error is not estimated then.
        max_step: the longest step in s.
        every, points: the interval in s, or the number, of the recorded points (default 501 points).  They
            do not change the steps.
        parameters: values for this run, as for `ModelFile.compile`.
        inputs, until: as for `ModelFile.compile`.  A number costs nothing; anything else is compiled,
            unless the last run had the same.
        starts: initial values of coordinates and speeds by name, in place of those of the model.
        guesses: where to search for initial values, by name.  They are not stated then: not even where the
            model states them.
        scales: what the accuracy is relative to, by name of a coordinate, speed or output.  The default is
            the range of its values over the motion.
        sensitivity: names of parameters, inputs and initial values (`start(theta)`) to differentiate by.
        progress: a function that is called with the time reached.

        Arguments that are not given have the values of the scene, or else their defaults.  A failed run keeps
        the results so far, and says why in `status` and `message`.  Raises Refused if an argument is invalid
        or there is no consistent initial state."""
        # Courses of inputs and a condition `until` are part of the code: another model runs with them.
        if inputs is not None or until is not None:
            numbers, courses = separate(inputs)
            return self._with_courses(numbers, courses, condition(until)).simulate(
                stop, accuracy=accuracy, method=method, rtol=rtol, atol=atol, step=step, max_step=max_step,
                every=every, points=points, parameters={**quantities("parameters", parameters), **numbers},
                starts=starts, guesses=guesses, scales=scales, sensitivity=sensitivity, progress=progress,
            )  # fmt: skip
        # All other arguments make a request, which the scene completes, then the defaults.
        given = quantities("starts", starts)
        lengths = {"stop": stop, "step": step, "max_step": max_step, "every": every}
        in_seconds: dict[str, Any] = {name: seconds(name, value) for name, value in lengths.items()}
        request = Request(
            accuracy=accuracy, method=method, rtol=rtol, atol=atol, points=points,
            starts=bound_starts(self.interface, given),
            guesses=bound_guesses(self.interface, quantities("guesses", guesses), given),
            scales=bound_scales(self.interface, quantities("scales", scales)),
            sensitivity=words("sensitivity", sensitivity), **in_seconds,
        )  # fmt: skip
        # Points that would not fit into memory are refused before the run.
        complete = request.completed(self.interface.simulate)
        check_memory(complete, self.interface.nx, of_this_machine(), "record fewer points")
        return self.run(complete, self._bound(parameters), progress)

    def _with_courses(
        self, numbers: Mapping[str, float | Quantity], courses: Inputs, until: str | None
    ) -> CompiledModel:
        """Return this model with other inputs and another end condition in its code."""
        choice, built_in = self.compilation.choice, self.artifact.built_in
        fixed = {name: value for name, value in numbers.items() if name in built_in}
        if not courses and not fixed and until is None:
            return self
        wanted = (dict(courses), fixed, until)
        recent = self._driven  # another thread may set it at any time
        if recent is None or recent[0] != wanted or not recent[1].compilation.is_current:
            kept = {name: given for name, given in choice.inputs.items() if name not in numbers}
            given = {name: value for name, value in self._given.items() if name not in courses}
            chosen = replace(choice, parameters={**given, **fixed}, inputs={**kept, **courses},
                             until=choice.until if until is None else until)  # fmt: skip
            made = Compilation(self.compilation.source, chosen, self.compilation.roots)
            recent = self._driven = wanted, CompiledModel(made, self.asked_backend)
        return recent[1]

    def run(self, request: Request, parameters: Sequence[float], progress: Progress | None = None) -> Run:
        """Simulate a `Request` with the array p of all parameters, then inputs, in SI units."""
        parameters = [float(value) for value in parameters]
        if request.sensitivity:
            from lagc.compiler.run_sensitivities import add_sensitivities, directions_of

            directions_of(self._loaded, request.sensitivity)
        found = self._loaded.simulate(request, parameters, progress)
        run = Run(**{name: getattr(found, name) for name in names(Solution)})
        run.loaded, run.request = self._loaded, request
        if request.sensitivity:
            add_sensitivities(self._loaded, run, request, parameters, running(progress))
        return run

    def check_expressions(self, expressions: Sequence[str]) -> None:
        """Compile expressions for `Run.evaluate`.  Raises Refused for one that is wrong."""
        if expressions:
            from lagc.compiler.probed import compile_probes

            compile_probes(self._loaded, expressions)

    def rhs(self, t: float, x: Sequence[float], parameters: Mapping[str, Value] | None = None) -> Array:
        """Return dx/dt at (t, x) as an array of the length of x, in SI units; for use with other integrators.

        x = (q, v), without the integral z of the work; discrete variables have their start values. Or x is
        (q, v, d), with discrete variables d.  Raises ValueError if x has another length,
        ArithmeticError if the accelerations are not determined there.
        """
        import numpy

        interface, system = self.interface, self._with(parameters)
        names, n, discretes = self.state_names, interface.nq + interface.nv, interface.discretes
        held = system.start()[interface.nx - len(discretes) :] if discretes else []
        if discretes and getattr(x, "__len__", int)() == n + len(discretes):
            names = (*names, *(d.name for d in discretes))
        state = reals("x", x, len(names), names)
        xdot, lam = [0.0] * interface.nx, [0.0] * interface.nc
        full = [*state[:n], *[0.0] * interface.nz, *(state[n:] or held)]
        status = system.rhs(real("t", t), full, xdot, lam)
        if status not in (0, 2):
            raise ArithmeticError(f"the right-hand side has no value at t = {t:g} (status {status})")
        return numpy.array([*xdot[:n], *[0.0] * len(state[n:])])

    def start(self, parameters: Mapping[str, Value] | None = None, **starts: Value) -> Array:
        """Return a consistent initial state x = (q, v) as an array, in SI units.

        `starts` are initial values by name, in place of those of the model.  Raises Refused if there is no
        consistent state.
        """
        import numpy

        wanted = Request(starts=bound_starts(self.interface, quantities("starts", starts)))
        found = self._loaded.initialize(self._with(parameters), wanted)
        return numpy.array(found.x[: self.interface.nq + self.interface.nv])

    def matrices(self) -> Matrices:
        """Return M, h, tau, G, gamma and qdot as SymPy matrices.  Raises ImportError without SymPy."""
        from lagc.reports.equations.script import matrices

        with self.compilation.lock:
            return matrices(self.equations)

    def derivation(self, language: str = "en", *, full: bool = False) -> Derivation:
        """Return the worked solution: from the declarations to the equations, as a person writes it.

        It shows itself in a notebook; `markdown`, `latex` and `html` are its text.  language: "en", "fr" or
        "de".  full: write all terms of long formulas.  Raises ValueError for another language."""
        from lagc.reports.derivation.derivation import derivation_of

        with self.compilation.lock:
            return derivation_of(self.equations, language, full)

    def _repr_latex_(self) -> str:
        from lagc.reports.equations.latex import equations_latex

        with self.compilation.lock:
            text = equations_latex(self.equations)
            count = len(self.equations.v) + len(self.equations.rows)
        return text if len(text) <= LONGEST else f"{count} equations; `lagc equations` prints them"
