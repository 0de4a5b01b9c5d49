"""What equations say of the clauses `when`: in scripts the list `events`, as SymPy reads it."""

from pathlib import Path
from random import Random
from typing import Any

import pytest

from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.reports.equations.write import write
from lagc.symbolic.walk import evaluate
from tests.reports.models import MODELS, derived, equations_of
from tests.reports.scripts import states_of

sympy = pytest.importorskip("sympy")

WITH_EVENTS = [
    str(path.relative_to(MODELS).with_suffix(""))
    for path in sorted(MODELS.rglob("*.lag"))
    if "reinit(" in path.read_text(encoding="utf-8")
]
ROW = """model Row "Balls beside each other, and two whens alike"
  parameter Mass m = 1 [kg];
  parameter Real e = 0.5;
  coordinate Length x[COUNT](each start = 1 [m]), event[COUNT];
  for i in 1:COUNT loop
    body ball[i] = Particle(mass = m, at = {x[i], event[i], 0});
    when x[i] < event[i]/2 or time > 2 [s] then
      reinit({der(x[i]), der(event[i])}, {-e*der(x[i]), VALUE});
    end when;
  end for;
  when x[1] > x[2] then
    reinit({der(x[1]), der(x[2])}, {der(x[2]), der(x[1])});
  end when;
  when x[1] > x[2] then
    reinit(x[2], 2*x[1]);
  end when;
end Row;
"""
VALUES = ("der(x[i])", "i*der(x[i])", "(if i == 7 then 0 else 1)*der(x[i])", "der(x[i]) + der(event[COUNT])")


def row(count: int, value: str) -> EquationsOfMotion:
    return equations_of(ROW.replace("VALUE", value).replace("COUNT", str(count)))


def assert_same(equations: EquationsOfMotion, full: bool) -> None:
    """Each clause that changes something, in order, with the values of its expressions at random states."""
    space: dict[str, Any] = {"__name__": "script"}
    exec(write(equations, "sympy", full), space)
    clauses = [when for when in equations.whens if when.changes]
    assert len(space["events"]) == len(clauses) > 0
    chance = Random(5)
    for _ in range(8):
        unknowns = (*equations.q, *equations.v, *equations.a, *equations.lam)
        state = {x: chance.uniform(-3, 3) for x in (equations.time, *unknowns)}
        state |= {p.symbol: abs(chance.uniform(0.1, 3)) for p in equations.model.parameters}
        state |= {x.symbol: chance.choice([0.0, 1.0]) for x in equations.model.discretes}
        state |= {x.symbol: chance.uniform(-3, 3) for x in equations.model.inputs}
        values = states_of(space, equations, state)
        for (condition, changes), when in zip(space["events"], clauses):
            (true,) = evaluate([when.condition], state)
            assert bool(condition.xreplace(values)) == bool(true)
            before = [values[state] for state in changes]
            assert before == [state[symbol] for symbol, _ in when.changes]
            expected = evaluate([value for _, value in when.changes], state)
            found = [float(sympy.sympify(value).xreplace(values)) for value in changes.values()]
            assert found == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("name", WITH_EVENTS)
def test_scripts_have_the_events_of_the_library(name: str) -> None:
    scenes = [derived(name, scene) for scene in derived(name).model.scenes]
    acting = [scene for scene in scenes if any(when.changes for when in scene.whens)]
    assert acting
    for scene in acting:
        assert_same(scene, full=True)


@pytest.mark.sample(1)
@pytest.mark.parametrize("value", VALUES)
@pytest.mark.parametrize("full", [True, False])
def test_scripts_have_the_events_of_loops(value: str, full: bool) -> None:
    """By their rules, too, where each clause stays whole."""
    assert_same(row(14, value), full)


def test_events_are_written_by_their_rules() -> None:
    equations = row(20, VALUES[0])
    text = write(equations, full=False)
    assert "event[i]' := x[i]'  when ((x[i] < event[i]/2) or (2 < t))    for i = 1..20" in text
    script = write(equations, "sympy", full=False)
    assert "event_[i].diff(t): x[i].diff(t)}) for i in range(1, 21)]," in script


def test_scripts_without_events_have_no_list_of_them() -> None:
    assert "event" not in write(derived("course/simple_pendulum"), "sympy")


def test_library_has_events() -> None:
    assert {Path(name).name for name in WITH_EVENTS} >= {"thermostat", "clock"}
