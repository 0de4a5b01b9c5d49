"""Units as people write them: numbers without one, spellings such as `Nm`, `Kg`, `°`, `m s^-2`, `meters`."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import islice, product
from typing import TypeAlias

from lagc.diagnostics.faults import Fault, Wrong
from lagc.diagnostics.suggest import foreign, in_hertz, is_many_radians, many_radians, unit_symbol
from lagc.semantics.names.scope import expect
from lagc.semantics.units import BROKEN, NONE, SYMBOLS, Dimension, UnknownUnit, name_of, over, si_text, unit
from lagc.syntax import tree


def is_bare(expression: tree.Expression, units: bool = False) -> bool:
    """Return whether an expression consists of numbers without units, `-2`, `{1, 0}`, `2/5`; `units`: or with
    them."""
    stack = [expression]
    while stack:
        top = stack.pop()
        if isinstance(top, tree.Unary):
            stack.append(top.operand)
        elif isinstance(top, tree.Binary):
            stack += [top.left, top.right]
        elif isinstance(top, tree.Vector):
            stack += top.elements
        elif units and isinstance(top, tree.Quantity):
            continue
        elif not isinstance(top, tree.Number):
            return False
    return True


def unit_remedy(expression: tree.Expression, wanted: Dimension | None) -> str | None:
    """Return a remedy for a number without a unit where a quantity of dimension `wanted` is needed."""
    if wanted is None or wanted == NONE or not is_bare(expression):
        return None
    span = expression.span
    text, unit = span.source.text[span.start : span.end], si_text(wanted)
    if isinstance(expression, tree.Binary):
        return f"a number inside an expression has no unit: write `{text}*1 [{unit}]`"
    return f"a number inside an expression has no unit: write `{text} [{unit}]`"


def expect_of(
    expression: tree.Expression, dimension: Dimension | None, wanted: Dimension, what: str, named: str
) -> None:
    """Check the dimension as `expect`; the remedy names the number that may lack a unit.  Raises Wrong."""
    try:
        expect(dimension, wanted, expression.span, what, named)
    except Wrong as wrong:
        factor = None if dimension is None else _lone_factor(expression)
        if factor is None or dimension is None:
            raise
        missing = over(wanted, dimension)
        if isinstance(factor, tree.Name):
            remedy = f"declare `{factor.name}` with its type: `parameter {name_of(missing)} {factor.name}`"
        else:
            remedy = f"a unit may be missing: `{factor.text} [{si_text(missing)}]` gives {named}"
        fault = wrong.fault
        raise Wrong(fault.code, fault.message, fault.span, remedy, fault.related) from None


def _lone_factor(expression: tree.Expression) -> tree.Number | tree.Name | None:
    """Return the only number without a unit among the factors of a product, as in `9.81*m*x` (not `1/2*m`),
    or the only factor that the same file declares as `parameter Real`."""
    numbers: list[tree.Number] = []
    names: list[tree.Name] = []
    stack = [expression]
    while stack:
        top = stack.pop()
        if isinstance(top, tree.Number):
            numbers.append(top)
        elif isinstance(top, tree.Name) and re.search(
            rf"\bparameter\s+Real\s+{top.name}\b", top.span.source.text
        ):
            names.append(top)
        elif isinstance(top, tree.Unary):
            stack.append(top.operand)
        elif isinstance(top, tree.Vector):
            stack += [part for part in top.elements if not is_bare(part) or part.span.text != "0"]
        elif isinstance(top, tree.Binary) and top.op == "*":
            stack += [top.left, top.right]
        elif isinstance(top, tree.Binary) and top.op == "/" and not is_bare(top):
            stack.append(top.left)
    if len(numbers) == 1 and numbers[0] is not expression:
        return numbers[0]
    return names[0] if len(names) == 1 else None


Models: TypeAlias = Mapping[str, Sequence[tree.Declaration]]  # declarations of each model
_NAMED = (tree.ModelDeclaration, tree.Package)


def whole_radians(file: tree.Tree) -> list[Fault]:
    """Return warnings for angles with large whole numbers of radians written without a unit."""
    named = [
        (d.name, [*_declarations_of(d.body)]) for d in _within(file.declarations) if isinstance(d, _NAMED)
    ]
    models = dict(named)  # by name; of equal names in several packages the last
    found: list[Fault] = []
    for own in (list(_declarations_of(file.declarations)), *(body for _, body in named)):
        many = [
            (name, fault)
            for d in own
            for name, value in _given_values(d)
            if (fault := _radians_warning(name, value))
        ]
        angles = _angles(own, models) if many else ()
        found += [fault for name, fault in many if name in angles]
    return found


def angular_hertz(file: tree.Tree) -> list[Fault]:
    """Return warnings for angular velocities, or rates of angles, in hertz."""
    named = [[*_declarations_of(d.body)] for d in _within(file.declarations) if isinstance(d, _NAMED)]
    found: list[Fault] = []
    for own in ([*_declarations_of(file.declarations)], *named):
        kinds = {
            declarator.name: d.type.path
            for d in own
            if isinstance(d, tree.Quantities) and d.type is not None
            for declarator in d.declarators
        }
        given = [each for d in own for each in _angular_velocities(d, kinds)]
        found += [fault for name, value in given if (fault := _hertz(name, value))]
    return found


def _angular_velocities(
    d: tree.Declaration, kinds: Mapping[str, tuple[str, ...]]
) -> Iterator[tuple[str, tree.Expression | None]]:
    """Yield the angular velocities that a declaration, or a line of a scene, gives values to."""
    if isinstance(d, tree.Start):
        target = d.target.span.text
        angle = target.removeprefix("der(").removesuffix(")").strip()
        rate = target.startswith("der(") and kinds.get(angle) == ("Angle",)
        if rate or kinds.get(target) == ("AngularVelocity",):
            yield target, d.value
    for declarator in d.declarators if isinstance(d, tree.Quantities) else ():
        kind = kinds.get(declarator.name)
        if kind == ("AngularVelocity",):
            yield declarator.name, declarator.value
            yield from ((declarator.name, a.value) for a in declarator.arguments if a.name == "start")
        elif kind == ("Angle",):
            yield from (
                (f"der({declarator.name})", a.value) for a in declarator.arguments if a.name == "rate"
            )


def _hertz(name: str, value: tree.Expression | None) -> Fault | None:
    if not isinstance(value, tree.Quantity) or not value.unit.text.strip().endswith("Hz"):
        return None
    return in_hertz(name, f"for a frequency write `2*pi*{value.span.text}`", value.span)


def _angles(own: Sequence[tree.Declaration], models: Models) -> set[str]:
    """Return the names of angles among declarations, inherited ones included."""
    found: set[str] = set()
    seen: set[str] = set()
    left = [own]
    while left:
        for d in left.pop():
            if isinstance(d, tree.Quantities) and d.type is not None and d.type.path == ("Angle",):
                found.update([declarator.name for declarator in d.declarators])
            elif isinstance(d, tree.Extends) and d.path[-1] in models and d.path[-1] not in seen:
                seen.add(d.path[-1])
                left.append(models[d.path[-1]])
    return found


def _within(declarations: Sequence[tree.Declaration]) -> Iterator[tree.Declaration]:
    for d in declarations:
        yield d
        if isinstance(d, _NAMED):
            yield from _within(d.body)


def _declarations_of(declarations: Sequence[tree.Declaration]) -> Iterator[tree.Declaration]:
    """Yield the declarations of one block and of its effects, scenes and loops."""
    for d in declarations:
        yield d
        if isinstance(d, (tree.Effect, tree.Scene, tree.ForLoop)):
            yield from _declarations_of(d.body)


def _given_values(d: tree.Declaration) -> Iterator[tuple[str, tree.Expression | None]]:
    """Yield the names that a declaration gives values to."""
    if isinstance(d, tree.Start) and isinstance(d.target, tree.Name):
        yield d.target.name, d.value
    elif isinstance(d, tree.Quantities):
        for declarator in d.declarators:
            yield declarator.name, declarator.value
            yield from ((declarator.name, a.value) for a in declarator.arguments if a.name == "start")


def _radians_warning(name: str, value: tree.Expression | None) -> Fault | None:
    number = value.operand if isinstance(value, tree.Unary) else value
    sign = "-" if isinstance(value, tree.Unary) and value.op == "-" else ""
    if not isinstance(number, tree.Number) or not is_many_radians(number.value):
        return None
    return many_radians(name, number.text, sign, number.span)


_SIGNS = str.maketrans({**dict.fromkeys("·⋅×∙•", "."), "−": "-", "⁻": "-", "º": "°", "μ": "u", "^": ""})
_WORD = re.compile(r"[^\W\d_]+|[%°]+")
_POWERS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹", "0123456789")
_COMMON = ("kg", "mm", "cm", "km", "ms", "kN", "kHz", "mN", "MPa", "GPa", "kPa", "kJ", "kW", "mrad")
_PIECES = ("kg", "N", "m", "s", "rad", "J", "W", "K", "A", "V", "Pa", "g", "mm", "cm", "km", "kN", "Hz")
_MOST = 2000  # spellings that are tried
_LONGEST = 40


def spelling_remedy(text: str, wanted: Dimension | None = None) -> str | None:
    """Return the remedy for a text that is not a unit, or None. A guess has the dimension `wanted` of its
    place."""
    if BROKEN.search(text):
        return "raise a pure number to that power: `k*(x/(1 [m]))^1.5`, with k in newtons"
    value = foreign("unit_values").get(text.strip())
    if value is not None:
        known = f"write it in a unit of the language: 1 {text.strip()} is `{value}`"
        return value if "`" in value else known
    if (meant := meant_unit(text, wanted)) is not None:
        return f"write `[{meant}]`"
    for guesses in (_close, _units_for) if wanted is not None else ():
        if (close := meant_unit(text, wanted, guesses)) is not None:
            return f"did you mean `[{close}]`?"
    if (meant := meant_unit(text)) is not None:
        return f"write `[{meant}]`"
    if wanted is not None:
        return f"write a unit of {name_of(wanted)}, such as `[{si_text(wanted) or '1'}]`"
    return None if (close := meant_unit(text, None, _close)) is None else f"did you mean `[{close}]`?"


def meant_unit(
    text: str, wanted: Dimension | None = None, meanings: Callable[[str], Iterator[str]] | None = None
) -> str | None:
    """Return the unit, of dimension `wanted` if it is given, that a text means, or None.  `meanings` yields
    the symbols that a word may mean."""
    if len(text) > _LONGEST:
        return None
    meanings = meanings or _meanings
    plain = re.sub(r"\*\*", "^", text.strip()).translate(_SIGNS).translate(_POWERS)
    plain = re.sub(r"\s*(\bper\b|/)\s*", "/", plain)
    plain = re.sub(r"\s*[.*]\s*|\s+|(?<=[A-Za-z])-(?=[A-Za-z])", ".", plain)
    words = list(_WORD.finditer(plain))
    for chosen in islice(product(*(tuple(meanings(word[0])) for word in words)), _MOST):
        spelled, at = "", 0
        for word, symbol in zip(words, chosen):
            spelled, at = spelled + plain[at : word.start()] + symbol, word.end()
        spelled += plain[at:]
        try:
            found = unit(spelled)
        except UnknownUnit:
            continue
        if wanted is None or found.dimension == wanted:
            return spelled
    return None


def _meanings(word: str) -> Iterator[str]:
    """Yield the symbols that a word may mean, the likeliest first."""
    if _is_unit(word):
        yield word
    plain = word.lower()
    yield unit_symbol(word)
    for prefix, short in foreign("unit_prefixes").items():
        if plain.startswith(prefix):
            yield short + unit_symbol(plain.removeprefix(prefix))
    yield from (symbol for symbol in (*_COMMON, *SYMBOLS) if symbol.lower() in (plain, plain.rstrip("s")))
    yield from sorted(_products(word), key=_unlikeliness)[:4]


def _close(word: str) -> Iterator[str]:
    """Yield the symbols that are most like a word."""
    import difflib

    if _is_unit(word):
        yield word
    yield from difflib.get_close_matches(word, [*_COMMON, *SYMBOLS], n=6, cutoff=0.5)


def _units_for(word: str) -> Iterator[str]:
    """Yield the common units for a word that is none."""
    yield from (word,) if _is_unit(word) else _PIECES


@lru_cache(maxsize=64)
def _products(word: str) -> Sequence[str]:
    """Return the products that a word may be: `N.m.s` and `N.ms` for `Nms`."""
    found = []
    for piece in _PIECES:
        if word.startswith(piece) and word != piece:
            rest = word[len(piece) :]
            others = (*_products(rest), *([rest] if rest in _PIECES else []))
            found += [f"{piece}.{other}" for other in others]
    return tuple(found)


def _unlikeliness(written: str) -> float:
    """Return how unlikely a product is: by its factors, prefixes, and factors that come twice."""
    parts = written.split(".")
    prefixed = sum(part in ("mm", "cm", "km", "kN", "g") for part in parts)
    return len(parts) + 1.5 * prefixed + 3 * (len(parts) - len(set(parts)))


def _is_unit(word: str) -> bool:
    try:
        unit(word)
    except UnknownUnit:
        return False
    return True
