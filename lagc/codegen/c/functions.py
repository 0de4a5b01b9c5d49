"""Functions of a Program as C functions."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from functools import partial

from lagc.codegen.identifiers import comment
from lagc.codegen.kernel_compiler.c_declarations import ignored
from lagc.codegen.kernel_compiler.real_types import DOUBLE, Arithmetic
from lagc.codegen.loop_segments import in_parts
from lagc.codegen.loops import Forms, Running, loops
from lagc.codegen.statements import AND, OR, Dialect, lines
from lagc.codegen.tables import NONE, Numbers, c_look_up
from lagc.lowering.loop_rolling import moves_itself
from lagc.lowering.program import Function, Run, uses
from lagc.symbolic.operators import spelling

CALLS = spelling("c")
LONGEST = 600  # lines of a function: the compile time of C grows faster than its length
OPERATIONS = 2  # operations and stores per line, about

# Sine and cosine in double precision (`lagc.kernels.arithmetic.trigonometry`).
TURN = "lagc_real sc{number}[2]; lagc_sine_cosine({value}, sc{number});"
TURN_TWO = "lagc_real sc{number}[4]; lagc_sine_cosine_two({value}, {other}, sc{number});"

# Printed if a function of the model calls them.  min and max return the first of equal operands, as Python.
HELPERS = {
    "sign": "static lagc_real lagc_sign(lagc_real a) { return (lagc_real)((a > 0) - (a < 0)); }\n",
    "min": "static lagc_real lagc_min(lagc_real a, lagc_real b) { return (b < a) ? b : a; }\n",
    "max": "static lagc_real lagc_max(lagc_real a, lagc_real b) { return (b > a) ? b : a; }\n",
}


def helpers(functions: Iterable[Function]) -> str:
    """Return the definitions of HELPERS that `functions` call."""
    used = {o.op for f in functions for o, n in zip(f.operations, uses(f)) if n}
    return "".join(text for op, text in HELPERS.items() if op in used)


def function_text(
    function: Function,
    locals_: Mapping[tuple[str, int], str],
    fields: Mapping[int, str],
    real: Arithmetic = DOUBLE,
    numbers: Numbers = NONE,
) -> str:
    """Return `static void lagc_fn_<name>(inputs..., outputs...)`. An array that is both read and written
    is one argument. `fields`: struct member of each index of p; `numbers`: its tables."""

    def load(array: str, index: int) -> str:
        if array == "t":
            return "t"
        return f"p->{fields[index]}" if array == "p" else f"{array}[{index}]"

    def entry(array: str, index: str) -> str:
        return f"((const lagc_real *)p)[{index}]" if array == "p" else f"{array}[{index}]"

    # How operations are spelled; arrays that are sums begin at zero.
    dialect = Dialect(
        calls=CALLS if real == DOUBLE else {op: _of_type(text, real) for op, text in CALLS.items()},
        infix={op: (f" {CALLS[op]} ", binds) for op, binds in (("and", AND), ("or", OR))},
        select="({} ? {} : {})",
        number="const lagc_real {name} = {value};",
        truth="const int {name} = {value};",
        store=lambda array, index, value: f"{array}[{index}] = {value};",
        comment=lambda text: f"/* {comment(text)} */",
        load=load,
        entry=entry,
        look_up=partial(c_look_up, numbers),
        literal=real.literal,
        explicit=True,  # MISRA C 2012, rule 12.1
        turn=TURN if real == DOUBLE else "",
        turn_two=TURN_TWO if real == DOUBLE else "",
        sine="sc{number}[{sine}]",
        cosine="sc{number}[{cosine}]",
    )
    size = dict(function.outputs)
    body = [f"{{ int i; for (i = 0; i < {size[a]}; i++) {{ {a}[i] = 0.0; }} }}" for a in function.cleared]
    # A long function without loops is cut, as C compilers need more than linear time. A sum into its own
    # argument stays whole.
    if not function.runs:
        long = len(function.operations) + len(function.stores) > OPERATIONS * LONGEST
        if not long or moves_itself(function):
            body += lines(function, dialect, locals_)
            return _about(function) + _definition(f"lagc_fn_{function.spelled}", function, body)
        function = in_parts(function)
    return _about(function) + _divided(function, loops(function, dialect, _forms(real), locals_), body)


def _head(run: Run, _: Sequence[Running]) -> str:
    """Return the head of a loop over the repetitions."""
    return f"for (int i = 0; i < {run.count}; i++) {{"


def _forms(real: Arithmetic) -> Forms:
    """Return the forms of C."""

    def table(name: str, values: Sequence[float]) -> list[str]:
        whole = all([isinstance(value, int) for value in values])
        texts = [str(value) if whole else real.literal(value) for value in values]
        entries = textwrap.wrap(", ".join(texts), 88)
        return [f"static const {'int' if whole else 'lagc_real'} {name}[{len(values)}] = {{", *entries, "};"]

    return Forms(
        array="lagc_real kept[{size}];", variable="lagc_real {name} = {value};",
        fixed="const lagc_real {name} = {value};", change="{name} = {value};", table=table,
        head=_head, end="}",
    )  # fmt: skip


def _divided(function: Function, parts: Sequence[list[str]], cleared: list[str]) -> str:
    """Return functions of about LONGEST lines that share the kept values."""
    array, *parts = parts
    blocks = [["{", *(f"    {line}" for line in part), "}"] for part in parts]
    groups: list[list[str]] = [[]]
    for block in blocks:
        if groups[-1] and len(groups[-1]) + len(block) > LONGEST:
            groups.append([])
        groups[-1] += block
    name = f"lagc_fn_{function.spelled}"
    more = {"kept": "lagc_real *kept"} if array else {}
    if len(groups) == 1:
        text = [_definition(name, function, [*array, *cleared, *groups[0]], {})]
    else:
        text = [_definition(f"{name}_{k}", function, group, more) for k, group in enumerate(groups, 1)]
        arguments = ", ".join([*_order(function), *more])
        calls = [f"{name}_{k}({arguments});" for k in range(1, len(groups) + 1)]
        text.append(_definition(name, function, [*array, *cleared, *calls], {}))
    return "\n".join(text)


def _about(function: Function) -> str:
    return f"/* {comment(function.description)} */\n" if function.description else ""


def _of_type(text: str, real: Arithmetic) -> str:
    """Return the function of the C library for this type of real."""
    return text if not text.isalnum() or text.startswith("lagc_") else real.call.format(text)


def _definition(name: str, function: Function, body: list[str], more: Mapping[str, str] | None = None) -> str:
    """Return the definition of a function; `more`: further formal parameters by name."""
    code = re.sub(r"/\*.*?\*/", "", "\n".join(body), flags=re.DOTALL)
    words = set(re.findall(r"(?<!->)(?<!\w)[A-Za-z_]\w*", code))
    unused = ignored([word for word in [*_order(function), *(more or ())] if word not in words])
    lines_ = "".join(f"    {line}\n" for line in [*body, unused] if line)
    formal = ", ".join([parameters(function), *(more or {}).values()])
    return f"static void {name}({formal})\n{{\n{lines_}}}\n"


def parameters(function: Function) -> str:
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
