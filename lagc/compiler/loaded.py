"""The backends of a compiled model: what is loaded, once for all that use it."""

from __future__ import annotations

from time import perf_counter
from typing import TYPE_CHECKING

from lagc.base.records import RLock, once
from lagc.compiler.pipeline import Compilation
from lagc.simulation.system import System

if TYPE_CHECKING:
    from lagc.simulation.backends.python import NumpySystem


class Loaded:
    """What is compiled and loaded of a model, for all that is bound to it.

    `artifact` is that of the backend `first`; `seconds` is what compiling took.  It pickles as these and
    the source: where it arrives, another backend may come first.
    """

    def __init__(self, compilation: Compilation, backend: str):
        self.compilation, self.asked = compilation, backend
        self.lock = RLock()
        self.systems: dict[str, System] = {}
        began = perf_counter()
        self.preferred = self.first = self._preferred()
        self.artifact = compilation.artifact(self.first)
        self.seconds = perf_counter() - began

    def __getstate__(self) -> dict[str, object]:
        kept = ("compilation", "asked", "first", "artifact", "seconds")
        return {name: getattr(self, name) for name in kept}

    def __setstate__(self, state: dict[str, object]) -> None:
        vars(self).update(state, lock=RLock(), systems={})
        self.preferred = self._preferred()

    @property
    def backend(self) -> str:
        """The backend that is loaded, C before NumPy; else the one that will be first."""
        if self.asked != "auto":
            return self.asked
        return next((b for b in ("c", "numpy") if b in self.systems), self.preferred)

    def system(self, backend: str) -> System:
        """With the model's own values."""
        found = self.systems.get(backend)
        if found is not None:
            return found
        with self.lock:
            if backend not in self.systems:
                from lagc.simulation.backends import load

                began = perf_counter()
                artifact = self.artifact if backend == self.first else self.compilation.artifact(backend)
                self.systems[backend] = load(artifact.interface, artifact.sources, backend, artifact.code)
                self.seconds += perf_counter() - began
            return self.systems[backend]

    @once
    def differentiated(self) -> NumpySystem:
        """With derivatives, in Python."""
        from lagc.simulation.backends.python import NumpySystem

        has = self.compilation.differentiates
        found = (self if has else Loaded(self.compilation.differentiated, "numpy")).system("numpy")
        assert isinstance(found, NumpySystem)
        return found

    def _preferred(self) -> str:
        """With `auto`, C where the compiled library is in the cache, else NumPy to begin with."""
        if self.asked != "auto":
            return self.asked
        from lagc.simulation.backends.compile import cached_library

        artifact = self.compilation.cached_artifact("c")
        return "c" if artifact is not None and cached_library(artifact.sources) else "numpy"
