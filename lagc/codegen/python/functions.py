"""Functions of a Program as Python functions on floats and lists."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial

from lagc.base.records import replace
from lagc.codegen.identifiers import comment
from lagc.codegen.kernel_compiler.library import Chosen
from lagc.codegen.loops import Forms, Running, loops
from lagc.codegen.sizes import CONSTANT_SIZES
from lagc.codegen.statements import Dialect, lines
from lagc.codegen.tables import NONE, Numbers, python_look_up
from lagc.lowering.program import Function, Run
from lagc.symbolic.operators import OPERATORS, spelling

CALLS = {**spelling("python"), "sin": "sine_cosine", "cos": "sine_cosine"}


def _entry(array: str, index: str) -> str:
    return "t" if array == "t" else f"{array}[{index}]"


DIALECT = Dialect(
    calls=CALLS,
    infix={},
    select="select({}, {}, {})",
    number="{name} = {value}",
    truth="{name} = {value}",
    store=lambda array, index, value: f"{array}[{index}] = {value}",
    comment=lambda text: f"# {comment(text)}",
    load=lambda array, index: _entry(array, str(index)),
    entry=_entry,
    look_up=partial(python_look_up, NONE),
    turn="sin{number}, cos{number} = sine_cosine({value})",
    sine="sin{number}",
    cosine="cos{number}",
)

# At initial guesses divisors are often zero: these functions use `quotient` instead of catching exceptions.
GUESSED = ("conditions",)
AT_GUESSES = replace(DIALECT, calls={**CALLS, "div": "quotient"}, called=("div",))


def _head(run: Run, running: Sequence[Running]) -> str:
    """Return the head of a loop over the repetitions."""
    names = ["i", *(name for name, *_ in running)]
    sequences = [f"range({run.count})"]
    sequences += [_all_of(array, place, stride, run.count) for _, array, place, stride in running]
    if len(names) == 1:
        return f"for i in {sequences[0]}:"
    return f"for {', '.join(names)} in zip({', '.join(sequences)}):"


def _all_of(array: str, first: int, stride: int | None, count: int) -> str:
    if stride is None:
        return array
    end = first + stride * count
    return f"{array}[{first}:{end if end >= 0 else ''}{f':{stride}' if stride != 1 else ''}]"


_STRAIGHT = 10_000  # operations up to which straight code is faster than loops

FORMS = Forms(
    array="kept = [0.0] * {size}",
    variable="{name} = {value}",
    fixed="{name} = {value}",
    change="{name} = {value}",
    table=lambda name, values: [f"{name} = ({', '.join(map(repr, values))})"],
    head=_head,
    end="",
    sequences=True,
    number="(1.0 * {})",  # for `_recompute`, which converts constants but not tuples
)

# Functions of math; its floor returns an integer without the sign of zero.
_MATH = sorted([CALLS[op] for op, row in OPERATORS.items() if row.value is getattr(math, CALLS[op], None)])
_MATH.remove("floor")
_FIRST, _REST = ", ".join(_MATH[:11]), ", ".join(_MATH[11:])

# Python raises where C returns infinity or NaN.  A function that raised is computed again with floats and
# functions that return what C returns; functions that do not raise stay fast.  Kernels change their
# arguments: they call `quotient` and `root` instead.
ARITHMETIC = (
    f"""\
from math import {", ".join(sorted([*_MATH, "inf", "nan"]))}
"""
    '''\
from math import copysign as _copysign, floor as _floor


def minimum(a, b):
    return b if b < a else a


def maximum(a, b):
    return b if b > a else a


def sign(a):
    return 1.0 if a > 0.0 else -1.0 if a < 0.0 else 0.0


def floor(a):
    if a - a != 0.0:
        return a  # infinity, or NaN
    whole = float(_floor(a))
    return whole if whole != 0.0 else a * 0.0  # keeps the sign of zero


def select(condition, a, b):
    return a if condition else b


def both(a, b):
    return a and b


def either(a, b):
    return a or b


def inverse(a):
    return not a


def quotient(a, b):
    """Return a / b by IEEE arithmetic."""
    if b != 0.0:
        return a / b
    return nan if a == 0.0 or a != a else _copysign(inf, a) * _copysign(1.0, b)


def root(a):
    """Return sqrt(a) by IEEE arithmetic."""
    return nan if a < 0.0 else sqrt(a)


class _Ieee(float):
    """A float whose division by zero gives infinity or NaN."""

    __slots__ = ()

    def __add__(self, other):
        return _Ieee(float(self) + float(other))

    def __sub__(self, other):
        return _Ieee(float(self) - float(other))

    def __mul__(self, other):
        return _Ieee(float(self) * float(other))

    def __neg__(self):
        return _Ieee(-float(self))

    def __truediv__(self, other):
        try:
            return _Ieee(float(self) / float(other))
        except ZeroDivisionError:
            a = float(self)
            if a != a or a == 0.0:
                return _Ieee(nan)
            return _Ieee(_copysign(inf, _copysign(1.0, a) * _copysign(1.0, other)))


def _ieee(function):
    """Return `function` of math, which returns what C returns where Python raises."""
    name = function.__name__

    def careful(*arguments):
        a = float(arguments[0])
        try:
            return _Ieee(function(*arguments))
        except OverflowError:  # of exp, sinh, cosh, pow
            odd = name == "sinh" or (name == "pow" and arguments[1] % 2.0 == 1.0)
            return _Ieee(_copysign(inf, a) if odd else inf)
        except ValueError:
            if name == "log" and a == 0.0:
                return _Ieee(-inf)
            if name == "pow" and a == 0.0:
                return _Ieee(_copysign(inf, a) if arguments[1] % 2.0 == 1.0 else inf)
            return _Ieee(nan)

    return careful


_CAREFUL = {
'''
    f"""\
    **{{f.__name__: _ieee(f) for f in ({_FIRST})}},
    **{{f.__name__: _ieee(f) for f in ({_REST}, minimum, maximum, sign, floor)}},
"""
    '''\
    "quotient": lambda a, b: a / b,
    "select": select,
    "both": both,
    "either": either,
    "inverse": inverse,
}


def _recompute(function, inputs, outputs):
    """Compute `function` as C does; write the lists in `outputs`."""
    code = function.__code__
    constants = tuple(_Ieee(c) if type(c) is float else c for c in code.co_consts)
    careful = type(function)(code.replace(co_consts=constants), _CAREFUL, None, function.__defaults__)
    values = [[_Ieee(b) for b in a] if isinstance(a, (list, tuple)) else _Ieee(a) for a in inputs]
    results = [[_Ieee(b) for b in a] for a in outputs]
    careful(*values, *results)
    for output, result in zip(outputs, results):
        output[:] = [float(b) for b in result]
'''
)


def sine_cosine(use: Chosen) -> list[str]:
    """Return the sine and cosine kernels that functions of the model call."""
    if not use.functions:
        return []
    numbers = [f"{name} = {size}\n" for name, size in CONSTANT_SIZES.items() if name in use.names]
    numbers += [f"{part.name} = {part.text}\n" for part in use.constants]
    return ["".join(numbers), *(part.text for part in use.functions), _CAREFULLY]


_CAREFULLY = """\
def _careful_sine_cosine(a):
    sine, cosine = sine_cosine(float(a))
    return _Ieee(sine), _Ieee(cosine)


_CAREFUL["sine_cosine"] = _careful_sine_cosine
"""


_EACH = '''\
def _recompute_each(function, inputs, outputs):
    """Do the same for each direction, if entries of the last input are arrays of many directions."""
    *others, d = inputs
    (changes,) = outputs
    many = [b for b in d if hasattr(b, "__len__")]
    if not many:
        return _recompute(function, inputs, outputs)
    found = [[0.0] * len(changes) for _ in many[0]]
    for k, own in enumerate(found):
        _recompute(function, (*others, [b[k] if hasattr(b, "__len__") else b for b in d]), (own,))
    changes[:] = [0.0 * many[0] + row for row in zip(*found)]


'''


def function_text(function: Function, locals_: Mapping[tuple[str, int], str], numbers: Numbers = NONE) -> str:
    """Return `def fn_<name>(inputs..., outputs...)`. An array that is both read and written is one
    argument. `numbers`: its tables."""
    dialect = AT_GUESSES if function.name in GUESSED else DIALECT
    if numbers:
        dialect = replace(dialect, look_up=partial(python_look_up, numbers))
    outputs = [name for name, _ in function.outputs]
    inputs = [name for name in function.inputs if name not in outputs]
    order = [*function.inputs, *(name for name in outputs if name not in function.inputs)]
    size = dict(function.outputs)
    body = [f"{a}[:] = [0.0] * {size[a]}" for a in function.cleared]
    if function.runs and len(function.operations) > _STRAIGHT:
        body += [line for part in loops(function, dialect, FORMS, {}) for line in part]
    else:
        body += lines(function, dialect, locals_) or ["pass"]
    description = comment(function.description).replace('"', "'")
    name = f"fn_{function.spelled}"
    text = [f"def {name}({', '.join(order)}):"]
    if description:
        text.append(f'    """{description}"""')
    text.append("    try:")
    text += [f"        {line}" for line in body]
    text.append("    except (ArithmeticError, ValueError):")
    arguments = f"({_tuple(inputs)}), ({_tuple(outputs)})"
    along = function.name == "along"
    text.append(f"        {'_recompute_each' if along else '_recompute'}({name}, {arguments})")
    return (_EACH if along else "") + "\n".join(text) + "\n"


def _tuple(names: list[str]) -> str:
    return "".join(f"{name}, " for name in names).rstrip() if names else ""
