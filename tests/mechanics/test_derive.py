"""The equations of the standard systems: closed forms, invariants, outputs."""

import numpy as np
import pytest

from lagc.mechanics.derive import derive
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.mechanics.formulation.states import build_states
from lagc.symbolic.derivative import tangent
from lagc.symbolic.walk import evaluate
from tests.invariants import verify
from tests.mechanics.builder import Builder
from tests.mechanics.models import (
    ALL,
    charged_particle,
    declared_speeds,
    free_solid,
    knife_edge,
    pendulum,
    relativistic,
    rheonomic_disc,
    rolling_ball,
)
from tests.mechanics.numbers import State, consistent_state, mass_matrix, motion, random_state

CLOSE = 1e-12


def value(e: EquationsOfMotion, name: str, state: State) -> float:
    return evaluate([next(o.expression for o in e.outputs if o.name == name)], state)[0]


def parameters(e: EquationsOfMotion) -> dict[str, float]:
    return {p.name: p.value or 0.0 for p in e.model.parameters}


@pytest.mark.parametrize("name", ALL)
def test_invariants_hold(name: str) -> None:
    verify(derive(ALL[name]()))


@pytest.mark.parametrize("name", ALL)
def test_mass_matrix_is_positive_definite(name: str) -> None:
    e = derive(ALL[name]())
    assert np.linalg.eigvalsh(mass_matrix(e, random_state(e, 3))).min() > 0.0


@pytest.mark.parametrize("name", sorted(ALL.keys() - {"relativistic"}))
def test_kinetic_energy_is_the_form_of_the_mass_matrix(name: str) -> None:
    """K2 = 1/2 v.M v; the driven disc has K0 as well."""
    e = derive(ALL[name]())
    state = random_state(e, 4)
    still = {**state, **dict.fromkeys(e.v, 0.0)}
    flipped = {**state, **{x: -state[x] for x in e.v}}
    kinetic = [evaluate([e.kinetic], s)[0] for s in (state, flipped, still)]
    v = np.array([state[x] for x in e.v])
    expected = 0.5 * v @ mass_matrix(e, state) @ v
    assert (kinetic[0] + kinetic[1]) / 2 - kinetic[2] == pytest.approx(expected, rel=CLOSE)


@pytest.mark.parametrize("name", ALL)
def test_energy_changes_by_the_power(name: str) -> None:
    e = derive(ALL[name]())
    state = consistent_state(e, 5)
    assert state is not None
    state = motion(e, state)
    rate = tangent(e.graph, [e.energy], build_states(e.model).flow)[0]
    found, power = evaluate([rate, e.power], state)
    assert found == pytest.approx(power, rel=1e-10, abs=1e-10)  # a, lam from a solve


def test_pendulum() -> None:
    e = derive(pendulum())
    state = random_state(e, 1)
    p, theta, omega = parameters(e), state[e.q[0]], state[e.v[0]]
    m, length, g, k = p["m"], p["l"], p["g"], p["k"]
    assert evaluate([e.mass_matrix[0, 0]], state) == [pytest.approx(m * length**2, rel=CLOSE)]
    assert e.bias_forces[0].is_zero
    drag = -k * length**3 * abs(omega) * omega
    assert evaluate([e.given_forces[0]], state)[0] == pytest.approx(
        -m * g * length * np.sin(theta) + drag, rel=CLOSE
    )
    assert value(e, "p", state) == pytest.approx(m * length**2 * omega, rel=CLOSE)
    assert value(e, "px", state) == pytest.approx(m * length * omega * np.cos(theta), rel=CLOSE)
    assert value(e, "Ly", state) == pytest.approx(-m * length**2 * omega, rel=CLOSE)
    assert value(e, "P", state) == pytest.approx(drag * omega, rel=CLOSE)
    energy = m * length**2 * omega**2 / 2 - m * g * length * np.cos(theta)
    assert value(e, "E", state) == pytest.approx(energy, rel=CLOSE)
    assert e.outputs[5].expression is e.a[0]
    assert {c.name: c.conservative for c in e.contributions} == {"field": True, "drag": False}


def test_unit_quaternions_stay_so() -> None:
    e = derive(free_solid())
    state = random_state(e, 3)
    change = evaluate(e.qdot[3:], state)
    assert sum(state[x] * d for x, d in zip(e.q[3:], change)) == pytest.approx(0.0, abs=1e-15)


def test_rolling_ball_on_a_turntable() -> None:
    """The centre moves with a = 2/7 Omega z x v; the third row follows from the first."""
    e = derive(rolling_ball())
    assert [row.label for row in e.rows] == ["touch", "roll[1]", "roll[2]"]
    assert e.dropped == ("row `roll[3]` is left out: it follows from `touch`",)
    state = consistent_state(e, 6)
    assert state is not None
    state = motion(e, state)
    p = parameters(e)
    rate = 2.0 / 7.0 * p["Omega"]
    ax, ay, _ = (state[x] for x in e.a[:3])
    vx, vy, _ = (state[x] for x in e.v[:3])
    assert [ax, ay] == pytest.approx([-rate * vy, rate * vx], rel=1e-11, abs=1e-12)
    assert value(e, "normal", state) == pytest.approx(p["m"] * p["g"], rel=1e-11)
    assert value(e, "spare", state) == 0.0


def test_charged_particle_turns_at_the_cyclotron_frequency() -> None:
    e = derive(charged_particle())
    state = motion(e, random_state(e, 8))
    p = parameters(e)
    vx, vy, _ = (state[x] for x in e.v)
    push = p["e"] * p["B"] / p["m"]
    assert [state[x] for x in e.a] == pytest.approx([push * vy, -push * vx, 0.0], abs=1e-12)
    expected = p["m"] * vx - 0.5 * p["e"] * p["B"] * state[e.q[1]]
    assert value(e, "px", state) == pytest.approx(expected, rel=CLOSE)
    assert e.power.is_zero
    kinetic = 0.5 * p["m"] * sum(state[x] ** 2 for x in e.v)
    assert evaluate([e.kinetic, e.energy], state) == pytest.approx([kinetic, kinetic], rel=CLOSE)


def test_declared_speeds_give_the_same_motion() -> None:
    plain, spoken = derive(knife_edge()), derive(declared_speeds())
    assert spoken.v_names == ("u", "w", "der(phi)")
    assert list(spoken.rows[0].jacobian) == [1]
    first = consistent_state(plain, 10)
    assert first is not None
    first = motion(plain, first)
    phi = first[plain.q[2]]
    vx, vy, omega = (first[x] for x in plain.v)
    second = {p.symbol: p.value or 0.0 for p in spoken.model.parameters}
    second |= {spoken.time: 0.0, **dict(zip(spoken.q, (first[x] for x in plain.q)))}
    speeds = (vx * np.cos(phi) + vy * np.sin(phi), -vx * np.sin(phi) + vy * np.cos(phi), omega)
    second = motion(spoken, second | dict(zip(spoken.v, speeds)))
    assert value(spoken, "ax", second) == pytest.approx(first[plain.a[0]], rel=1e-11)
    p = parameters(spoken)
    assert value(spoken, "p", second) == pytest.approx(
        p["m"] * (vx - p["d"] * np.sin(phi) * omega), rel=1e-11
    )


def test_relativistic_mass() -> None:
    """M = m (gamma + gamma^3 v v / c^2), K = m c^2 (gamma - 1)."""
    e = derive(relativistic())
    state = random_state(e, 11)
    p = parameters(e)
    v = np.array([state[x] for x in e.v])
    gamma = 1.0 / np.sqrt(1.0 - v @ v / p["c"] ** 2)
    expected = p["m"] * (gamma * np.eye(2) + gamma**3 * np.outer(v, v) / p["c"] ** 2)
    assert mass_matrix(e, state) == pytest.approx(expected, rel=CLOSE)
    kinetic = p["m"] * p["c"] ** 2 * (gamma - 1.0)
    assert evaluate([e.kinetic], state)[0] == pytest.approx(kinetic, rel=1e-11)


def test_driven_disc_keeps_account_of_its_drives() -> None:
    e = derive(rheonomic_disc())
    assert [(r.label, r.level.value, r.time_dependent) for r in e.rows] == [
        ("hub", "position", True),
        ("rolling", "velocity", True),
    ]
    assert not e.power.is_zero


def test_starts_and_conditions_are_in_speeds() -> None:
    b = Builder()
    x, y = b.coordinate("x", 1.0, 2.0), b.coordinate("y", 3.0, 4.0)
    b.particle("p", b.parameter("m"), (x, y, 0.0))
    b.speed("u", b.der(x) + 2.0 * b.der(y))
    b.initially(b.der(x) - 1.0)
    e = derive(b.model())
    assert e.v_names == ("u", "der(y)")
    assert evaluate([s.value for s in e.starts_v], {}) == [10.0, 4.0]
    residual, _ = e.initial_conditions[0]
    assert evaluate([residual], dict(zip(e.v, (10.0, 4.0)))) == [1.0]


def test_what_an_input_does_is_work_from_outside() -> None:
    """A potential and a force that hold an input give power and no energy."""
    b = Builder()
    x, y = b.coordinate("x"), b.coordinate("y")
    u = b.input("u")
    b.particle("p", b.parameter("m", 2.0), (x, y, 0.0))
    b.potential("field", u * x * y)
    b.potential("spring", x * x)
    b.force("push", (0.0, u * u, 0.0), (x, y, 0.0))
    b.output("P", b.quantity("power", "push"))
    e = derive(b.model())
    assert [c.conservative for c in e.contributions] == [False, True, False]
    state = random_state(e, 12)
    at, vx, vy = state[u], *(state[s] for s in e.v)
    assert evaluate([e.potential], state)[0] == pytest.approx(state[x] ** 2, rel=CLOSE)
    expected = -at * (vx * state[y] + vy * state[x]) + at * at * vy
    assert evaluate([e.power], state)[0] == pytest.approx(expected, rel=CLOSE)
    assert value(e, "P", state) == pytest.approx(at * at * vy, rel=CLOSE)


def test_energy_of_a_driven_bead() -> None:
    """On a rod turned at w: kinetic() + potential() is energy(), the balance keeps K2 - K0 + V."""
    b = Builder()
    r, g, w = b.coordinate("r"), b.graph, b.parameter("w", 2.0)
    b.particle("bead", b.parameter("m", 3.0), (r * g.cos(w * b.time), r * g.sin(w * b.time), 0.0))
    b.output("E", b.quantity("energy"))
    e = derive(b.model())
    state = random_state(e, 13)
    reach, speed = state[e.q[0]], state[e.v[0]]
    assert value(e, "E", state) == pytest.approx(1.5 * (speed**2 + 4.0 * reach**2), rel=CLOSE)
    assert evaluate([e.energy], state)[0] == pytest.approx(1.5 * (speed**2 - 4.0 * reach**2), rel=CLOSE)
    assert e.power.is_zero  # Jacobi's integral: the rod's work is not in it


def test_nothing_moves() -> None:
    e = derive(Builder().model())
    verify(e)
    assert e.v == () and e.mass_matrix == {} and e.power.is_zero
