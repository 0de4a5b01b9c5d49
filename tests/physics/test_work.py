"""In every model, energy at the start + the work of each action = energy at the end.

The power of each action is an output. Its work is summed by Boole's rule, apart from the run's own integral.
"""

from __future__ import annotations

import pytest

import lagc
from lagc.compiler.pipeline import Choice, Compilation
from lagc.host.model_library import read
from tests.physics.library import scenes

np = pytest.importorskip("numpy")

POINTS = 801
SPAN = 0.5  # s, at most
BOOLE = (7.0, 32.0, 12.0, 32.0, 7.0)  # 4 intervals, of 2/45 (M. Abramowitz, I. Stegun, 1964, eq. 25.4.14)


def _integral(values: list[float], step: float) -> float:
    parts = np.array(values[:-1]).reshape(-1, 4)
    ends = np.append(parts[1:, 0], values[-1])
    sums = parts @ np.array(BOOLE[:4]) + BOOLE[4] * ends
    return float(2.0 / 45.0 * step * sums.sum())


CASES = scenes()


@pytest.mark.sample(0, 12)
@pytest.mark.parametrize(("name", "scene"), CASES, ids=[f"{n}-{s}" for n, s in CASES])
def test_energy_changes_by_the_work_of_each_action(name: str, scene: str) -> None:
    source = read(name)
    equations = Compilation(source, Choice(scene=scene)).equations
    actions = [c.name for c in equations.contributions if not c.conservative]
    if not actions:
        return
    asked = [f"  output Power power__{k} = power({action});" for k, action in enumerate(actions)]
    head, end, tail = source.text.rpartition("\nend ")
    model = lagc.loads("\n".join([head, *asked]) + end + tail, source.name)
    system = model.compile(scene, backend="numpy")
    stop = min(SPAN, float(system.interface.simulate.get("stop", SPAN)))
    run = system.simulate(stop, accuracy=1e-9, points=POINTS)
    assert run.status == "ok", run.message
    if run.events:
        return  # which change the energy, or let a power jump
    works = [_integral(run.column(f"power__{k}"), stop / (POINTS - 1)) for k in range(len(actions))]
    size = max(abs(run.energy.start), abs(run.energy.end), *map(abs, works))
    assert run.energy.end - run.energy.start == pytest.approx(sum(works), abs=1e-7 * size)
