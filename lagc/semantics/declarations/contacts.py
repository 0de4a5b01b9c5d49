"""One-sided constraints: `constraint floor: bob.z >= 0 (restitution = 0.8);`.

The gap of `a >= b` is a - b, that of `a <= b` is b - a. It is never negative. A contact touches where its gap
is zero; then it may push its gap open, and never pulls.
"""

from __future__ import annotations

from collections.abc import Sequence

from lagc.diagnostics.suggest import did_you_mean
from lagc.semantics import model as objects
from lagc.semantics.context import Context
from lagc.semantics.declarations.actions import no_modifiers, residuals, timely
from lagc.semantics.names.scope import Entry, Reference, Scalar, Value, scalar_of
from lagc.semantics.refusals import Wrong
from lagc.semantics.time_derivatives import BIT, VELOCITY
from lagc.semantics.units import NONE, si_text
from lagc.semantics.values.evaluate import all_values, evaluate_as
from lagc.semantics.values.unit_hints import expect_of
from lagc.symbolic.graph import Node
from lagc.syntax import tree

_ARGUMENTS = ("restitution",)
_MOVED = BIT["coordinate"] | BIT["time"]


def declare_contact(context: Context, entry: Entry) -> Value:
    """Declare a contact for each component of lhs >= rhs or lhs <= rhs."""
    source = entry.source
    assert isinstance(source, tree.Constraint)
    no_modifiers(entry)
    given = _arguments(context, entry, source)
    left, right = all_values(context, [source.left, source.right], entry.environment)
    differences = residuals(left, right, source)
    entry.size = None if isinstance(left, Scalar) else len(differences)
    for k, (node, found) in enumerate(differences):
        gap = node if source.relation == ">=" else -node
        _check(context, source, gap)
        label = entry.path if entry.size is None else f"{entry.path}[{k + 1}]"
        symbol = context.graph.symbol("discrete", label)
        context.clock.set_rate(symbol, context.graph.zero)
        restitution = given.get("restitution", context.graph.zero)
        entry.objects.append(
            objects.Contact(
                entry.path, label, gap, si_text(found or NONE), symbol, restitution, entry.span, entry.effect
            )
        )
    return Reference(entry)


def _check(context: Context, source: tree.Constraint, gap: Node) -> None:
    """Refuse a gap that depends on what has no place in it."""
    span = source.left.span.to(source.right.span)
    timely(context, gap, span, "a constraint")
    mask = context.clock.mask(gap)
    if mask & VELOCITY:
        raise Wrong(
            "LAG0235",
            f"`{source.relation}` restricts positions; this one restricts velocities",
            span,
            "write the bound of a position, or a load that acts beyond the bound of the velocity",
        )
    for kind, named in (("input", "an input"), ("discrete", "a discrete variable")):
        if mask & BIT[kind]:
            raise Wrong(
                "LAG0235",
                f"the bound `{source.name}` depends on {named}, whose time derivative is not known",
                span,
                "write the bound in coordinates, parameters and time",
            )
    if not mask & BIT["coordinate"]:
        raise Wrong(
            "LAG0235",
            f"the bound `{source.name}` depends on no coordinate, so it restricts nothing",
            span,
            "compare an expression of coordinates: `constraint floor: ball.z >= 0;`",
        )


def _arguments(context: Context, entry: Entry, source: tree.Constraint) -> dict[str, Node]:
    """Return the value of each argument of a contact by name."""
    found: dict[str, Node] = {}
    for argument in source.arguments:
        name, span = argument.name, argument.name_span or argument.span
        if name not in _ARGUMENTS:
            remedy = (name and did_you_mean(name, _ARGUMENTS)) or f"the arguments are {', '.join(_ARGUMENTS)}"
            raise Wrong(
                "LAG0209", f"a one-sided constraint has no `{name or argument.span.text}`", span, remedy
            )
        if name in found:
            raise Wrong("LAG0209", f"`{name}` is given twice", span)
        if argument.value is None or argument.arguments:
            raise Wrong("LAG0210", f"`{name}` needs a value", argument.span)
        found[name] = _number(context, entry, name, argument.value)
    return found


def _number(context: Context, entry: Entry, name: str, written: tree.Expression) -> Node:
    value = evaluate_as(context, written, entry.environment, NONE)
    scalar = scalar_of(value, written.span, f"the {name}")
    expect_of(written, scalar.dimension, NONE, f"the {name}", "a number")
    timely(context, scalar.node, written.span, f"the {name}")
    if scalar.node.is_const and not 0.0 <= scalar.node.value <= 1.0:
        raise Wrong(
            "LAG0235",
            f"the {name} is {scalar.node.value:g}, and not from 0 to 1",
            written.span,
            "0 is an impact without rebound, 1 one without loss of energy",
        )
    return scalar.node


def refuse_beside(context: Context, whens: Sequence[objects.When]) -> None:
    """Report clauses `when` that set states, in a model with contacts."""
    for clause in whens:
        if clause.changes:
            context.report(
                Wrong(
                    "LAG0236",
                    "`reinit` and one-sided constraints do not act in one model yet",
                    clause.span,
                    "let a one-sided constraint make the impact, or write all impacts as clauses `when`",
                )
            )
