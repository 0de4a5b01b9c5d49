"""Equations of motion as numbers at a state, and random states."""

import random
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.mechanics.formulation.states import build_states
from lagc.mechanics.identities.constraint_manifold import onto
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import evaluate

Array = NDArray[np.float64]
State = dict[Node, float]


def random_state(e: EquationsOfMotion, seed: int) -> State:
    """Random q (unit quaternions), v, t; the parameters at their defaults."""
    r = random.Random(seed)
    state: State = {p.symbol: p.value or 0.0 for p in e.model.parameters}
    state.update((u.symbol, r.uniform(-1, 1)) for u in e.model.inputs)
    state[e.time] = r.uniform(0, 2)
    state.update((x, r.uniform(-1, 1)) for x in (*e.q, *e.v))
    for i in e.quaternions:
        size = sum(state[x] ** 2 for x in e.q[i : i + 4]) ** 0.5
        state.update((x, state[x] / size) for x in e.q[i : i + 4])
    return state


def consistent_state(e: EquationsOfMotion, seed: int) -> State | None:
    """A random state moved onto the rows; None where that fails."""
    return onto(build_states(e.model), e.rows)(random_state(e, seed))


def vector(nodes: tuple[Node, ...] | list[Node], state: Mapping[Node, float]) -> Array:
    return np.array(evaluate(nodes, state), dtype=float)


def mass_matrix(e: EquationsOfMotion, state: Mapping[Node, float]) -> Array:
    m = np.zeros((len(e.v), len(e.v)))
    for (i, j), value in zip(e.mass_matrix, evaluate(list(e.mass_matrix.values()), state)):
        m[i, j] = m[j, i] = value
    return m


def jacobian(e: EquationsOfMotion, state: Mapping[Node, float]) -> Array:
    g = np.zeros((len(e.rows), len(e.v)))
    for k, row in enumerate(e.rows):
        g[k, list(row.jacobian)] = evaluate(list(row.jacobian.values()), state)
    return g


def motion(e: EquationsOfMotion, state: Mapping[Node, float]) -> State:
    """`state` with a and lam: least squares where rows are redundant."""
    m, g = mass_matrix(e, state), jacobian(e, state)
    nc = len(e.rows)
    kkt = np.block([[m, -g.T], [g, np.zeros((nc, nc))]])
    gamma = vector([row.gamma for row in e.rows], state)
    right = np.concatenate([vector(e.given_forces, state) - vector(e.bias_forces, state), gamma])
    solution = np.linalg.lstsq(kkt, right, rcond=1e-13)[0]
    return {**state, **dict(zip([*e.a, *e.lam], map(float, solution)))}
