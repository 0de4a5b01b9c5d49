"""Public functions of generated C that evaluate one function of the model.

The functions that integrate are kernels.  Those that do not apply to a model are in `any_model`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from lagc.base.records import dataclass
from lagc.codegen.c.header import members
from lagc.codegen.heading import rates
from lagc.codegen.kernel_compiler.real_types import DOUBLE, Arithmetic
from lagc.codegen.statements import loads
from lagc.lowering.program import Interface, Program
from lagc.symbolic.walk import double

POINT = "const lagc_params *p, lagc_real t, const lagc_real *x"


@dataclass(frozen=True)
class PublicFunction:
    """A public function: its comment in the header, its head, and the lines of its body."""

    comment: str
    head: str
    body: str

    @property
    def name(self) -> str:
        return self.head.partition("(")[0].rpartition("lagc_")[2]

    @property
    def declaration(self) -> str:
        return f"/* {self.comment} */\n{self.head};\n"

    @property
    def definition(self) -> str:
        return f"{self.head}\n{{\n{self.body}}}\n"


def public_functions(program: Program, real: Arithmetic = DOUBLE) -> list[PublicFunction]:
    interface, functions = program.interface, program.functions
    found = [_default_params(interface, real)]
    if "start" in functions:
        found.append(PublicFunction(
            "Set x[NX] to the start values of the model." + (
                "  They need not meet the constraints and\n * initial equations: see lagc_consistent."
                if interface.needs_consistency else ""),
            "void lagc_start(const lagc_params *p, lagc_real *x)", "    lagc_fn_start(p, x);\n"))  # fmt: skip
    found.append(_rhs(interface))
    if "system" in functions:
        found += _system(interface)
    direct = {**_DIRECT, "conditions": _conditions(interface)}
    found += [function for name, function in direct.items() if name in functions]
    if "outputs" in functions:
        found.append(_outputs(program))
    if "power" in functions:
        found.append(
            _of_accelerations(
                program, "power", "e[1] = d(energy)/dt: power of the given loads and drives.", "e"
            )
        )
    if interface.nc and "scales" in functions:
        found += _linear()
    if interface.differentiated:
        found.append(_stack(len(interface.relations)))
    for group, pattern in interface.derivatives.items():
        found += _derivatives(group, pattern, len(interface.relations))
    if "along" in interface.functions:
        found.append(_along(interface))
    return found


def _direct(name: str, comment: str, output: str) -> PublicFunction:
    return PublicFunction(
        comment,
        f"void lagc_{name}({POINT}, lagc_real *{output})",
        f"    lagc_fn_{name}(p, t, x, {output});\n",
    )


_DIRECT = {
    "energies": _direct(
        "energies", "e[3]: kinetic energy, potential energy, and the energy whose change is the work.", "e"
    ),
    "position": _direct("position", "phi[NH]: residuals of the holonomic constraints.", "phi"),
    "velocity": _direct(
        "velocity",
        "psi[NC]: residuals of all constraints at velocity level; the first NH are d(phi)/dt.",
        "psi",
    ),
    "scales": _direct(
        "scales", "s[NC] > 0: scale of each constraint equation; residuals are compared with it.", "s"
    ),
    "displace": PublicFunction(
        "dq[NQ] = N(t,q) d, for an infinitesimal displacement d[NV].",
        f"void lagc_displace({POINT}, const lagc_real *d, lagc_real *dq)",
        "    lagc_fn_displace(p, t, x, d, dq);\n",
    ),
    "gaps": _direct("gaps", "g[NCON]: gaps of the contacts.", "g"),
    "limits": PublicFunction(
        "b[NLIMITS]: bounded values computed from parameters; see lagc_check.",
        "void lagc_limits(const lagc_params *p, lagc_real *b)",
        "    lagc_fn_limits(p, b);\n",
    ),
    "measures": PublicFunction(
        "s: values of the stated rates; largest: the largest parameter of each unit of an unknown.",
        "void lagc_measures(const lagc_params *p, lagc_real *s, lagc_real *largest)",
        "    lagc_fn_measures(p, s, largest);\n",
    ),
}

_HOLD = "    int i;\n    for (i = LAGC_NINT; i < LAGC_NX; i++) {\n        xdot[i] = 0;\n    }\n"
_FORGET = "    w->rank_deficient = 0; /* forget earlier evaluations */\n"


def _conditions(interface: Interface) -> PublicFunction:
    count, entries = len(interface.condition_ends), len(interface.condition_columns)
    together = "    lagc_assemble_slopes(J);\n" if interface.part_ends else ""
    return PublicFunction(
        f"c[{count}]: residuals of the initial equations at x[NU]: phi, psi, the initial section, stated\n"
        f" * rates minus their values, but not unit quaternions.  J[{entries}]: derivatives that are not\n"
        f" * identically zero.  sizes[{count}]: sums of the magnitudes of the terms.",
        f"void lagc_conditions({POINT}, lagc_real *c, lagc_real *J, lagc_real *sizes)",
        f"    lagc_fn_conditions(p, t, x, c, J, sizes);\n{together}")  # fmt: skip


def _default_params(interface: Interface, real: Arithmetic) -> PublicFunction:
    fields = [*interface.parameters, *interface.inputs]
    text = "    lagc_params p;\n"
    if interface.prepared:
        text += "    int i;\n    for (i = 0; i < LAGC_NPREPARED; i++) {\n"
        text += f"        p.prepared[i] = {real.nan};\n    }}\n"
    for name, field in zip(members(interface), fields):
        there = field.value is not None and not math.isnan(field.value)
        value = real.literal(double(field.value or 0.0)) if there else real.nan
        text += f"    p.{name} = {value};\n"
    if not fields:
        text += "    p.none = 0;\n"
    missing = any(f.value is None for f in fields)
    return PublicFunction(
        "Return the parameter values of the model."
        + ("  Set those that are NAN: they have none." if missing else "")
        + ("  Call lagc_bind before they are used." if interface.prepared else ""),
        "lagc_params lagc_default_params(void)", text + "    return p;\n")  # fmt: skip


def _rhs(interface: Interface) -> PublicFunction:
    return PublicFunction(
        "xdot[NX] and the multipliers lambda[NC] at (t, x).  lambda may be NULL."
        + ("  Rates of discrete variables\n * are 0." if interface.discretes else ""),
        f"lagc_status lagc_rhs({POINT}, lagc_real *xdot, lagc_real *lambda, lagc_work *w)",
        (_HOLD if interface.discretes else "") + _forget(interface)
        + f"    return lagc_{rates(interface)}(p, t, x, xdot, "
        "(lambda != NULL) ? lambda : w->lam, w);\n")  # fmt: skip


def _forget(interface: Interface) -> str:
    return _FORGET if interface.nc else ""


def _system(interface: Interface) -> list[PublicFunction]:
    call = "    lagc_system_at(p, t, x, w);\n"
    found = [
        PublicFunction(
            "M[NV*NV]: the full mass matrix.",
            f"void lagc_mass_matrix({POINT}, lagc_real *M, lagc_work *w)",
            "    int i, j;\n" + call
            + "    for (i = 0; i < LAGC_NV; i++) {\n        for (j = 0; j <= i; j++) {\n"
            "            M[(i * LAGC_NV) + j] = w->M[(i * (i + 1) / 2) + j];\n"
            "            M[(j * LAGC_NV) + i] = w->M[(i * (i + 1) / 2) + j];\n        }\n    }\n"),
        PublicFunction(
            "r[NV] = tau - h: applied forces minus velocity terms, M a = r + G^T lambda.",
            f"void lagc_forces({POINT}, lagc_real *r, lagc_work *w)",
            "    int i;\n" + call + _each("i < LAGC_NV", "r[i] = w->force[i]")),
    ]  # fmt: skip
    if interface.nc:
        body = "    int i;\n" + call
        if interface.nh:
            body += "    if (phi != NULL) {\n        lagc_fn_position(p, t, x, phi);\n    }\n"
        else:
            body += "    (void)phi;\n"
        body += "    if (psi != NULL) {\n        lagc_fn_velocity(p, t, x, psi);\n    }\n"
        body += _each("(G != NULL) && (i < (LAGC_NC * LAGC_NV))", "G[i] = w->G[i]")
        body += _each("(gamma != NULL) && (i < LAGC_NC)", "gamma[i] = w->gamma[i]")
        found.append(PublicFunction(
            "Constraints: phi[NH], psi[NC], G[NC*NV] by rows, and gamma[NC] with G a = gamma.  Each output\n"
            " * may be NULL.",
            f"void lagc_constraints({POINT}, lagc_real *phi, lagc_real *psi, "
            "lagc_real *G, lagc_real *gamma, lagc_work *w)", body))  # fmt: skip
    return found


def _each(test: str, statement: str) -> str:
    """Return a loop over i."""
    return f"    for (i = 0; {test}; i++) {{\n        {statement};\n    }}\n"


def _outputs(program: Program) -> PublicFunction:
    return _of_accelerations(program, "outputs", "y[NY]: the outputs of the model.", "y")


def _of_accelerations(program: Program, name: str, comment: str, output: str) -> PublicFunction:
    """A function that may need energies, accelerations or multipliers."""
    function = program.functions[name]
    given = {"p": "p", "t": "t", "x": "x", "modes": "w->modes", "e": "e", "a": "w->xdot + LAGC_NQ",
             "lam": "w->lam", "contact_forces": "w->contacts.forces"}  # fmt: skip
    call = f"    lagc_fn_{function.spelled}({', '.join(given[i] for i in function.inputs)}, {output});\n"
    if "e" in function.inputs:
        call = f"    lagc_fn_energies(p, t, x, e);\n{call}"
    head = f"lagc_status lagc_{name}({POINT}, lagc_real *{output}, lagc_work *w)"
    room = "    lagc_real e[3];\n" if "e" in function.inputs else ""
    if not {"a", "lam", "modes", "contact_forces"} & {array for array, _ in loads(function)}:
        unused = "" if "w->" in call else "    (void)w;\n"
        return PublicFunction(comment, head, room + call + unused + "    return LAGC_OK;\n")
    room += "    lagc_status status;\n"
    solved = f"    status = lagc_{rates(program.interface)}(p, t, x, w->xdot, w->lam, w);\n"
    return PublicFunction(
        comment, head, room + _forget(program.interface) + solved + call + "    return status;\n"
    )


def _in_own_modes(name: str, last: str, relations: int) -> str:
    """The call of `stack` or of derivatives, in the modes of the state."""
    if not relations:
        return f"    lagc_fn_{name}(p, t, x, a, lambda, {last});\n"
    return (f"    lagc_real modes[{relations}];\n    lagc_fn_modes(p, t, x, modes);\n"
            f"    lagc_fn_{name}_on(p, t, x, modes, a, lambda, {last});\n")  # fmt: skip


def _derivatives(group: str, pattern: Sequence[tuple[int, int]], relations: int) -> list[PublicFunction]:
    if not pattern:
        return []
    columns = _COLUMNS[group]
    tables = "".join(
        f"    static const int {name}_of[] = {{\n{_numbers(values)}    }};\n"
        for name, values in zip(("row", "column"), zip(*pattern))
    )
    return [
        PublicFunction(
            f"J[{len(pattern)}]: derivatives of lagc_stack by {columns}, those that are not\n"
            " * identically zero.",
            f"void lagc_by_{group}({POINT}, const lagc_real *a, const lagc_real *lambda, lagc_real *J)",
            _in_own_modes(f"by_{group}", "J", relations)),
        PublicFunction(
            "Set rows and columns to the places of these derivatives; return their number.",
            f"int lagc_by_{group}_pattern(const int **rows, const int **columns)",
            f"{tables}    *rows = row_of;\n    *columns = column_of;\n    return {len(pattern)};\n"),
    ]  # fmt: skip


def _stack(relations: int) -> PublicFunction:
    return PublicFunction(
        "s[LAGC_D_END]: the differentiated functions at any a[NV] and lambda[NC].  From row LAGC_D_...:\n"
        " * QDOT: rates of q; INERTIA: M a; FORCE: tau - h + G^T lambda; ROW: G a - gamma; CONDITION:\n"
        " * initial equations; START: start values; OUTPUT: outputs; INDICATOR: event indicators; REINIT:\n"
        " * new values of states.",
        f"void lagc_stack({POINT}, const lagc_real *a, const lagc_real *lambda, lagc_real *s)",
        _in_own_modes("stack", "s", relations))  # fmt: skip


def _along(interface: Interface) -> PublicFunction:
    size = max(part.stop for part in interface.groups.values())
    return PublicFunction(
        f"s[LAGC_D_END]: derivative of lagc_stack in the direction d[{size}] of time, q and v, a and\n"
        " * lambda, the parameters, then the inputs, in the order of the struct.",
        f"void lagc_along({POINT}, const lagc_real *a, const lagc_real *lambda, const lagc_real *d,\n"
        "    lagc_real *s)",
        _in_own_modes("along", "d, s", len(interface.relations)))  # fmt: skip


_COLUMNS = {
    "time": "the time",
    "state": "q and v",
    "acceleration": "a and lambda",
    "parameter": "the parameters, then the inputs, in the order of the struct",
}


def _numbers(values: Sequence[int]) -> str:
    rows = [", ".join(map(str, values[k : k + 16])) for k in range(0, len(values), 16)]
    return "        " + ",\n        ".join(rows) + "\n"


def _linear() -> list[PublicFunction]:
    return [
        PublicFunction(
            "Assemble and factor [M G^T; G 0] at (t, x) for calls of lagc_solve.",
            f"lagc_status lagc_assemble({POINT}, lagc_work *w)",
            _FORGET + "    return lagc_assemble_at(p, t, x, w);\n"),
        PublicFunction(
            "Solve M s1 - G^T s2 = r1, G s1 = r2 for s[NV+NC] = (s1, s2), with r[NV+NC] = (r1, r2).",
            "void lagc_solve(const lagc_real *r, lagc_real *s, lagc_work *w)",
            "    lagc_solve_at(r, s, w);\n"),
    ]  # fmt: skip
