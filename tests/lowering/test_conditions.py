"""The derivatives of the conditions of a start, against differences of 50 digits."""

import random

import mpmath as mp
import pytest

from lagc.lowering.jacobians import condition_rows
from lagc.lowering.lower_equations import optimize
from tests.lowering.interpret import ask
from tests.oracle.lagrange import Expressions
from tests.simulation.initialization.generated_starts import compilation_of

STEP = mp.mpf(10) ** -20
LIBRARY = (
    "andrews_squeezer", "bead_on_hoop", "car_axis", "chaplygin_sleigh_speeds", "four_bar", "knife_edge",
    "moving_rail", "particle_on_torus", "rolling_disc", "slider_crank", "sphere_on_turntable", "spring_chain",
    "wheelset",
)  # fmt: skip


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", LIBRARY)
def test_derivatives_are_exact(name: str) -> None:
    """Differences of step 1e-20 are off by 1e-40; a double is off by the rounding of its terms."""
    equations = compilation_of(f"classic/{name}").equations
    program = optimize(equations)
    interface, dice = program.interface, random.Random(name)
    unknowns = [*equations.q, *equations.v]
    rows = condition_rows(equations)
    with mp.workdps(50):
        x = [dice.uniform(0.3, 1.0) for _ in unknowns]
        p = [f.value or 0.0 for f in (*interface.parameters, *interface.inputs)]
        found = ask(program, "conditions", {"p": p, "t": [0.25], "x": x})
        given = {s.symbol: mp.mpf(s.value or 0.0) for s in equations.model.parameters}
        given.update((u.symbol, mp.mpf(u.default)) for u in equations.model.inputs)
        given[equations.time] = mp.mpf(0.25)
        given.update((symbol, mp.mpf(value)) for symbol, value in zip(unknowns, x))
        evaluate = Expressions(rows)
        assert found["c"] == pytest.approx([float(a) for a in evaluate(given)], rel=1e-12, abs=1e-13)
        slopes = [[0.0] * (len(unknowns) + len(interface.rate_names)) for _ in rows]
        begin = 0
        for row, end in zip(slopes, interface.condition_ends):
            for k in range(begin, end):
                row[interface.condition_columns[k]] = found["J"][k]
            begin = end
        for k, symbol in enumerate(unknowns):
            above = evaluate({**given, symbol: given[symbol] + STEP})
            below = evaluate({**given, symbol: given[symbol] - STEP})
            exact = [float((a - b) / (2 * STEP)) for a, b in zip(above, below)]
            assert [row[k] for row in slopes] == pytest.approx(exact, rel=1e-11, abs=1e-12)
    for k in range(len(interface.rate_names)):
        assert [row[len(unknowns) + k] for row in slopes] == [
            -1.0 if i == len(rows) - len(interface.rate_names) + k else 0.0 for i in range(len(rows))
        ]
