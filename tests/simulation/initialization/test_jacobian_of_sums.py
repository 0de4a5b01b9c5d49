"""Derivatives of conditions on sums, put together from parts: against closed forms, and counted."""

import numpy as np
import pytest

import lagc
from lagc.compiler import pipeline
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Source
from lagc.lowering.jacobians import condition_slopes
from lagc.simulation.backends.python import NumpySystem
from lagc.simulation.initialization.initialize import consistent_start

N = 18
TEXT = """model Way
  structural Integer n = 18;
  coordinate Angle x[n](each start = 0.3);
  point P[0] = {0, 0, 0};
  for i in 1:n loop
    body b[i] = Particle(mass = 1 [kg], at = {x[i], 0, 0}*(1 [m]));
    point P[i] = P[i-1] + {sin(x[i]), 0, cos(x[i])}*(1 [m]);
  end for;
initial
  for i in 1:n loop
    P[i].x*P[i].z = 0;
    der(P[i].x) = 0;
  end for;
end Way;
"""


@pytest.fixture(scope="module")
def way() -> lagc.CompiledModel:
    compiled = lagc.loads(TEXT).compile()
    assert compiled.interface.part_ends
    return compiled


def test_derivatives_by_parts_are_the_closed_forms(way: lagc.CompiledModel) -> None:
    random = np.random.default_rng(5)
    x, v = random.uniform(-1.0, 1.0, (2, N))
    c, slopes, _ = way.load("numpy").conditions(0.0, [*x, *v])
    found, interface = np.zeros((2 * N, 2 * N)), way.interface
    for row in range(2 * N):
        for k in interface.condition_entries(row):
            found[row, interface.condition_columns[k]] = slopes[k]
    along, up = np.cumsum(np.sin(x)), np.cumsum(np.cos(x))
    before, none = np.tri(N), np.zeros((N, N))
    product = before * (np.outer(up, np.cos(x)) - np.outer(along, np.sin(x)))
    expected = np.empty((2 * N, 2 * N))
    expected[0::2] = np.hstack([product, none])
    expected[1::2] = np.hstack([-before * np.sin(x) * v, before * np.cos(x)])
    assert np.allclose(found, expected, rtol=0.0, atol=1e-14 * N)
    assert np.allclose(c[0::2], along * up, rtol=0.0, atol=1e-14 * N**2)
    assert np.allclose(c[1::2], np.cumsum(np.cos(x) * v), rtol=0.0, atol=1e-14 * N)


def test_both_languages_put_the_same_bits_together(way: lagc.CompiledModel) -> None:
    y = np.random.default_rng(6).uniform(-1.0, 1.0, 2 * N).tolist()
    assert way.load("numpy").conditions(0.0, y) == way.load("c").conditions(0.0, y)


def test_there_are_as_many_parts_as_the_model_is_long() -> None:
    counts = []
    for n in (N, 2 * N, 4 * N):
        model = pipeline.resolve(pipeline.parse(Source("m.lag", TEXT)), Choice(parameters={"n": n}))
        slopes = condition_slopes(pipeline.derive(model))
        counts.append(sum(len(own) for own in (*slopes.rows, *slopes.sums)))
    one, two, four = counts
    assert four - two == 2 * (two - one)


@pytest.mark.full
def test_what_cannot_be_left_as_guessed_is_found_in_few_evaluations(monkeypatch: pytest.MonkeyPatch) -> None:
    """Far down a ladder, speeds move by traces that its rungs need: that shows at whole steps."""
    count, evaluate = 0, NumpySystem.conditions

    def counted(self: NumpySystem, t: float, x: list[float]) -> tuple[list[float], list[float], list[float]]:
        nonlocal count
        count += 1
        return evaluate(self, t, x)

    monkeypatch.setattr(NumpySystem, "conditions", counted)
    system = lagc.load("large/truss").compile(parameters={"n": 20}, backend="numpy").load("numpy")
    found = consistent_start(system)
    rungs = system.conditions(0.0, found.x)[0]
    assert max(map(abs, rungs)) < 1e-12 and count < 40
