"""Bodies whose mass, a parameter, is zero: motion is determined where masses and rows are regular."""

import random

import numpy as np
import pytest

import lagc
from lagc.diagnostics.faults import Refused

Rows = list[list[float]]


def case(dice: random.Random) -> tuple[str, dict[str, float], Rows]:
    """A model of coordinates in a line that may be coupled by springs, rows or bodies that move with two of
    them, values of its masses, and [M; G] at these."""
    n = dice.randint(1, 4)
    lines, matrix, given = list[str](), [[0.0] * n for _ in range(n)], dict[str, float]()
    for i in range(n):
        lines.append(f"coordinate Length x{i}(start = {i}.5 [m], rate = {dice.choice((0, 1))} [m/s]);")
    for k in range(n + dice.randint(0, 1)):
        i = k if k < n else dice.randrange(n)
        j = dice.choice([i, i, i, dice.randrange(n)])
        way = [float(u == i) + float(u == j and i != j) for u in range(n)]
        at = f"x{i}" if i == j else f"x{i} + x{j}"
        mass = dice.choice((0.0, 0.0, 0.5, 2.0))
        given[f"m{k}"] = mass
        lines.append(f"parameter Mass m{k}(min = 0) = 1 [kg];")
        lines.append(f"body b{k} = Particle(mass = m{k}, at = {{{at}, {dice.choice(('0', '1'))} [m], 0}});")
        for u in range(n):
            for v in range(n):
                matrix[u][v] += mass * way[u] * way[v]
    if n > 1 and dice.random() < 0.5:
        i, j = dice.sample(range(n), 2)
        lines.append(f"potential s = 1/2*3 [N/m]*(x{i} - x{j})^2;")
    if n > 1 and dice.random() < 0.6:
        i, j = dice.sample(range(n), 2)
        lines.append(f"constraint r: x{i} = 2*x{j};")
        matrix.append([float(u == i) - 2.0 * (u == j) for u in range(n)])
    return "model M\n" + "\n".join(lines) + "\nend M;\n", given, matrix


@pytest.mark.full
def test_a_massless_coordinate_is_refused_where_nothing_determines_it() -> None:
    dice = random.Random(11)
    refused = 0
    for k in range(30):
        text, given, matrix = case(dice)
        determined = int(np.linalg.matrix_rank(matrix)) == len(matrix[0])
        model = lagc.loads(text).compile(backend="c" if k % 15 == 0 else "numpy")
        if determined:
            assert model.simulate(0.5, points=3, parameters=given).status == "ok", text
            continue
        with pytest.raises(Refused) as caught:
            model.simulate(0.5, points=3, parameters=given)
        (fault,) = caught.value.faults
        assert fault.code == "LAG0612" and "der(x" in fault.message, text
        refused += 1
    assert 10 < refused < 25


def test_check_refuses_a_parameter_that_takes_all_inertia_away() -> None:
    text = "model M\n parameter Mass m = 0;\n coordinate Length x(rate = 1);\n"
    text += " body b = Particle(mass = m, at = {x, 0, 0});\nend M;\n"
    (fault,) = lagc.loads(text).check()
    assert fault.code == "LAG0612" and "nothing has inertia along `der(x)`" in fault.message


def test_a_long_chain_names_the_link_without_mass() -> None:
    """Its equations are solved without the mass matrix, by pivots that are no longer those of speeds."""
    text = """model Chain
      structural Integer n = 40;
      parameter Mass m;
      coordinate Angle a[n](each start = 0.3);
      point P[0] = {0, 0, 0};
      for i in 1:n loop
        point P[i] = P[i-1] + {sin(a[i]), -cos(a[i]), 0}*(1 [m]);
        body b[i] = Particle(mass = if i == n then m else 1 [kg], at = P[i]);
      end for;
    end Chain;"""
    with pytest.raises(Refused) as caught:
        lagc.loads(text).compile(backend="numpy").simulate(1.0, parameters={"m": 0.0})
    (fault,) = caught.value.faults
    assert fault.code == "LAG0612" and "`der(a[40])`" in fault.message
    assert fault.remedy is not None and "`b[40]`" in fault.remedy
