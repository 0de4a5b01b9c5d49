"""The backends of a compiled model, loaded once for all that use it, and the choice between them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING

from lagc.base.records import RLock, once, replace
from lagc.compiler.pipeline import Compilation
from lagc.diagnostics.faults import Refused
from lagc.host.budgets import running
from lagc.kernels import DEFAULT_METHOD, IMPLICIT, SERIES
from lagc.simulation.system import System

if TYPE_CHECKING:
    from lagc.simulation.backends.python import NumpySystem
    from lagc.simulation.initialization.initialize import NoStart
    from lagc.simulation.initialization.result import Start
    from lagc.simulation.request import Request
    from lagc.simulation.solution import Solution

Progress = Callable[[float], None]
FUNCTIONS = "functions"  # C that evaluates
FOLLOWING = 50.0  # runs that a second run of a model lets expect


class Loaded:
    """The code of a model, compiled and loaded, for all systems with different parameters. `artifact` is that
    of the target `first`; `seconds` is the time of compilation so far.  It has one method of integration;
    `root` is that with the default method.  Pickles without the loaded code: on another machine, another
    backend may come first."""

    def __init__(self, compilation: Compilation, backend: str, root: Loaded | None = None):
        self.compilation, self.asked = compilation, backend
        self.lock = RLock()
        self.systems: dict[str, System] = {}  # by target
        self.root = root or self
        self.others: dict[str, Loaded] = {}  # of a root, by method
        self.followers: dict[tuple[str, tuple[int, ...] | None], System] = {}  # with what sensitivities need
        self.held_systems: dict[tuple[int, ...], NumpySystem] = {}  # by the modes of contacts
        self.probed: dict[tuple[str, ...], System] = {}  # of a root, by the expressions of probes
        self.numpy_s = 0.0  # the longest run of `auto` in NumPy so far
        began = perf_counter()
        self.preferred = self._preferred_backend()
        self.first = FUNCTIONS if self.preferred == "c" and not self._is_built() else self.preferred
        self.artifact = compilation.artifact(self.first)
        self.seconds = perf_counter() - began

    def __getstate__(self) -> dict[str, object]:
        kept = ("compilation", "asked", "first", "artifact", "seconds", "root")
        return {name: getattr(self, name) for name in kept}

    def __setstate__(self, state: dict[str, object]) -> None:
        vars(self).update(
            state, lock=RLock(), systems={}, numpy_s=0.0, followers={}, others={}, held_systems={}, probed={}
        )
        self.preferred = self._preferred_backend()

    @property
    def backend(self) -> str:
        """The backend that is loaded (C before NumPy), or else the first that will be."""
        if self.asked != "auto":
            return self.asked
        return next((b for b in ("c", "numpy") if b in self.systems), self.preferred)

    def system(self, target: str) -> System:
        """Return the system of a backend, or that of FUNCTIONS, with the model's own parameter values."""
        found = self.systems.get(target)
        if found is not None:
            return found
        with self.lock:
            if target not in self.systems:
                from lagc.simulation.backends import load

                began = perf_counter()
                artifact = self.artifact if target == self.first else self.compilation.artifact(target)
                backend = "c" if target == FUNCTIONS else target
                found = load(artifact.interface, artifact.sources, backend, artifact.code, self._another)
                self.systems[target] = found
                self.seconds += perf_counter() - began
            return self.systems[target]

    def evaluating(self, backend: str) -> System:
        """Return the system of `backend` for evaluations.  In C it has no integrator, which takes most of the
        time of the C compiler, unless that is compiled already; runs of it are those of `system("c")`."""
        lean = (
            backend == "c" and "c" not in self.systems and (FUNCTIONS in self.systems or not self._is_built())
        )
        return self.system(FUNCTIONS if lean else backend)

    @once
    def differentiated(self) -> NumpySystem:
        """Return the system with derivatives, in Python."""
        from lagc.simulation.backends.python import NumpySystem

        found = Loaded(self.compilation.differentiated, "numpy").system("numpy")
        assert isinstance(found, NumpySystem)
        return found

    def in_modes(self, modes: tuple[int, ...]) -> Compilation:
        """Return the compilation that holds contacts in these modes."""
        own = self.compilation
        return Compilation(own.source, replace(own.choice, contact_modes=modes), own.roots)

    def in_contact_modes(self, modes: tuple[int, ...]) -> NumpySystem:
        """Return the system with derivatives that holds its contacts in these modes."""
        from lagc.simulation.backends.python import NumpySystem

        with self.lock:
            if modes not in self.held_systems:
                found = Loaded(self.in_modes(modes).differentiated, "numpy").system("numpy")
                assert isinstance(found, NumpySystem)
                self.held_systems[modes] = found
            return self.held_systems[modes]

    def sensitive(self, backend: str, modes: tuple[int, ...] | None = None) -> System:
        """Return the system that follows sensitivities: in C for a run in C, and for `auto` with a compiler.
        It holds contacts in `modes`."""
        own = self.compilation if modes is None else self.in_modes(modes)
        with self.lock:
            if (backend, modes) not in self.followers:
                self.followers[backend, modes] = self._compiled(
                    backend == "c", lambda kind: Loaded(own.sensitive, kind).system(kind)
                )
            return self.followers[backend, modes]

    def for_steps(self) -> System:
        """Return the system for many short calls."""
        return self._compiled(False, self.system)

    def _compiled(self, wanted: bool, load: Callable[[str], System]) -> System:
        """Return the system that `load` returns for a backend: C if it is `wanted` or asked for, and for
        `auto` with a compiler."""
        from lagc.simulation.backends.compile import CannotCompile
        from lagc.simulation.supervision import has_compiler

        if wanted or self.asked == "c" or (self.asked == "auto" and has_compiler()):
            try:
                return load("c")
            except CannotCompile:
                if self.asked == "c":
                    raise
        return load("numpy")

    def taking(self, method: str) -> Loaded:
        """Return the same model with this method of integration."""
        root = self.root
        if method == DEFAULT_METHOD:
            return root
        with root.lock:
            if method not in root.others:
                root.others[method] = Loaded(self.compilation.taking(method), self.asked, root)
            return root.others[method]

    def _another(self, backend: str, method: str) -> System:
        """Return the system of `backend` with this method."""
        return self.taking(method).system(backend)

    def simulate(
        self, request: Request, parameters: Sequence[float], progress: Progress | None = None
    ) -> Solution:
        """Return the motion. The backend `auto` takes C if the library is in the cache, or if the model ran
        before in this process and compiling takes less time than fifty such runs.  Otherwise the run starts
        in NumPy, and changes to C when it has taken as long as compiling would."""
        request.completed(self.artifact.interface.simulate)  # refuses before anything is compiled
        # Methods that are not carried by the usual code need a library of their own, which is the same model
        # taken again.
        own = self.taking(request.method or DEFAULT_METHOD)
        if own is not self:
            return own.simulate(request, parameters, progress)
        if self.asked != "auto":
            return self._run(self.asked, request, parameters, progress)
        from lagc.simulation.backends.compile import CannotCompile

        # Compiled before: C is faster in any case.
        if self.backend == "c":
            try:
                return self._run("c", request, parameters, progress, "compiled before")
            except CannotCompile as error:
                return self._run("numpy", request, parameters, progress, str(error))
        from lagc.simulation.supervision import CompileTimer, SlowRun, compile_time, has_compiler

        # Runs in NumPy so far show what a run costs; fifty of them are worth a compilation.
        if FOLLOWING * self.numpy_s > compile_time(self.artifact.interface) and has_compiler():
            try:
                self.system("c")
            except (CannotCompile, Refused) as error:  # Refused: an imported file has changed
                self.numpy_s = 0.0
                return self._run("numpy", request, parameters, progress, str(error))
            return self._run("c", request, parameters, progress, "a repeated run")
        # NumPy begins at once. A timer ends the run when it has taken as long as compiling would: at most
        # twice the better of both (the ski rental problem).
        system = self.system("numpy").bind(parameters)
        began = perf_counter()
        start = self.initialize(system, request)
        timer = CompileTimer(compile_time(self.artifact.interface), progress)
        try:
            reason = "faster than compiling C"
            run = self._run("numpy", request, parameters, timer, reason, start, perf_counter() - began)
            self.numpy_s = max(self.numpy_s, perf_counter() - began)
            return run
        except SlowRun:
            spent = perf_counter() - began
            if progress is not None:
                progress(0.0)  # the run starts again from its initial state
            try:
                self.system("c")
            except (CannotCompile, Refused) as error:  # Refused: an imported file has changed
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
    ) -> Solution:
        from lagc.simulation.initialization.initialize import NoStart
        from lagc.simulation.simulate import simulate

        system = self.system(backend).bind(parameters)
        try:
            implicit, series = [None if request.sensitivity else partial(self._another, backend, method)
                                for method in (IMPLICIT[0], SERIES[0])]  # fmt: skip
            found = simulate(system, request, self.seconds, running(progress), start, spent, implicit, series)
        except NoStart as error:
            raise self._with_places(error) from None
        found.backend_reason = reason
        return found

    def initialize(self, system: System, request: Request) -> Start:
        """Return the initial state of a run; all backends give the same bits. Raises Refused if there is
        none."""
        from lagc.simulation.initialization.initialize import NoStart, begin

        try:
            return begin(system, request)
        except NoStart as error:
            raise self._with_places(error) from None

    def _with_places(self, error: NoStart) -> Refused:
        """Return the error with its places in the model text."""
        from lagc.compiler.source_spans import placed

        with self.compilation.lock:
            return placed(self.compilation.equations, error)

    def _preferred_backend(self) -> str:
        """Return the backend that `auto` begins with: C if the compiled library is in the cache, else
        NumPy."""
        if self.asked != "auto":
            return self.asked
        return "c" if self._is_built() else "numpy"

    def _is_built(self) -> bool:
        """Return whether the compiled library for runs is in the cache."""
        from lagc.simulation.backends.compile import cached_library

        artifact = self.compilation.cached_artifact("c")
        return artifact is not None and cached_library(artifact.sources)
