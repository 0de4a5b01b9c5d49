"""The equations of a model as lines: all of them, or those of large models by their rules.

Equations of large models are multiplied out if they are sums that follow a rule, as for a chain; otherwise
they are recursions along the model (see `recursion`).
"""

from __future__ import annotations

from collections.abc import Sequence

from lagc.base.records import dataclass, replace
from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.formulation.equations import EquationsOfMotion
from lagc.reports.algebra.expansion import TooLarge
from lagc.reports.algebra.polynomials import NotFinite, Polynomial
from lagc.reports.algebra.trigonometric_identities import ShortAlgebra
from lagc.reports.equations.formulas import (
    LETTER,
    ZERO,
    Formula,
    Formulas,
    Motion,
    SharedAlgebra,
    SymbolKinds,
    collector_of,
    conditions,
    divided,
    everything,
    formulas,
    nonnegative,
    rate_of,
    shared,
    tidy,
    with_long_sums,
)
from lagc.reports.equations.modes import Law
from lagc.reports.names import Name, Names, names, words_taken
from lagc.reports.patterns.formula_trees import Former, Line, Total, indices
from lagc.reports.patterns.index_rules import ruled, summed
from lagc.reports.patterns.recursion import arrays, residuals
from lagc.symbolic.graph import Node

MOST = 12  # equations of a kind that are all written
TERMS = 60_000  # of all equations, where they are written as sums that are long
LOCAL = 30  # terms of what is not long, as where only neighbours act on each other
ONE, ALL, EACH = 20_000, 2_000_000, 1_000  # products: at most for one of them, for all, or for each
SHORT = 8  # terms and series of such an equation
KINDS = (
    "shared", "kinematic", "momentum", "entry", "motion", "position", "velocity", "closed", "contact",
    "complement", "bound", "stick", "slip", "impact", "poisson", "event",
)  # fmt: skip


@dataclass(frozen=True)
class Page:
    """`ruled`: lines and terms that follow a rule are written once. Otherwise `factors` has the factor by
    which each equation of motion was divided."""

    lines: tuple[Line, ...]
    names: Names
    ruled: bool
    taken: set[str]  # what counters are not called
    factors: tuple[Total, ...] = ()

    def by_kind(self) -> list[tuple[str, list[Line]]]:
        kinds = [(kind, [x for x in self.lines if x.kind == kind]) for kind in KINDS]
        return [(kind, lines) for kind, lines in kinds if lines]


def page(
    equations: EquationsOfMotion, full: bool = True, laws: Sequence[Law] = (), motion: Motion | None = None
) -> Page:
    """Return the lines of all equations and `laws`, in `full` or by their rules if they are many; in another
    form, which `motion` makes, always in full. Raises Refused (LAG0590) if a number is not finite."""
    try:
        if full or motion or max(len(equations.v), len(equations.rows)) <= MOST:
            return _plain(equations, laws, motion)
        return _by_rule(equations, laws)
    except NotFinite:
        message = "a factor in the equations of motion is not a finite number"
        remedy = "the numbers of the model are too large, or too different, to be multiplied"
        raise Refused([Fault("LAG0590", message, remedy=remedy)]) from None


def _plain(equations: EquationsOfMotion, laws: Sequence[Law], motion: Motion | None) -> Page:
    found, shown = formulas(equations, laws, motion), _shown(equations)
    letter = _letter(equations)
    for number, node in enumerate(found.named, 1):
        shown[node] = Name(f"{letter}{number}", f"{letter}{number}")
    former = Former(found.collector, shown)
    factors = tuple([former.total(x.factor) for x in found.found if x.factor is not None])
    return Page(tuple(_lines(found, shown)), shown, False, set(), factors)


def _by_rule(equations: EquationsOfMotion, laws: Sequence[Law]) -> Page:
    motion = residuals(equations)
    try:
        found = _in_sums(equations, motion, laws)
    except TooLarge:
        found = _in_parts(equations, motion, laws)
    return _ruled(equations, found)


def in_parts(equations: EquationsOfMotion, nodes: Sequence[Node]) -> Page:
    """Return a line for each expression, kind "motion", with names for shared parts, by rules. Raises
    NotFinite."""
    carried = {x for part in equations.inertias for x in part.carried if x.args}
    algebra = SharedAlgebra(equations.graph, shared(nodes) | carried, nonnegative(equations))
    collector = collector_of(SymbolKinds(equations), algebra)
    found = [
        Formula("motion", "", collector.collect(tidy(equations, algebra, p)), ZERO)
        for p in algebra.polynomials(nodes)
    ]
    return _ruled(equations, Formulas(collector, found, algebra.definitions))


def _ruled(equations: EquationsOfMotion, found: Formulas) -> Page:
    """Return the page on which formulas that follow a rule are written once."""
    shown, parts = _shown(equations), found.named
    if parts:
        shown |= {node: Name(f"part[{k}]", f"part[{k}]") for k, node in enumerate(parts)}
        lines = _lines(found, shown)
        shown |= arrays(parts, lines[: len(parts)], lines[len(parts) :], _letter(equations))
    free = words_taken(shown)
    short = [replace(x, left=summed(x.left, free), right=summed(x.right, free)) for x in _lines(found, shown)]
    return Page(tuple(ruled(short, free)), shown, True, free)


def _in_sums(equations: EquationsOfMotion, motion: Sequence[Node], laws: Sequence[Law]) -> Formulas:
    """Return the formulas multiplied out.  Raises TooLarge if one is too long, or if the first equation is so
    long that all of them would be."""
    _try_sum(equations, motion)
    algebra = ShortAlgebra(nonnegative(equations))
    collector = collector_of(SymbolKinds(equations), algebra)
    every: list[Polynomial] = []
    limit = max(ALL, EACH * len(motion))
    for node in motion:
        algebra.limit = min(algebra.spent + ONE, limit)
        every.append(tidy(equations, algebra, algebra.polynomials([node])[0]))
    algebra.limit = limit
    found = everything(equations, collector, divided(equations, collector, every), laws)
    algebra.end_limit()
    return with_long_sums(equations, collector, found)


def _try_sum(equations: EquationsOfMotion, motion: Sequence[Node]) -> None:
    algebra = ShortAlgebra(nonnegative(equations), ONE)
    collector = collector_of(SymbolKinds(equations), algebra)
    first = tidy(equations, algebra, algebra.polynomials(motion[:1])[0])
    # Many terms in the first equation of many are no good, nor are terms that follow no rule.
    if len(first) > LOCAL and len(first) * len(motion) > TERMS:
        raise TooLarge
    written = Former(collector, names(equations)).total(collector.collect(collector.cancel(first)))
    if len(summed(written, set()).terms) > SHORT:
        raise TooLarge


def _in_parts(equations: EquationsOfMotion, motion: Sequence[Node], laws: Sequence[Law]) -> Formulas:
    """Return the formulas with names for shared parts."""
    roots = [*equations.qdot, *motion, *conditions(equations, laws)]
    algebra = SharedAlgebra(equations.graph, shared(roots), nonnegative(equations))
    collector = collector_of(SymbolKinds(equations), algebra)
    found = everything(equations, collector, divided(equations, collector, algebra.polynomials(motion)), laws)
    return Formulas(collector, found, algebra.definitions)


def _shown(equations: EquationsOfMotion) -> Names:
    """The names, with those of the rates of coordinates that are no speeds."""
    shown = names(equations)
    for q in equations.q:
        name = shown[q]
        shown[rate_of(equations, q)] = Name(name.base, name.full, 1)
    letters = [x for x in equations.graph.nodes if x.op == "symbol" and x.record.kind == LETTER]
    return shown | {x: Name(x.record.owner, x.record.owner, x.record.order) for x in letters}


def _letter(equations: EquationsOfMotion) -> str:
    bases = [name.base for name in names(equations).values()]
    return next(c for c in ("s", "part", "shared_part") if not any(x.startswith(c) for x in bases))


def _lines(found: Formulas, shown: Names) -> list[Line]:
    """Return the definitions of parts, and all formulas, as they are written."""
    former = Former(found.collector, shown)
    lines = [former.line(x.kind, x.label, x.left, x.right, x.condition, x.clause) for x in found.found]
    parts = [former.line(x.kind, x.label, x.left, x.right) for x in found.definitions]
    named = [
        replace(x, label=shown[node].base, indices=indices(shown[node].base))
        for x, node in zip(parts, found.named)
    ]
    return [*named, *lines]
