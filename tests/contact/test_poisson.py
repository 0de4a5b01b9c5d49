"""Poisson's law of impact, `law = poisson`, against closed forms and Newton's law."""

import math
from typing import Any

import pytest

import lagc
from lagc.api import Run
from lagc.cli.main import main
from lagc.diagnostics.faults import Refused
from lagc.host import model_library

BACKENDS = ["numpy", pytest.param("c", marks=pytest.mark.full)]


def _matrix(a: float) -> tuple[float, float, float]:
    """Return W_n, W_t and W_nt of the tip of a rod of 1 kg and 1 m at this angle."""
    s, c = math.sin(a), math.cos(a)
    return 1.0 + 3.0 * c * c, 1.0 + 3.0 * s * s, -3.0 * s * c


def _rod(backend: str = "numpy", newton: bool = False, **values: Any) -> Run:
    text = model_library.read("rod_on_its_tip").text
    model = lagc.loads(text.replace("law = poisson", "law = newton") if newton else text)
    return model.compile(backend=backend).simulate(0.01, rtol=1e-9, parameters=values)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_tip_that_sticks_gets_back_its_impulse(backend: str) -> None:
    """Compression: (W_n - W_nt^2/W_t) p = v. Expansion gives e p. Newton's law has u_n = e v instead."""
    run = _rod(backend)
    normal, along, mixed = _matrix(1.2)
    impulse = 1.5 * 2.0 / (normal - mixed**2 / along)
    (hit,) = run.events
    assert hit.kind == "impact" and hit.impulse == pytest.approx(impulse, rel=1e-13)
    assert run.final["der(y)"] == pytest.approx(impulse - 2.0, rel=1e-12)
    assert run.final["der(x)"] == pytest.approx(-mixed / along * impulse, rel=1e-12)


def test_a_tip_that_slides_back_tells_the_laws_apart() -> None:
    """The tip slides forwards, stops, and sticks: Newton's law gives e v, Poisson's e times the impulse."""
    normal, along, mixed = _matrix(1.2)
    u, v, mu, e = 1.0, 2.0, 1.0, 0.5
    compression = v + mixed / along * u
    compression /= normal - mixed**2 / along
    friction = -(u + mixed * compression) / along
    assert abs(friction) < mu * compression
    poisson, newton = _rod(u=u), _rod(u=u, newton=True)
    assert poisson.events[0].impulse == pytest.approx((1.0 + e) * compression, rel=1e-12)
    assert poisson.events[0].impulse != pytest.approx(newton.events[0].impulse, rel=1e-3)


def test_a_tip_that_slides_all_the_time_follows_both_laws() -> None:
    """p = (1 + e) v/(W_n - mu W_nt), with friction against the slip."""
    normal, _, mixed = _matrix(1.2)
    for newton in (False, True):
        run = _rod(u=10.0, mu=0.1, newton=newton)
        assert run.events[0].impulse == pytest.approx(3.0 / (normal - 0.1 * mixed), rel=1e-12)


@pytest.mark.parametrize("backend", BACKENDS)
def test_without_friction_it_is_newtons_law(backend: str) -> None:
    """The rod of the reference: J = (1 + e) v/(1/m + d^2/J)."""
    text = model_library.read("rod_impact").text.replace("restitution = e", "restitution = e, law = poisson")
    run = lagc.loads(text).compile(backend=backend, scene="hit").simulate(rtol=1e-9)
    assert run.events[0].impulse == pytest.approx(1.08894870037899138989, rel=1e-13)


@pytest.mark.parametrize("e", [0.0, 0.4, 1.0])
def test_a_ball_on_a_ball_passes_its_blow_on(e: float) -> None:
    """Two balls touch, a third hits the first: blows pass in rounds, each with (1 + e)/2 of the speed."""
    text = f"""model Row
  coordinate Length a(rate = 1 [m/s]), b(start = 1 [m]), c(start = 2 [m]);
  body A = Particle(mass = 1 [kg], at = {{a, 0, 0}});
  body B = Particle(mass = 1 [kg], at = {{b, 0, 0}});
  body C = Particle(mass = 1 [kg], at = {{c, 0, 0}});
  constraint one: b - a >= 1 [m] (restitution = {e}, law = poisson);
  constraint two: c - b >= 1 [m] (restitution = {e});
end Row;
"""
    laws = [text, text.replace(", law = poisson", "")]
    one, other = (lagc.loads(x).compile(backend="numpy").simulate(0.1, rtol=1e-9) for x in laws)
    assert one.final["der(c)"] == pytest.approx(other.final["der(c)"], abs=1e-14)


def test_an_impact_in_which_newtons_law_adds_energy() -> None:
    """T. R. Kane, D. A. Levinson, Dynamics, 1985, 5.8: it is refused; Poisson's law has an answer."""
    values = {"a": 0.8, "u": 2.0, "e": 0.9, "mu": 0.8}
    refused, run = _rod(newton=True, **values), _rod(**values)
    assert refused.status == "failed" and "`law = poisson` does not" in refused.message
    assert run.status == "ok" and run.events[0].loss > 0.0


def test_the_contact_that_is_hit_is_named_and_not_a_rail_beside_it() -> None:
    """A bead on a rough rail, declared before the rod, takes part in the law but is not hit."""
    rail = """
  coordinate Length s(rate = 1 [m/s]), r;
  body bead = Particle(mass = 1 [kg], at = {s, 0, r});
  constraint rail: r = 0 (friction = 0.1, at = bead);
"""
    text = model_library.read("rod_on_its_tip").text.replace("law = poisson", "law = newton")
    head, body, rest = text.partition("\n  constraint ")
    model = lagc.loads(head + rail + body + rest).compile(backend="numpy")
    run = model.simulate(0.01, parameters={"a": 0.8, "u": 2.0, "e": 0.9, "mu": 0.8})
    assert run.status == "failed" and "where `floor` touches" in run.message


def test_explain_names_the_law(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", "rod_on_its_tip"]) == 0
    assert "restitution e, law poisson, friction mu" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [("restitution = 0.5, law = poison", "there are two laws of impact"),
     ("restitution = 0.5, law = 2", "there are two laws of impact"),
     ("law = poisson", "`law` needs `restitution` beside it"),
     ("restitution = 0.5, laws = poisson", "has no `laws`")],
)  # fmt: skip
def test_what_makes_no_sense_is_refused(arguments: str, message: str) -> None:
    text = f"""model M
  coordinate Length z;
  body ball = Particle(mass = 1 [kg], at = {{0, 0, z}});
  constraint floor: z >= 0 ({arguments});
end M;
"""
    with pytest.raises(Refused) as found:
        lagc.loads(text).compile(backend="numpy")
    assert message in found.value.faults[0].message
