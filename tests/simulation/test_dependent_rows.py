"""Rows that depend on each other in code without a dense matrix: accelerations, the shortest multipliers and
contradictions, against the pseudo-inverse in 50 digits; motions through configurations where rank is lost."""

import math
import random
import re
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, NamedTuple

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc.base.records import replace
from lagc.codegen.c.emit import render as render_c
from lagc.compiler import pipeline
from lagc.compiler.stages import Choice
from lagc.diagnostics.faults import Source
from lagc.host.model_library import read as read_model
from lagc.lowering.kkt import solve as kkt
from lagc.lowering.kkt.prune import prune, with_pivots
from lagc.mechanics.derive import derive
from lagc.mechanics.formulation.equations import EquationsOfMotion, Row
from lagc.mechanics.formulation.states import build_states
from lagc.mechanics.identities.constraint_manifold import walk
from lagc.simulation.backends.compile import compiler as compiler_of_c
from lagc.simulation.system import INCONSISTENT, OK, REDUNDANT, Options, System
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import evaluate
from tests.hard.test_vanishing_rows import text as track
from tests.lowering import large
from tests.lowering.exact import values as in_digits
from tests.mechanics.numbers import consistent_state, jacobian, mass_matrix, random_state
from tests.mechanics.random_systems import random_system
from tests.mechanics.test_mobility import Made, bennett, cranks, frames, general_7r, planar, sarrus, spherical
from tests.simulation.programs import BACKENDS, build, rates

DIGITS = 50
SHARE = 1e-8  # singular values, beside the largest, of rows that depend on others
VANISHED = 1e-12  # the length of a gradient that is rounding, of terms of about 1
State = Mapping[Node, float]


@pytest.fixture(autouse=True)
def _without_dense_matrices(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kkt, "_MOST_UNKNOWNS", 0)


def equations(text: str, **parameters: int) -> EquationsOfMotion:
    tree = pipeline.parse(Source("model.lag", text))
    found = pipeline.derive(pipeline.resolve(tree, Choice(parameters=parameters)))
    return with_pivots(prune(found)[0])


def compiled(e: EquationsOfMotion, backend: str) -> System:
    program = pipeline.optimize(e, work=False)
    assert "system" not in program.functions and "factor" in program.functions
    return build(program, backend)


def bound(e: EquationsOfMotion, state: State, backend: str) -> tuple[System, list[float]]:
    """The system, and x."""
    system = compiled(e, backend)
    kept = {f.name for f in system.interface.parameters}
    given = [*(p.symbol for p in e.model.parameters if p.name in kept), *(u.symbol for u in e.model.inputs)]
    return system.bind([state[x] for x in given]), [state[x] for x in (*e.q, *e.v)]


class Solved(NamedTuple):
    """As at the start of a trajectory."""

    status: int
    a: np.ndarray
    lam: np.ndarray


def solved(e: EquationsOfMotion, state: State) -> Solved:
    system, x = bound(e, state, "numpy")
    xdot, lam = [0.0] * len(x), [0.0] * len(e.rows)
    status = system.equations().first(state[e.time], x, xdot, lam)  # type: ignore[attr-defined]
    return Solved(status, np.array(xdot[len(e.q) :]), np.array(lam))


def truth(e: EquationsOfMotion, state: State) -> tuple[np.ndarray, np.ndarray]:
    """Accelerations, and the shortest multipliers: with M = L L^T, mu = D lam, D the lengths of the columns
    of L^-1 G^T = U S V D and y = L^T a, the rows prescribe y along the columns of U that belong to singular
    values that are not zero; what of mu is along the other rows of V makes no force, and is taken away."""
    n, c = len(e.v), len(e.rows)
    with mpmath.workdps(DIGITS):
        m, g = mpmath.zeros(n), mpmath.zeros(c, n)
        for (i, j), value in zip(e.mass_matrix, in_digits(list(e.mass_matrix.values()), state)):
            m[i, j] = m[j, i] = value
        for r, row in enumerate(e.rows):
            for j, value in zip(row.jacobian, in_digits(list(row.jacobian.values()), state)):
                g[r, j] = value
        inverse = mpmath.inverse(mpmath.cholesky(m))
        columns = inverse * g.T
        lengths = [mpmath.norm(columns[:, r]) for r in range(c)]
        found = [r for r in range(c) if lengths[r] > VANISHED]
        lengths = [lengths[r] for r in found]
        b = mpmath.matrix([[columns[i, r] / d for r, d in zip(found, lengths)] for i in range(n)])
        gamma = in_digits([e.rows[r].gamma for r in found], state)
        gamma = mpmath.matrix([x / d for x, d in zip(gamma, lengths)])
        y = inverse * mpmath.matrix(in_digits(e.applied_forces, state))
        u, values, v = mpmath.svd_r(b, full_matrices=True)
        mu, spare = mpmath.zeros(len(found), 1), []
        for k in range(len(found)):
            if k < n and values[k] > SHARE * values[0]:
                share = (v[k, :] * gamma)[0] / values[k] - (u[:, k].T * y)[0]
                y += share * u[:, k]
                mu += share / values[k] * v[k, :].T
            else:
                spare.append([v[k, i] / lengths[i] for i in range(len(found))])
        lam = mpmath.matrix([x / d for x, d in zip(mu, lengths)])
        if spare:
            free = mpmath.matrix(spare)
            lam -= free.T * mpmath.lu_solve(free * free.T, free * lam)
        a, own = inverse.T * y, dict(zip(found, lam))
        return np.array([float(x) for x in a]), np.array([float(own.get(r, 0.0)) for r in range(c)])


def with_copies(e: EquationsOfMotion, seed: int, wrong: float = 0.0) -> EquationsOfMotion:
    """One or two rows more, combinations of the others; `wrong` is added to their right-hand sides."""
    r, graph, rows = random.Random(seed), e.graph, list(e.rows)
    for n in range(r.randint(1, 2)):
        weights = [r.choice([-2.0, -1.0, 1.0, 3.0]) for _ in e.rows]

        def mixed(nodes: list[Node], weights: list[float] = weights) -> Node:
            return graph.sum([w * node for w, node in zip(weights, nodes)])

        columns = sorted({j for row in e.rows for j in row.jacobian})
        rows.append(
            replace(
                e.rows[0],
                label=f"more[{n}]",
                multiplier=graph.symbol("multiplier", f"more[{n}]"),
                residual=mixed([row.residual for row in e.rows]),
                rate=mixed([row.rate for row in e.rows]),
                jacobian={j: mixed([row.jacobian.get(j, graph.zero) for row in e.rows]) for j in columns},
                gamma=graph.add(mixed([row.gamma for row in e.rows]), graph.const(wrong)),
            )
        )
    return replace(e, rows=tuple(rows))


def alike(e: EquationsOfMotion) -> bool:
    """Whether its rows can be added: all of one level."""
    return len({row.level for row in e.rows}) == 1


RANDOM = (9, 10, 11, 17, 23, 26, 28, 34, 35, 39, 43, 49, 50, 53)  # seeds of systems that have what is tried


@cache
def random_case(seed: int) -> tuple[EquationsOfMotion, State]:
    e = derive(random_system(seed))
    assert e.rows and alike(e) and len(e.rows) < len(e.v)
    state = consistent_state(e, seed)
    assert state is not None and np.linalg.eigvalsh(mass_matrix(e, state))[0] > 0.0
    return e, state


RING = "constraint ring: D = {0, 0, 0};"
FOUR_BAR = read_model("classic/four_bar").text
WINDOWS = read_model("classic/n_four_bar").text
TWICE = large.CLOSED.replace("  effect", "  constraint again: 3*P[n] = {0.3*n*l, 0, 0};\n  effect", 1)
RUNG = "constraint rung[i]: dot(P[i] - Q[i], P[i] - Q[i]) = l^2;"
LADDER = large.LADDER.replace(
    RUNG, RUNG + RUNG.replace("rung", "again").replace(": ", ": 2*").replace("l^2", "2*l^2")
)
UNEVEN = TWICE.replace("  effect", "  body tip = Particle(mass = 1e6*m, at = P[2]);\n  effect", 1)


def upright(e: EquationsOfMotion, away: float) -> State:
    """Windows so far from their flat configuration."""
    state = random_state(e, 1)
    state.update((q, math.pi / 2.0 - away if q.value.name.startswith("th") else 0.0) for q in e.q)
    state.update((v, 1.0 if "th" in v.value.name else 0.0) for v in e.v)
    return state


AGAIN = {"again": "again: D", "scaled": "again: 100*D", "less": "again: 0.01*D"}
WINDOW_CASES = ((1, 1e-2), (3, 1e-2), (6, 1e-2), (6, 1e-3), (3, 0.5))
OPEN = {f"windows {n} {away}": (n, away) for n, away in WINDOW_CASES}
LARGE = {
    f"{name} {n}": (text, n)
    for name, text in (("closed twice", TWICE), ("uneven masses", UNEVEN), ("ladder", LADDER))
    for n in (6, 10)
}


def special_case(name: str) -> tuple[EquationsOfMotion, Any]:
    if name in OPEN:
        n, away = OPEN[name]
        e = equations(WINDOWS, N=n)
        return e, upright(e, away)
    if name in AGAIN:
        e = equations(FOUR_BAR.replace(RING, f"{RING}\n  constraint {AGAIN[name]} = {{0, 0, 0}};"))
    else:
        text, n = LARGE[name]
        e = equations(text, n=n)
    return e, consistent_state(e, 5)


def assert_solved(found: Solved, e: EquationsOfMotion, state: State) -> None:
    a, lam = truth(e, state)
    assert np.abs(found.a - a).max() <= 1e-12 * np.abs(a).max()
    if found.status == REDUNDANT:
        assert np.abs(found.lam - lam).max() <= 1e-8 * np.abs(lam).max()


@pytest.mark.sample(0, 7)
@pytest.mark.parametrize("name", [*AGAIN, *OPEN, *LARGE])
def test_mechanisms(name: str) -> None:
    e, state = special_case(name)
    found = solved(e, state)
    assert found.status == (OK if "windows" in name else REDUNDANT)
    assert_solved(found, e, state)


@pytest.mark.full
@pytest.mark.parametrize("seed", RANDOM)
def test_random_systems_with_rows_that_follow_from_others(seed: int) -> None:
    e, state = random_case(seed)
    more = with_copies(e, 7)
    found = solved(more, state)
    assert found.status == REDUNDANT
    assert_solved(found, more, state)


@pytest.mark.full
@pytest.mark.parametrize("seed", RANDOM[::4])
def test_random_systems_with_rows_that_contradict_others(seed: int) -> None:
    e, state = random_case(seed)
    size = float(np.abs(solved(e, state).a).max()) + 1.0
    assert solved(with_copies(e, 7, wrong=100.0 * size), state).status == INCONSISTENT


@pytest.mark.full
@pytest.mark.parametrize("seed", RANDOM[1::3])
def test_rows_in_units_that_are_far_apart(seed: int) -> None:
    """Each row times a number from 1e-6 to 1e6."""
    e, state = random_case(seed)
    r = random.Random(seed)
    more = with_copies(e, 7)
    more = replace(more, rows=tuple([times(10.0 ** r.uniform(-6.0, 6.0), row) for row in more.rows]))
    found = solved(more, state)
    assert found.status == REDUNDANT
    assert_solved(found, more, state)


def times(factor: float, row: Row) -> Row:
    return replace(
        row,
        residual=factor * row.residual,
        rate=factor * row.rate,
        jacobian={j: factor * slope for j, slope in row.jacobian.items()},
        gamma=factor * row.gamma,
    )


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("make", [planar, spherical, bennett, general_7r, sarrus, cranks, frames])
def test_spatial_loops(make: Callable[[random.Random], Made]) -> None:
    """At random speeds, where the loop comes to from its start."""
    e = with_pivots(prune(derive(make(random.Random(1))[0].model()))[0])
    state = moving(e, walk(build_states(e.model), e.rows).far[-1])
    found = solved(e, state)
    assert found.status == (OK if make in (general_7r, frames) else REDUNDANT)
    assert_solved(found, e, state)


def moving(e: EquationsOfMotion, state: State) -> dict[Node, float]:
    """With random speeds that the rows allow."""
    found = {**{p.symbol: p.value or 0.0 for p in e.model.parameters}, **state}
    found.update((v, random.Random(k).uniform(-1.0, 1.0)) for k, v in enumerate(e.v))
    inverse = np.linalg.pinv(jacobian(e, found), rcond=SHARE)
    for _ in range(2):
        missed = inverse @ np.array(evaluate([row.rate for row in e.rows], found))
        found.update((v, found[v] - d) for v, d in zip(e.v, missed))
    return found


def test_rows_that_vanish_share_no_force() -> None:
    """Rolling in a tilted track, of whose rows one is rounding at 90 degrees."""
    e = equations(track("angles", "tilted", 90.0, 1.5))
    state = random_state(e, 1)
    values = {"th": math.pi / 2.0, "phi": 0.0, "der(th)": 1.5, "der(phi)": 1.5 - 1.5 / 0.2}
    state.update((x, values[name]) for x, name in zip((*e.q, *e.v), (*e.q_names, *e.v_names)))
    found = solved(e, state)
    assert found.status == REDUNDANT
    assert_solved(found, e, state)


BENNETT = read_model("bennett").text
MANY_BENNETTS = f"""
model Loop
{BENNETT.split("that moves")[1][1:].split("  effect")[0]}
  dissipation brake = 1/2*0.5 [N.m.s/rad2]*der(th1)^2;
end Loop;

model Many
  Loop k[12];
  effect gravity Gravity field; end gravity;
  scene lab uses gravity;
end Many;
"""


@pytest.mark.full
def test_many_spatial_loops_are_braked_to_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    """Through the folded configuration, where each loses another row; G. T. Bennett's relations of the
    angles."""
    monkeypatch.undo()
    compiled = lagc.loads(MANY_BENNETTS).compile(backend="c" if compiler_of_c() else "numpy")
    assert "system" not in compiled.program.functions
    run = compiled.simulate(5.0, method="dop853", rtol=1e-9, atol=1e-9, points=51)
    assert run.status == "ok" and run.position_drift <= 1e-12, run.message
    assert abs(run.energy.imbalance) <= 1e-6 * abs(run.energy.work)
    first, second, third = (run[f"k[7].th{i}"] for i in (1, 2, 3))
    assert first.min() < -2.0 and first.max() > 1.3
    assert abs(first + third - 2.0 * math.pi).max() <= 1e-8
    ratio = math.sin(math.radians(55.0)) / math.sin(math.radians(15.0))
    product = np.cos(first / 2.0) * np.cos(second / 2.0)
    assert abs(np.sin(first / 2.0) * np.sin(second / 2.0) - ratio * product).max() <= 1e-8


@pytest.mark.full
@pytest.mark.parametrize(
    "row", ["th[2] - th[3] = 0.2 [rad/s2]*time^2", "1e6*(th[2] - th[3]) = 0.2e6 [rad/s2]*time^2"]
)
def test_a_contradiction_is_refused_and_named(monkeypatch: pytest.MonkeyPatch, row: str) -> None:
    monkeypatch.undo()
    text = WINDOWS.replace("  effect", f"  constraint off: {row};\n  effect", 1)
    compiled = lagc.loads(text).compile(parameters={"N": 40}, backend="numpy")
    assert "system" not in compiled.program.functions
    with pytest.raises(lagc.Refused) as refused:
        compiled.simulate(1.0)
    assert re.search(r"`off`.* contradict each other", refused.value.faults[0].message)


@pytest.mark.sample(1)
@BACKENDS
def test_backends_agree(backend: str) -> None:
    e, state = special_case("closed twice 6")
    found = [rates(*bound(e, state, of), state[e.time]) for of in ("numpy", backend)]
    assert found[0] == found[1]


@pytest.mark.sample(1)
@pytest.mark.parametrize("n", [2, 7])
def test_windows_pass_the_flat_configuration(n: int) -> None:
    """As the pendulum that they are."""
    system = compiled(equations(WINDOWS, N=n), "numpy")
    names = [*system.interface.q_names, *system.interface.v_names]
    start = [1.0 if name.startswith("der(th") else 0.0 for name in names]
    rate = 9.81 * ((n + 1) / 2 + n) / ((n + 1) / 3 + n)
    exact = solve_ivp(lambda _, x: [x[1], rate * math.sin(x[0])], (0.0, 1.0), [0.0, 1.0], "DOP853",
                      rtol=1e-13, atol=1e-13).y[:, -1]  # fmt: skip
    done = system.integrate(Options("dop853", 1e-9, 1e-9), 0.0, start, [0.0, 1.0])
    assert done.status == OK and exact[0] > math.pi / 2.0
    found = dict(zip(names, done.x))
    assert all(math.isclose(found[f"th[{i}]"], exact[0], rel_tol=1e-6) for i in range(1, n + 2))
    assert all(abs(found[f"ph[{i}]"]) <= 1e-6 for i in range(1, n + 1))


@pytest.mark.full
def test_nothing_is_as_large_as_a_matrix(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    program = pipeline.optimize(equations(WINDOWS, N=26), work=False)
    unknowns = program.interface.nv + program.interface.nc
    assert "system" not in program.functions
    for name, function in program.functions.items():
        assert sum(length for _, length in function.outputs) <= 30 * unknowns, name
    (header,) = [text for name, text in render_c(program, False).items() if name.endswith(".h")]
    sizes = {name: int(size) for name, size in re.findall(r"#define (\w+) +(\d+)", header)}
    arrays = re.findall(r"\b\w+((?:\[\w+\])+);", header)
    lengths = [math.prod(sizes.get(n) or int(n) for n in re.findall(r"\w+", array)) for array in arrays]
    assert unknowns <= max(lengths) <= 30 * unknowns
