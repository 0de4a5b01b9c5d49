"""Coordinates without mass whose rates constraints give: integrals and filters beside the motion."""

import random

import pytest

import lagc
from lagc.diagnostics.faults import Refused
from tests.simulation.programs import BACKENDS

pytestmark = pytest.mark.usefixtures("no_cache")


@pytest.mark.sample(1)
@BACKENDS
@pytest.mark.parametrize("count", [1, 2, 4])
@pytest.mark.parametrize("seed", range(2))
def test_linear_filters_of_an_oscillator(backend: str, count: int, seed: int) -> None:
    """x'' = -k x - c x' - g.y and y' = A y + b x, against the exponential of the matrix; no filter
    needs a force."""
    linalg, np = pytest.importorskip("scipy.linalg"), pytest.importorskip("numpy")
    rng = random.Random(f"{seed} {count}")
    size = 10.0 ** rng.choice([-9, 0, 9])  # of what is filtered: the filters may be in any unit
    k, c = rng.uniform(1.0, 4.0), rng.uniform(0.0, 0.3)
    g = [rng.uniform(-0.3, 0.3) for _ in range(count)]
    a = [[rng.uniform(-0.5, 0.5) - (i == j) for j in range(count)] for i in range(count)]
    b = [rng.uniform(-1.0, 1.0) for _ in range(count)]
    names = [f"y{i}" for i in range(count)]
    rows = []
    for y, row, e in zip(names, a, b):
        side = " + ".join([*(f"{x!r}*{z}" for x, z in zip(row, names)), f"{size * e!r}/(1 [m])*x"])
        rows.append(f"der({y}) = ({side})/(1 [s])" if rng.random() < 0.5 else f"({side})/(1 [s]) = der({y})")
    pull = " + ".join([f"{k!r} [N/m]*x", f"{c!r} [N.s/m]*der(x)",
                       *(f"{h / size!r} [N]*{y}" for h, y in zip(g, names))])  # fmt: skip
    text = f"""model M
      coordinate Length x(start = 1 [m], rate = 0, fixed = true);
      coordinate Real {", ".join(f"{y}(start = {size!r}, startFixed = true)" for y in names)};
      body p = Particle(mass = 1 [kg], at = {{x, 0, 0}});
      force pull = -({pull})*world.x at p;
      constraint {"; constraint ".join(f"c{i}: {row}" for i, row in enumerate(rows))};
      output Energy needed = reaction(c0);
    end M;"""
    model = lagc.loads(text).compile(backend=backend)
    run = model.simulate(3.0, accuracy=1e-9, points=2)
    assert run.status == "ok", run.message
    assert not any(run["needed"])
    matrix = np.zeros((count + 2, count + 2))  # x, x', y/size
    matrix[0, 1] = 1.0
    matrix[1] = [-k, -c, *(-h for h in g)]
    for i in range(count):
        matrix[2 + i] = [b[i], 0.0, *a[i]]
    x, v, *y = linalg.expm(3.0 * matrix) @ np.array([1.0, 0.0, *[1.0] * count])
    found = [float(run[name][-1]) for name in ("x", "der(x)", *names)]
    assert found == pytest.approx([x, v, *(size * e for e in y)], rel=1e-8, abs=1e-8 * min(1.0, size))


@pytest.mark.parametrize(
    ("more", "culprit"),
    [
        ("constraint sum: der(y) + der(z) = x/(1 [s]);", "z"),  # one row for two rates
        ("constraint one: 2*der(y) = x/(1 [s]); constraint two: der(z) = 0;", "y"),
        ("constraint one: der(y) = x/(1 [s]); potential V = 1 [N/m]*(x - z)^2;", "z"),
        ("constraint one: der(y) = x/(1 [s]); potential V = 1 [N/m]*(x - y)^2;", "y"),
    ],
)
def test_what_no_row_alone_gives_is_named(more: str, culprit: str) -> None:
    text = f"""model M
      coordinate Length x(start = 1 [m]), y, z;
      body p = Particle(mass = 1 [kg], at = {{x, 0, 0}});
      {more}
    end M;"""
    with pytest.raises(Refused) as refused:
        lagc.loads(text).compile(backend="numpy")
    assert {f.code for f in refused.value.faults} == {"LAG0501"}
    assert any(f"`{culprit}`" in f.message for f in refused.value.faults)
    assert all("`kinetic T = 1/2*(1 [kg])*der(" in str(f.remedy) for f in refused.value.faults)
    inert = " ".join(f"kinetic k{y} = 1/2*(1 [kg])*der({y})^2;" for y in "yz")
    lagc.loads(text.replace("end M", f"{inert} end M")).compile(backend="numpy")  # as the remedy says
