"""Constraints whose gradient vanishes wherever they hold: `x^2 = 0`, `norm(a - b) = 0`, `1 - cos(u) = 0`.

Such a residual touches zero without crossing. No multiplier can enforce it, and it restricts more than one
degree of freedom. It is recognized by structure: a power, or a sum of terms of one sign with extremes at
zero. The gradient of a product such as `x^2*y` vanishes on one branch.
"""

from collections.abc import Sequence

from lagc.diagnostics.faults import Fault, Refused
from lagc.mechanics.formulation.constraints import Classified
from lagc.mechanics.formulation.equations import Row
from lagc.mechanics.formulation.states import States
from lagc.mechanics.identities.constraint_manifold import onto
from lagc.mechanics.identities.samples import magnitudes, samples
from lagc.mechanics.redundancy import dependent_rows
from lagc.symbolic.enclosures import intervals
from lagc.symbolic.expression_text import brief
from lagc.symbolic.graph import Node
from lagc.symbolic.walk import depends, symbols
from lagc.syntax import tree

_STATES = 3
_HOLDS = 1e-7  # of its terms, at a state that meets other constraints to 1e-12
_EVEN = ("cos", "cosh")  # 1 at an argument of 0, which is an extreme
_KINKED = ("max", "min", "abs")  # no constraints by themselves


def refuse_degenerate(states: States, classified: Sequence[Classified]) -> tuple[Fault, ...]:
    """Return warnings LAG0413 of products whose gradient vanishes with one factor. Raises Refused: LAG0413
    for a constraint whose gradient vanishes wherever it holds, unless others imply it."""
    # Affine velocity rows have a gradient without speeds: it cannot vanish with the row.
    asked = [x for x in classified if x.row.holonomic or not x.row.linear]
    residuals = [x.row.residual for x in asked]
    moving = depends(residuals, symbols(residuals) - {p.symbol for p in states.model.parameters})
    warnings: list[Fault] = []
    everywhere: list[Classified] = []
    # A residual is a product of factors: it vanishes with any of them, and its gradient with those that touch
    # zero.
    for x in asked:
        factors, flat = _flat_factors(states, x.row.residual, moving)
        if flat and all(f in flat or _is_never_zero(states, f) for f in factors):
            everywhere.append(x)
        elif flat:
            warnings.append(_of_factor(x, flat[0]))
    # Rows that others imply need no force, so a vanishing gradient does no harm.
    if everywhere:
        others = [x.row for x in classified if x not in everywhere]
        faults = [_of_all(x) for x in everywhere if not _is_implied(states, x.row, others)]
        if faults:
            raise Refused(faults)
    return tuple(warnings)


def _is_implied(states: States, row: Row, others: Sequence[Row]) -> bool:
    """Return whether `row` holds at states that meet the others: nothing has to enforce it then."""
    spare = {r.row for r in dependent_rows(states, others)}
    kept = [x for k, x in enumerate(others) if k not in spare]
    met = [s for s in map(onto(states, kept), samples(states.model, _STATES, vary=False)) if s is not None]
    found = [magnitudes([row.residual], state)[0] for state in met]
    return bool(found) and all(abs(value) <= _HOLDS * size for value, size in found)


def _flat_factors(states: States, node: Node, moving: set[Node]) -> tuple[list[Node], list[Node]]:
    """Return the factors that move, and those of them at whose zeros the gradient vanishes."""
    node = _bare(node)
    powers = list(zip(node.args, node.value)) if node.op == "mul" else [(node, 1)]
    own = [(base, e) for base, e in powers if e > 0 and base in moving]
    return [b for b, _ in own], [b for b, e in own if e > 1 or _touches(states, b, moving)]


def _touches(states: States, node: Node, moving: set[Node]) -> bool:
    """Return whether zero is an extreme of a sum of squares, roots of such, cosines and numbers."""
    if 0.0 not in intervals([node], states.bounds)[node]:
        return False
    pending = [node]
    # Terms of a sum: numbers, cosines and squares; the interval has told that zero is its end.
    while pending:
        term = pending.pop()
        bare = _bare(term)
        if term.op == "add":
            pending.extend(term.args)
        elif not (bare.is_const or bare.op in _EVEN or _is_square(states, bare, moving)):
            return False
    return True


def _is_square(states: States, term: Node, moving: set[Node]) -> bool:
    """Return whether a term is a product of even powers and roots, and moves."""
    if term.op == "sqrt":
        return _touches(states, term.args[0], moving)
    if term.op != "mul":
        return False
    for base, exponent in zip(term.args, term.value):
        if exponent % 2 and not (base.op == "sqrt" and exponent > 0):
            return False
        if exponent < 0 and base in moving:
            return False
    return term in moving


def _is_never_zero(states: States, factor: Node) -> bool:
    """Return whether a factor has no zero, with the parameters' values."""
    values = {p.symbol: (p.value, p.value) for p in states.model.parameters if p.value is not None}
    low, high = intervals([factor], values)[factor]
    return factor.op == "exp" or low > 0.0 or high < 0.0


def _bare(node: Node) -> Node:
    return node.args[0] if node.op == "scale" else node


def _of_factor(x: Classified, factor: Node) -> Fault:
    return Fault(
        "LAG0413",
        f"the gradient of the constraint `{x.row.label}` vanishes where `{brief(factor)}` is zero, which is "
        "one way to meet it: no force can enforce it there",
        x.constraint.span,
        remedy="write the factor that is meant to vanish, as a row of its own and to the first power: "
        "`y = 0` or `x = 0` in place of `x^2*y = 0`",
        severity="warning",
    )


def _of_all(x: Classified) -> Fault:
    c = x.constraint
    rows = _rows_meant(c.left, c.right) if len(c.residuals) == 1 else None
    remedy = (
        "write what has to vanish itself, each part as a row of its own: `a = b` in place of "
        "`norm(a - b) = 0`, `x = 0` in place of `x^2 = 0`"
    )
    if rows:
        remedy = f"write {_list(rows)}{', each as a row of its own' if len(rows) > 1 else ''}"
    return Fault(
        "LAG0413",
        f"the gradient of the constraint `{x.row.label}` vanishes wherever the constraint holds, so that no "
        "force can enforce it",
        c.span,
        remedy=remedy,
    )


def _list(rows: Sequence[str]) -> str:
    *first, last = [f"`{row}`" for row in rows]
    return f"{', '.join(first)} and {last}" if first else last


# -- the constraints that are meant, read off the syntax tree ------------------------------------


def _rows_meant(left: tree.Expression, right: tree.Expression) -> list[str] | None:
    """Return the rows to write in the place of `left = right`; None if they are not obvious."""
    if _is_number(right, 0.0):
        return _parts(left)
    if _is_number(left, 0.0):
        return _parts(right)
    for one, other in ((left, right), (right, left)):
        if _is_number(one, 1.0) and isinstance(other, tree.Call) and _name(other) in _EVEN:
            return _vanishes(_arguments(other)[0])
    return None


def _parts(e: tree.Expression) -> list[str] | None:
    """Return the rows that hold where `e`, which has one sign, is zero; None if they are not obvious."""
    if isinstance(e, tree.Unary):
        return _parts(e.operand)
    if isinstance(e, tree.Call):
        return _rows_of_call(e)
    if not isinstance(e, tree.Binary):
        return None
    if e.op == "^":
        return _parts(e.left) or _vanishes(e.left)
    if e.op == "/":
        return _parts(e.left)
    if e.op == "-":
        return _rows_meant(e.left, e.right)
    if e.op == "+":
        both = _parts(e.left), _parts(e.right)
        return None if both[0] is None or both[1] is None else list(dict.fromkeys([*both[0], *both[1]]))
    return _of_product(e) if e.op == "*" else None


def _rows_of_call(e: tree.Call) -> list[str] | None:
    arguments, name = _arguments(e), _name(e)
    if name == "sqrt" and len(arguments) == 1:
        return _parts(arguments[0])
    if name == "norm" and len(arguments) == 1:
        return _vector_vanishes(arguments[0])
    if name == "dot" and len(arguments) == 2 and _words(arguments[0]) == _words(arguments[1]):
        return _vector_vanishes(arguments[0])
    return None


def _of_product(e: tree.Expression) -> list[str] | None:
    """Return the rows of the one factor that touches zero, or of a factor that is written twice."""
    factors = _factors(e)
    words = [_words(x) for x in factors]
    twice = [x for x, word in zip(factors, words) if words.count(word) > 1]
    parts = [found for found in map(_parts, factors) if found is not None]
    if parts:
        return parts[0] if all(found == parts[0] for found in parts) else None
    return _vanishes(twice[0]) if twice and len(set(words)) == len(words) - len(twice) + 1 else None


def _factors(e: tree.Expression) -> list[tree.Expression]:
    if isinstance(e, tree.Binary) and e.op == "*":
        return [*_factors(e.left), *_factors(e.right)]
    return [e]


def _vanishes(e: tree.Expression) -> list[str] | None:
    if isinstance(e, tree.Call) and _name(e) in _KINKED:
        return None
    if isinstance(e, tree.Binary) and e.op == "-":
        return [f"{_words(e.left)} = {_words(e.right)}"]
    return [f"{_words(e)} = 0"]


def _vector_vanishes(e: tree.Expression) -> list[str] | None:
    if isinstance(e, tree.Vector):
        rows = [_vanishes(x) for x in e.elements if not _is_number(x, 0.0)]
        return None if None in rows else [row for found in rows if found for row in found]
    if isinstance(e, tree.Binary) and e.op == "-":
        return _vanishes(e)
    return [f"{_words(e)} = {{0, 0, 0}}"]


def _is_number(e: tree.Expression, value: float) -> bool:
    e = e.value if isinstance(e, tree.Quantity) else e
    return isinstance(e, tree.Number) and e.value == value


def _name(e: tree.Call) -> str:
    return e.function.name if isinstance(e.function, tree.Name) else ""


def _arguments(e: tree.Call) -> list[tree.Expression]:
    return [x.value for x in e.arguments if x.value is not None]


def _words(e: tree.Expression) -> str:
    return e.span.text
