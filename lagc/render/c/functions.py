"""Functions of a Program as C functions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from lagc.optimize.program import Function, Program
from lagc.render.names import comment
from lagc.render.statements import AND, OR, Dialect, lines, loads, uses

CALLS = {
    **{op: op for op in ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh")},
    **{op: op for op in ("exp", "log", "sqrt", "floor", "atan2", "pow")},
    "abs": "fabs", "sign": "lagc_sign", "min": "lagc_min", "max": "lagc_max", "not": "!",
}  # fmt: skip

# Written where a function of the model uses them.  min and max keep the first of equal operands,
# so that they do in C what they do in Python.
HELPERS = {
    "sign": "static double lagc_sign(double a) { return a > 0.0 ? 1.0 : (a < 0.0 ? -1.0 : 0.0); }\n",
    "min": "static double lagc_min(double a, double b) { return b < a ? b : a; }\n",
    "max": "static double lagc_max(double a, double b) { return b > a ? b : a; }\n",
}


def helpers(program: Program) -> str:
    """The definitions of HELPERS that the functions of `program` call."""
    used = {o.op for f in program.functions.values() for o, n in zip(f.operations, uses(f)) if n}
    return "".join(text for op, text in HELPERS.items() if op in used)


def function_text(
    function: Function, locals_: Mapping[tuple[str, int], str], fields: Mapping[int, str]
) -> str:
    """`static void lagc_fn_<name>(inputs..., outputs...)`; an array both read and written stands
    once.  `fields`: the member of the parameters' struct for each index of p."""

    def load(array: str, index: int) -> str:
        if array == "t":
            return "t"
        return f"p->{fields[index]}" if array == "p" else f"{array}[{index}]"

    dialect = Dialect(
        calls=CALLS,
        infix={"and": (" && ", AND), "or": (" || ", OR)},
        select="({} ? {} : {})",
        number="const double {name} = {value};",
        truth="const int {name} = {value};",
        store="{array}[{index}] = {value};",
        comment=lambda text: f"/* {comment(text)} */",
        load=load,
    )
    body = lines(function, dialect, locals_)
    read = {array for array, _ in loads(function)}
    written = {store.array for store in function.stores}
    unused = [name for name in _order(function) if name not in read and name not in written]
    text = []
    if function.description:
        text.append(f"/* {comment(function.description)} */")
    text.append(f"static void lagc_fn_{function.name}({parameters(function)})")
    text.append("{")
    text += [f"    {line}" for line in body]
    text += [f"    (void)({name});" for name in unused]
    text.append("}")
    return "\n".join(text) + "\n"


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
        return "double t"
    return f"double *{name}" if written else f"const double *{name}"
