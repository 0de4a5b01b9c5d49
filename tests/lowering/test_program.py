"""The functions of a Program against the equations they come from, solved by numpy."""

import math
import random
from collections.abc import Iterable
from typing import Any, TypeAlias

import numpy as np
import pytest

from lagc.compiler import pipeline
from lagc.compiler.stages import Choice
from lagc.host import model_library
from lagc.lowering.lower_equations import optimize
from lagc.lowering.program import Program
from lagc.mechanics.derive import derive
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import evaluate
from tests.lowering.interpret import bound, interpret
from tests.mechanics import models

MODELS = {
    "pendulum": models.pendulum, "chain of 3": lambda: models.chain(3),
    "string pendulum": models.string_pendulum, "free solid": models.free_solid,
    "rolling ball": models.rolling_ball, "charged particle": models.charged_particle,
    "rheonomic disc": models.rheonomic_disc, "knife edge": models.knife_edge,
    "declared speeds": models.declared_speeds, "constant speed": models.constant_speed,
}  # fmt: skip


class State:
    """One random state: values of the symbols, and the arrays of the generated functions."""

    def __init__(self, equations: EquationsOfMotion, program: Program, seed: int) -> None:
        rng = random.Random(seed)
        interface = program.interface
        model = equations.model
        self.values: dict[Node, float] = {equations.time: rng.uniform(0, 2)}
        self.values.update((p.symbol, p.value * rng.uniform(0.8, 1.2)) for p in model.parameters)
        self.values.update((u.symbol, rng.uniform(-1, 1)) for u in model.inputs)
        self.values.update((s, rng.uniform(-1, 1)) for s in (*equations.q, *equations.v))
        for k in equations.quaternions:
            part = equations.q[k : k + 4]
            length = math.sqrt(sum(self.values[s] ** 2 for s in part))
            self.values.update((s, self.values[s] / length) for s in part)
        by_name = {p.name: self.values[p.symbol] for p in model.parameters}
        by_name.update((u.name, self.values[u.symbol]) for u in model.inputs)
        self.arrays: dict[str, list[float]] = {
            "p": bound(program, [by_name[f.name] for f in (*interface.parameters, *interface.inputs)]),
            "t": [self.values[equations.time]],
            "x": [self.values[s] for s in (*equations.q, *equations.v)] + [0.0] * interface.nz,
        }

    def solve(self, equations: EquationsOfMotion) -> tuple[np.ndarray, np.ndarray]:
        """a and lam by numpy (least squares where the rows are dependent), known from here on."""
        n, c = len(equations.v), len(equations.rows)
        kkt = np.zeros((n + c, n + c))
        for (i, j), node in equations.mass_matrix.items():
            kkt[i, j] = kkt[j, i] = self(node)
        for k, row in enumerate(equations.rows):
            for j, node in row.jacobian.items():
                kkt[n + k, j] = self(node)
                kkt[j, n + k] = self(node)
        right = [self(tau) - self(h) for tau, h in zip(equations.given_forces, equations.bias_forces)]
        right += [self(row.gamma) for row in equations.rows]
        x = np.linalg.solve(kkt, right)
        self.condition = np.linalg.cond(kkt)
        a, lam = x[:n], -x[n:]
        self.values.update(zip(equations.a, map(float, a)))
        self.values.update(zip(equations.lam, map(float, lam)))
        self.arrays["a"], self.arrays["lam"] = list(map(float, a)), list(map(float, lam))
        return a, lam

    def __call__(self, node: Node) -> float:
        return evaluate([node], self.values)[0]

    def all(self, nodes: Iterable[Node]) -> list[float]:
        return evaluate(list(nodes), self.values)


def assert_near(found: Any, wanted: Any, relative: float = 1e-11) -> None:
    """Equal within the rounding of a well-conditioned solve, measured by the largest entry."""
    found, wanted = np.asarray(found, float), np.asarray(wanted, float)
    assert found.shape == wanted.shape
    scale = max(1.0, float(np.abs(wanted).max(initial=0.0)))
    assert np.abs(found - wanted).max(initial=0.0) <= relative * scale


Compiled: TypeAlias = tuple[EquationsOfMotion, Program]


@pytest.fixture(scope="module", params=MODELS)
def compiled(request: pytest.FixtureRequest) -> Compiled:
    equations = derive(MODELS[request.param]())
    return equations, optimize(equations, work=True)


@pytest.mark.parametrize("seed", range(4))
def test_right_hand_side_solves_the_equations(compiled: Compiled, seed: int) -> None:
    equations, program = compiled
    state = State(equations, program, seed)
    a, lam = state.solve(equations)
    assert state.condition < 1e4 or equations.rows
    found = interpret(program.functions["rhs"], state.arrays)
    if "watch" in program.functions:
        found |= interpret(program.functions["watch"], {**state.arrays, "health": found["health"]})
    n, m = len(equations.q), len(equations.v)
    assert_near(found["xdot"][:n], state.all(equations.qdot))
    assert_near(found["xdot"][n : n + m], a)
    assert_near(found["lam"], lam)
    if program.interface.nz:
        assert_near(found["xdot"][n + m :], [state(equations.power)])
    assert 1e-6 < found["health"][0] <= 1.0 + 1e-12
    assert 0.0 <= found["health"][1] < 1e-12


@pytest.mark.parametrize("seed", range(2))
def test_every_other_function_has_the_values_of_its_nodes(compiled: Compiled, seed: int) -> None:
    equations, program = compiled
    state = State(equations, program, seed)
    state.solve(equations)
    n = len(equations.v)
    energies = state.arrays["e"] = state.all([equations.kinetic, equations.potential, equations.energy])
    wanted = {
        ("system", "M"): [
            state(equations.mass_matrix[i, j]) if (i, j) in equations.mass_matrix else 0.0
            for i in range(n)
            for j in range(i + 1)
        ],
        ("system", "G"): [
            state(row.jacobian[j]) if j in row.jacobian else 0.0 for row in equations.rows for j in range(n)
        ],
        ("system", "gamma"): [state(row.gamma) for row in equations.rows],
        ("system", "r"): [
            state(tau) - state(h) for tau, h in zip(equations.given_forces, equations.bias_forces)
        ],
        ("system", "qdot"): state.all(equations.qdot),
        ("position", "phi"): [state(row.residual) for row in equations.rows if row.holonomic],
        ("velocity", "psi"): [state(row.rate) for row in equations.rows],
        ("energies", "e"): energies,
        ("power", "e"): [state(equations.power)],
        ("outputs", "y"): state.all(o.expression for o in equations.outputs),
        ("start", "x"): state.all(s.value for s in equations.starts[: len(equations.q) + n]),
    }
    functions = program.functions
    for (name, array), values in wanted.items():
        if name in functions:
            inputs = {k: state.arrays[k] for k in functions[name].inputs}
            found = interpret(functions[name], inputs)[array]
            assert_near(found[: len(values)], values, 1e-13)


@pytest.mark.parametrize("seed", range(2))
def test_assemble_factor_solve_agree_with_the_right_hand_side(compiled: Compiled, seed: int) -> None:
    equations, program = compiled
    functions = program.functions
    assert ("solve" in functions) == bool(equations.rows)
    if not equations.rows:
        return
    state = State(equations, program, seed)
    a, lam = state.solve(equations)
    w = interpret(functions["assemble"], state.arrays)["w"]
    assert len(w) == program.interface.work_size
    factored = interpret(functions["factor"], {"w": w})
    right = [state(tau) - state(h) for tau, h in zip(equations.given_forces, equations.bias_forces)]
    right += [state(row.gamma) for row in equations.rows]
    s = interpret(functions["solve"], {"w": factored["w"], "r": right})["s"]
    assert_near(s, [*a, *lam])
    assert factored["health"][0] > 1e-6


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["classic/chain", "large/truss", "large/net", "large/ball_chain"])
def test_energies_are_not_computed_again_for_outputs(name: str) -> None:
    """But where other outputs are made of the same, as the angular momentum of balls is."""
    costs = []
    for n in (3, 6):
        tree = pipeline.parse(model_library.read(name))
        model = pipeline.resolve(tree, Choice(parameters={"n": n}))
        outputs = optimize(pipeline.derive(model)).functions["outputs"]
        assert ("e" in outputs.inputs) == (name != "large/ball_chain")
        costs.append(outputs.cost)
    assert (costs[1] <= costs[0] < 4) == (name != "large/ball_chain")
