"""Each solution of the library: every formula has the value of its expression, the terms add up to the
equations of motion, and the last lines are those of `lagc equations`."""

import re
from collections.abc import Sequence
from math import isfinite
from pathlib import Path

import pytest

from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.reports.derivation.derivation import Derivation
from lagc.reports.derivation.document import Formulas, Heading
from lagc.reports.derivation.rates import rates_of
from lagc.reports.equations.write import write
from lagc.symbolic.derivative import gradient
from lagc.symbolic.walk import evaluate
from tests.derivation.values import State, gap, solution, states
from tests.reports.models import MODELS, derived, rows

FOLDERS = ("course", "contact", "mechanisms", "classic", "hard", "effects")
SLOW = ("classic/whipple_bicycle",)  # half a minute
NAMES = [str(path.relative_to(MODELS).with_suffix("")) for folder in FOLDERS
         for path in sorted((MODELS / folder).glob("*.lag"))]  # fmt: skip
FEW = ["course/simple_pendulum", "course/moving_slide_explicit", "course/wheel_rolling_explicit",
       "classic/heavy_top_quaternion", "classic/chaplygin_sleigh_speeds", "contact/incline"]  # fmt: skip
CASES = [*FEW, *[name for name in NAMES if name not in FEW and name not in SLOW]]
CLOSE = 1e-11  # of the largest term: sums of tens of terms of which each is rounded a few times


@pytest.mark.sample(6)
@pytest.mark.parametrize("name", CASES)
def test_formulas_are_the_expressions_and_terms_the_equations(name: str) -> None:
    equations, found = derived(name), solution(name)
    tried = [at for at in states(equations, found, 6) if all(map(isfinite, residuals(equations, at)))][:2]
    assert tried  # at others, a speed is above that of light
    for at in tried:
        wrong = [written.about for written in found.written if not gap(written, at) < CLOSE]
        assert not wrong
        assert_terms_add_up(equations, found, at)


def assert_terms_add_up(equations: EquationsOfMotion, found: Derivation, at: State) -> None:
    """The terms in the rates, taken to the speeds, are M a + h - tau - G^T lambda there."""
    rates, graph = rates_of(equations), equations.graph
    every = [x for term in found.terms for x in term.forces.values()]
    values = iter(evaluate([*found.inertial, *every], at))
    sums = [next(values) for _ in found.inertial]
    sizes = [abs(x) for x in sums]
    for term in found.terms:
        for j in term.forces:
            value = next(values)
            sums[j] -= value
            sizes[j] += abs(value)
    for i, (v, own) in enumerate(zip(equations.v, residuals(equations, at))):
        moved = [rates.declared.rates[rate] for rate in rates.symbols]
        slopes = [gradient(graph, {x: graph.one}, [v]).get(v, graph.zero) for x in moved]
        directions = evaluate(slopes, at)
        shown = sum(d * x for d, x in zip(directions, sums))
        size = 1.0 + sum(abs(d) * x for d, x in zip(directions, sizes))
        assert abs(shown - own) < CLOSE * size, (i, shown, own)


def residuals(equations: EquationsOfMotion, at: State) -> list[float]:
    """M a + h - tau - G^T lambda, with the forces of contacts."""
    found = []
    for i, row in enumerate(equations.mass_rows(range(len(equations.v)))):
        terms = [m * equations.a[j] for j, m in row.items()]
        terms += [equations.bias_forces[i], -equations.given_forces[i]]
        terms += [-(r.multiplier * r.jacobian[i]) for r in equations.rows if i in r.jacobian]
        for contact in equations.contacts:
            pairs = zip(contact.forces, contact.jacobians)
            terms += [-(force * slopes[i]) for force, slopes in pairs if i in slopes]
        found.append(equations.graph.sum(terms))
    return evaluate(found, at)


def result(found: Derivation) -> list[str]:
    """The equations under "Result", each on one line, without what they were divided by."""
    titles = [k for k, block in enumerate(found.blocks) if isinstance(block, Heading) and block.level == 2]
    first = next(k for k in titles if found.blocks[k].text == "Result")  # type: ignore[union-attr]
    last = titles[titles.index(first) + 1]
    blocks = [block for block in found.blocks[first:last] if isinstance(block, Formulas)]
    lines = [re.sub(r" \\qquad \\text\{\((divided|times).*", "", "".join(row.lines) + row.note)
             for block in blocks for row in block.rows]  # fmt: skip
    return [squeezed(line) for line in lines if r"\sum_j E_j" not in line]


def squeezed(line: str) -> str:
    return re.sub(r"[\s&]+", " ", line).strip()


def written(equations: EquationsOfMotion) -> Sequence[str]:
    return [squeezed(row) for row in rows(write(equations, "latex", full=False)) if r"\text{" not in row[:12]]


@pytest.mark.sample(6)
@pytest.mark.parametrize("name", CASES)
def test_the_last_lines_are_those_of_equations(name: str) -> None:
    shown, printed = sorted(result(solution(name))), sorted(written(derived(name)))
    assert shown == printed


def test_slow_models_are_a_part_of_the_library() -> None:
    assert set(SLOW) <= set(NAMES) and all(Path(MODELS / f"{name}.lag").exists() for name in FEW)
