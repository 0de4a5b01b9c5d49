"""Other forms of the equations of motion, for the same writers.

undivided   M a + h - Q - G^T lam = 0, as derived
solved      a = M^-1 (Q + G^T lam - h)
matrix      the entries of M, h, Q, G and gamma
hamilton    p = dK/dq',  H(q, p),  q' = dH/dp,  p' = -dH/dq   (W. R. Hamilton, 1835)
"""

from fractions import Fraction

from lagc.mechanics.balance.energy import BY_DEGREES, WHOLE
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.mechanics.formulation.states import solve_rows
from lagc.reports.algebra.collect import Collector
from lagc.reports.equations.formulas import LETTER, ZERO, Formula, Motion, motion_polynomials, tidy
from lagc.reports.names import names
from lagc.symbolic.derivative import gradient
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import substitute


class NoForm(Exception):
    """A model has no such form; the message says why."""


def undivided(equations: EquationsOfMotion, collector: Collector) -> list[Formula]:
    one = collector.collect({(): Fraction(1)})
    found = zip(equations.v_names, motion_polynomials(equations, collector.algebra))
    return [Formula("motion", name, collector.collect(p), ZERO, factor=one) for name, p in found]


def solved(equations: EquationsOfMotion, collector: Collector) -> list[Formula]:
    """The accelerations in the state and the multipliers. Raises NoForm without an inverse of M."""
    right = [a + b for a, b in zip(equations.applied_forces, equations.constraint_forces)]
    found = _inverse(equations, right)
    pairs = zip(equations.v_names, equations.a, found)
    return [_formula(equations, collector, "motion", name, a, node) for name, a, node in pairs]


def matrix(equations: EquationsOfMotion, collector: Collector) -> list[Formula]:
    """The entries that are not zero; h and Q are the bias forces and the given forces."""
    nodes: dict[str, Node] = {}
    for i, row in enumerate(equations.mass_rows(range(len(equations.v))), 1):
        nodes.update((f"M_{i}_{j + 1}", x) for j, x in row.items())
    nodes.update((f"h_{i}", x) for i, x in enumerate(equations.bias_forces, 1))
    nodes.update((f"Q_{i}", x) for i, x in enumerate(equations.given_forces, 1))
    for k, constraint in enumerate(equations.rows, 1):
        nodes.update((f"G_{k}_{j + 1}", x) for j, x in constraint.jacobian.items())
        nodes[f"gamma_{k}"] = constraint.gamma
    taken = {name.base for name in names(equations).values()}
    letters = {name: name if name not in taken else f"{name}_" for name, x in nodes.items() if not x.is_zero}
    symbol = equations.graph.symbol
    return [_formula(equations, collector, "entry", word, symbol(LETTER, word), nodes[name])
            for name, word in letters.items()]  # fmt: skip


def hamilton(equations: EquationsOfMotion, collector: Collector) -> list[Formula]:
    """Raises NoForm unless all forces have a potential and the parameters are free."""
    _check(equations)
    graph, v = equations.graph, list(equations.v)
    slopes = gradient(graph, {equations.kinetic: graph.one}, v)
    momenta = [slopes.get(x, graph.zero) for x in v]
    *at_rest, rest = substitute(graph, [*momenta, equations.energy], dict.fromkeys(v, graph.zero))
    shown = names(equations)
    words = [f"p_{shown[q].base}" for q in equations.q]
    p = [graph.symbol(LETTER, word, "p") for word in words]
    changes = [graph.symbol(LETTER, word, "p", 1) for word in words]
    relative = [a - b for a, b in zip(p, at_rest)]
    rates = _inverse(equations, relative)
    energy = 0.5 * graph.sum(a * b for a, b in zip(relative, rates)) + rest  # K2 - K0 + V
    falls = gradient(graph, {-energy: graph.one}, list(equations.q))
    found = [("momentum", word, a, b) for word, a, b in zip(words, p, momenta)]
    found.append(("entry", "H", graph.symbol(LETTER, "H"), energy))
    found += [("motion", name, a, b) for name, a, b in zip(equations.v_names, v, rates)]
    pairs = zip(words, changes, [falls.get(q, graph.zero) for q in equations.q])
    found += [("motion", word, a, b) for word, a, b in pairs]
    return [_formula(equations, collector, *each) for each in found]


def _check(equations: EquationsOfMotion) -> None:
    """Raises NoForm where there are no Hamilton's equations."""
    loads = [c.name for c in equations.contributions if not c.conservative]
    rows = [*(row.label for row in equations.rows), *(c.label for c in equations.contacts)]
    reasons = [f"`{name}` has no potential" for name in loads] + [f"`{label}` is explicit" for label in rows]
    if equations.model.speeds or equations.quaternions:
        reasons.append("speeds or orientations are declared")
    if equations.balance not in (WHOLE, BY_DEGREES):
        reasons.append("K is not quadratic in the rates")
    if reasons:
        raise NoForm(f"there is no Hamiltonian: {', '.join(reasons)}")


def _inverse(equations: EquationsOfMotion, right: list[Node]) -> list[Node]:
    """Return M^-1 `right`. Raises NoForm where nothing with inertia moves with a speed."""
    every = range(len(equations.v))
    idle = [name for j, name in enumerate(equations.v_names) if j not in equations.massive]
    if idle:
        raise NoForm(f"the mass matrix has no inverse: nothing with inertia moves with {', '.join(idle)}")
    found = solve_rows(equations.graph, equations.mass_rows(every), right, every)
    return [found[j] for j in every]


def _formula(
    equations: EquationsOfMotion, collector: Collector, kind: str, label: str, left: Node, right: Node
) -> Formula:
    algebra = collector.algebra
    p = tidy(equations, algebra, algebra.polynomials([right])[0])
    return Formula(kind, label, collector.collect(algebra.symbol_only(left)), collector.collect(p))


FORMS: dict[str, Motion] = {"undivided": undivided, "solved": solved, "matrix": matrix, "hamilton": hamilton}
