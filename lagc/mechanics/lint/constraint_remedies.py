"""What a row says that touches zero and does not cross it, in rows that cross it: of `norm(a - b) = 0`
that `a = b`, of `x^2 + y^2 = 0` that `x = 0` and `y = 0`.  Read off the syntax tree, in the user's words."""

from __future__ import annotations

from lagc.syntax import tree

_FLAT = ("cos", "cosh")  # 1 at an argument of 0, which is an extreme
_BENT = ("max", "min", "abs")  # no rows by themselves


def held(left: tree.Expression, right: tree.Expression) -> list[str] | None:
    """The rows in the place of `left = right`; None where these are not plain to see."""
    if _is_number(right, 0.0):
        return _parts(left)
    if _is_number(left, 0.0):
        return _parts(right)
    for one, other in ((left, right), (right, left)):
        if _is_number(one, 1.0) and isinstance(other, tree.Call) and _name(other) in _FLAT:
            return _vanishes(_arguments(other)[0])
    return None


def _parts(e: tree.Expression) -> list[str] | None:
    """The rows that hold where `e`, which is of one sign, is zero."""
    if isinstance(e, tree.Unary):
        return _parts(e.operand)
    if isinstance(e, tree.Call):
        return _called(e)
    if not isinstance(e, tree.Binary):
        return None
    if e.op == "^":
        return _parts(e.left) or _vanishes(e.left)
    if e.op == "/":
        return _parts(e.left)
    if e.op == "-":
        return held(e.left, e.right)
    if e.op == "+":
        both = _parts(e.left), _parts(e.right)
        return None if both[0] is None or both[1] is None else list(dict.fromkeys([*both[0], *both[1]]))
    return _of_product(e) if e.op == "*" else None


def _called(e: tree.Call) -> list[str] | None:
    arguments, name = _arguments(e), _name(e)
    if name == "sqrt" and len(arguments) == 1:
        return _parts(arguments[0])
    if name == "norm" and len(arguments) == 1:
        return _vector_vanishes(arguments[0])
    if name == "dot" and len(arguments) == 2 and _words(arguments[0]) == _words(arguments[1]):
        return _vector_vanishes(arguments[0])
    return None


def _of_product(e: tree.Expression) -> list[str] | None:
    """Of the one factor that touches zero, or of one that is written twice."""
    factors = _factors(e)
    words = [_words(x) for x in factors]
    twice = [x for x, word in zip(factors, words) if words.count(word) > 1]
    touching = [found for found in map(_parts, factors) if found is not None]
    if touching:
        return touching[0] if all(found == touching[0] for found in touching) else None
    return _vanishes(twice[0]) if twice and len(set(words)) == len(words) - len(twice) + 1 else None


def _factors(e: tree.Expression) -> list[tree.Expression]:
    if isinstance(e, tree.Binary) and e.op == "*":
        return [*_factors(e.left), *_factors(e.right)]
    return [e]


def _vanishes(e: tree.Expression) -> list[str] | None:
    if isinstance(e, tree.Call) and _name(e) in _BENT:
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
