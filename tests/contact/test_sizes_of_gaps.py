"""Each gap has its own size: nothing of a contact depends on the size of another quantity."""

import math

import pytest

import lagc
from lagc.api import Run
from lagc.diagnostics.faults import Refused

BACKENDS = ["numpy", pytest.param("c", marks=pytest.mark.full)]
G = 9.81


def _run(text: str, stop: float, backend: str = "numpy", accuracy: float = 1e-6) -> Run:
    scene = f"scene s\n simulate(stop = {stop} [s], accuracy = {accuracy});\nend s;"
    return lagc.loads(f"model M\n{text}\n{scene}\nend M;").compile(backend=backend).simulate()


def _ball(x: float, z: float, contact: str) -> str:
    return f"""coordinate Length x(start = {x} [m]), z(start = {z} [m]);
      body b = Particle(mass = 1 [kg], at = {{x, 0, z}});
      Gravity field(g = {G} [m/s2]);
      {contact}"""


def _bounces(height: float, e: float, t: float) -> tuple[int, float]:
    """Return how many impacts a dropped ball has had until t, and its height then."""
    speed, last, count = math.sqrt(2.0 * G * height), math.sqrt(2.0 * height / G), 1
    if t < last:
        return 0, height - G * t * t / 2.0
    while True:
        speed *= e
        if t < last + 2.0 * speed / G:
            return count, speed * (t - last) - G * (t - last) ** 2 / 2.0
        last += 2.0 * speed / G
        count += 1


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("x", [0.0, 6.4e6])
def test_a_ball_bounces_alike_wherever_it_is(x: float, backend: str) -> None:
    """A ball dropped from 0.5 mm, here and 6400 km away along the floor, against parabolas."""
    count, height = _bounces(5e-4, 0.8, 0.06)
    run = _run(_ball(x, 5e-4, "constraint floor: z >= 0 (restitution = 0.8);"), 0.06, backend)
    assert run.status == "ok" and len(run.events) == count == 5
    assert run.final["z"] == pytest.approx(height, abs=1e-6 * 5e-4)


def test_the_length_of_a_wire_does_not_end_the_bounces_of_a_bead() -> None:
    """The same where the other length is that of another body, which swings."""
    other = """coordinate Length y(start = 1e6 [m]);
      body far = Particle(mass = 1 [kg], at = {0, y, 0});
      potential wire = 1 [N/m]*y^2/2;"""
    count, height = _bounces(5e-4, 0.8, 0.06)
    run = _run(_ball(0.0, 5e-4, "constraint floor: z >= 0 (restitution = 0.8);") + other, 0.06)
    assert len(run.events) == count and run.final["z"] == pytest.approx(height, abs=1e-6 * 5e-4)


def test_a_gap_with_a_small_factor_is_followed() -> None:
    """A gap z/L from 1, under 9.81 L m/s2: the second flight after 1 s, with e = 1/2."""
    text = """parameter Length L = 1e13 [m];
      coordinate Length z(start = L);
      body ball = Particle(mass = 1 [kg], at = {0, 0, z});
      force f = {0, 0, -9.81*L*1 [kg/s2]} at ball;
      constraint ground: z/L >= 0 (restitution = 0.5);"""
    run = _run(text, 1.0)
    assert run["z"][0] == 1e13 and len(run.events) == 2
    count, height = _bounces(1.0, 0.5, 1.0)
    assert count == 2 and run.final["z"] / 1e13 == pytest.approx(height, abs=1e-6)


@pytest.mark.parametrize("start", [0.1, 0.4])
def test_a_stop_where_nothing_pushes_ends_no_bounces_early(start: float) -> None:
    """A mass on a spring hits a stop at the place of its rest, where it has no acceleration: half swings with
    speeds v, v/2, v/4, ..., for ever, one each pi/w."""
    text = f"""coordinate Length x(start = {start} [m]);
      body b = Particle(mass = 1 [kg], at = {{x, 0, 0}});
      potential spring = 100 [N/m]*x^2/2;
      constraint stop: x >= 0 (restitution = 0.5);"""
    run = _run(text, 3.0)
    times = [event.t for event in run.events]
    assert {event.kind for event in run.events} == {"impact"}
    assert times == pytest.approx([math.pi * (k + 0.5) / 10.0 for k in range(len(times))], abs=1e-6)
    assert len(times) == 10


@pytest.mark.parametrize("x", [0.0, 6.4e6])
def test_a_start_below_the_floor_is_refused_wherever_it_is(x: float) -> None:
    with pytest.raises(Refused) as raised:
        _run(_ball(x, -1e-3, "constraint floor: z >= 0;"), 0.1)
    assert raised.value.faults[0].code == "LAG0624" and "0.001 m beyond" in raised.value.faults[0].message


def test_a_start_that_rounding_has_put_below_the_floor_is_said() -> None:
    """1e-10 m below a floor whose height has terms of 1 m: no start is moved without a word."""
    run = _run(_ball(1.0, 0.9999999999, "constraint floor: z >= x;"), 0.1)
    assert any("1e-10 m beyond the bound `floor`" in note for note in run.notes), run.notes
    assert run.final["z"] == run.final["x"]
