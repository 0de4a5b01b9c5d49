"""Probes: expressions that are evaluated over a finished run, as outputs that the text does not declare."""

from __future__ import annotations

from lagc.diagnostics.faults import Source
from lagc.semantics.context import Context
from lagc.semantics.model import Output
from lagc.semantics.names.scope import Environment, Value, flat, shape, subscripts, vector_value
from lagc.semantics.units import NONE, M, si_text
from lagc.semantics.values.evaluate import evaluate
from lagc.syntax import tree

PROBE = "probe("  # no declaration has such a name


def parse_probe(context: Context, text: str) -> tree.Expression:
    """Return the expression of a text.  Raises Refused if it is not one."""
    from lagc.syntax.parse import parse_expression

    source = Source("<expression>", text, asked=True)
    context.importer.free.append(source)
    return parse_expression(source)


def probe_outputs(
    context: Context, number: int, written: tree.Expression, environment: Environment
) -> list[Output]:
    """Return the outputs `probe(number)`, with a subscript for each element of a vector or an array; the
    value of a body or point is its position.  Raises Wrong."""
    from lagc.semantics.model import Body

    value: Value = evaluate(context, written, environment)
    if isinstance(value, Body):
        value = vector_value(value.position, M)
    scalars = flat(value, written.span, "an expression over a run")
    sizes = shape(value)
    unit = next((si_text(s.dimension) for s in scalars if s.dimension is not None), si_text(NONE))
    places = subscripts(sizes, written.span)
    names = [f"{PROBE}{number})" + (f"[{','.join(map(str, place))}]" if place else "") for place in places]
    return [Output(name, s.node, unit, unit, written.span) for name, s in zip(names, scalars)]
