"""The equations of motion as formulas: terms collected, common factors cancelled, names short.

Each equation is the derived one up to a factor that is a number or a product of parameters.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from fractions import Fraction

from lagc.diagnostics.faults import Fault, Refused
from lagc.expr.graph import Node
from lagc.expr.walk import reachable
from lagc.mechanics.equations import EquationsOfMotion, Row
from lagc.records import dataclass
from lagc.view.abridged import ALL, MOST, chosen
from lagc.view.algebra import LONG, Algebra, TooLarge
from lagc.view.collect import Collector, Sum, positive_first
from lagc.view.names import Name, names, pi_of
from lagc.view.naming import NamingAlgebra
from lagc.view.polynomials import NotFinite, Polynomial, scaled
from lagc.view.trigonometry import ShortAlgebra, TurningAlgebra, shorten, unit_quaternion, without_noise


@dataclass(frozen=True, slots=True)
class Formula:
    """`left` = `right`; kind shared, kinematic, motion, position, velocity, event; `label` says of what.
    At an event, when the `condition` becomes true, `left` takes the value `right`."""

    kind: str
    label: str
    left: Sum
    right: Sum
    condition: Sum | None = None


@dataclass(frozen=True)
class Sheet:
    """`left_out`: by kind, words for the formulas that are not here."""

    collector: Collector
    names: dict[Node, Name]
    formulas: tuple[Formula, ...]
    left_out: dict[str, str]


KINDS = ("shared", "kinematic", "motion", "position", "velocity", "event")
ZERO = Sum(())
WORK, PER_ENTRY = 60_000, 100  # products, and for each entry of the rows of M that are written
MOST_WORK = 1_000_000  # some seconds


def by_kind(found: Sheet) -> list[tuple[str, list[Formula]]]:
    kinds = [(kind, [f for f in found.formulas if f.kind == kind]) for kind in KINDS]
    return [(kind, formulas) for kind, formulas in kinds if formulas]


def sheet(equations: EquationsOfMotion, full: bool = True) -> Sheet:
    """The formulas of `equations`, some where they are many and not all are asked for in `full`; multiplied
    out, or where that is too long, with shared parts named s1, s2, ...  Raises Refused (LAG0590) where one of
    their numbers is not finite."""
    known, asked = nonnegative(equations), _asked(equations, full)
    try:
        work = min(WORK + PER_ENTRY * len(asked.motion) * len(equations.v), MOST_WORK)
        for kind in (ShortAlgebra, TurningAlgebra):
            algebra = kind(known, work)
            with suppress(TooLarge):
                found = _sheet(equations, algebra, asked)
                algebra.rest()
                return found
        return _sheet(equations, NamingAlgebra(equations.graph, _shared(equations, asked), known), asked)
    except NotFinite:
        message = "a factor in the equations of motion is not a finite number"
        remedy = "the numbers of the model are too large, or too different, to be multiplied"
        raise Refused([Fault("LAG0590", message, remedy=remedy)]) from None


def nonnegative(equations: EquationsOfMotion) -> list[Node]:
    return [p.symbol for p in equations.model.parameters if p.minimum >= 0]


@dataclass(frozen=True, slots=True)
class _Asked:
    """The formulas that are written: numbers of coordinates and of speeds, with the rows of M, and rows."""

    kinematic: list[int]
    motion: list[int]
    inertia: list[dict[int, Node]]
    rows: list[Row]
    left_out: dict[str, str]


def _asked(equations: EquationsOfMotion, full: bool) -> _Asked:
    own = set(equations.v)
    rates = [i for i, e in enumerate(equations.qdot) if not (e in own and _is_rate(e))]
    levels = {
        level: [row for row in equations.rows if row.level.value == level]
        for level in ("position", "velocity")
    }
    parts = {
        "kinematic": chosen([equations.q_names[i] for i in rates], full),
        "motion": chosen(equations.v_names, full),
        **{level: chosen([row.label for row in rows], full) for level, rows in levels.items()},
    }
    motion = parts["motion"].numbers
    return _Asked(
        kinematic=[rates[k] for k in parts["kinematic"].numbers],
        motion=motion,
        inertia=equations.mass_rows(motion),
        rows=[rows[k] for level, rows in levels.items() for k in parts[level].numbers],
        left_out={kind: part.words for kind, part in parts.items() if part.words},
    )


def _sheet(equations: EquationsOfMotion, algebra: Algebra, asked: _Asked) -> Sheet:
    collector = collector_of(equations, algebra)
    shown, left_out = names(equations), dict(asked.left_out)
    formulas = [
        *_kinematic(equations, collector, shown, asked.kinematic),
        *_motion(equations, collector, asked),
        *_rows(equations, collector, asked.rows),
        *_events(equations, collector),
    ]
    named = (
        algebra.definitions
        if isinstance(algebra, NamingAlgebra)
        else _long_sums(equations, algebra, formulas)
    )
    if named:
        definitions = _definitions(named, collector, shown)
        if left_out and len(definitions) > MOST:
            left_out["shared"] = f"and {len(definitions) - MOST} more: {ALL}"
            del definitions[MOST:]
        formulas = [*definitions, *formulas]
    return Sheet(collector, shown, tuple(formulas), left_out)


def collector_of(equations: EquationsOfMotion, algebra: Algebra) -> Collector:
    """What collects terms in the order of the symbols of `equations`."""
    model = equations.model
    algebra.pi = pi_of(equations)
    parameters = [p.symbol for p in model.parameters] + [i.symbol for i in model.inputs]
    if algebra.pi is not None:
        parameters.insert(0, algebra.pi)
    for node in (*parameters, *equations.q, *equations.v, *equations.a, *equations.lam):
        algebra.symbol(node)
    return Collector(
        algebra,
        parameters={algebra.symbol(n) for n in parameters},
        leading=[algebra.symbol(n) for n in equations.a],
        rates={algebra.symbol(n) for n in equations.v},
        trailing=[algebra.symbol(n) for n in equations.lam],
        cancelled={algebra.symbol(p.symbol) for p in model.parameters if p.minimum >= 0 or p.value},
    )


def _long_sums(
    equations: EquationsOfMotion, algebra: Algebra, formulas: Sequence[Formula]
) -> list[tuple[Node, Polynomial]]:
    """A symbol for each long sum under a root or below a line that is written twice or more, and the sum."""
    times: dict[int, int] = {}
    pending: list[int | Sum | None] = [part for f in formulas for part in (f.left, f.right, f.condition)]
    while pending:
        part = pending.pop()
        if isinstance(part, Sum):
            pending += [base for product in part.terms for base, _ in product.factors]
        elif part is not None:
            times[part] = times.get(part, 0) + 1
            if times[part] == 1:
                inner = algebra.atoms[part].args
                pending += [atom for p in inner for monomial, _ in p for atom, _ in monomial]
    found: list[tuple[Node, Polynomial]] = []
    for number in sorted(times):  # those within others come first
        atom = algebra.atoms[number]
        if times[number] > 1 and atom.op == "sum" and len(atom.args[0]) >= LONG:
            algebra.named[number] = equations.graph.symbol("shown part", str(len(found)))
            found.append((algebra.named[number], tidy(equations, algebra, dict(atom.args[0]))))
    return found


def _definitions(
    named: Sequence[tuple[Node, Polynomial]], collector: Collector, shown: dict[Node, Name]
) -> list[Formula]:
    """s1 = ..., for the parts that were named."""
    algebra = collector.algebra
    taken = {name.base for name in shown.values()}
    letter = next(c for c in ("s", "part", "shared_part") if not any(n.startswith(c) for n in taken))
    formulas = []
    for number, (node, p) in enumerate(named, 1):
        shown[node] = Name(f"{letter}{number}", f"{letter}{number}")
        formulas.append(
            Formula(
                "shared", shown[node].base, collector.collect(algebra.symbol_only(node)), collector.collect(p)
            )
        )
    return formulas


def _kinematic(
    equations: EquationsOfMotion, collector: Collector, shown: dict[Node, Name], which: Sequence[int]
) -> list[Formula]:
    """q' = N v + n of coordinates of which that says more than q' = v."""
    algebra, formulas = collector.algebra, []
    for i, p in zip(which, algebra.polynomials([equations.qdot[i] for i in which])):
        right = collector.factored(tidy(equations, algebra, p))
        name = shown[equations.q[i]]
        rate = equations.graph.symbol("shown rate", equations.q_names[i])
        shown[rate] = Name(name.base, name.full, 1)
        formulas.append(
            Formula("kinematic", equations.q_names[i], collector.collect(algebra.symbol_only(rate)), right)
        )
    return formulas


def _is_rate(speed: Node) -> bool:
    return speed.record.kind == "rate" and not speed.record.turns


def _motion(equations: EquationsOfMotion, collector: Collector, asked: _Asked) -> list[Formula]:
    """M a + h - tau - G^T lam = 0 along some of the speeds."""
    return [
        Formula("motion", equations.v_names[i], collector.collect(collector.cancel(p)), ZERO)
        for i, p in zip(asked.motion, _motion_polynomials(equations, collector.algebra, asked))
    ]


def _motion_polynomials(equations: EquationsOfMotion, algebra: Algebra, asked: _Asked) -> list[Polynomial]:
    """M a + h - tau - G^T lam, shortened, nothing cancelled."""
    found = []
    for i, inertia in zip(asked.motion, asked.inertia):
        total, force = algebra.polynomials([equations.bias_forces[i], equations.given_forces[i]])
        total = algebra.add(total, scaled(force, Fraction(-1)))
        for j, entry in inertia.items():
            e, s = algebra.polynomials([entry, equations.a[j]])
            total = algebra.add(total, algebra.multiply(tidy(equations, algebra, e), s))
        for row in equations.rows:
            if i in row.jacobian:
                e, s = algebra.polynomials([row.jacobian[i], row.multiplier])
                total = algebra.add(total, scaled(algebra.multiply(e, s), Fraction(-1)))
        found.append(tidy(equations, algebra, total))
    return found


def tidy(equations: EquationsOfMotion, algebra: Algebra, p: Polynomial) -> Polynomial:
    """`p` by the identities of trigonometry and of unit quaternions, without rounding noise."""
    p = shorten(algebra, without_noise(algebra, p))
    for i in equations.quaternions:
        w, x, y, z = [algebra.symbol(q) for q in equations.q[i : i + 4]]
        p = unit_quaternion(algebra, p, (w, x, y, z))
    return p


def _rows(equations: EquationsOfMotion, collector: Collector, rows: Sequence[Row]) -> list[Formula]:
    algebra = collector.algebra
    formulas = []
    for row, p in zip(rows, algebra.polynomials([row.residual for row in rows])):
        p = tidy(equations, algebra, p)
        by_rate = row.linear and not row.holonomic
        left = collector.collect(p, sorted(collector.rates)) if by_rate else collector.collect(p)
        formulas.append(Formula(row.level.value, row.label, Sum(positive_first(left.terms)), ZERO))
    return formulas


def _events(equations: EquationsOfMotion, collector: Collector) -> list[Formula]:
    """What states become at the moment that the conditions of clauses `when` become true."""
    algebra, formulas = collector.algebra, []
    for when in equations.whens:
        for state, value in when.changes:
            condition, left, right = algebra.polynomials([when.condition, state, value])
            formulas.append(
                Formula(
                    "event", when.clause.words, collector.collect(left),
                    collector.collect(tidy(equations, algebra, right)), collector.collect(condition),
                )
            )  # fmt: skip
    return formulas


def _shared(equations: EquationsOfMotion, asked: _Asked) -> set[Node]:
    """Sums and products that are used more than once in the formulas that are asked for."""
    along = [row.jacobian[i] for row in equations.rows for i in asked.motion if i in row.jacobian]
    roots = [
        *[equations.qdot[i] for i in asked.kinematic],
        *[entry for row in asked.inertia for entry in row.values()],
        *[force[i] for force in (equations.bias_forces, equations.given_forces) for i in asked.motion],
        *[row.residual for row in asked.rows],
        *along,
        *[node for when in equations.whens for pair in when.changes for node in pair],
    ]
    uses: dict[Node, int] = {}
    for node in (*reachable(roots), *roots):
        for below in node.args:
            uses[below] = uses.get(below, 0) + 1
    return {
        node
        for node, times in uses.items()
        if times > 1 and node.op in ("add", "mul") and any(a.args for a in node.args)
    }
