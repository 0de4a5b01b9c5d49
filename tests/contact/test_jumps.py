"""Bounds that jump or bend, and new values beside contacts, against closed forms."""

import math

import pytest

import lagc
from lagc.api import Run
from lagc.diagnostics.faults import Refused

BACKENDS = ["numpy", pytest.param("c", marks=pytest.mark.full)]
G = 9.81


def _run(
    text: str,
    backend: str = "numpy",
    stop: float = 2.0,
    mass: str = "1 [kg]",
    z: float = 0.0,
    vx: float = 0.0,
) -> Run:
    model = f"""model M
      coordinate Length x(rate = {vx} [m/s]), z(start = {z} [m]);
      Gravity field(g = 9.81 [m/s2]);
      body ball = Particle(mass = {mass}, at = {{x, 0, z}});
      {text}
      scene s
        simulate(stop = {stop} [s], accuracy = 1e-9);
      end s;
    end M;"""
    return lagc.loads(model).compile(backend=backend).simulate()


def _acts(run: Run, contact: str) -> list[tuple[str, float]]:
    return [(event.kind, event.t) for event in run.events if event.contact == contact]


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    "bound",
    [
        "(if time < 0.7 [s]/3 then 0 [m] else 0.5 [m])",
        'table(time, {0, 0.7/3} [s], {0, 0.5} [m], interpolation = "held")',
    ],
)
def test_a_bound_that_jumps_over_a_body_ends_the_run(backend: str, bound: str) -> None:
    run = _run(f"constraint bench: z >= {bound};", backend)
    assert run.status == "failed" and run.final["z"] == 0.0
    assert "at t = 0.233333 s" in run.message and "0.5 m beyond the bound `bench`" in run.message


def test_a_body_that_comes_to_a_step_ends_the_run() -> None:
    run = _run("constraint stair: z >= (if x < 0.7 [m] then 0 [m] else 0.3 [m]);", vx=1.0)
    assert run.status == "failed" and "0.3 m beyond the bound `stair`" in run.message
    assert run.final["x"] == pytest.approx(0.7, abs=1e-9)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_bound_that_jumps_away_lets_the_body_fall(backend: str) -> None:
    run = _run("constraint bench: z >= (if time < 0.25 [s] then 0 [m] else -1 [m]);", backend, 0.6)
    assert run.status == "ok" and _acts(run, "bench") == [("opens", 0.25)]
    assert run.final["z"] == pytest.approx(-G * 0.35**2 / 2.0, abs=1e-9)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("e", [0.0, 0.5])
def test_a_bound_whose_speed_jumps_has_an_impact(backend: str, e: float) -> None:
    """The ball gets (1 + e) times the jump; with e = 0 the bound carries it on."""
    heights = 'table(time, {0, 1, 2} [s], {0, 0, 1} [m], interpolation = "linear")'
    run = _run(f"constraint bench: z >= {heights} (restitution = {e});", backend, 1.1)
    assert run.status == "ok"
    hit = next(event for event in run.events if event.contact == "bench")
    assert (hit.kind, hit.t) == ("impact", 1.0)
    assert hit.impulse == pytest.approx(1.0 + e, rel=1e-12)
    exact = 0.15 - G * 0.1**2 / 2.0 if e else 0.1
    assert run.final["z"] == pytest.approx(exact, abs=1e-9)
    assert abs(run.energy.imbalance) < 1e-9


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_kick_lets_a_ball_leave(backend: str) -> None:
    run = _run("constraint bench: z >= 0 (restitution = 0.5);\n"
               "when time >= 0.3 [s] then reinit(der(z), 2 [m/s]); end when;", backend)  # fmt: skip
    assert run.status == "ok"
    acts = _acts(run, "bench")
    assert acts[0] == ("opens", 0.3) and acts[1][0] == "impact" and acts[-1][0] == "rests"
    assert acts[1][1] == pytest.approx(0.3 + 4.0 / G, abs=1e-9)
    assert acts[-1][1] == pytest.approx(0.3 + 4.0 / G * 2.0, abs=1e-9)
    assert run.final["z"] == 0.0 and abs(run.energy.work) < 1e-9  # 2 J given by the kick, 2 J lost


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_kick_into_a_floor_is_an_impact(backend: str) -> None:
    run = _run("constraint bench: z >= 0 (restitution = 0.5);\n"
               "when time >= 0.3 [s] then reinit(der(z), -2 [m/s]); end when;", backend, 0.4)  # fmt: skip
    hit = next(event for event in run.events if event.contact == "bench")
    assert (hit.kind, hit.t) == ("impact", 0.3) and hit.impulse == pytest.approx(3.0)
    assert run.final["der(z)"] == pytest.approx(1.0 - G * 0.1, abs=1e-9)


def test_a_body_that_is_lifted_falls_and_one_that_is_put_down_touches() -> None:
    run = _run("constraint bench: z >= 0;\n"
               "when time >= 0.3 [s] then reinit(z, 0.2 [m]); end when;\n"
               "when time >= 0.4 [s] then reinit(z, 0); reinit(der(z), 0); end when;", stop=0.6)  # fmt: skip
    assert _acts(run, "bench") == [("opens", 0.3), ("closes", 0.4)]
    assert run.status == "ok" and run.final["z"] == 0.0 and run.final["bench"] == 1.0


@pytest.mark.parametrize("backend", BACKENDS)
def test_new_values_beyond_a_bound_end_the_run(backend: str) -> None:
    run = _run("constraint bench: z >= 0;\n"
               "when time >= 0.3 [s] then reinit(z, -0.25 [m]); end when;", backend, z=1.0)  # fmt: skip
    assert run.status == "failed" and "at t = 0.3 s" in run.message
    assert "0.25 m beyond the bound `bench`" in run.message
    assert run.final["z"] == pytest.approx(1.0 - G * 0.09 / 2.0)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_conveyor_that_is_switched(backend: str) -> None:
    """A load slips for v/(mu g) after the belt starts or stops."""
    run = _run("discrete Velocity belt(start = 0);\n"
               "constraint bench: z >= 0 (friction = 0.3, slip = der(x) - belt);\n"
               "when time >= 0.5 [s] then reinit(belt, 1 [m/s]); end when;\n"
               "when time >= 1.5 [s] then reinit(belt, 0); end when;", backend)  # fmt: skip
    slips = 1.0 / (0.3 * G)
    expected = [("slips", 0.5), ("sticks", 0.5 + slips), ("slips", 1.5), ("sticks", 1.5 + slips)]
    assert [kind for kind, _ in _acts(run, "bench")] == [kind for kind, _ in expected]
    assert [t for _, t in _acts(run, "bench")] == pytest.approx([t for _, t in expected], abs=1e-9)
    assert run.final["x"] == pytest.approx(1.0, abs=1e-9) and run.final["der(x)"] == 0.0


@pytest.mark.full
def test_both_backends_give_the_same_bits_with_new_values() -> None:
    text = """constraint floor: z >= 0 (friction = 0.3, slip = der(x), restitution = 0.2);
      when der(z) > -0.1 [m/s] then reinit(der(x), 1 [m/s]); end when;
      when time >= 1.2 [s] then reinit(der(z), -2 [m/s]); end when;"""
    one, other = (_run(text, backend, z=1.0) for backend in ("numpy", "c"))
    assert one.status == "ok" and one.states == other.states and one.events == other.events


@pytest.mark.parametrize("mass", ["3e-3 [kg]", "700 [kg]"])
def test_what_lies_under_a_changing_load_stays(mass: str) -> None:
    """All states are zero: round-off of the accelerations is no motion. It leaves where the load is zero."""
    weight = f"{mass}*(9.81 [m/s2])*time/(1 [s])"
    run = _run(f"constraint bench: z >= 0;\nforce lift = {{0, 0, {weight}}} at ball;", stop=1.5, mass=mass)
    assert run.status == "ok" and [kind for kind, _ in _acts(run, "bench")] == ["opens"]
    assert run.final["z"] == pytest.approx(G * 0.5**3 / 6.0, abs=1e-9)
    assert math.isclose(run.events[0].t, 1.0, abs_tol=1e-9)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_press_that_closes_is_named(backend: str) -> None:
    run = _run("constraint low: z >= 0;\n"
               "constraint press: z <= 1 [m] - (0.6 [m/s])*time;", backend, z=0.5)  # fmt: skip
    assert run.status == "failed"
    assert "at t = 1.66667 s" in run.message and "`low`" in run.message and "`press`" in run.message


def test_two_bounds_in_one_line_have_a_remedy() -> None:
    with pytest.raises(Refused) as refused:
        _run("constraint floor: 0 <= z <= 2 [m];")
    remedy = "`constraint floor_1: 0 <= z;` and `constraint floor_2: z <= 2 [m];`"
    assert remedy in str(refused.value.faults[0].remedy)
    run = _run("constraint floor_1: 0 <= z;\nconstraint floor_2: z <= 2 [m];")
    assert run.status == "ok"


def test_an_impact_may_trigger_new_values() -> None:
    """A pad that throws: each impact gives 3 m/s upwards, and the impact stays in the record."""
    run = _run("constraint pad: z >= 0;\n"
               "when impulse(pad) > 0 then reinit(der(z), 3 [m/s]); end when;", stop=0.8, z=1.0)  # fmt: skip
    fall = math.sqrt(2.0 / G)
    assert run.status == "ok"
    assert [kind for kind, _ in _acts(run, "pad")] == ["impact"]
    first = next(event for event in run.events if event.contact == "pad")
    assert first.t == pytest.approx(fall, abs=1e-9) and first.impulse == pytest.approx(math.sqrt(2.0 * G))
    left = 0.8 - fall
    assert run.final["z"] == pytest.approx(3.0 * left - G * left**2 / 2.0, abs=1e-8)
