"""The errors of FMUs in FMPy, against runs of lagc to 1e-9."""

from collections.abc import Sequence
from math import inf
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import lagc
from lagc.host import model_library
from tests.fmi.units import archive

MODELS = model_library.library_models()
POINTS = 301
NEAR = 1e-6  # of the time: values so near to an event may be those before it or after it


class Result(NamedTuple):
    """What FMPy says of an FMU and of its runs; the largest error of a state in Co-Simulation and in Model
    Exchange, over the largest magnitude in its scaling group, infinite if the run did not reach its end."""

    model: str
    version: int
    problems: list[str]
    co: float
    exchange: float


def errors(
    model: str,
    folder: Path,
    versions: Sequence[int] = (3, 2),
    horizon: float = inf,
    limit: float | None = None,
) -> list[Result]:
    """Build, validate and simulate the FMUs of a library model, as long as its scene or the horizon; a run
    that takes more than `limit` seconds is a problem."""
    from fmpy.validation import validate_fmu

    system = lagc.load(model).compile()
    stop = min(system.interface.simulate.get("stop", 10.0), horizon)
    run = system.simulate(stop=stop, accuracy=1e-9, points=POINTS)
    if run.status != "ok":  # no such accuracy is reached: the best that the method gives
        run = system.simulate(stop=stop, rtol=1e-12, points=POINTS)
    found = []
    for version in versions:
        path = folder / f"{model.rpartition('/')[2]}{version}.fmu"
        path.write_bytes(archive(model, version, None))
        problems, measured = validate_fmu(str(path)), []
        for kind in ("CoSimulation", "ModelExchange"):
            try:
                measured.append(_simulated(str(path), kind, run, system.interface, limit))
            except Exception as error:  # of FMPy, which has no other class
                problems.append(f"{kind}: {error}")
                measured.append(inf)
        found.append(Result(model, version, problems, *measured))
    return found


def _simulated(path: str, kind: str, run: Any, interface: Any, limit: float | None) -> float:
    """Return the error of a run in FMPy.  Raises Exception if it does not reach its end."""
    import fmpy

    end = float(run.t[-1])
    names = fmu_names(fmpy.read_model_description(path))
    result = fmpy.simulate_fmu(
        path, fmi_type=kind, stop_time=end, output=list(names.values()), timeout=limit,
        output_interval=end / (POINTS - 1), relative_tolerance=1e-10, record_events=False,
    )  # fmt: skip
    reached = result["time"][-1]
    if end - reached > NEAR * (1.0 + end):
        raise TimeoutError(f"ends at {reached:.6g} s of {end:g} s")
    return _error(run, result, interface, names)


def fmu_names(about: Any) -> dict[str, str]:
    """The names of the variables of an FMU, by those of lagc."""
    return {v.name.strip("'").replace("\\'", "'"): v.name for v in about.modelVariables}


def _error(run: Any, result: Any, interface: Any, names: dict[str, str]) -> float:
    events = np.array([0.0, *(event.t for event in run.events)])
    apart = np.abs(result["time"][:, None] - events).min(axis=1) > NEAR * (1.0 + run.t[-1])
    size = dict.fromkeys(interface.kinds, 0.0)
    for name, kind in zip(interface.state_names, interface.kinds):
        size[kind] = max(size[kind], np.abs(run[name]).max())
    worst = 0.0
    for name, kind in zip(interface.state_names, interface.kinds):
        own = np.interp(result["time"], run.t, run[name]) if len(result) != len(run.t) else run[name]
        off = np.abs(result[names[name.replace(", ", ",")]] - own)[apart]
        worst = max(worst, float(off.max()) / (size[kind] or 1.0))
    return worst
