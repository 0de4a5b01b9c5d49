"""The values of formulas in a solution, and of the expressions that they stand for."""

import math
from collections.abc import Mapping
from functools import cache

from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.mechanics.formulation.states import build_states
from lagc.mechanics.identities.samples import Chance, samples
from lagc.reports.derivation.derivation import Derivation, derivation_of
from lagc.reports.derivation.rates import rates_of
from lagc.reports.derivation.writer import Written
from lagc.reports.names import slip_speeds
from lagc.reports.patterns.formula_trees import Call, Form, Series, Symbol, Term, Total
from lagc.symbolic.derivative import tangent
from lagc.symbolic.graph import Node
from lagc.symbolic.operators import VALUES
from lagc.symbolic.walk import evaluate
from tests.reports.models import derived

State = dict[Node, float]


@cache
def solution(name: str, scene: str | None = None) -> Derivation:
    """The solution of `course/simple_pendulum`, or of any other model of the library."""
    return derivation_of(derived(name) if scene is None else derived(name, scene))


def states(equations: EquationsOfMotion, found: Derivation, count: int = 2) -> list[State]:
    """Random states with values for all symbols: rates and second derivatives are free, declared speeds
    follow from them; virtual velocities, multipliers and forces of contacts are free."""
    rates, declared = rates_of(equations), build_states(equations.model)
    chance, every = Chance(4711), list[State]()
    for state in samples(equations.model, count, spread=1.0):
        free = [*rates.states.a, *rates.stars.values(), *equations.lam]
        free += [force for c in equations.contacts for force in c.forces]
        state.update((x, 2.0 * chance.draw()) for x in free)
        state.update((x, chance.draw()) for x in rates.symbols if x not in state)
        state[equations.graph.symbol("number", "pi")] = math.pi
        for speed in equations.model.speeds:
            (spelt,) = declared.in_rates([speed.expression])
            change = tangent(equations.graph, [spelt], rates.states.flow)
            second = equations.graph.leaf(speed.symbol.record.derivative)
            state[speed.symbol], state[second] = evaluate([spelt, *change], state)
        for contact in equations.contacts:
            for symbol, slip in zip(slip_speeds(contact), contact.slips):
                if symbol != slip.rate:
                    (state[symbol],) = evaluate([slip.rate], state)
        for symbol, meaning in found.meanings.items():
            (state[symbol],) = evaluate([meaning], state)
        every.append(state)
    return every


def value(form: Form | Term | Series, at: Mapping[Node, float]) -> float:
    """The value of a form as a reader evaluates it; NaN for the root of a negative number."""
    if isinstance(form, Total):
        return math.fsum(value(x, at) for x in form.terms)
    if isinstance(form, Term):
        product = (-1.0 if form.negative else 1.0) * float(form.size)  # type: ignore[arg-type]
        for factor, e in form.factors:
            base = value(factor, at)
            if e != int(e) and base < 0.0:
                return math.nan
            product *= base ** (int(e) if e == int(e) else float(e))
        return product
    if isinstance(form, Symbol):
        return at[form.node]
    assert isinstance(form, Call), form
    return float(VALUES[form.op](*[value(x, at) for x in form.args]))


def gap(written: Written, at: State) -> float:
    """The relative difference of a formula from its expression; 0 where neither has a value."""
    axes = evaluate([node for _, node in written.forms], at)
    shown = math.fsum(value(form, at) * x for (form, _), x in zip(written.forms, axes) if x)
    (true,) = evaluate([written.node], at)
    if math.isnan(true) and math.isnan(shown):
        return 0.0
    scale = max([1.0, abs(true), *[abs(value(t, at)) for form, _ in written.forms for t in form.terms]])
    return abs(shown - true) / scale
