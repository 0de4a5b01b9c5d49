"""The public functions of the generated C that ask one thing of the model, and their definitions.

Those that integrate are in the support text.  Only what a model has is written: one without
constraints has no function for them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from lagc.base.records import dataclass
from lagc.codegen.c.header import members
from lagc.codegen.kernel_compiler.real_types import DOUBLE, Arithmetic
from lagc.codegen.statements import loads
from lagc.lowering.program import Interface, Program
from lagc.symbolic.evaluate import double

_POINT = "const lagc_params *p, lagc_real t, const lagc_real *x"


@dataclass(frozen=True)
class Verb:
    """A public function: what the header says of it, its head, and the lines of its body."""

    comment: str
    head: str
    body: str

    @property
    def declaration(self) -> str:
        return f"/* {self.comment} */\n{self.head};\n"

    @property
    def definition(self) -> str:
        return f"{self.head}\n{{\n{self.body}}}\n"


def verbs(program: Program, real: Arithmetic = DOUBLE) -> list[Verb]:
    interface, functions = program.interface, program.functions
    found = [_default_params(interface, real)]
    if "start" in functions:
        found.append(Verb(
            "x[NX] as the model gives it: start values" + (
                ", which constraints, initial conditions\n * and orientations may still have to move."
                if interface.needs_consistency else "."),
            "void lagc_start(const lagc_params *p, lagc_real *x)", "    lagc_fn_start(p, x);\n"))  # fmt: skip
    found.append(_rhs(interface))
    if "system" in functions:
        found += _system(interface)
    direct = {**_DIRECT, "conditions": _conditions(interface)}
    found += [verb for name, verb in direct.items() if name in functions]
    if interface.pieces:
        found.append(_SOME)
    if "outputs" in functions:
        found.append(_outputs(program))
    if "power" in functions:
        found.append(
            _of_accelerations(
                program, "power", "e[1] = d(energy)/dt: what the given actions and drives feed in.", "e"
            )
        )
    if interface.nc and "scales" in functions:
        found += _linear()
    if interface.differentiated:
        found.append(_stack(len(interface.switches)))
    for group, pattern in interface.derivatives.items():
        found += _derivatives(group, pattern, len(interface.switches))
    if "along" in interface.functions:
        found.append(_along(interface))
    return found


def _direct(name: str, comment: str, output: str) -> Verb:
    return Verb(
        comment,
        f"void lagc_{name}({_POINT}, lagc_real *{output})",
        f"    lagc_fn_{name}(p, t, x, {output});\n",
    )


_DIRECT = {
    "energies": _direct(
        "energies", "e[3]: kinetic, potential, and the energy whose balance the work is.", "e"
    ),
    "position": _direct("position", "phi[NH], the residuals of the holonomic constraints.", "phi"),
    "velocity": _direct("velocity", "psi[NC], the rates of all constraints.", "psi"),
    "scales": _direct(
        "scales", "s[NC] > 0: the size of each row's terms; residuals are judged against it.", "s"
    ),
    "displace": Verb(
        "dq[NQ] = N(t,q) d for d[NV], an infinitesimal displacement.",
        f"void lagc_displace({_POINT}, const lagc_real *d, lagc_real *dq)",
        "    lagc_fn_displace(p, t, x, d, dq);\n",
    ),
    "limits": Verb(
        "b[NLIMITS], the values made of parameters that have bounds: see `lagc_check`.",
        "void lagc_limits(const lagc_params *p, lagc_real *b)",
        "    lagc_fn_limits(p, b);\n",
    ),
    "measures": Verb(
        "The values of the stated rates, and the largest parameter of each unit of the unknowns.",
        "void lagc_measures(const lagc_params *p, lagc_real *s, lagc_real *largest)",
        "    lagc_fn_measures(p, s, largest);\n",
    ),
}

_AFRESH = "    w->rank_deficient = 0; /* whatever was found before */\n"


def _conditions(interface: Interface) -> Verb:
    count, entries = len(interface.condition_ends), len(interface.condition_columns)
    some = f"_some(p, t, x, c, J, sizes, 0, {max(interface.pieces) + 1})" if interface.pieces else ""
    together = "    lagc_put_together(J);\n" if interface.part_ends else ""
    return Verb(
        f"What a consistent start x[NU] satisfies besides unit quaternions, c[{count}] = 0: phi, psi, the\n"
        f" * initial section, and stated rates less their values; J[{entries}], the derivatives that are\n"
        f" * not identically zero; sizes[{count}] of the terms.",
        f"void lagc_conditions({_POINT}, lagc_real *c, lagc_real *J, lagc_real *sizes)",
        f"    lagc_fn_conditions{some or '(p, t, x, c, J, sizes)'};\n{together}")  # fmt: skip


_SOME = Verb(
    "The same of the pieces first..last-1 alone, of which each depends on unknowns of its own; what\n"
    " * belongs to others stays as it is.",
    f"void lagc_some_conditions({_POINT}, lagc_real *c, lagc_real *J, lagc_real *sizes,\n"
    "                          int first, int last)",
    "    lagc_fn_conditions_some(p, t, x, c, J, sizes, first, last);\n",
)


def _default_params(interface: Interface, real: Arithmetic) -> Verb:
    fields = [*interface.parameters, *interface.inputs]
    text = "    lagc_params p;\n"
    if interface.prepared:
        text += f"    int i;\n    for (i = 0; i < LAGC_NPREPARED; i++)\n        p.prepared[i] = {real.nan};\n"
    for name, field in zip(members(interface), fields):
        there = field.value is not None and not math.isnan(field.value)
        value = real.literal(double(field.value or 0.0)) if there else real.nan
        text += f"    p.{name} = {value};\n"
    if not fields:
        text += "    p.none = 0;\n"
    missing = any(f.value is None for f in fields)
    return Verb(
        "The values of the model." + (" NAN where it gives none: set these." if missing else "")
        + (" They are not bound yet: see lagc_bind." if interface.prepared else ""),
        "lagc_params lagc_default_params(void)", text + "    return p;\n")  # fmt: skip


def _rhs(interface: Interface) -> Verb:
    return Verb(
        "xdot[NX] at (t, x), and the multipliers lambda[NC]; lambda may be NULL.",
        f"lagc_status lagc_rhs({_POINT}, lagc_real *xdot, lagc_real *lambda, lagc_work *w)",
        _afresh(interface)
        + "    return lagc_rhs_at(p, t, x, xdot, lambda ? lambda : w->lam, w);\n")  # fmt: skip


def _afresh(interface: Interface) -> str:
    return _AFRESH if interface.nc else ""


def _system(interface: Interface) -> list[Verb]:
    call = "    lagc_system_at(p, t, x, w);\n"
    found = [
        Verb(
            "The mass matrix M[NV*NV], all of it.",
            f"void lagc_mass_matrix({_POINT}, lagc_real *M, lagc_work *w)",
            "    int i, j;\n" + call
            + "    for (i = 0; i < LAGC_NV; i++)\n        for (j = 0; j <= i; j++) {\n"
            "            M[i * LAGC_NV + j] = w->M[i * (i + 1) / 2 + j];\n"
            "            M[j * LAGC_NV + i] = w->M[i * (i + 1) / 2 + j];\n        }\n"),
        Verb(
            "r[NV] = tau - h: given forces less the velocity terms, M a = r + G^T lambda.",
            f"void lagc_forces({_POINT}, lagc_real *r, lagc_work *w)",
            "    int i;\n" + call + "    for (i = 0; i < LAGC_NV; i++)\n        r[i] = w->force[i];\n"),
    ]  # fmt: skip
    if interface.nc:
        body = "    int i;\n" + call
        if interface.nh:
            body += "    if (phi)\n        lagc_fn_position(p, t, x, phi);\n"
        else:
            body += "    (void)phi;\n"
        body += "    if (psi)\n        lagc_fn_velocity(p, t, x, psi);\n"
        body += "    for (i = 0; G && i < LAGC_NC * LAGC_NV; i++)\n        G[i] = w->G[i];\n"
        body += "    for (i = 0; gamma && i < LAGC_NC; i++)\n        gamma[i] = w->gamma[i];\n"
        found.append(Verb(
            "The constraints: phi[NH], their rates psi[NC], G[NC*NV] by rows and gamma[NC] with\n"
            " * G a = gamma.  Each may be NULL.",
            f"void lagc_constraints({_POINT}, lagc_real *phi, lagc_real *psi, "
            "lagc_real *G, lagc_real *gamma, lagc_work *w)", body))  # fmt: skip
    return found


def _outputs(program: Program) -> Verb:
    return _of_accelerations(program, "outputs", "y[NY], the outputs of the model.", "y")


def _of_accelerations(program: Program, name: str, comment: str, output: str) -> Verb:
    """A function that may need energies, or what the right-hand side gives: accelerations, multipliers."""
    function = program.functions[name]
    given = {"p": "p", "t": "t", "x": "x", "modes": "w->modes", "e": "e", "a": "w->xdot + LAGC_NQ",
             "lam": "w->lam"}  # fmt: skip
    call = f"    lagc_fn_{function.spelled}({', '.join(given[i] for i in function.inputs)}, {output});\n"
    if "e" in function.inputs:
        call = f"    lagc_fn_energies(p, t, x, e);\n{call}"
    head = f"lagc_status lagc_{name}({_POINT}, lagc_real *{output}, lagc_work *w)"
    room = "    lagc_real e[3];\n" if "e" in function.inputs else ""
    if not {"a", "lam", "modes"} & {array for array, _ in loads(function)}:
        unused = "" if "w->" in call else "    (void)w;\n"
        return Verb(comment, head, room + call + unused + "    return LAGC_OK;\n")
    room += "    lagc_status status;\n"
    solved = "    status = lagc_rhs_at(p, t, x, w->xdot, w->lam, w);\n"
    return Verb(comment, head, room + _afresh(program.interface) + solved + call + "    return status;\n")


def _on_own_branch(name: str, last: str, switches: int) -> str:
    """The call of `stack`, or of derivatives: with switches on the branch of the state."""
    if not switches:
        return f"    lagc_fn_{name}(p, t, x, a, lambda, {last});\n"
    return (f"    lagc_real modes[{switches}];\n    lagc_fn_modes(p, t, x, modes);\n"
            f"    lagc_fn_{name}_on(p, t, x, modes, a, lambda, {last});\n")  # fmt: skip


def _derivatives(group: str, pattern: Sequence[tuple[int, int]], switches: int) -> list[Verb]:
    if not pattern:
        return []
    columns = _COLUMNS[group]
    tables = "".join(
        f"    static const int {name}_of[] = {{\n{_numbers(values)}    }};\n"
        for name, values in zip(("row", "column"), zip(*pattern))
    )
    return [
        Verb(
            f"J[{len(pattern)}], the derivatives of this stack by {columns} that are not\n"
            " * identically zero.",
            f"void lagc_by_{group}({_POINT}, const lagc_real *a, const lagc_real *lambda, lagc_real *J)",
            _on_own_branch(f"by_{group}", "J", switches)),
        Verb(
            "Their rows and columns; returns how many there are.",
            f"int lagc_by_{group}_pattern(const int **rows, const int **columns)",
            f"{tables}    *rows = row_of;\n    *columns = column_of;\n    return {len(pattern)};\n"),
    ]  # fmt: skip


def _stack(switches: int) -> Verb:
    return Verb(
        "s[LAGC_D_END], what is differentiated, at any a[NV] and lambda[NC].  From the rows LAGC_D_... on:\n"
        " * QDOT, the rates of q; INERTIA, M a; FORCE, tau - h + G^T lambda; ROW, G a - gamma; CONDITION,\n"
        " * of a consistent start; START, the start values; OUTPUT; INDICATOR, event indicators; REINIT.",
        f"void lagc_stack({_POINT}, const lagc_real *a, const lagc_real *lambda, lagc_real *s)",
        _on_own_branch("stack", "s", switches))  # fmt: skip


def _along(interface: Interface) -> Verb:
    size = max(part.stop for part in interface.groups.values())
    return Verb(
        f"s[LAGC_D_END], what this stack changes by where all that it depends on changes along d[{size}]:\n"
        " * time, q and v, a and lambda, the parameters, then the inputs, in the order of the struct.",
        f"void lagc_along({_POINT}, const lagc_real *a, const lagc_real *lambda, const lagc_real *d,\n"
        "    lagc_real *s)",
        _on_own_branch("along", "d, s", len(interface.switches)))  # fmt: skip


_COLUMNS = {
    "time": "the time",
    "state": "q and v",
    "acceleration": "a and lambda",
    "parameter": "the parameters, then the inputs, in the order of the struct",
}


def _numbers(values: Sequence[int]) -> str:
    rows = [", ".join(map(str, values[k : k + 16])) for k in range(0, len(values), 16)]
    return "        " + ",\n        ".join(rows) + "\n"


def _linear() -> list[Verb]:
    return [
        Verb(
            "Form and factor [M G^T; G 0] at (t, x), for the calls of lagc_solve that follow a success.",
            f"lagc_status lagc_assemble({_POINT}, lagc_work *w)",
            _AFRESH + "    return lagc_assemble_at(p, t, x, w);\n"),
        Verb(
            "s[NV+NC] = (s1, s2) with M s1 - G^T s2 = r1 and G s1 = r2 for r[NV+NC] = (r1, r2).",
            "void lagc_solve(const lagc_real *r, lagc_real *s, lagc_work *w)",
            "    lagc_solve_at(r, s, w);\n"),
    ]  # fmt: skip
