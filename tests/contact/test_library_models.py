"""Models of the library with contacts, against closed forms and integrations of their own."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import lagc
from lagc.api import Run
from lagc.host import model_library

pytestmark = pytest.mark.full
BACKENDS = ["numpy", "c"]
G = 9.81
ALPHA, P2 = 0.2, 3.0 * G / (4.0 * 0.5)
NODES, WEIGHTS = (part / 2.0 for part in np.polynomial.legendre.leggauss(40))
RATIO = 1.0 - 1.5 * math.sin(ALPHA) ** 2


def _quarter(theta: float) -> float:
    """Return the time from rest at theta to upright, by the integral of dtheta/theta' (Gauss)."""
    x = NODES + 0.5
    fallen = theta * x**2  # from theta
    rate = np.sqrt(4.0 * P2 * np.sin((2.0 * (ALPHA - theta) + fallen) / 2.0) * np.sin(fallen / 2.0))
    return float(np.sum(2.0 * WEIGHTS * theta * x / rate))


def _impacts(theta: float) -> list[float]:
    """Return the times of all impacts of Housner's block, down to amplitudes that are no numbers any more."""
    times = [_quarter(theta)]
    while theta > 1e-300:
        # P2 (cos(alpha - theta) - cos(alpha)) is half of the squared rate when upright
        rest = RATIO**2 * 2.0 * math.sin((2.0 * ALPHA - theta) / 2.0) * math.sin(theta / 2.0)
        theta *= RATIO**2
        for _ in range(20):
            left = 2.0 * math.sin((2.0 * ALPHA - theta) / 2.0) * math.sin(theta / 2.0)
            theta -= (left - rest) / math.sin(ALPHA - theta)
        times.append(times[-1] + 2.0 * _quarter(theta))
    return times


def _block(backend: str, law: str = "", scene: str = "few", **given: Any) -> Run:
    text = model_library.read("rocking_block").text.replace("(friction = mu", f"({law}friction = mu")
    model = lagc.loads(text).compile(backend=backend, scene=scene)
    return model.simulate(parameters=given.pop("parameters", {}), **{"accuracy": 1e-9, **given})


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_block_rocks_with_the_times_and_the_ratio_of_housner(backend: str) -> None:
    run = _block(backend, stop=3.0 if backend == "c" else 1.0)
    hits = [event.t for event in run.events if event.kind == "impact"]
    assert len(hits) == (6 if backend == "c" else 2)
    assert hits == pytest.approx(_impacts(0.1)[: len(hits)], rel=1e-10)
    for time, before, after in run.corners:
        if time in hits:
            assert after[5] / before[5] == pytest.approx(RATIO, rel=1e-10)


def test_a_block_stops_rocking_and_stands() -> None:
    """160 impacts until they are lower than 1e-10 of its size, with the times of Housner; the later ones, up
    to 1e-10 of the height of its first fall, hide in the round-off of the gaps. `rests` is early by the
    flights left."""
    run, exact = _block("c", scene="all", accuracy=1e-8), _impacts(0.1)
    hits = [event.t for event in run.events if event.kind == "impact"][:-2]
    assert run.status == "ok" and len(hits) > 150
    assert hits[:160] == pytest.approx(exact[:160], abs=2e-9)
    rests = [event.t for event in run.events if event.kind == "rests"]
    assert exact[len(hits)] - 1e-4 < rests[0] < exact[-1]
    assert run.final["E"] == pytest.approx(G * 0.5 * math.cos(ALPHA), rel=1e-9)
    assert abs(run.final["theta"]) < 1e-20 and abs(run.final["der(theta)"]) < 1e-20


def test_a_slender_block_has_the_period_of_housner() -> None:
    """Small angles: T = 4/p acosh(1/(1 - theta0/alpha)), to the order alpha^2."""
    alpha = 1e-3
    run = _block("c", stop=0.5, parameters={"alpha": alpha, "theta0": alpha / 2.0})
    hits = [event.t for event in run.events if event.kind == "impact"]
    assert hits == pytest.approx([math.acosh(2.0) / math.sqrt(P2)], rel=alpha**2)


@pytest.mark.parametrize("law", ["newton", "poisson"])
def test_both_laws_without_restitution_give_the_ratio_of_housner(law: str) -> None:
    """The floor gives back nothing, and the edge that leaves has no impulse."""
    run = _block("c", f"restitution = 0, law = {law}, ", stop=0.5)
    ((before, after),) = [(before, after) for _, before, after in run.corners]
    assert after[5] / before[5] == pytest.approx(RATIO, rel=1e-12)


@pytest.mark.parametrize("share", [1.01, 0.9, 0.0])
def test_an_edge_slips_in_its_impact_if_friction_is_small(share: float) -> None:
    """It needs 3 sin cos/(4 - 3 sin^2) of the impulse to stick. With a tangential impulse of nu of the normal
    one, p (1 + 3 sin^2 - 3 nu sin cos) = 2 m R sin w, and the rate becomes w - 3 p (sin - nu cos)/(m R)."""
    s, c = math.sin(ALPHA), math.cos(ALPHA)
    least = 3.0 * s * c / (4.0 - 3.0 * s * s)
    nu = min(share, 1.0) * least
    starts = {"theta": 0.0, "der(theta)": -1.0, "der(x)": -0.5 * c, "der(y)": -0.5 * s}
    run = _block("c", stop=1e-3, parameters={"theta0": 0.0, "mu": share * least}, starts=starts)
    impulse = s / (1.0 + 3.0 * s * s - 3.0 * nu * s * c)
    (hit,) = [event for event in run.events if event.kind == "impact"]
    assert hit.t == 0.0 and hit.impulse == pytest.approx(impulse, rel=1e-12)
    rate = 1.0 - 6.0 * impulse * (s - nu * c)
    assert run["der(theta)"][0] == pytest.approx(-rate, rel=1e-12)
    assert (rate == pytest.approx(RATIO, rel=1e-12)) == (share > 1.0)


def _rod_in_bush(w: float, e: float, hits: int) -> list[float]:
    """Return the times of the first impacts of a pin in its bush, by equations of the rod and the slider:
    (J + m l^2/4) theta'' = -m r w^2 l/2 sin(w t + theta), s'' = 0, and impulses along the line of centres."""
    r, length, c, m2, m3 = 0.05, 0.12, 0.5e-3, 0.21, 0.14
    inertia = 0.00025 + m2 * length**2 / 4.0

    def pin(t: float, y: Any) -> tuple[float, float]:
        x = r * math.cos(w * t) + length * math.cos(y[0]) - y[1]
        return x, r * math.sin(w * t) - length * math.sin(y[0])

    def gap(t: float, y: Any) -> float:
        return c - math.hypot(*pin(t, y))

    gap.terminal, gap.direction = True, -1.0  # type: ignore[attr-defined]
    t, y, found = 0.0, np.array([0.0, r + length, w * r / length, 0.0]), []
    for _ in range(hits):
        motion = solve_ivp(
            lambda t, y: [y[2], y[3], -m2 * r * w**2 * length / 2.0 / inertia * math.sin(w * t + y[0]), 0.0],
            (t, t + 0.1), y, "DOP853", events=gap, rtol=1e-13, atol=1e-15, max_step=1e-5,
        )  # fmt: skip
        t, y = float(motion.t_events[0][0]), motion.y_events[0][0]
        found.append(t)
        x, up = pin(t, y)
        x, up = x / math.hypot(x, up), up / math.hypot(x, up)
        turn, slide = length * (x * math.sin(y[0]) + up * math.cos(y[0])), x
        drive = r * w * (x * math.sin(w * t) - up * math.cos(w * t))
        impulse = -(1.0 + e) * (drive + turn * y[2] + slide * y[3]) / (turn**2 / inertia + slide**2 / m3)
        y = y + np.array([0.0, 0.0, turn * impulse / inertia, slide * impulse / m3])
    return found


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_pin_bounces_in_its_bush(backend: str) -> None:
    hits = 8 if backend == "numpy" else 30
    model = lagc.load("slider_crank_with_clearance").compile(backend=backend)
    run = model.simulate(1e-3 if backend == "numpy" else 4e-3, accuracy=1e-10)
    found = [event.t for event in run.events if event.kind == "impact"][:hits]
    assert found == pytest.approx(_rod_in_bush(5000.0 * 2.0 * math.pi / 60.0, 0.9, len(found)), abs=1e-10)


def test_a_small_clearance_moves_the_slider_as_none() -> None:
    """A pin that is c from the centre of the bush moves the slider by c/cos(theta) at most."""
    c, w = 1e-5, 5000.0 * 2.0 * math.pi / 60.0
    model = lagc.load("slider_crank_with_clearance").compile(backend="c")
    run = model.simulate(0.024, accuracy=1e-5, parameters={"c": c, "e": 0.0}, points=2001)
    phi = w * np.array(run.t)
    ideal = 0.05 * np.cos(phi) + np.sqrt(0.12**2 - (0.05 * np.sin(phi)) ** 2)
    assert run.status == "ok"
    assert np.max(np.abs(run["s"] - ideal) * np.cos(run["theta"])) < 1.01 * c


def _tippe_top(stop: float) -> Any:
    """Return the motion of the top on its sphere, in Euler's angles: (theta, phi, psi, x', y', theta', phi',
    psi') with the mass matrix and the rows of contact of R. I. Leine, C. Glocker, 2003, chapter 5. It ends
    where the stem touches."""
    m, i1, i3, a1, a2, r1, r2 = 6e-3, 8e-7, 7e-7, 3e-3, 16e-3, 15e-3, 5e-3
    mu, b = 0.3, 3.0 * math.pi / 16.0 * 5e-4

    def rates(t: float, y: Any) -> list[float]:
        th, ph, _, vx, vy, dth, dph, dps = y
        s, c, sp, cp = math.sin(th), math.cos(th), math.sin(ph), math.cos(ph)
        across, along = (a1 * dph + r1 * dps) * s, dth * (a1 * c - r1)
        slip = np.array([vx + across * cp + along * sp, vy + across * sp - along * cp])
        spin = dph + dps * c
        mass = np.diag([m, m, m, i1, i1 * s * s + i3 * c * c, i3])
        mass[4, 5] = mass[5, 4] = i3 * c
        force = np.array([
            0.0, 0.0, -m * G, ((i1 - i3) * dph * c - i3 * dps) * dph * s,
            -(2.0 * (i1 - i3) * dph * c - i3 * dps) * dth * s, i3 * dph * dth * s,
        ])  # fmt: skip
        normal = np.array([0.0, 0.0, 1.0, -a1 * s, 0.0, 0.0])
        slips = np.array([
            [1.0, 0.0, 0.0, (a1 * c - r1) * sp, a1 * s * cp, r1 * s * cp],
            [0.0, 1.0, 0.0, -(a1 * c - r1) * cp, a1 * s * sp, r1 * s * sp],
        ])  # fmt: skip
        push = normal - mu / math.sqrt(slip @ slip + (b * spin) ** 2) * (slip @ slips)
        pushed, free = np.linalg.solve(mass, push), np.linalg.solve(mass, force)
        found = free + pushed * (a1 * c * dth**2 - normal @ free) / (normal @ pushed)
        return [dth, dph, dps, found[0], found[1], *found[3:]]

    def gap(t: float, y: Any) -> float:
        return r1 - r2 + (a2 - a1) * math.cos(y[0])

    gap.terminal = True  # type: ignore[attr-defined]
    start = [0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 180.0]
    return solve_ivp(rates, (0.0, stop), start, "DOP853", events=gap, rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_tippe_top_turns_over_as_in_eulers_angles(backend: str) -> None:
    stop = 0.05 if backend == "numpy" else 1.5
    run = lagc.load("tippe_top").compile(backend=backend).simulate(stop, accuracy=1e-9)
    exact = _tippe_top(stop)
    if backend == "numpy":
        assert run.final["theta"] == pytest.approx(exact.y[0, -1], abs=1e-8)
        assert run.final["der(x)"] == pytest.approx(exact.y[3, -1], abs=1e-9)
    else:
        (hit,) = [event.t for event in run.events if event.name == "stem: impact"][:1]
        assert hit == pytest.approx(exact.t_events[0][0], abs=1e-7)
        before = next(state for time, state, _ in run.corners if time == hit)
        assert before[7:9] == pytest.approx(exact.y_events[0][0][3:5], abs=1e-8)


def test_a_tippe_top_keeps_jelletts_integral_and_spins_on_its_stem() -> None:
    run = lagc.load("tippe_top").compile(backend="c").simulate(8.0, accuracy=1e-8)
    t, last = np.array(run.t), max(event.t for event in run.events)
    sphere, stem = run["J1"][t < 1.35], run["J2"][t > last]
    assert sphere == pytest.approx(sphere[0], rel=1e-9) and stem == pytest.approx(stem[0], rel=1e-8)
    assert run.final["theta"] > 0.997 * math.pi and np.max(np.diff(run["E"])) < 1e-12
    assert run.final["z"] == pytest.approx(16e-3 + 5e-3, abs=1e-6)  # higher than at its start
