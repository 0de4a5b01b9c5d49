"""Inputs, parameters and states that change between two calls of `advance`."""

import random
from typing import Any

import pytest

from lagc.simulation.system import MAX_STEPS, OK, STEP_UNDERFLOW, Options
from tests.simulation.driven import MODELS, consistent, model, stepper, stepper_of
from tests.simulation.programs import BACKENDS, build, four_bar, needs_compiler
from tests.simulation.scaled import system

pytestmark = pytest.mark.usefixtures("own_cache")
METHODS = pytest.mark.parametrize("method", ["dop853", "dopri5"])
NAMES = pytest.mark.parametrize("name", MODELS)
TIGHT = {
    "dop853": Options(rtol=1e-12, atol=1e-12),
    "dopri5": Options(method="dopri5", rtol=1e-11, atol=1e-11),
}


def switches(name: str, seed: int, count: int) -> list[tuple[float, dict[int, float]]]:
    """When a piece ends, and what is changed at its beginning: inputs, and now and then a parameter that
    the constraints do not see (a mass)."""
    dice = random.Random(f"{name} {seed}")
    interface = model(name, "numpy").interface
    first, t = len(interface.parameters), 0.0
    found: list[tuple[float, dict[int, float]]] = []
    for _ in range(count):
        t += dice.choice([0.001, 0.01, 0.1]) * dice.uniform(0.5, 1.5)
        new = {
            i: dice.uniform(-2.0, 2.0)
            for i in range(first, first + len(interface.inputs))
            if dice.random() < 0.7
        }
        if dice.random() < 0.2:
            new[0] = dice.uniform(0.3, 1.0)
        found.append((t, new))
    return found


def driven(name: str, backend: str, options: Options, pieces: Any) -> Any:
    run = stepper(name, backend, options)
    for t, new in pieces:
        for i, value in new.items():
            run.p[i] = value
        assert run.advance(t) == OK
    return run


def restarted(name: str, backend: str, options: Options, pieces: Any) -> list[float]:
    """The same with a new trajectory for every piece."""
    run, values, t0 = stepper(name, backend, options), {}, 0.0
    x = run.facts()[1]
    for t, new in pieces:
        values.update(new)
        run = stepper(name, backend, options)
        for i, value in values.items():
            run.p[i] = value
        run.put(t0, x)
        assert run.advance(t) == OK
        t0, x = t, run.facts()[1]
    return list(x)


@pytest.mark.sample(1)
@METHODS
@NAMES
@pytest.mark.parametrize("seed", range(3))
def test_against_restarts_and_scipy(name: str, seed: int, method: str) -> None:
    integrate = pytest.importorskip("scipy.integrate")
    pieces = switches(name, seed, 25)
    run = driven(name, "numpy", TIGHT[method], pieces)
    x = run.facts()[1]
    again = restarted(name, "numpy", TIGHT[method], pieces)
    assert x == pytest.approx(again, rel=1e-8, abs=1e-8)
    system, values, t0 = model(name, "numpy").load("numpy"), {}, 0.0
    expected = consistent(name, system)
    for t, new in pieces:
        values.update(new)
        bound = system.bind([values.get(i, v) for i, v in enumerate(system.parameters)])

        def rates(t: float, x: Any, bound: Any = bound) -> list[float]:
            found = [0.0] * bound.nx
            bound.rhs(t, x.tolist(), found, [0.0] * bound.nc)
            return found

        expected = integrate.solve_ivp(rates, (t0, t), expected, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
        t0 = t
    # without projection the constraint of `Rod` drifts by what the tolerance leaves
    assert x == pytest.approx(list(expected), rel=2e-8, abs=2e-8)


@pytest.mark.sample(1)
@needs_compiler
@METHODS
@NAMES
def test_both_languages_agree_bitwise(name: str, method: str) -> None:
    """In what was done, too; adaptive and fixed steps, dense output on the way, states put elsewhere."""
    for options in (Options(method=method, rtol=1e-7, atol=1e-7), Options(method=method, step=0.007)):
        found = []
        for backend in ("c", "numpy"):
            dice, run = random.Random(name), stepper(name, backend, options)
            seen = []
            for t, new in switches(name, 9, 30):
                for i, value in new.items():
                    run.p[i] = value
                before = run.facts()
                if dice.random() < 0.3:
                    run.put(before[0], [a * 1.0000001 for a in before[1]])
                if before[3] and dice.random() < 0.5:
                    seen.append(run.dense(before[2] + 0.4 * (before[0] - before[2])))
                if before[3] and dice.random() < 0.2:
                    run.limit(1)
                    seen.append(run.advance(t))
                    assert seen[-1] in (OK, MAX_STEPS)
                    run.limit(0)
                    now = run.facts()
                    seen.append(run.dense(now[2] + 0.7 * (now[0] - now[2])))
                assert run.advance(t) == OK
                seen.append(run.facts())
            found.append(repr(seen))
        assert found[0] == found[1]


@pytest.mark.sample(2)
@BACKENDS
@NAMES
def test_fixed_steps_are_those_of_restarts(name: str, backend: str) -> None:
    """Bit for bit, but for the sizes of states so far, by which projection judges what it leaves (1e-15
    of them at a step, at most all of one sign): nothing else is carried over."""
    for method in ("dop853", "dopri5"):
        pieces, options = switches(name, 4, 20), Options(method=method, step=0.004)
        run = driven(name, backend, options, pieces)
        _, x, _, steps, *_ = run.facts()
        left = 1e-15 * steps * max(map(abs, x)) if model(name, "numpy").interface.nc else 0.0
        again = restarted(name, backend, options, pieces)
        assert all(abs(a - b) <= left for a, b in zip(x, again))


@pytest.mark.sample(3)
@BACKENDS
@METHODS
@NAMES
def test_one_workspace_serves_many_states(name: str, backend: str, method: str) -> None:
    """In any order, with inputs, calls of other functions and dense output between, in C now with one
    workspace and now with another: the same bits as with a workspace for each."""
    options = Options(method=method, rtol=1e-6, atol=1e-6)
    count = 4

    def motions(shared: bool) -> str:
        dice = random.Random(f"{name} {method}")
        works = [stepper(name, backend, options).work for _ in range(2)]
        work = works[0] if shared else None
        states = [stepper(name, backend, options, work) for _ in range(count)]
        seen = []
        for _ in range(60):
            one = dice.choice(states)
            one.p[-1] = dice.choice([one.p[-1], dice.uniform(-1.0, 1.0)])
            other = dice.choice(works)
            if shared and backend == "c":
                one.work = other
            t, x, t_old, steps = one.facts()[:4]
            what = dice.random()
            if what < 0.4:
                assert one.advance(t + dice.uniform(0.001, 0.2)) == OK
            elif what < 0.7:
                assert one.step(t + dice.uniform(0.001, 0.2)) == OK
            elif what < 0.9 and steps:
                seen.append(one.dense(t_old + dice.random() * (t - t_old)))
            elif shared:
                one.disturb([a + 0.1 for a in x])
            seen.append(one.facts())
        return repr(seen)

    assert motions(True) == motions(False)


@pytest.mark.sample(1)
@BACKENDS
@METHODS
def test_dependent_rows_are_known_to_the_state_alone(backend: str, method: str) -> None:
    """Linkages that pass configurations where rows depend on others, each at its own time, through one
    workspace: what one has met is nothing to the others."""
    system = build(four_bar(2, 0.0, -4.0), backend)
    options = Options(method=method, rtol=1e-7, atol=1e-7)

    def motions(shared: bool) -> str:
        dice = random.Random(method)
        first = stepper_of(system, options, system.start())
        states = [
            stepper_of(system, options, system.start(), first.work if shared else None) for _ in range(3)
        ]
        seen = []
        for _ in range(80):
            one = dice.choice(states)
            t = one.facts()[0]
            if t > 2.0:
                continue
            status = one.step(t + dice.uniform(0.01, 0.2))
            assert status == OK, status
            seen.append((one.facts(), one.dense(t + 0.3 * (one.facts()[0] - t))))
            if dice.random() < 0.3 and shared:
                one.disturb(system.start())
        return repr(seen)

    assert motions(True) == motions(False)


@pytest.mark.sample(5)
@BACKENDS
@METHODS
@NAMES
def test_dense_output_belongs_to_the_step_done(name: str, backend: str, method: str) -> None:
    """Whether it is asked before or after parameters and state were changed, or a step failed."""
    for seed in range(5):
        dice = random.Random(seed)
        states = [stepper(name, backend, Options(method=method, rtol=1e-7, atol=1e-7)) for _ in range(4)]
        for state in states:
            state.p[-1] = 0.7
            assert state.advance(0.2) == OK
        t, x, t_old = states[0].facts()[:3]
        at = t_old + dice.uniform(0.1, 0.9) * (t - t_old)
        expected = states[0].dense(at)
        for i in range(len(states[1].p)):
            states[1].p[i] *= 1.5
        assert states[1].dense(at) == expected
        states[2].put(t, [a + 0.25 for a in x])
        assert states[2].dense(at) == expected and states[2].dense(t) == [a + 0.25 for a in x]
        states[3].p[-1] = -5.0
        states[3].longest(1e-300)
        assert states[3].advance(1.0) == STEP_UNDERFLOW
        assert states[3].dense(at) == expected
        states[3].longest(0.0)  # and the next step is not that of before
        fresh = stepper(name, backend, TIGHT[method])
        fresh.put(t, x)
        fresh.p[:] = states[3].p
        assert states[3].advance(0.3) == OK and fresh.advance(0.3) == OK
        assert states[3].facts()[1] == pytest.approx(fresh.facts()[1], abs=2e-5)


@pytest.mark.sample(2, 12)
@BACKENDS
@METHODS
@NAMES
@pytest.mark.parametrize("changing", [False, True], ids=["smooth", "switched"])
def test_a_kilohertz_costs_a_step_a_call(name: str, backend: str, method: str, changing: bool) -> None:
    """No search for a first step, no tiny steps; one evaluation more where an input has changed."""
    calls = 300 if backend == "c" else 120
    dice, run = random.Random(name), stepper(name, backend, Options(method=method, rtol=1e-6, atol=1e-6))
    for k in range(1, calls + 1):
        if changing:
            run.p[-1] = dice.uniform(-1.0, 1.0)
        assert run.advance(0.001 * k) == OK
    _, _, _, steps, rejected, rhs = run.facts()[:6]
    assert steps <= calls + 3 and rejected <= 2
    each = 12 if method == "dop853" else 6
    assert rhs <= (each + changing) * steps + each * rejected + 2
    before = run.facts()[3]
    assert run.advance(0.001 * calls + 0.1) == OK
    assert run.facts()[3] - before < 25  # and the long steps are not forgotten


@needs_compiler
@NAMES
def test_a_record_in_slices_is_the_record(name: str) -> None:
    """Steps one by one, slices of any length: the same bits and the same counts."""
    times, found = [0.013 * i for i in range(60)], []
    for budget in (0, 1, 3, 7):
        run = stepper(name, "c", Options(rtol=1e-8, atol=1e-8))
        found.append(repr((run.record(times, budget), run.facts())))
    assert len(set(found)) == 1
    one, other = (stepper(name, "c", Options(rtol=1e-8, atol=1e-8)) for _ in range(2))
    while one.facts()[0] != 0.6:
        assert one.step(0.6) == OK
    assert other.advance(0.6) == OK and one.facts() == other.facts()


@BACKENDS
@NAMES
def test_options_may_change_too(name: str, backend: str) -> None:
    """From adaptive to fixed steps, to others, and back: the grid begins where it is begun."""
    run = stepper(name, backend, Options(rtol=1e-9, atol=1e-9))
    options = run.options if backend == "c" else run.run.options
    t, dice = 0.0, random.Random(name)
    for k in range(30):
        options.step = [0.0, 0.003, 0.005][k % 3]
        t += dice.uniform(0.005, 0.03)
        for _ in range(dice.randint(0, 2)):  # in the middle of a grid
            assert run.step(t) == OK
        assert run.facts()[0] <= t
        assert run.advance(t) == OK and run.facts()[0] == t
    exact = stepper(name, backend, Options(rtol=1e-12, atol=1e-12))
    assert exact.advance(t) == OK
    assert run.facts()[1] == pytest.approx(exact.facts()[1], rel=1e-6, abs=1e-6)


@needs_compiler
def test_the_method_may_change_too() -> None:
    both = system(model("Cart", "c").program, "c")  # with all explicit methods
    run = stepper_of(both, Options(rtol=1e-9, atol=1e-9), consistent("Cart", both))
    for k in range(1, 21):
        run.options.method = k % 2
        assert run.advance(0.05 * k) == OK
        run.options.method = 1 - k % 2
        assert run.dense(run.facts()[0]) == run.facts()[1]
        run.dense(0.5 * (run.facts()[2] + run.facts()[0]))
    exact = stepper("Cart", "c", Options(rtol=1e-12, atol=1e-12))
    assert exact.advance(1.0) == OK
    assert run.facts()[1] == pytest.approx(exact.facts()[1], rel=1e-6, abs=1e-6)
