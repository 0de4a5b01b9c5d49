"""Derivatives of the whole library against differences in 50 digits. The derivatives of the conditions of a
start, against differences of 50 digits."""

import random
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

import mpmath as mp
import numpy as np
import pytest

from lagc.lowering.event_relations import frozen
from lagc.lowering.jacobians import condition_rows, groups, motion_by_sweeps, stack
from lagc.lowering.kkt.prune import prune, with_pivots
from lagc.lowering.lower_equations import optimize
from lagc.lowering.storage import places
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.simulation.linearization.derivatives import Point
from lagc.simulation.system import System
from lagc.symbolic.graph import Node
from tests.lowering.exact import DIGITS, along, values
from tests.lowering.interpret import ask
from tests.oracle.lagrange import Expressions
from tests.physics.library import compiled, fullest
from tests.simulation.initialization.generated_starts import compilation_of

CLOSE = 1e-13  # of the sum of the terms: some hundred roundings of 1e-16
ROUNDING = 1e-16  # of the largest entry: what is left where the terms of one cancel
MOST = 14  # unknowns of the linear solve in 50 digits


class Differentiated(NamedTuple):
    equations: EquationsOfMotion
    by: dict[str, list[Node]]
    system: System


@cache
def differentiated(name: str, scene: str) -> Differentiated:
    model = compiled(name, scene, "numpy")
    system = model.differentiated()
    equations = with_pivots(prune(model.compilation.differentiated.equations)[0])
    names = {field.name for field in system.interface.parameters}
    at = places(equations, [p for p in equations.model.parameters if p.name in names])
    return Differentiated(equations, groups(at), system)


@pytest.mark.sample(0, 11)
@pytest.mark.parametrize("name, scene", fullest())
def test_derivatives_are_those_of_differences(name: str, scene: str) -> None:
    model = compiled(name, scene, "numpy")
    if model.interface.nv + model.interface.nc > 60:
        pytest.skip("too long in 50 digits")
    if model.interface.contacts:
        pytest.skip("contacts have no derivatives")
    chance = random.Random(name)
    equations, by, system = differentiated(name, scene)
    t, x = chance.uniform(0.1, 1.0), [a + chance.uniform(-0.2, 0.2) for a in system.start()]
    a, lam = ([chance.uniform(-1, 1) for _ in range(n)] for n in (system.nv, system.nc))
    point = Point(system, t, x, a, lam)
    everything = [s for symbols in by.values() for s in symbols]
    given = dict(zip(everything, [t, *x, *a, *lam, *system.parameters]))
    nodes = [node for part in stack(equations, frozen(equations)[1]).values() for node in part]
    with mp.workdps(DIGITS):
        exact = values(nodes, {s: mp.mpf(value) for s, value in given.items()})
        swept = stack(equations, frozen(equations)[1], motion_by_sweeps)
        same = values([x for part in swept.values() for x in part], {s: mp.mpf(v) for s, v in given.items()})
        largest = max([1.0, *map(abs, exact)])  # numbers within equations have 16 digits
        assert all(abs(a - b) <= 8 * ROUNDING * largest for a, b in zip(same, exact, strict=True))
        _assert_close(point.stack, exact, np.abs(point.stack) + max(1.0, np.abs(point.stack).max()))
        for group, symbols in by.items():
            way = [_step(s, given[s], chance) for s in symbols]
            found = point.by(group)
            expected = along(lambda at: values(nodes, at), given, dict(zip(symbols, way)))
            # where derivatives of terms cancel, what is left is round-off of terms as large as the value
            _assert_close(found @ way, expected, np.abs(found) @ np.abs(way) + np.abs(point.stack))


def _step(symbol: Node, value: float, chance: random.Random) -> float:
    """A part of a direction; none of a discrete variable, which jumps."""
    return 0.0 if symbol.record.kind == "discrete" else chance.uniform(-1, 1) * max(abs(value), 0.1)


def _assert_close(found: Any, expected: Sequence[Any], terms: Any) -> None:
    assert len(found) == len(expected)
    rounding = ROUNDING * max(terms, default=0.0)
    for k, (a, b, size) in enumerate(zip(found, expected, terms)):
        far = abs(mp.mpf(float(a)) - b)
        assert far <= max(CLOSE * max(float(size), abs(b)), rounding), (k, a, b, size)


@pytest.mark.sample(0, 8)
@pytest.mark.parametrize("name, scene", fullest())
def test_those_of_the_motion_are_those_of_differences(name: str, scene: str) -> None:
    """d(a, lam)/d(state, parameters) against accelerations that are solved for in 50 digits."""
    model = compiled(name, scene, "numpy")
    nv, nc = model.interface.nv, model.interface.nc
    if nv + nc > MOST:
        pytest.skip("too long in 50 digits")
    if model.interface.contacts:
        pytest.skip("contacts have no derivatives")
    if model.interface.loading_rows:
        pytest.skip("its loads depend on multipliers: tests/simulation/test_loads_of_reactions.py")
    chance = random.Random(f"{name} moves")
    equations, by, system = differentiated(name, scene)
    parts = stack(equations)
    x = [a + chance.uniform(-0.2, 0.2) for a in system.start()]
    try:
        point = Point(system, 0.5, x)
    except ArithmeticError:
        pytest.skip("rows depend on each other: no linear solve in 50 digits")
    unknown = by["acceleration"]
    given = dict(
        zip([s for g in ("time", "state", "parameter") for s in by[g]], [0.5, *x, *system.parameters])
    )

    def motion(at: Mapping[Node, Any]) -> list[Any]:
        """a and lam of F = F0 + K (a, lam), F being linear in them."""
        nodes = [*(i - f for i, f in zip(parts["inertia"], parts["force"])), *parts["row"]]
        zero = values(nodes, {**at, **dict.fromkeys(unknown, mp.mpf(0))})
        columns = []
        for symbol in unknown:
            unit = {**at, **{s: mp.mpf(int(s is symbol)) for s in unknown}}
            columns.append([a - b for a, b in zip(values(nodes, unit), zero)])
        return list(mp.lu_solve(mp.matrix(columns).T, -mp.matrix(zero)))

    with mp.workdps(DIGITS):
        try:
            motion({s: mp.mpf(value) for s, value in given.items()})
        except ZeroDivisionError:
            pytest.skip("rows depend on each other: no linear solve in 50 digits")
        d = np.concatenate(point.scales)  # errors of a solve are normwise, in any units
        condition = np.linalg.cond(d[:, None] * point.residual("acceleration") * d)
        ways, terms = {}, 0.0
        for group in ("time", "state", "parameter"):
            way = ways[group] = [_step(s, given[s], chance) for s in by[group]]
            inertia, force, row = (np.abs(point.partial(p, group)) for p in ("inertia", "force", "row"))
            sums = np.abs(point.inverse) @ np.vstack([inertia + force, row]) @ np.abs(way) / d
            terms = max(terms, *sums)
        for group, way in ways.items():
            expected = along(motion, given, dict(zip(by[group], way)))
            _assert_close(point.motion(group) @ way, expected, condition * d * terms)


STEP = mp.mpf(10) ** -20
LIBRARY = (
    "andrews_squeezer", "bead_on_hoop", "car_axis", "chaplygin_sleigh_speeds", "four_bar", "knife_edge",
    "moving_rail", "particle_on_torus", "rolling_disc", "slider_crank", "sphere_on_turntable", "spring_chain",
    "wheelset",
)  # fmt: skip


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", LIBRARY)
def test_derivatives_are_exact(name: str) -> None:
    """Differences of step 1e-20 are off by 1e-40; a double is off by the rounding of its terms."""
    equations = compilation_of(f"classic/{name}").equations
    program = optimize(equations)
    interface, dice = program.interface, random.Random(name)
    unknowns = [*equations.q, *equations.v]
    rows = condition_rows(equations)
    with mp.workdps(50):
        x = [dice.uniform(0.3, 1.0) for _ in unknowns]
        p = [f.value or 0.0 for f in (*interface.parameters, *interface.inputs)]
        found = ask(program, "conditions", {"p": p, "t": [0.25], "x": x})
        given = {s.symbol: mp.mpf(s.value or 0.0) for s in equations.model.parameters}
        given.update((u.symbol, mp.mpf(u.default)) for u in equations.model.inputs)
        given[equations.time] = mp.mpf(0.25)
        given.update((symbol, mp.mpf(value)) for symbol, value in zip(unknowns, x))
        evaluate = Expressions(rows)
        assert found["c"] == pytest.approx([float(a) for a in evaluate(given)], rel=1e-12, abs=1e-13)
        slopes = [[0.0] * (len(unknowns) + len(interface.rate_names)) for _ in rows]
        begin = 0
        for row, end in zip(slopes, interface.condition_ends):
            for k in range(begin, end):
                row[interface.condition_columns[k]] = found["J"][k]
            begin = end
        for k, symbol in enumerate(unknowns):
            above = evaluate({**given, symbol: given[symbol] + STEP})
            below = evaluate({**given, symbol: given[symbol] - STEP})
            exact = [float((a - b) / (2 * STEP)) for a, b in zip(above, below)]
            assert [row[k] for row in slopes] == pytest.approx(exact, rel=1e-11, abs=1e-12)
    for k in range(len(interface.rate_names)):
        assert [row[len(unknowns) + k] for row in slopes] == [
            -1.0 if i == len(rows) - len(interface.rate_names) + k else 0.0 for i in range(len(rows))
        ]
