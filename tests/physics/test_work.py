"""In every model, energy at the start + the work of each action, constraint and event = energy at the end.

The works are sums of the powers along the motion, apart from the run's own integral and from the energies.
"""

import pytest

import lagc
from lagc.api import Run
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.simulation.works import Works, works
from lagc.symbolic.walk import symbols
from tests.physics.library import compiled, fullest, scenes

SPAN = 0.5  # s, of a smooth motion
EVENTFUL = 1.5  # s, of one with events
ACCURACY = 1e-6
TOLERANCE = 1e-6  # of the largest energy or work


def _works(model: lagc.CompiledModel) -> tuple[Works, Run]:
    equations, system = model.equations, model.system
    events = equations.whens or equations.contacts or model.interface.relations
    longest = EVENTFUL if events else SPAN
    stop = min(longest, float(model.interface.simulate.get("stop", longest)))
    run = model.simulate(stop, accuracy=ACCURACY, points=2)
    assert run.status in ("ok", "terminated"), run.message
    found = works(equations, system, run.states[0], run.times[-1], "dop853")
    assert found is not None
    return found, run


def _drives(equations: EquationsOfMotion) -> bool:
    """Whether energies or velocities are given functions of time."""
    carried = [x for part in equations.inertias for x in part.carried]
    return equations.time in symbols([equations.energy, equations.potential, *carried])


CASES = sorted({*fullest(), *[(n, s) for n, s in scenes() if n.startswith(("contact/", "hard/walls"))]})


@pytest.mark.full
@pytest.mark.parametrize(("name", "scene"), CASES, ids=[f"{n}-{s}" for n, s in CASES])
def test_energy_changes_by_the_work_of_each_action(name: str, scene: str) -> None:
    model = compiled(name, scene, "numpy")
    equations = model.equations
    found, run = _works(model)
    taken = [found.actions[c.name] for c in equations.contributions if not c.conservative]
    given = [*taken, *found.rows.values(), *found.clauses.values()]
    size = max(map(abs, [found.start, found.end, *found.actions.values(), *given]))
    balance = found.end - found.start - sum(given)
    if not _drives(equations) and not equations.contacts:
        assert balance == pytest.approx(0.0, abs=TOLERANCE * size)
        assert found.rest == pytest.approx(0.0, abs=TOLERANCE * size)
    assert balance == pytest.approx(found.rest, abs=TOLERANCE * size)
    impacts_alone = equations.contacts and not any(c.slips for c in equations.contacts)
    if impacts_alone and not _drives(equations):  # they work by impacts alone
        losses = sum(event.loss for event in run.events if event.t > 0.0)
        assert found.rest == pytest.approx(-losses, abs=TOLERANCE * size)


def test_an_event_and_a_potential_have_their_works() -> None:
    """A mass falls from 1 m; at z = 0.5 m it gets twice its speed: m g h = 4.905 J more."""
    model = lagc.loads("""model Kicked
  coordinate Length z(start = 1 [m]);
  body b = Particle(mass = 1 [kg], at = {0, 0, z});
  Gravity field(g = 9.81 [m/s2]);
  force push = {0, 0, 2 [N]} at b;
  when z < 0.5 [m] then reinit(der(z), 2*der(z)); end when;
  scene all simulate(stop = 0.4 [s]); end all;
end Kicked;
""").compile(backend="numpy")
    run = model.simulate(accuracy=1e-9, points=2)
    found = works(model.equations, model.system, run.states[0], run.times[-1], "dop853")
    assert found is not None and found.rest == 0.0
    fall = 1.0 - run["z"][-1]
    assert found.actions["field"] == pytest.approx(9.81 * fall, rel=1e-8)
    assert found.actions["push"] == pytest.approx(-2.0 * fall, rel=1e-8)
    assert found.clauses[0] == pytest.approx(3.0 * (9.81 - 2.0) * 0.5, rel=1e-7)  # 4 - 1 times the energy
