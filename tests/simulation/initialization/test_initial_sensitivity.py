"""What consistent starts change by: differences of the starts that are found."""

from collections.abc import Callable
from random import Random
from typing import Any

import numpy as np
import pytest

import lagc

pytestmark = pytest.mark.usefixtures("own_cache")

SWUNG = """model M
  parameter Length l = 0.5 [m], A = 0.1 [m]; parameter Frequency f = 2;
  coordinate Length x(start = 0.3 [m]), z;
  body b = Particle(mass = 1 [kg], at = {x, 0, z});
  constraint s: (x - A*sin(f*time))^2 + z^2 = l^2;
end M;"""


def _random(seed: int) -> tuple[str, dict[str, float]]:
    """Three coordinates, the first of them stated, under one or two random conditions, and the parameters."""
    random = Random(seed)
    values = {f"p[{k}]": random.uniform(0.5, 2.0) for k in range(1, 5)}
    a, b, c = (random.uniform(0.5, 1.5) for _ in range(3))
    rows = [f"{a!r}*x^2 + {b!r}*y*z + sin({c!r}*z) + y = p[2] + x*p[3]*(z + sin(time/(1 [s])))"]
    if random.random() < 0.5:
        rows.append(f"der(x) - {b!r}*der(y)*cos(x*p[3]) = {c!r}*p[4]*1 [1/s] + z*der(z)")
    constraints = "\n".join(f"  constraint c{k}: {row};" for k, row in enumerate(rows))
    listed = ", ".join(repr(value) for value in values.values())
    text = (
        f"model M\n  parameter Real p[4] = {{{listed}}};\n"
        "  coordinate Real x(start = 0.3*p[1], rate = p[4]*1 [1/s]), y, z;\n"
        "  body b = Particle(mass = 1 [kg], at = {x, y, z}*1 [m]);\n"
        f"{constraints}\nend M;"
    )
    return text, values


@pytest.mark.sample(0, 6)
@pytest.mark.parametrize("seed", range(-1, 12))
def test_where_the_search_has_a_choice(seed: int) -> None:
    """By differences of fourth order of the starts themselves."""
    text, values = _random(seed) if seed >= 0 else (SWUNG, {"l": 0.5, "A": 0.1, "f": 2.0})
    model = lagc.loads(text).compile(backend="numpy")
    run = model.simulate(0.0, sensitivity=list(values))
    assert run.status == "ok", run.message
    for name, value in values.items():

        def start(way: float, name: str = name, value: float = value) -> np.ndarray:
            there = model.simulate(0.0, parameters={name: value * (1.0 + way)})
            return np.array([there[column][0] for column in model.state_names])

        def difference(
            step: float, value: float = value, start: Callable[[float], np.ndarray] = start
        ) -> Any:
            ways = (start(-2.0 * step), start(-step), start(step), start(2.0 * step))
            return (ways[0] - ways[3] + 8.0 * (ways[2] - ways[1])) / (12.0 * step * value)

        coarse, fine = difference(2e-3), difference(1e-3)
        found = np.array([run.sensitivity(column, name)[0] for column in model.state_names])
        doubt = np.abs(fine - coarse).max() + 1e-10 * (1.0 + np.abs(fine).max())
        assert np.abs(found - fine).max() <= doubt, name


@pytest.mark.full
def test_one_without_a_derivative_leaves_the_others() -> None:
    text = SWUNG.replace("), z;", "), z(start = -0.4 [m]), w(start = 1 [m], fixed = true);").replace(
        "end M", "  body c = Particle(mass = 1 [kg], at = {0, w, 0});\n  constraint h: w = 1 [m];\nend M"
    )
    run = lagc.loads(text).compile(backend="numpy").simulate(1.0, points=3, sensitivity=["start(w)", "f"])
    assert run.status == "failed" and "start(w)" in run.message
    assert np.isnan(run.sensitivity("x", "start(w)")).all()
    assert np.isfinite(run.sensitivity("x", "f")).all()


def test_an_array_stands_for_its_entries() -> None:
    text = """model Two
      parameter Length l[2] = {1, 2} [m];
      coordinate Angle th[2](each start = 0.1 [rad]);
      for i in 1:2 loop
        body b[i] = Particle(mass = 1 [kg], at = l[i]*{sin(th[i]), 0, -cos(th[i])});
      end for;
    end Two;"""
    asked = ["l", "start(th)", "start(der(th))", "l[1]"]
    run = lagc.loads(text).compile(backend="numpy").simulate(0.1, points=2, sensitivity=asked)
    assert run.sensitivities is not None
    assert [d.name for d in run.sensitivities.directions] == [
        *("l[1]", "l[2]", "start(th[1])", "start(th[2])", "start(der(th[1]))", "start(der(th[2]))")
    ]
