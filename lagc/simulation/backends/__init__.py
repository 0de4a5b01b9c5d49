"""Backends: from the generated code of a model to a `System`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import CodeType

from lagc.lowering.program import Interface
from lagc.simulation.backends.base import Another, Compiled
from lagc.simulation.system import System


def load(
    interface: Interface, sources: Mapping[str, str], backend: str, code: Sequence[CodeType] = (),
    another: Another | None = None,
) -> System:  # fmt: skip
    """Return the system that `sources` (file name -> text, for `backend`) define, with the model's own
    values. `bind` gives it other values.  `code` is the compiled text of the NumPy module, if it is known;
    `another` returns the system of a backend with a method of integration that this code lacks.
    Raises CannotCompile (`lagc.simulation.backends.compile`) if the C compiler is missing or fails."""
    if backend == "c":
        from lagc.simulation.backends.c import CModel

        library = CModel(interface, sources)
        library.functions  # noqa: B018  compiles
        model: Compiled = library
    else:
        from lagc.simulation.backends.python import NumpyModel

        model = NumpyModel(interface, sources, code)
    model.another = another
    return model.bind(model.defaults())
