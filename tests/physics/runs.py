"""Runs of library models for the tests of physics."""

import lagc
from lagc.api import Run


def motion(name: str, stop: float, scene: str | None = None, points: int = 101, accuracy: float = 1e-10,
           starts: dict[str, float] | None = None, **parameters: float) -> Run:  # fmt: skip
    """The motion of a model of the library, that has to arrive."""
    system = lagc.load(name).compile(scene)
    run = system.simulate(stop, accuracy=accuracy, points=points, parameters=parameters, starts=starts)
    assert run.status == "ok", run.message
    return run


def spread(values: object) -> float:
    """Largest minus smallest."""
    import numpy

    array = numpy.asarray(values)
    return float(array.max() - array.min())
