"""Public functions of generated Python modules, as text."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from lagc.codegen.heading import status_texts
from lagc.codegen.kernel_compiler.library import library
from lagc.lowering.program import Interface, Program, tables

_ALWAYS = '''\
STATUSES = @STATUSES@


def default_params(**values):
    """Return the list p of parameters and inputs: the values of the model, or those given by keyword.

    Raises KeyError for a name that is not in PARAMETERS, ValueError if a value is missing."""
    for name in values:
        if name not in PARAMETERS:
            raise KeyError(f"{name!r} is not a parameter: {', '.join(PARAMETERS)}")
    p = [float(values.get(name, row[0])) for name, row in PARAMETERS.items()]
    for name, value in zip(PARAMETERS, p):
        if value != value:
            raise ValueError(f"the parameter {name!r} needs a value")
    return p


def rhs(t, x, p=None):
    """Return xdot[NX].  Raises ArithmeticError if the equations have no solution at (t, x)."""
    return _solved(t, x, p)[1]


def accelerations(t, x, p=None):
    """Return accelerations a[NV] and multipliers lam[NC]; errors as `rhs`."""
    _, xdot, lam = _solved(t, x, p)
    return xdot[NQ : NQ + NV], lam


def integrate(t0, x0, times, p=None, options=None, progress=None):
    """Integrate from (t0, x0) to times[-1]; return a Trajectory with the states at `times`."""
    return _integrate(equations(p), options or Options(), float(t0), _state(x0), _floats(times), progress)


def equations(p=None):
    """Return Equations with parameters p (see `default_params`), for many calls."""
    return Equations(default_params() if p is None else _floats(p))


def _solved(t, x, p):
    model = equations(p)
    xdot, lam = [0.0] * NX, [0.0] * NC
    status = model.rhs(float(t), _state(x), xdot, lam)
    if status in FAILED:
        raise ArithmeticError(f"{STATUSES[status]} Index: {model.culprit}.")
    return model, xdot, lam


def _floats(values):
    return [float(v) for v in values]


def _state(x):
    if len(x) != NX:
        raise ValueError(f"x has {len(x)} entries, not {NX}")
    return _floats(x)
'''

_CHECK = '''\
def check(p=None, options=None):
    """Raise ValueError, with the name, if a parameter or input is not finite or outside of its BOUNDS, or an
    option is not valid."""
    if options is not None:
        options.check()
    if p is not None:
        equations(p).check()
'''

_START = '''\
def start(p=None):
    """Return x[NX] with the start values of the model.  They need not meet the constraints and initial
    equations: see `consistent`."""
    x = [0.0] * NX
    fn_start(equations(p).p, x)
    return x
'''

_CONSISTENT = '''\
def consistent(x=None, t=0.0, p=None, levels=None):
    """Return a consistent initial state x[NX] near the guess x (None: `start`).

    It meets the constraints, their rates, the initial section and unit quaternions.  `levels` (UNSTATED,
    DECLARED, SCENE, RUN, FIXED) of q, v and the stated rates say how firmly each value is stated (None: as in
    the model); values of a lower level move first, and as few stated values as possible.  Raises
    ArithmeticError if no consistent state is found, ValueError for a t, level or parameter that is not
    valid."""
    model = equations(p)
    model.check()
    if not abs(t) < inf:
        raise ValueError(f"the time {t!r} is not finite")
    if levels is not None and not (len(levels) == NU and set(levels) <= set(range(FIXED + 1))):
        raise ValueError(f"levels are {NU} numbers from {UNSTATED} to {FIXED}: not {levels!r}")
    guess = start(p) if x is None else _state(x)
    work = StartWork()
    status = prepare(model.p, float(t), guess, levels, work)
    if status == OK:
        status = reach_start(model.p, float(t), work)
    if status in FAILED:
        raise ArithmeticError(f"{STATUSES[status]} Index: {work.culprit}.")
    return [*work.y[: NQ + NV], *guess[NQ + NV :]]
'''

_SYSTEM = '''\
def mass_matrix(t, x, p=None):
    """Return the mass matrix M, NV rows of NV."""
    packed = equations(p).system(float(t), _state(x))[1]
    rows = [packed[i * (i + 1) // 2 :][: i + 1] for i in range(NV)]
    return [[rows[max(i, j)][min(i, j)] for j in range(NV)] for i in range(NV)]


def forces(t, x, p=None):
    """Return r[NV] = tau - h: applied forces minus velocity terms, M a = r + G^T lam."""
    return equations(p).system(float(t), _state(x))[2]
'''

_CONSTRAINTS = '''\
def constraints(t, x, p=None):
    """Return phi[NH], psi[NC] (all constraints at velocity level), G (NC rows of NV) and gamma[NC] with
    G a = gamma."""
    model, t, x = equations(p), float(t), _state(x)
    _, _, _, g, gamma = model.system(t, x)
    rows = [g[i * NV : (i + 1) * NV] for i in range(NC)]
    phi, psi = [0.0] * NH, [0.0] * NC
    if NH:
        fn_position(model.p, t, x, phi)
    fn_velocity(model.p, t, x, psi)
    return phi, psi, rows, gamma
'''

_ENERGIES = '''\
def energies(t, x, p=None):
    """Return kinetic energy, potential energy, and the energy whose change is the work."""
    e = [0.0] * 3
    fn_energies(equations(p).p, float(t), _state(x), e)
    return e
'''

_OUTPUTS = '''\
def outputs(t, x, p=None):
    """Return the outputs y[NY], in the order of Y_NAMES."""
    model, xdot, lam = _solved(t, x, p)
    y = [0.0] * NY
@ENERGIES@    fn_outputs(model.p, float(t), _state(x), @E@xdot[NQ : NQ + NV], lam, @C@y)
    return y
'''

_ENERGIES_FIRST = """\
    e = [0.0] * 3
    fn_energies(model.p, float(t), _state(x), e)
"""

_DERIVATIVES = '''

def stack(t, x, a, lam, p=None):
    """Return the differentiated functions at any a and lam, with the rows of STACK: qdot, M a,
    tau - h + G^T lam, G a - gamma, initial equations, start values, outputs, event indicators, values of
    `reinit`."""
    found = [0.0] * max(rows.stop for rows in STACK.values())
    _at_state(fn_stack@ON@, equations(p).p, float(t), _state(x), _floats(a), _floats(lam), found)
    return found


def _at_state(function, p, t, x, a, lam, *last):
    @CALL@
'''

_BY_GROUPS = '''

def derivatives(group, t, x, a, lam, p=None):
    """Return the derivatives of `stack` by a group: "time", "state" (q, v), "acceleration" (a, lam) or
    "parameter" (parameters, then inputs).  PATTERNS has their rows and columns."""
    found = [0.0] * len(PATTERNS[group])
    if found:
        function = {@FUNCTIONS@}[group]
        _at_state(function, equations(p).p, float(t), _state(x), _floats(a), _floats(lam), found)
    return found
'''

_ALONG = '''

def along(t, x, a, lam, d, p=None):
    """Return the derivative of `stack` in the direction d = (dt, dx, da, dlam, dp), with parameters, then
    inputs, in p.  The entries of d may be arrays, for many directions at once."""
    found = [0.0] * max(rows.stop for rows in STACK.values())
    _at_state(fn_along@ON@, equations(p).p, float(t), _state(x), _floats(a), _floats(lam), d, found)
    return found
'''

_AT_STATE = "function(p, t, x, a, lam, *last)"
_ON_BRANCH = """\
\"\"\"Call `function` in the modes of the state.\"\"\"
    modes = [0.0] * NMODE
    fn_modes(p, t, x, modes)
    function(p, t, x, modes, a, lam, *last)"""

_MANY = '''\
def rhs_many(t, x, p=None):
    """Return xdot of many states, an array of shape (n_states, NX).

    x has the same shape; t is a number or an array of n_states; p is as for `rhs`, or an array
    (n_states, number of parameters).  Needs NumPy, whose functions may differ from those of the C library in
    the last bit.  States whose linear solve is inaccurate are computed one by one; a state without a solution
    gives NaN.
    """
    import numpy

    x = numpy.asarray(x, dtype=float)
    p = numpy.asarray(default_params() if p is None else p, dtype=float)
    t = numpy.broadcast_to(numpy.asarray(t, dtype=float), len(x))
    p = numpy.broadcast_to(p, (len(x), len(PARAMETERS)))
    xdot = numpy.empty_like(x)
    rest = range(len(x))
    if STRAIGHT:
        columns, health = [0.0] * NX, [1.0] + [0.0] * @HEALTH@
        with numpy.errstate(all="ignore"):
            given = list(p.T)
            if NALL > NP:
                prepared = [0.0] * (NALL - NP)
                _vectorised(fn_bind)(given, prepared)
                given += prepared
            @RHS@columns, [0.0] * NC, health)
@WATCH@            for k, value in enumerate(columns):
                xdot[:, k] = value
            sound = health[0] >= (LEAST_PIVOT if NC else SINGULAR)
            if NC:
                sound = sound & (health[1] <= REFINED_RESIDUAL * NMANY * NMANY)
            sound = sound & numpy.isfinite(xdot).all(axis=1)
@OPEN@        rest = numpy.flatnonzero(~sound)
    for i in rest:
        row = [0.0] * NX
        failed = equations(p[i]).rhs(float(t[i]), x[i].tolist(), row, [0.0] * NC) in FAILED
        xdot[i] = numpy.nan if failed else row
    return xdot


def _vectorised(function):
    """Return `function` for arrays instead of numbers."""
    import numpy

    names = {
        "tan": "tan", "asin": "arcsin", "acos": "arccos", "atan": "arctan",
        "sinh": "sinh", "cosh": "cosh", "tanh": "tanh", "exp": "exp", "log": "log", "sqrt": "sqrt",
        "floor": "floor", "sign": "sign", "atan2": "arctan2", "pow": "power", "fabs": "fabs",
        "select": "where", "both": "logical_and", "either": "logical_or", "inverse": "logical_not",
    }
    arrays = {ours: getattr(numpy, theirs) for ours, theirs in names.items()}
    arrays["sine_cosine"] = lambda a: (numpy.sin(a), numpy.cos(a))
    arrays["minimum"] = lambda a, b: numpy.where(b < a, b, a)
    arrays["maximum"] = lambda a, b: numpy.where(b > a, b, a)
    return type(function)(function.__code__, arrays)
'''

_LOOKED_UP = """\
    arrays["TABLES"] = TABLES
    arrays["piece"] = lambda table, a: numpy.maximum(numpy.searchsorted(table, a, "right") - 1, 0)
    arrays["entry"] = lambda table, place: numpy.asarray(table)[numpy.asarray(place, dtype=int)]
"""


_WATCH = """\
            if not numpy.all(health[0] >= TRUSTED_PIVOT):
                _vectorised(fn_watch)(given, health)
"""
_OPEN = "            sound = sound & (x[:, NX - NCON :] == 0.0).all(axis=1)\n"
_PLAIN = "_vectorised(fn_rhs)(given, t, list(x.T), "
_ON_BRANCHES = """\
modes = [0.0] * NMODE
            _vectorised(fn_modes)(given, t, list(x.T), modes)
            _vectorised(fn_rhs_on)(given, t, list(x.T), modes, """


def public_functions(program: Program, complete: bool) -> list[str]:
    """Return the functions that apply to the model; `complete` adds those that no run of lagc calls."""
    found = [_ALWAYS.replace("@STATUSES@", _statuses(program.interface))]
    for name, text in (
        ("start", _START),
        ("system", _SYSTEM),
        ("energies", _ENERGIES),
        ("outputs", _outputs(program)),
    ):
        if name in program.functions:
            found.append(text)
    if complete:
        found.append(_CHECK)
    if complete and program.interface.needs_consistency:
        found.append(_CONSISTENT)
    if program.interface.nc and "system" in program.functions:
        found.append(_CONSTRAINTS)
    if program.interface.differentiated:
        found.append(_stacked(program.interface))
    rhs = _ON_BRANCHES if program.interface.relations else _PLAIN
    watch = _WATCH if "watch" in program.functions else ""
    many = _MANY.replace("@RHS@", rhs).replace("@WATCH@", watch)
    many = many.replace("@HEALTH@", str(max(program.interface.health, 2) - 1))
    many = many.replace("@OPEN@", _OPEN if program.interface.contacts else "")
    many, last, end = many.rpartition("    return type")
    return [*found, many + (_LOOKED_UP if tables(program.functions.values()) else "") + last + end]


def _outputs(program: Program) -> str:
    shared = "outputs" in program.functions and "e" in program.functions["outputs"].inputs
    found = _OUTPUTS.replace("@ENERGIES@", _ENERGIES_FIRST if shared else "")
    found = found.replace("@C@", "model.work.contacts.forces, " if program.interface.contacts else "")
    return found.replace("@E@", "e, " if shared else "")


def _stacked(interface: Interface) -> str:
    """Return `stack` and its derivatives, by groups or along directions."""
    parts = [f"    {name!r}: {part!r},\n" for name, part in interface.stack.items()]
    on = "_on" if interface.relations else ""
    text = "".join(["STACK = {  # rows of the derivatives\n", *parts, "}\n", _DERIVATIVES])
    text += _by_groups(interface.derivatives) if interface.derivatives else _ALONG
    return text.replace("@CALL@", _ON_BRANCH if on else _AT_STATE).replace("@ON@", on)


def _by_groups(patterns: Mapping[str, Sequence[tuple[int, int]]]) -> str:
    from textwrap import fill  # only for models with derivatives

    text = ["\n\nPATTERNS = {  # (row, column) of each\n"]
    for name, pattern in patterns.items():
        places = fill(", ".join(map(repr, pattern)), 100, initial_indent=" " * 8, subsequent_indent=" " * 8)
        text.append(f"    {name!r}: [\n{places}\n    ],\n" if pattern else f"    {name!r}: [],\n")
    functions = ", ".join(f"{name!r}: fn_by_{name}@ON@" for name, pattern in patterns.items() if pattern)
    return "".join([*text, "}\n", _BY_GROUPS.replace("@FUNCTIONS@", functions)])


def _statuses(interface: Interface) -> str:
    return "".join(["(\n", *(f"    {text!r},\n" for text in status_texts(library("python"), interface)), ")"])
