"""Functions of a Program as C functions."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from lagc.expr.operators import spelling
from lagc.optimize.program import Function, Program, uses
from lagc.render.c.parts import LONGEST, SHARED, divided
from lagc.render.kernels.arithmetic import DOUBLE, Arithmetic
from lagc.render.names import comment
from lagc.render.statements import AND, OR, Dialect, lines

CALLS = spelling("c")

# Sines and cosines in double precision: see `lagc.kernels.trigonometry`.
TURN = "lagc_real sc{number}[2]; lagc_sine_cosine({value}, sc{number});"
TURN_TWO = "lagc_real sc{number}[4]; lagc_sine_cosine_two({value}, {other}, sc{number});"

# Written where a function of the model uses them.  min and max keep the first of equal operands,
# so that they do in C what they do in Python.
HELPERS = {
    "sign": "static lagc_real lagc_sign(lagc_real a) { return (lagc_real)((a > 0) - (a < 0)); }\n",
    "min": "static lagc_real lagc_min(lagc_real a, lagc_real b) { return b < a ? b : a; }\n",
    "max": "static lagc_real lagc_max(lagc_real a, lagc_real b) { return b > a ? b : a; }\n",
}


def helpers(program: Program) -> str:
    """The definitions of HELPERS that the functions of `program` call."""
    used = {o.op for f in program.functions.values() for o, n in zip(f.operations, uses(f)) if n}
    return "".join(text for op, text in HELPERS.items() if op in used)


def function_text(
    function: Function,
    locals_: Mapping[tuple[str, int], str],
    fields: Mapping[int, str],
    real: Arithmetic = DOUBLE,
) -> str:
    """`static void lagc_fn_<name>(inputs..., outputs...)`; an array both read and written stands
    once.  `fields`: the member of the parameters' struct for each index of p."""

    def load(array: str, index: int) -> str:
        if array == "t":
            return "t"
        return f"p->{fields[index]}" if array == "p" else f"{array}[{index}]"

    dialect = Dialect(
        calls=CALLS if real == DOUBLE else {op: _of_type(text, real) for op, text in CALLS.items()},
        infix={op: (f" {CALLS[op]} ", binds) for op, binds in (("and", AND), ("or", OR))},
        select="({} ? {} : {})",
        number="const lagc_real {name} = {value};",
        truth="const int {name} = {value};",
        store="{array}[{index}] = {value};",
        comment=lambda text: f"/* {comment(text)} */",
        load=load,
        literal=real.literal,
        turn=TURN if real == DOUBLE else "",
        turn_two=TURN_TWO if real == DOUBLE else "",
        sine="sc{number}[{sine}]",
        cosine="sc{number}[{cosine}]",
    )
    size = dict(function.outputs)
    body = [f"{{ int i; for (i = 0; i < {size[a]}; i++) {a}[i] = 0.0; }}" for a in function.cleared]
    body += lines(function, dialect, locals_)
    name = f"lagc_fn_{function.name}"
    about = f"/* {comment(function.description)} */\n" if function.description else ""
    if len(body) <= LONGEST:
        return about + _definition(name, function, body)
    parts, shared = divided(body, {array for array, _ in function.outputs})
    more = f", lagc_real *{SHARED}" if shared else ""
    text = [_definition(f"{name}_{k}", function, part, more) for k, part in enumerate(parts, 1)]
    arguments = ", ".join([*_order(function), *([SHARED] if shared else [])])
    calls = [f"{name}_{k}({arguments});" for k in range(1, len(parts) + 1)]
    return about + "\n".join([*text, _definition(name, function, _room(shared) + calls)])


def _of_type(text: str, real: Arithmetic) -> str:
    """The function of C's library for this type of real."""
    return text if not text.isalnum() or text.startswith("lagc_") else real.call.format(text)


def _room(shared: int) -> list[str]:
    return [f"lagc_real {SHARED}[{shared}];"] if shared else []


def _definition(name: str, function: Function, body: list[str], more: str = "") -> str:
    code = "\n".join(line for line in body if line[0] != "/")
    words = set(re.findall(r"(?<!->)(?<!\w)[A-Za-z_]\w*", code))
    unused = [
        f"(void)({word});" for word in [*_order(function), *([SHARED] if more else [])] if word not in words
    ]
    lines_ = "".join(f"    {line}\n" for line in [*body, *unused])
    return f"static void {name}({parameters(function)}{more})\n{{\n{lines_}}}\n"


def parameters(function: Function) -> str:
    """The formal parameters of `function`."""
    outputs = {name for name, _ in function.outputs}
    return ", ".join(_formal(name, name in outputs) for name in _order(function))


def _order(function: Function) -> list[str]:
    names: Iterable[str] = (*function.inputs, *(name for name, _ in function.outputs))
    return list(dict.fromkeys(names))


def _formal(name: str, written: bool) -> str:
    if name == "p":
        return "const lagc_params *p"
    if name == "t":
        return "lagc_real t"
    return f"lagc_real *{name}" if written else f"const lagc_real *{name}"
