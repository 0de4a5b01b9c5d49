"""The equations of models with contacts in each of their modes, against equations written by hand and models
that are held in a mode."""

from pathlib import Path
from typing import Any

import pytest

from lagc.mechanics.derive import derive
from lagc.mechanics.formulation.contacts import MODE_STICKS, hold_contacts
from lagc.mechanics.identities.samples import Chance, samples
from lagc.reports.equations.modes import modes
from lagc.reports.equations.write import write
from lagc.symbolic.walk import evaluate
from tests.reports.models import derived, equations_of

BALL = """model Ball
  parameter Mass m(min = 0) = 1 [kg];
  parameter Real e(min = 0) = 0.5; coordinate Length y(start = 1 [m]);
  Gravity field; body ball = Particle(mass = m, at = {0, y, 0});
  constraint floor: y >= 0 (restitution = e LAW);
  LOAD
end Ball;"""


def script(name: str) -> dict[str, Any]:
    """What the script of a model defines, by SymPy."""
    pytest.importorskip("sympy")
    space: dict[str, Any] = {"__name__": "script"}
    exec(write(derived(name), "sympy"), space)
    return space


def test_a_ball_flies_touches_and_bounces() -> None:
    found = script("contact/bouncing_ball")
    import sympy

    t, y, m, g, e, push = (found[name] for name in ("t", "y", "m", "g", "e", "lambda_floor"))
    assert found["equations"] == [sympy.Eq(y.diff(t, 2) + g, 0)]
    assert found["gaps"] == [y]
    touching = [sympy.Eq(m * y.diff(t, 2) + m * g - push, 0), sympy.Eq(y, 0), sympy.Ge(push, 0)]
    assert found["modes"] == {"floor touches": touching}
    assert found["impacts"] == [(y.diff(t), -e * y.diff(t))]


def test_a_block_sticks_to_a_belt_and_slips() -> None:
    found = script("contact/block_on_belt")
    import sympy

    names = ("t", "x", "y", "m", "k", "g", "w", "mu", "mu_s", "lambda_belt", "F_belt")
    t, x, y, m, k, g, w, mu, mu_s, push, rub = (found[name] for name in names)
    both = [
        sympy.Eq(m * x.diff(t, 2) + k * x - rub, 0),
        sympy.Eq(m * y.diff(t, 2) + m * g - push, 0),
        sympy.Eq(y, 0),
        sympy.Ge(push, 0),
    ]
    sticks, slips = found["modes"]["belt touches and sticks"], found["modes"]["belt touches and slips"]
    assert sticks == [*both, sympy.Eq(x.diff(t) - w, 0), sympy.Le(sympy.Abs(rub), mu_s * push)]
    assert slips[:4] == both
    slip = found["u_belt"]
    assert slips[4:] == [sympy.Eq(slip, x.diff(t) - w), sympy.Eq(rub, -mu * sympy.sign(slip) * push)]


def test_several_contacts_have_one_system_with_their_laws() -> None:
    found = script("contact/newtons_cradle")
    import sympy

    t, m, l, g, e = (found[name] for name in "tmlge")  # noqa: E741
    theta = [found[f"theta_{k}"] for k in range(1, 6)]
    push = [0, *(found[f"lambda_pair_{k}"] for k in range(1, 5)), 0]
    (system,) = found["modes"].values()
    for k, (x, equation) in enumerate(zip(theta, system[:5])):
        expected = m * l**2 * x.diff(t, 2) + m * g * l * sympy.sin(x) - push[k] + push[k + 1]
        assert sympy.expand(equation.lhs - equation.rhs - expected) == 0
    for k, law in enumerate(system[5:]):
        gap = theta[k + 1] - theta[k]
        conditions = sympy.Ge(gap, 0), sympy.Ge(push[k + 1], 0), sympy.Eq(gap * push[k + 1], 0)
        assert law == sympy.And(*conditions)
        rate, after = found["impacts"][k]
        assert rate == gap.diff(t)
        assert sympy.expand(after + e * gap.diff(t)) == 0


def test_a_bead_rubs_on_a_hoop_in_both_directions() -> None:
    """The friction along the unit tangent (-z, x)/r is at most mu times the reaction, 2 r |lambda|."""
    found = script("contact/rough_hoop")
    import sympy

    names = ("t", "x", "z", "m", "g", "mu", "lambda_hoop", "F_hoop", "N_hoop")
    t, x, z, m, g, mu, push, rub, normal = (found[name] for name in names)
    r = sympy.sqrt(x**2 + z**2)
    expected = (
        m * x.diff(t, 2) - 2 * x * push + z / r * rub,
        m * z.diff(t, 2) + m * g - 2 * z * push - x / r * rub,
    )
    for equation, other in zip(found["equations"], expected):
        assert sympy.simplify(equation.lhs - other) == 0
    slip = found["u_hoop"]
    size, along, sticks, slips = found["laws"]
    assert size == sympy.Eq(normal, sympy.Abs(push))
    assert along.lhs == slip
    assert sympy.expand(along.rhs - (x * z.diff(t) - z * x.diff(t)) / r) == 0
    assert sticks == sympy.Or(sympy.Ne(slip, 0), sympy.Le(sympy.Abs(rub), 2 * mu * r * normal))
    assert slips == sympy.Or(sympy.Eq(slip, 0), sympy.Eq(rub, -2 * mu * r * sympy.sign(slip) * normal))


@pytest.mark.parametrize("name", ["incline", "block_on_belt", "painleve_rod", "thrown_across", "slack_rope"])
def test_each_mode_is_the_model_held_in_it(name: str) -> None:
    """The forces, and those of constraints, for any multipliers."""
    equations, chance = derived(f"contact/{name}"), Chance(4711)
    (contact,) = equations.contacts
    for mode, held_as in zip(modes(equations)[1:], (MODE_STICKS, 1) if contact.slips else (1,)):
        held = derive(hold_contacts(equations.model, [held_as]))
        state = next(samples(equations.model, 1, vary=False))
        state.update((symbol, chance.draw()) for symbol in (*equations.v, *equations.a, *contact.forces))
        slides = held_as != MODE_STICKS and len(contact.slips) == 1
        if slides and evaluate([contact.slips[0].rate], state)[0] < 0:
            held = derive(hold_contacts(equations.model, [-1]))
        for law in [x for x in mode.laws if x.kind == "closed" and x.left.record is not None]:
            state[law.left] = evaluate([law.right], state)[0]
        state.update(zip(held.lam, [state[force] for force in contact.forces]))
        found = evaluate(mode.equations.given_forces, state)
        assert found == pytest.approx(total(held, state), rel=1e-12, abs=1e-12)
        assert found != pytest.approx(evaluate(equations.given_forces, state))


def total(held: Any, state: Any) -> list[float]:
    """The given forces and those of constraints."""
    forces = list(evaluate(held.given_forces, state))
    for row in held.rows:
        for j, slope in zip(row.jacobian, evaluate(list(row.jacobian.values()), state)):
            forces[j] += slope * state[row.multiplier]
    return forces


def test_poissons_law_names_its_impulses() -> None:
    text = write(equations_of(BALL.replace("LAW", ", law = poisson").replace("LOAD", "")))
    assert "P2_floor = e*P1_floor" in text


def test_a_load_of_a_push_vanishes_with_it() -> None:
    """A load -reaction(floor) on an open contact is zero."""
    given = BALL.replace("LAW", "").replace("LOAD", "force F = {0, -reaction(floor)/2, 0} at ball;")
    text = write(equations_of(given))
    flight, _, touches = text.partition("// `floor` touches")
    assert "y'' = 0" in flight
    assert "2*m*y'' - lambda_floor = 0" in touches


@pytest.mark.parametrize("word", ["lambda_floor", "modes", "impacts"])
def test_names_of_the_model_stay_its_own(word: str) -> None:
    given = BALL.replace("LAW", "").replace("LOAD", "").replace("Real e(", f"Real {word}(")
    space: dict[str, Any] = {"__name__": "script"}
    pytest.importorskip("sympy")
    exec(write(equations_of(given.replace("= e", f"= {word}")), "sympy"), space)
    import sympy

    (_, after), rate = space["impacts"][0], space["impacts"][0][0]
    assert after == -sympy.Symbol(word, nonnegative=True) * rate


@pytest.mark.full
@pytest.mark.parametrize("path", sorted(Path("models/contact").glob("*.lag")), ids=lambda path: path.stem)
def test_every_model_with_contacts_is_written(path: Path) -> None:
    """In all formats; SymPy reads the script."""
    pytest.importorskip("sympy")
    equations = derived(f"contact/{path.stem}")
    for full in (False, True):
        for format in ("text", "latex", "sympy"):
            text = write(equations, format, full)
            assert format == "latex" or all(contact.label in text for contact in equations.contacts)
        exec(text, {"__name__": "script"})


CHAIN = """model Chain
  parameter Mass m(min = 0) = 1 [kg]; parameter Length l(min = 0) = 1 [m];
  coordinate Angle th[14](each start = 0.1 [rad]);
  Gravity field;
  point P[0] = {0 [m], 0 [m], 0 [m]};
  for i in 1:14 loop
    point P[i] = P[i-1] + {l*sin(sum(th[k] for k in 1:i)), 0 [m], -l*cos(sum(th[k] for k in 1:i))};
    body b[i] = Particle(mass = m, at = P[i]);
    constraint floor[i]: P[i].z >= -5 [m] (friction = 0.3, slip = der(P[i].x));
  end for;
end Chain;"""


@pytest.mark.full
def test_modes_of_large_models_have_their_own_parts() -> None:
    """As recursions: each force is in a part or an equation of motion."""
    pytest.importorskip("sympy")
    space: dict[str, Any] = {"__name__": "script"}
    exec(write(equations_of(CHAIN), "sympy", False), space)
    (system,) = space["modes"].values()
    assert len(space["equations"]) == 14
    assert len(space["impacts"]) == 14
    moved = str([equation for equation in system if equation.is_Equality])
    assert all(f"{force}_floor[{i}]" in moved for force in ("F", "lambda") for i in range(1, 15))
