"""Requests of a run: the settings of a scene, the outputs to record, expressions over the finished run."""

from collections.abc import Sequence
from math import inf
from typing import NamedTuple

from lagc.base.records import replace
from lagc.base.run_options import RUN_OPTIONS
from lagc.base.text import FINEST, MOST_POINTS
from lagc.diagnostics.faults import Fault, Refused, Source, Span, Wrong
from lagc.diagnostics.suggest import did_you_mean, meant_argument
from lagc.semantics.context import Context
from lagc.semantics.model import Coordinate, Model, Output
from lagc.semantics.names.scope import (
    Environment,
    Scalar,
    Value,
    expect,
    flat,
    kind,
    shape,
    subscripts,
    vector_value,
)
from lagc.semantics.units import NONE, M, si_text, unit
from lagc.semantics.values.evaluate import evaluate, evaluate_as
from lagc.syntax import tree

_SETTINGS = {option.of_scene: option for option in RUN_OPTIONS.values()}
_ALTERNATIVES = (
    ("accuracy", "rtol"), ("accuracy", "atol"), ("accuracy", "step"), ("step", "rtol"), ("step", "atol"),
    ("step", "maxstep"), ("every", "points"),
)  # fmt: skip


class _Given(NamedTuple):
    number: float
    span: Span


class Settings:
    """The settings of a scene, from all of its `simulate` statements."""

    def __init__(self, context: Context, environment: Environment):
        self.context, self.environment = context, environment
        self._given: dict[str, _Given] = {}

    def numbers(self) -> dict[str, float]:
        """Return the settings by name."""
        return {name: given.number for name, given in self._given.items()}

    def read(self, simulate: tree.Simulate) -> None:
        """Record the arguments of `simulate` and report their faults."""
        for argument in simulate.arguments:
            self.context.attempt(self._read, argument)

    def _read(self, argument: tree.Argument) -> None:
        """Record one argument.  Raises Wrong."""
        name, value = argument.name, argument.value
        if name is None:
            raise Wrong("LAG0209", "an argument of `simulate` needs a name: `stop = 20`", argument.span)
        if name not in _SETTINGS or value is None:
            message = f"`simulate` has no argument `{name}`"
            remedy = meant_argument(name, _SETTINGS) or f"it has {', '.join(_SETTINGS)}"
            raise Wrong("LAG0209", message, argument.name_span or argument.span, remedy)
        if name in self._given:
            related = ((self._given[name].span, "first here"),)
            raise Wrong("LAG0209", f"`{name}` is given twice", argument.span, related=related)
        number = self._number(name, value)
        wrong = self._fault(name, number)
        if wrong:
            raise Wrong("LAG0308", wrong, value.span)
        for first, second in _ALTERNATIVES:
            if name in (first, second) and (first in self._given or second in self._given):
                raise Wrong("LAG0209", f"`{first}` and `{second}` exclude each other", argument.span)
        self._given[name] = _Given(number, argument.span)

    def _number(self, name: str, e: tree.Expression) -> float:
        """Return the number of an argument.  Raises Wrong if it is not a constant number of the right
        dimension."""
        dimension = unit(_SETTINGS[name].unit or "1").dimension
        value = evaluate_as(self.context, e, self.environment, dimension)
        if not isinstance(value, Scalar):
            raise Wrong("LAG0306", f"`{name}` must be a number; this is {kind(value)}", e.span)
        if not value.node.is_const:
            message = f"`{name}` must be a fixed number; this depends on parameters or on the motion"
            raise Wrong("LAG0208", message, e.span)
        expect(value.dimension, dimension, e.span, f"`{name}`")
        number = value.node.value
        assert isinstance(number, float)
        return number

    def _fault(self, name: str, number: float) -> str | None:
        """Return the reason why a number is not valid for a setting, or None."""
        if number <= 0:
            return f"`{name}` must be positive"
        relative = _SETTINGS[name].relative
        if relative and number >= 1:
            return f"`{name}` is a relative {relative} and must be below 1"
        if name == "rtol" and number < FINEST:
            return f"`rtol` is below {FINEST:g}, the limit set by round-off"
        if name == "points" and (number < 2 or number % 1 or number > MOST_POINTS):
            return f"`points` must be an integer from 2 to {MOST_POINTS:,}"
        numbers = {**self.numbers(), name: number}
        if name in ("stop", "every") and numbers.get("stop", 0.0) / numbers.get("every", inf) > MOST_POINTS:
            return f"`every` = {numbers['every']:g} s gives more than {MOST_POINTS:,} points"
        return None


MOST_NAMED = 12


def asked_for(model: Model, names: Sequence[str]) -> Model:
    """Return the model with those of its outputs that are among `names`.  Raises Refused (LAG0606) for a name
    that is no output, coordinate or speed."""
    known = [output.name for output in model.outputs]
    for c in model.coordinates:
        symbols = (c.symbol, c.rate_symbol) if isinstance(c, Coordinate) else (*c.symbols, *c.rate_symbols)
        known += [c.name, *(symbol.record.name for symbol in symbols)]
    known += [speed.name for speed in model.speeds]
    known = list(dict.fromkeys(known))
    faults = []
    for name in names:
        if name not in known:
            there = ", ".join([f"`{x}`" for x in known]) if len(known) <= MOST_NAMED else ""
            remedy = did_you_mean(name, known) or (f"there are {there}" if there else None)
            faults.append(Fault("LAG0606", f"there is no output or coordinate `{name}`", remedy=remedy))
    if faults:
        raise Refused(faults)
    kept = tuple([output for output in model.outputs if output.name in names])
    return replace(model, outputs=kept, asked=tuple(names))


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
