"""Along a run the terms of a solution balance: accelerations of the run, multipliers by least squares."""

import pytest

import lagc
from lagc.symbolic.walk import evaluate
from tests.derivation.values import State, states

np = pytest.importorskip("numpy")

CLOSE = 1e-12  # of the largest term: roundings of the right-hand side and of the terms
NAMES = ["simple_pendulum", "moving_slide_explicit", "wheel_rolling_explicit", "heavy_top", "four_bar"]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.usefixtures("own_cache")
def test_the_terms_balance(name: str) -> None:
    """d/dt(dK/dq') - dK/dq - Q is in the range of the gradients of the constraints, and no further."""
    model = lagc.load(name).compile(backend="numpy")
    found, equations = model.derivation(), model.equations
    nq, nv = len(equations.q), len(equations.v)
    run = model.simulate(stop=0.3, points=4)
    for t, x in zip(run.t, run.x):
        at = parameters_of(model, run.parameters)
        at |= dict(zip((*equations.q, *equations.v), map(float, x)))
        at |= dict(zip(equations.a, map(float, model.rhs(t, x[: nq + nv])[nq:])))
        at |= {equations.time: float(t), **dict.fromkeys(equations.lam, 1.0)}
        assert states(equations, found)  # the solution is of the same graph
        total, sizes = np.array(evaluate(found.inertial, at)), [1e-3]
        columns = []
        for term in found.terms:
            values = np.zeros(nv)
            values[list(term.forces)] = evaluate(list(term.forces.values()), at)
            sizes += list(abs(values))
            if term.kind == "given":
                total = total - values
            else:
                columns.append(values)
        if columns:
            matrix = np.array(columns).T
            total = total - matrix @ np.linalg.lstsq(matrix, total, rcond=None)[0]
        assert abs(total).max() < CLOSE * max(sizes) * nv


def parameters_of(model: lagc.CompiledModel, values: list[float]) -> State:
    interface = model.interface
    symbols = {p.name: p.symbol for p in (*model.model.parameters, *model.model.inputs)}
    names = [f.name for f in (*interface.parameters, *interface.inputs)]
    found = {symbols[name]: value for name, value in zip(names, values)}
    unused = {p.symbol: p.value or 0.0 for p in model.model.parameters if p.symbol not in found}
    return {**unused, **found, model.equations.graph.symbol("number", "pi"): np.pi}
