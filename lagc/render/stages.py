"""The loops over stages of a Runge-Kutta method, as text: C functions and their Python twins.

Coefficients stand in the text and zeros are left out.  Both twins write the same operations in
the same order: h * (a_1 k_1 + a_2 k_2 + ...), from left to right.

`stages` fills k_2 ... k_s from k_1 and gives the new state; `error` is the norm of the step's
error over coordinates and speeds, each over its weight, `parts` (of DOP853) are its rows as vectors;
`dense` prepares the interpolant of the last step, `dense_at` evaluates it (see `Tableau`).
"""

from __future__ import annotations

from lagc.render.tableaus import Row, Tableau

_HEAD = '''\
"""The stages of the integrators, written by `lagc.render.stages` from `lagc.render.tableaus`."""

from __future__ import annotations

from math import sqrt

from lagc.render.numpy.support.base import FAILED, OK
from lagc.render.numpy.support.problem import Problem

# fmt: off
# -- what follows is part of generated modules --
'''


def python_file(tableaus: tuple[Tableau, ...]) -> str:
    """The file `lagc/render/numpy/support/stages.py`."""
    return _HEAD + "".join(f"\n\n{part}" for t in tableaus for part in python_functions(t))


def python_functions(tableau: Tableau) -> list[str]:
    parts = [_python_parts(tableau)] if len(tableau.errors) == 2 else []
    return [_python_stages(tableau), _python_error(tableau), *parts, _python_dense(tableau),
            _python_at(tableau)]  # fmt: skip


def c_functions(tableau: Tableau) -> list[str]:
    return [_c_stages(tableau), _c_error(tableau), _c_dense(tableau), _c_at(tableau)]


def c_parts(tableau: Tableau) -> str:
    """For models with constraints on positions: the rows of the error as vectors, in w->parts."""
    text = (
        f"static void lagc_{tableau.name}_parts(const lagc_state *s, lagc_work *w)\n{{\n    int i;\n"
        "    for (i = 0; i < LAGC_NX; i++) {\n"
    )
    for i, row in enumerate(tableau.errors):
        text += f"        w->parts[{i}][i] = {_sum(row, 's->k[{}][i]', ' ' * 12)};\n"
    return text + "    }\n}\n"


def _sum(row: Row, term: str, indent: str) -> str:
    """The combination `row` of terms, on as many lines as it needs."""
    lines = [""]
    for k, (stage, value) in enumerate(row.items()):
        sign = "" if k == 0 else " - " if value < 0.0 else " + "
        text = f"{sign}{value if k == 0 else abs(value)!r} * {term.format(stage - 1)}"
        if len(indent) + len(lines[-1]) + len(text) > 100:
            lines.append(indent)
            text = text.lstrip()
        lines[-1] += text
    return "\n".join(lines)


def _time(c: float, base: str) -> str:
    return f"{base} + h" if c == 1.0 else f"{base} + {c!r} * h"


# -- Python --


def _zipped(row: Row, more: str = "") -> tuple[str, str]:
    names = [f"a{i - 1}" for i in row]
    lists = ", ".join(f"k[{i - 1}]" for i in row)
    if len(names) > 7:
        half = lists.index(f"k[{sorted(row)[len(names) // 2] - 1}]")
        lists = lists[:half].rstrip() + "\n" + " " * 12 + lists[half:]
    return more + ", ".join(names), lists


def _python_combination(target: str, row: Row, indent: str) -> str:
    names, lists = _zipped(row, "v, ")
    total = _sum(row, "a{}", indent + "        ")
    return (f"{indent}{target} = [\n{indent}    v + h * ({total})\n"
            f"{indent}    for {names} in zip(x, {lists})\n{indent}]\n")  # fmt: skip


def _python_evaluation(c: float, stage: int, result: str) -> str:
    return (f"    status = rhs({_time(c, 't')}, y, k[{stage - 1}], lam)\n"
            f"    if status in FAILED:\n        return {result}\n")  # fmt: skip


def _python_stages(tableau: Tableau) -> str:
    text = (
        f"def {tableau.name}_stages(\n    problem: Problem, t: float, x: list[float], h: float,"
        " k: list[list[float]], lam: list[float]\n) -> tuple[int, list[float]]:\n    rhs = problem.rhs\n"
    )
    for stage, (c, row) in enumerate(zip(tableau.c, tableau.a), start=1):
        if row:
            text += _python_combination("y", row, "    ") + _python_evaluation(c, stage, "status, y")
    return text + _python_combination("y", tableau.b, "    ") + "    return OK, y\n"


def _python_error(tableau: Tableau) -> str:
    every = sorted({stage for row in tableau.errors for stage in row})
    names, lists = _zipped(dict.fromkeys(every, 0.0), "weight, ")
    text = f"def {tableau.name}_error(h: float, weights: list[float], k: list[list[float]]) -> float:\n"
    text += "".join(f"    sum{i} = 0.0\n" for i in range(len(tableau.errors)))
    text += f"    for {names} in zip(weights, {lists}):\n"
    for i, row in enumerate(tableau.errors):
        text += f"        e = ({_sum(row, 'a{}', ' ' * 12)}) / weight\n        sum{i} += e * e\n"
    return text + f"    n = len(weights)\n    h = abs(h)\n{_error_result(tableau, '')}"


def _python_parts(tableau: Tableau) -> str:
    text = f"def {tableau.name}_parts(k: list[list[float]]) -> list[list[float]]:\n    return [\n"
    for row in tableau.errors:
        names, lists = _zipped(row)
        text += f"        [\n            {_sum(row, 'a{}', ' ' * 16)}\n"
        text += f"            for {names} in zip({lists})\n        ],\n"
    return text + "    ]\n"


def _error_result(tableau: Tableau, end: str) -> str:
    if len(tableau.errors) == 1:
        return f"    return h * sqrt(sum0 / n){end}\n"
    return (f"    total = sum0 + 0.01 * sum1{end}\n"
            + ("    if total == 0.0:\n        return 0.0\n" if not end else
               "    if (total == 0.0)\n        return 0.0;\n")
            + f"    return h * sum0 * sqrt(1.0 / (n * total)){end}\n")  # fmt: skip


def _python_dense(tableau: Tableau) -> str:
    text = (
        f"def {tableau.name}_dense(\n    problem: Problem, t: float, x: list[float], z: list[float],"
        " h: float,\n    k: list[list[float]], lam: list[float],\n) -> tuple[int, list[list[float]]]:\n"
    )
    if tableau.extra_c:
        text += "    rhs = problem.rhs\n"
    for stage, (c, row) in enumerate(zip(tableau.extra_c, tableau.extra_a), start=tableau.stages + 2):
        text += _python_combination("y", row, "    ") + _python_evaluation(c, stage, "status, []")
    last = tableau.stages
    text += f"""\
    r1 = [b - a for a, b in zip(x, z)]
    r2 = [h * a - b for a, b in zip(k[0], r1)]
    r3 = [a - h * b - c for a, b, c in zip(r1, k[{last}], r2)]
"""
    names = []
    for i, row in enumerate(tableau.dense):
        zipped, lists = _zipped(row)
        names.append(f"r{i + 4}")
        text += (f"    r{i + 4} = [\n        h * ({_sum(row, 'a{}', ' ' * 12)})\n"
                 f"        for {zipped} in zip({lists})\n    ]\n")  # fmt: skip
    return text + f"    return OK, [x, r1, r2, r3, {', '.join(names)}]\n"


def _nested(tableau: Tableau, term: str, share: str = "s") -> str:
    count = 4 + len(tableau.dense)
    text = term.format(count - 1)
    for i in range(count - 2, -1, -1):
        factor = text if i == count - 2 else f"({text})"
        text = f"{term.format(i)} + {share if i % 2 == 0 else 'u'} * {factor}"
    return text


def _python_at(tableau: Tableau) -> str:
    names = ", ".join(f"r{i}" for i in range(4 + len(tableau.dense)))
    return (
        f"def {tableau.name}_at(s: float, r: list[list[float]]) -> list[float]:\n    u = 1.0 - s\n"
        f"    return [\n        {_nested(tableau, 'r{}')}\n        for {names} in zip(*r)\n    ]\n"
    )


# -- C --


def _c_combination(row: Row, base: str = "x") -> str:
    total = _sum(row, "s->k[{}][i]", " " * 12)
    return f"    for (i = 0; i < LAGC_NX; i++)\n        s->y[i] = {base}[i] + h * ({total});\n"


def _c_evaluation(c: float, stage: int) -> str:
    return (
        f"    status = lagc_rhs_(p, {_time(c, 't')}, s->y, s->k[{stage - 1}], w->lam, w);\n"
        "    if (LAGC_FAILED(status))\n        return status;\n"
    )


def _c_stages(tableau: Tableau) -> str:
    text = (
        f"static int lagc_{tableau.name}_stages(const lagc_params *p, double t, const double *x,\n"
        "                              double h, lagc_state *s, lagc_work *w)\n{\n"
        "    double own[LAGC_NX]; /* of x: apart from s, so that loops run over several entries at once */\n"
        "    int i, status;\n    for (i = 0; i < LAGC_NX; i++)\n        own[i] = x[i];\n"
    )
    for stage, (c, row) in enumerate(zip(tableau.c, tableau.a), start=1):
        if row:
            text += _c_combination(row, "own") + _c_evaluation(c, stage)
    return text + _c_combination(tableau.b, "own") + "    return LAGC_OK;\n}\n"


def _c_error(tableau: Tableau) -> str:
    text = (
        f"static double lagc_{tableau.name}_error(double h, const lagc_state *s, const lagc_work *w)\n{{\n"
        "    const int n = LAGC_NQ + LAGC_NV;\n    int i;\n    double e"
    )
    text += "".join(f", sum{i} = 0.0" for i in range(len(tableau.errors)))
    text += ", total;\n" if len(tableau.errors) > 1 else ";\n"
    text += "    for (i = 0; i < n; i++) {\n"
    for i, row in enumerate(tableau.errors):
        text += f"        e = ({_sum(row, 's->k[{}][i]', ' ' * 12)}) / w->weights[i];\n"
        text += f"        sum{i} += e * e;\n"
    return text + "    }\n    h = fabs(h);\n" + _error_result(tableau, ";") + "}\n"


def _c_dense(tableau: Tableau) -> str:
    text = (
        f"static int lagc_{tableau.name}_dense(const lagc_params *p, double t, const double *x,\n"
        "                             const double *z, double h, lagc_state *s, lagc_work *w)\n"
        "{\n    int i;\n"
    )
    if tableau.extra_c:
        text += "    int status;\n"
    for stage, (c, row) in enumerate(zip(tableau.extra_c, tableau.extra_a), start=tableau.stages + 2):
        text += _c_combination(row) + _c_evaluation(c, stage)
    if not tableau.extra_c:
        text += "    (void)p;\n    (void)t;\n    (void)w;\n"
    last = tableau.stages
    text += f"""\
    for (i = 0; i < LAGC_NX; i++) {{
        s->r[0][i] = x[i];
        s->r[1][i] = z[i] - x[i];
        s->r[2][i] = h * s->k[0][i] - s->r[1][i];
        s->r[3][i] = s->r[1][i] - h * s->k[{last}][i] - s->r[2][i];
"""
    for i, row in enumerate(tableau.dense):
        text += f"        s->r[{i + 4}][i] = h * ({_sum(row, 's->k[{}][i]', ' ' * 12)});\n"
    return text + "    }\n    return LAGC_OK;\n}\n"


def _c_at(tableau: Tableau) -> str:
    return (
        f"static void lagc_{tableau.name}_at(double v, const lagc_state *s, double *x)\n{{\n"
        "    const double u = 1.0 - v;\n    int i;\n    for (i = 0; i < LAGC_NX; i++)\n"
        f"        x[i] = {_nested(tableau, 's->r[{}][i]', 'v')};\n}}\n"
    )


if __name__ == "__main__":  # python -m lagc.render.stages > lagc/render/numpy/support/stages.py
    from lagc.render.tableaus import TABLEAUS

    print(python_file(TABLEAUS), end="")
