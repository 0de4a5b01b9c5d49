"""A Jacobian that is kept by sums is the one that is not, and tells the same of its rows."""

import random

import numpy as np
import pytest

from lagc.compiler.checking import check
from lagc.compiler.stages import Choice, parse, resolve
from lagc.diagnostics.faults import Source
from lagc.mechanics.derive import derive
from lagc.mechanics.formulation import jacobian as module
from lagc.mechanics.formulation.jacobian import Entries, formed_of
from lagc.mechanics.formulation.states import build_states
from lagc.mechanics.redundancy import dependent_rows, tables
from lagc.semantics.model import Model
from lagc.symbolic import derivative as jacobians
from tests.mechanics.numbers import jacobian, random_state, vector
from tests.mechanics.random_systems import random_system
from tests.rejected.motion import CASES
from tests.rejected.test_rejected import unmarked, whole

LADDER = """model M
  structural Integer n = {n};
  parameter Length l(min = 0) = {length} [m], d(min = 0) = {length} [m];
  coordinate Angle a[n](each start = 20 [deg]), b[n](each start = 20 [deg]);
  point P[0] = {{0, 0, 0}};
  point Q[0] = {{d, 0, 0}};
  for i in 1:n loop
    point P[i] = P[i-1] + l*{{sin(a[i]), 0, -cos(a[i])}};
    point Q[i] = Q[i-1] + l*{{sin(b[i]), 0, -cos(b[i])}};
    body left[i] = Particle(mass = 1 [kg], at = P[i]);
    body right[i] = Particle(mass = 1 [kg], at = Q[i]);
    constraint rung[i]: norm(P[i] - Q[i]) = d;
  end for;
  {more}
end M;"""


CHAIN = """model M
  structural Integer n = {n};
  parameter Length l(min = 0) = 0.1 [m];
  parameter Stiffness k = 1000 [N/m];
  parameter Damping c = 0.1 [N.s/m];
  coordinate Angle a[n](each start = 20 [deg]);
  point P[0] = {{0, 0, 0}};
  for i in 1:n loop
    frame F[i] = rotate_y(world, a[i]);
    point P[i] = P[i-1] + l*F[i].x;
    body b[i] = Particle(mass = 1 [kg], at = P[i]);
    {action}
  end for;
end M;"""


@pytest.fixture
def by_sums(monkeypatch: pytest.MonkeyPatch) -> None:
    """Wherever there are some."""
    monkeypatch.setattr(jacobians, "_WORTH", 0)
    monkeypatch.setattr(module, "_FEW", 0)


@pytest.mark.sample(1, 9)
@pytest.mark.parametrize("seed", range(40))
def test_random_systems(seed: int, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> None:
    plain = derive(random_system(seed))
    request.getfixturevalue("by_sums")
    found = derive(random_system(seed))
    assert [row.label for row in found.rows] == [row.label for row in plain.rows]
    assert [row.linear for row in found.rows] == [row.linear for row in plain.rows]
    state = random_state(plain, seed)
    values = {x.record.name: value for x, value in state.items()}
    again = {x: values[x.record.name] for x in random_state(found, seed)}
    wanted = vector(plain.given_forces, state)
    assert vector(found.given_forces, again) == pytest.approx(wanted, rel=1e-11, abs=1e-11)
    for one, other in zip(found.contributions, plain.contributions):
        forces = dict(zip(other.forces, vector(list(other.forces.values()), state)))
        same = dict(zip(one.forces, vector(list(one.forces.values()), again)))
        for j in forces.keys() | same.keys():
            assert same.get(j, 0.0) == pytest.approx(forces.get(j, 0.0), rel=1e-11, abs=1e-11)
    if found.rows:
        assert np.allclose(jacobian(found, again), jacobian(plain, state), rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize("about, code, text", CASES, ids=[case[0] for case in CASES])
@pytest.mark.usefixtures("by_sums")
def test_faults_are_found_at_their_places(about: str, code: str, text: str) -> None:
    plain, start, end = unmarked(whole(text))
    faults = [f for f in check(Source("model.lag", plain), Choice()) if f.severity == "error"]
    assert [(f.code, f.span.start, f.span.end) for f in faults if f.span] == [(code, start, end)]


def ladder(n: int, length: float = 0.3, more: str = "") -> Model:
    return resolve(parse(Source("m.lag", LADDER.format(n=n, length=length, more=more))), Choice())


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("length", [0.3, 1e-9, 1e9])
def test_rank_of_a_long_ladder_whatever_its_unit(length: float) -> None:
    """Twice the same rung, and one rung more than has room."""
    more = "constraint again: norm(P[n-2] - Q[n-2]) = d; constraint top: P[2].x - Q[2].x = -d;"
    e = derive(ladder(60, length, more))
    assert all(isinstance(row.jacobian, Entries) for row in e.rows)
    found = dependent_rows(build_states(e.model), e.rows)
    assert [(r.row, r.others) for r in found] == [(60, (57,))]


@pytest.mark.full
def test_rows_are_made_of_what_they_depend_on() -> None:
    """By the combination that is found the dense rows add up, which the sums say nothing of."""
    e = derive(ladder(50, more="constraint again: norm(P[n-2] - Q[n-2]) = d;"))
    states = build_states(e.model)
    for _, table in tables(states, e.rows, 2, vary=False):
        for line in range(len(table.rows)):
            left, factors = table.reduce(line)
            if table.rows[line] == 50:
                assert table.depends(line, left)
                assert table.made_of(factors) == pytest.approx({47: 1.0}, abs=1e-9)
            else:
                assert not table.depends(line, left)
            table.add(line, left, factors)


@pytest.mark.full
def test_bases_stay_short() -> None:
    """Work in proportion to the ladder: no line is reduced by many, and none is long."""
    work = {}
    for n in (50, 100):
        e = derive(ladder(n))
        ((_, table),) = tables(build_states(e.model), e.rows, 1)
        work[n] = 0
        for line in range(len(table.rows)):
            left, factors = table.reduce(line)
            work[n] += len(left) + len(factors)
            table.add(line, left, factors)
    assert work[100] < 2.2 * work[50]


ACTIONS = {
    "a floor": "potential floor[i] = k*max(0 [m], -1 [m] - P[i].z)^2/2;",
    "drag": "force drag[i] = -c*velocity(b[i]) at b[i];",
    "torques": "torque bend[i] = -c*der(a[i])*l^2/1 [rad]*{0, 1, 0} on F[i];",
}


@pytest.mark.sample(0, 2)
@pytest.mark.parametrize("name", ACTIONS)
def test_actions_along_a_chain_are_derived_in_proportion(name: str) -> None:
    """As many nodes for each link, however long the chain; and the forces are those of differences."""
    sizes = {}
    for n in (100, 150, 200):
        text = CHAIN.format(n=n, action=ACTIONS[name])
        e = derive(resolve(parse(Source("m.lag", text)), Choice()))
        sizes[n] = len(e.graph.nodes)
    assert sizes[200] - sizes[150] < 1.05 * (sizes[150] - sizes[100])
    state = random_state(e, 3)
    for c in (e.contributions[0], e.contributions[-1]):
        forces = np.zeros(len(e.v))
        forces[list(c.forces)] = vector(list(c.forces.values()), state)
        assert forces @ vector(e.v, state) == pytest.approx(vector([c.power], state)[0], rel=1e-9, abs=1e-12)
    total = sum(vector([c.power for c in e.contributions], state))
    assert vector(e.given_forces, state) @ vector(e.v, state) == pytest.approx(total, rel=1e-9)


@pytest.mark.full
def test_entries_are_formed_when_asked_for() -> None:
    e = derive(ladder(60))
    assert len(formed_of([row.jacobian for row in e.rows])) < 30 * 60
    before = len(e.graph.nodes)
    assert [2 in row.jacobian for row in e.rows] == [k >= 2 for k in range(60)]
    assert len(e.graph.nodes) == before
    row, dice = e.rows[-1], random.Random(2)
    assert len(row.jacobian) == 120 and list(row.jacobian) == list(range(120))
    state = {x: dice.uniform(-1.0, 1.0) for x in random_state(e, 1)}
    direction = np.array([dice.uniform(-1.0, 1.0) for _ in e.v])
    moved = {**state, **{v: state[v] + d for v, d in zip(e.v, direction)}}
    rate = vector([row.rate], moved) - vector([row.rate], state)  # affine in v
    assert jacobian(e, state)[-1] @ direction == pytest.approx(rate[0], rel=1e-9)
