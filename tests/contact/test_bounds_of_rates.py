"""Bounds of velocities: one-way clutches and ratchets, against closed forms. Friction that cannot be is
refused; what it couples and what it spoils is told."""

import math
import random
from collections.abc import Callable

import numpy as np
import pytest

import lagc
from lagc.compiler.pipeline import Contents, delivered
from lagc.diagnostics.faults import Refused

BACKENDS = ["numpy", pytest.param("c", marks=pytest.mark.full)]

HUB = """model Hub "a wheel with friction of its bearing, driven by a shaft that turns to and fro"
  parameter Inertia J = 0.5 [kg.m2];
  parameter RotationalDamping c = 0.4 [N.m.s/rad];
  parameter AngularVelocity W = 3 [rad/s], w = 2 [rad/s];
  coordinate Angle hub(rate = 0);
  body wheel = Solid(mass = 1 [kg], inertia = J*{1, 1, 1}, frame = rotate_z(world, hub), com = {0, 0, 0});
  dissipation bearing = c*der(hub)^2/2;
  constraint clutch: der(hub) >= W*sin(w*time);
  output Torque drive = reaction(clutch);
  scene s
    simulate(stop = 6 [s], accuracy = 1e-9);
  end s;
end Hub;"""

WHEELS = """model Wheels "the hub is never slower than the sprocket, and may hit a stop"
  parameter AngularVelocity a = 1 [rad/s], b = 2 [rad/s];
  coordinate Angle sprocket(rate = a), hub(rate = b);
  frame A = rotate_z(world, sprocket);
  frame B = rotate_z(world, hub);
  body one = Solid(mass = 1 [kg], inertia = {1, 1, 1}*3 [kg.m2], frame = A, com = {0, 0, 0});
  body two = Solid(mass = 1 [kg], inertia = {1, 1, 1}*2 [kg.m2], frame = B, com = {0, 0, 0});
  constraint clutch: der(hub) >= der(sprocket);
  constraint stop: hub <= 1 [rad] (restitution = 0.5);
  scene s
    simulate(stop = 1 [s], accuracy = 1e-9);
  end s;
end Wheels;"""

PAWL = """model Pawl "a ratchet: a mass on a spring moves forwards alone"
  coordinate Length x(start = -1 [m], rate = 0);
  body load = Particle(mass = 2 [kg], at = {x, 0, 0});
  potential spring = 18 [N/m]*x^2/2;
  constraint pawl: der(x) >= 0;
  output Force held = reaction(pawl);
  scene s
    simulate(stop = 2 [s], accuracy = 1e-9);
  end s;
end Pawl;"""


def _root(f: Callable[[float], float], low: float, high: float) -> float:
    from scipy.optimize import brentq

    return float(brentq(f, low, high, xtol=1e-14, rtol=1e-14))


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_one_way_clutch_that_a_sinusoid_drives(backend: str) -> None:
    """It opens where the torque J W w cos(w t) + c W sin(w t) falls to zero. The hub then coasts,
    J h'' = -c h', until the shaft is as fast again; there speeds do not jump."""
    inertia, c, top, w = 0.5, 0.4, 3.0, 2.0
    run = lagc.loads(HUB).compile(backend=backend).simulate()
    opens = (math.pi - math.atan(inertia * w / c)) / w
    fast = top * math.sin(w * opens)
    closes = _root(
        lambda t: fast * math.exp(-c * (t - opens) / inertia) - top * math.sin(w * t), math.pi, math.pi + 0.7
    )
    assert run.status == "ok"
    assert [event.kind for event in run.events] == ["opens", "closes", "opens"]
    times = [event.t for event in run.events]
    assert times == pytest.approx([opens, closes, opens + math.pi], abs=1e-8)
    t = run.t
    coasts = (opens <= t) & (t <= closes)
    first, second = t < opens, (closes < t) & (t < opens + math.pi)
    speed, drive = run["der(hub)"], run["drive"]
    driven = inertia * top * w * np.cos(w * t) + c * top * np.sin(w * t)
    assert speed[coasts] == pytest.approx(fast * np.exp(-c * (t[coasts] - opens) / inertia), abs=1e-7)
    for part in (first, second):
        assert speed[part] == pytest.approx(top * np.sin(w * t[part]), abs=1e-12)
        assert drive[part] == pytest.approx(driven[part], abs=1e-7)
    assert not drive[coasts][1:-1].any()


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_hub_that_rebounds_takes_the_sprocket_with_it(backend: str) -> None:
    """The open clutch takes part in the impact on the stop. The hub rebounds at -1 rad/s, the clutch brings
    both to one speed, 1/5 rad/s, with which the hub hits the stop again, ..., until both are at rest: the
    stop has taken the angular momentum of both, 7 kg m2/s, and the clutch that of the sprocket, 3 kg m2/s."""
    run = lagc.loads(WHEELS).compile(backend=backend).simulate()
    assert [(event.contact, event.kind) for event in run.events] == [("clutch", "impact"), ("stop", "impact")]
    assert [event.t for event in run.events] == pytest.approx([0.5, 0.5], abs=1e-12)
    assert [event.impulse for event in run.events] == pytest.approx([3.0, 7.0], rel=1e-9)
    assert run.final["der(hub)"] == run.final["der(sprocket)"] == 0.0


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_ratchet_holds_what_its_spring_pulls_back(backend: str) -> None:
    """Half a swing with w = 3 rad/s, from -1 m to 1 m; there the pawl bears k x = 18 N."""
    run = lagc.loads(PAWL).compile(backend=backend).simulate()
    (event,) = run.events
    assert (run.status, event.kind) == ("ok", "closes") and event.t == pytest.approx(math.pi / 3.0, abs=1e-9)
    assert run.final["x"] == pytest.approx(1.0, abs=1e-9) and run.final["der(x)"] == 0.0
    assert run["held"][-1] == pytest.approx(18.0, rel=1e-8)


def test_a_bound_whose_speed_jumps_drives_at_once() -> None:
    """The shaft is at 2 rad/s from t = 0.25 s on: an impulse brings the hub to it."""
    text = PAWL.replace("der(x) >= 0", "der(x) >= (if time < 0.25 [s] then -9 [m/s] else 5 [m/s])")
    run = lagc.loads(text).compile(backend="numpy").simulate()
    event = next(event for event in run.events if event.contact == "pawl")
    assert (event.kind, event.t) == ("impact", 0.25)
    assert event.impulse == pytest.approx(2.0 * (5.0 - 3.0 * math.sin(0.75)), rel=1e-8)
    assert run.final["der(x)"] == pytest.approx(5.0, rel=1e-12)


def test_a_new_speed_is_shared_by_the_clutch() -> None:
    """A clause `when` gives the hub -1 rad/s: the clutch gives both (2 (-1) + 3 1)/5 rad/s."""
    clause = "when time >= 0.25 [s] then reinit(der(hub), -1 [rad/s]); end when;"
    text = WHEELS.replace("constraint stop: hub <= 1 [rad] (restitution = 0.5);", clause)
    run = lagc.loads(text).compile(backend="numpy").simulate()
    event = next(event for event in run.events if event.contact == "clutch")
    assert (event.kind, event.t) == ("impact", 0.25) and event.impulse == pytest.approx(2.4, rel=1e-12)
    assert run.final["der(hub)"] == pytest.approx(0.2, rel=1e-12) == run.final["der(sprocket)"]


@pytest.mark.full
@pytest.mark.parametrize("seed", range(3))
def test_clutches_in_a_train_never_slip_back_and_keep_momentum(seed: int) -> None:
    """Five masses in a row, each not slower than the one before. The loads change the momentum of all, by
    sum F (1 - cos(w t))/w; clutches pass it on."""
    draw = random.Random(seed).uniform
    mass, force, w = ([draw(low, high) for _ in range(5)] for low, high in ((1, 3), (-9, 9), (1, 4)))
    parts = [
        f"coordinate Length x{k}(rate = 0);\n"
        f"body b{k} = Particle(mass = {mass[k]} [kg], at = {{x{k}, 0, 0}});\n"
        f"force f{k} = {{{force[k]} [N]*sin({w[k]} [1/s]*time), 0, 0}} at b{k};\n"
        for k in range(5)
    ]
    parts += [
        f"constraint c{k}: der(x{k + 1}) >= der(x{k});\noutput Force r{k} = reaction(c{k});\n"
        for k in range(4)
    ]
    text = (
        f"model Train\n{''.join(parts)}scene s\nsimulate(stop = 4 [s], accuracy = 1e-8);\nend s;\nend Train;"
    )
    run = lagc.loads(text).compile(backend="numpy").simulate()
    assert run.status == "ok" and {event.kind for event in run.events} == {"closes", "opens"}
    momentum = sum(m * run[f"der(x{k})"] for k, m in enumerate(mass))
    assert momentum == pytest.approx(sum(f * (1 - np.cos(a * run.t)) / a for f, a in zip(force, w)), abs=1e-6)
    for k in range(4):
        lead, push = run[f"der(x{k + 1})"] - run[f"der(x{k})"], run[f"r{k}"]
        assert lead.min() > -1e-12 and push.min() > -1e-6
        assert np.abs(lead * push).max() < 1e-6  # either runs ahead or is driven


def test_a_start_against_the_clutch_is_refused() -> None:
    with pytest.raises(Refused) as raised:
        lagc.loads(WHEELS).compile(backend="numpy").simulate(parameters={"a": 3.0})
    assert "beyond the bound `clutch`" in raised.value.faults[0].message


@pytest.mark.parametrize(
    ("bound", "message"),
    [
        ("der(x) >= 0 (restitution = 0.5)", "restricts velocities, so it has no `restitution`"),
        ("der(x) >= 0 (friction = 0.5, slip = der(x))", "restricts velocities, so it has no `friction`"),
        ("der(x)^2 <= 1 [m2/s2]", "not linear in the velocities"),
    ],
)
def test_what_no_bound_of_velocities_has_is_refused(bound: str, message: str) -> None:
    with pytest.raises(Refused) as raised:
        lagc.loads(PAWL.replace("der(x) >= 0", bound).replace("reaction(pawl)", "0")).compile(backend="numpy")
    assert message in raised.value.faults[0].message


SLOPE = """model M
  parameter Real mu = 0.4, mu_s = 0.5, one = 1;
  parameter Length r = 5 [mm];
  coordinate Length s(rate = {rate} [m/s]), n;
  Gravity field(g = 9.81 [m/s2]);
  body block = Particle(mass = 1 [kg], at = {{s*cos(12 [deg]), 0, -s*sin(12 [deg])}} + n*{{0, 0, 1}});
  {rows}
  scene run
    simulate(stop = 0.5 [s]);
  end run;
end M;
"""


def _model(rows: str, rate: float = 0.0) -> lagc.ModelFile:
    return lagc.loads(SLOPE.format(rows=rows, rate=rate))


@pytest.mark.parametrize("relation", ["=", ">="])
def test_static_friction_below_that_of_sliding_is_refused(relation: str) -> None:
    text = f"constraint slope: n {relation} 0 [m] (friction = mu, static = mu_s, slip = der(s));"
    compiled = _model(text).compile(backend="numpy")
    with pytest.raises(Refused) as refused:
        compiled.simulate(parameters={"mu_s": 0.3})
    assert [fault.code for fault in refused.value.faults] == ["LAG0617"]
    assert compiled.simulate(accuracy=1e-6).final["s"] == 0.0


@pytest.mark.parametrize("relation", ["=", ">="])
def test_static_friction_is_at_least_that_of_sliding(relation: str) -> None:
    """Where it depends on the slip: tan(12 deg) = .21 is above `static`, and below what friction holds."""
    law = "friction = 0.1*one + 0.2*exp(-slip/(0.1 [m/s])), static = 0.2"
    model = _model(f"constraint slope: n {relation} 0 [m] ({law}, slip = der(s));")
    run = model.compile(backend="numpy").simulate(accuracy=1e-6)
    assert run.status == "ok" and run.final["s"] == 0.0 and 0.2 < math.tan(math.radians(12.0)) < 0.3


def test_a_pin_has_no_negative_radius() -> None:
    pin = """  body rod = Solid(mass = 1 [kg], inertia = {0, 0.1, 0.1} [kg.m2], com = {0.5 [m], 0, 0});
  joint pin = Revolute(world, rod, axis = world.y, at = {0, 0, 0}, friction = 0.2, radius = -5 [mm]);"""
    with pytest.raises(Refused) as refused:
        _model(pin).compile(backend="numpy")
    assert [fault.code for fault in refused.value.faults] == ["LAG0235"]


@pytest.mark.parametrize("relation", ["=", ">="])
def test_no_code_of_a_method_that_follows_no_contacts(relation: str) -> None:
    model = _model(f"constraint slope: n {relation} 0 [m] (friction = mu, slip = der(s));")
    with pytest.raises(Refused) as refused:
        delivered(model.compile().compilation, Contents(["taylor"]))
    assert [fault.code for fault in refused.value.faults] == ["LAG0623"]


def test_friction_couples_what_it_presses_with_what_it_slows() -> None:
    rows = """constraint slope: n = 0 [m] (friction = 0.05, slip = der(s));
  force up = {0, 0, 20[N]*sin(3[rad/s]*time)} at block;"""
    fixed = rows.replace(" (friction = 0.05, slip = der(s))", "")
    texts = [SLOPE.format(rows=text, rate=1.0).replace("12 [deg]", "0") for text in (rows, fixed)]
    notes = [" ".join(lagc.loads(text).compile(backend="numpy").interface.notes) for text in texts]
    assert ["independent" in note for note in notes] == [False, True]
