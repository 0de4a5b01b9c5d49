"""The public functions of generated modules.  A module has those that apply to its model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from typing import Any

from lagc.codegen.python.support.base import FAILED, Options, Trajectory
from lagc.codegen.python.support.equations import Equations
from lagc.codegen.python.support.generated import (
    FIXED,
    LEAST_PIVOT,
    NALL,
    NC,
    NH,
    NHEALTH,
    NMANY,
    NMODE,
    NP,
    NQ,
    NU,
    NV,
    NX,
    NY,
    PARAMETERS,
    PATTERNS,
    REFINED_RESIDUAL,
    SINGULAR,
    STACK,
    STATUSES,
    STRAIGHT,
    TABLES,
    TRUSTED_PIVOT,
    UNSTATED,
    StartWork,
    fn_along,
    fn_along_on,
    fn_bind,
    fn_energies,
    fn_modes,
    fn_outputs,
    fn_position,
    fn_rhs,
    fn_rhs_on,
    fn_stack,
    fn_stack_on,
    fn_start,
    fn_velocity,
    fn_watch,
    prepare,
    reach_start,
)  # fmt: skip
from lagc.codegen.python.support.integrator import _integrate
from lagc.codegen.python.support.plain import is_plain, other_inputs
from lagc.kernels.language.statuses import OK

# -- what follows is part of generated modules --


def default_params(**values: float) -> list[float]:
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


def rhs(t: float, x: Sequence[float], p: Sequence[float] | None = None) -> list[float]:
    """Return xdot[NX].  Raises ArithmeticError if the equations have no solution at (t, x)."""
    return _solved(t, x, p)[1]


def accelerations(
    t: float, x: Sequence[float], p: Sequence[float] | None = None
) -> tuple[list[float], list[float]]:
    """Return accelerations a[NV] and multipliers lam[NC]; errors as `rhs`."""
    _, xdot, lam = _solved(t, x, p)
    return xdot[NQ : NQ + NV], lam


def integrate(
    t0: float,
    x0: Sequence[float],
    times: Sequence[float],
    p: Sequence[float] | None = None,
    options: Options | None = None,
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """Integrate from (t0, x0) to times[-1]; return a Trajectory with the states at `times`."""
    return _integrate(equations(p), options or Options(), float(t0), _state(x0), _floats(times), progress)


def equations(p: Sequence[float] | None = None) -> Equations:
    """Return Equations with parameters p (see `default_params`), for many calls."""
    return Equations(default_params() if p is None else _floats(p))


def _solved(
    t: float, x: Sequence[float], p: Sequence[float] | None
) -> tuple[Equations, list[float], list[float]]:
    model = equations(p)
    xdot, lam = [0.0] * NX, [0.0] * NC
    status = model.rhs(float(t), _state(x), xdot, lam)
    if status in FAILED:
        raise ArithmeticError(f"{STATUSES[status]} Index: {model.culprit}.")
    return model, xdot, lam


def _floats(values: Sequence[float]) -> list[float]:
    return [float(v) for v in values]


def _state(x: Sequence[float]) -> list[float]:
    if len(x) != NX:
        raise ValueError(f"x has {len(x)} entries, not {NX}")
    return _floats(x)


def check(p: Sequence[float] | None = None, options: Options | None = None) -> None:
    """Raise ValueError, with the name, if a parameter or input is not finite or outside of its BOUNDS, or an
    option is not valid."""
    if options is not None:
        options.check()
    if p is not None:
        equations(p).check()


def start(p: Sequence[float] | None = None) -> list[float]:
    """Return x[NX] with the start values of the model.  They need not meet the constraints and initial
    equations: see `consistent`."""
    x = [0.0] * NX
    fn_start(equations(p).p, x)
    return x


def consistent(
    x: Sequence[float] | None = None,
    t: float = 0.0,
    p: Sequence[float] | None = None,
    levels: Sequence[int] | None = None,
) -> list[float]:
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


def mass_matrix(t: float, x: Sequence[float], p: Sequence[float] | None = None) -> list[list[float]]:
    """Return the mass matrix M, NV rows of NV."""
    packed = equations(p).system(float(t), _state(x))[1]
    rows = [packed[i * (i + 1) // 2 :][: i + 1] for i in range(NV)]
    return [[rows[max(i, j)][min(i, j)] for j in range(NV)] for i in range(NV)]


def forces(t: float, x: Sequence[float], p: Sequence[float] | None = None) -> list[float]:
    """Return r[NV] = tau - h: applied forces minus velocity terms, M a = r + G^T lam."""
    return equations(p).system(float(t), _state(x))[2]


def constraints(
    t: float, x: Sequence[float], p: Sequence[float] | None = None
) -> tuple[list[float], list[float], list[list[float]], list[float]]:
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


def energies(t: float, x: Sequence[float], p: Sequence[float] | None = None) -> list[float]:
    """Return kinetic energy, potential energy, and the energy whose change is the work."""
    e = [0.0] * 3
    fn_energies(equations(p).p, float(t), _state(x), e)
    return e


def outputs(t: float, x: Sequence[float], p: Sequence[float] | None = None) -> list[float]:
    """Return the outputs y[NY], in the order of Y_NAMES."""
    model, xdot, lam = _solved(t, x, p)
    given: dict[str, Any] = {"p": model.p, "t": float(t), "x": _state(x), "a": xdot[NQ : NQ + NV], "lam": lam}
    names = fn_outputs.__code__.co_varnames[: fn_outputs.__code__.co_argcount - 1]
    if "e" in names:
        given["e"] = energies(t, x, p)
    given.update(other_inputs(model.work))
    y = [0.0] * NY
    fn_outputs(*(given[name] for name in names), y)
    return y


def stack(
    t: float, x: Sequence[float], a: Sequence[float], lam: Sequence[float], p: Sequence[float] | None = None
) -> list[float]:
    """Return the differentiated functions at any a and lam, with the rows of STACK: qdot, M a,
    tau - h + G^T lam, G a - gamma, initial equations, start values, outputs, event indicators, values of
    `reinit`."""
    found = [0.0] * max(rows.stop for rows in STACK.values())
    function = fn_stack_on if NMODE else fn_stack
    _at_state(function, equations(p).p, float(t), _state(x), _floats(a), _floats(lam), found)
    return found


def _at_state(
    function: Callable[..., None], p: list[float], t: float, x: list[float], a: list[float], lam: list[float],
    *last: Any,
) -> None:  # fmt: skip
    """Call `function`, in the modes of the state."""
    if NMODE:
        modes = [0.0] * NMODE
        fn_modes(p, t, x, modes)
        function(p, t, x, modes, a, lam, *last)
    else:
        function(p, t, x, a, lam, *last)


def derivatives(
    group: str,
    t: float,
    x: Sequence[float],
    a: Sequence[float],
    lam: Sequence[float],
    p: Sequence[float] | None = None,
) -> list[float]:
    """Return the derivatives of `stack` by a group: "time", "state" (q, v), "acceleration" (a, lam) or
    "parameter" (parameters, then inputs).  PATTERNS has their rows and columns."""
    found = [0.0] * len(PATTERNS[group])
    if found:
        function = globals()[f"fn_by_{group}_on" if NMODE else f"fn_by_{group}"]
        _at_state(function, equations(p).p, float(t), _state(x), _floats(a), _floats(lam), found)
    return found


def along(
    t: float,
    x: Sequence[float],
    a: Sequence[float],
    lam: Sequence[float],
    d: Sequence[Any],
    p: Sequence[float] | None = None,
) -> list[Any]:
    """Return the derivative of `stack` in the direction d = (dt, dx, da, dlam, dp), with parameters, then
    inputs, in p.  The entries of d may be arrays, for many directions at once."""
    found = [0.0] * max(rows.stop for rows in STACK.values())
    function = fn_along_on if NMODE else fn_along
    _at_state(function, equations(p).p, float(t), _state(x), _floats(a), _floats(lam), d, found)
    return found


def rhs_many(t: Any, x: Any, p: Any = None) -> Any:
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
    rest: Any = range(len(x))
    # All states at once through the function of the model, with arrays in the place of numbers.
    if STRAIGHT:
        health: list[Any] = [1.0] + [0.0] * (NHEALTH - 1)
        columns: list[Any] = [0.0] * NX
        with numpy.errstate(all="ignore"):
            given = list(p.T)
            if NALL > NP:
                prepared = [0.0] * (NALL - NP)
                _vectorised(fn_bind)(given, prepared)
                given += prepared
            state, modes = list(x.T), [0.0] * NMODE
            if NMODE:
                _vectorised(fn_modes)(given, t, state, modes)
                _vectorised(fn_rhs_on)(given, t, state, modes, columns, [0.0] * NC, health)
            else:
                _vectorised(fn_rhs)(given, t, state, columns, [0.0] * NC, health)
            if "fn_watch" in globals() and not numpy.all(health[0] >= TRUSTED_PIVOT):
                _vectorised(fn_watch)(given, health)
            for k, value in enumerate(columns):
                xdot[:, k] = value
            # The tests of `rhs_at`: a state that passes them has the same rates, up to NumPy's functions.
            sound = health[0] >= (LEAST_PIVOT if NC else SINGULAR)
            if NC:
                sound = sound & (health[1] <= REFINED_RESIDUAL * NMANY * NMANY)
            sound = sound & numpy.isfinite(xdot).all(axis=1)
            sound = sound & is_plain(x)
        rest = numpy.flatnonzero(~sound)
    # The others one by one.
    for i in rest:
        row = [0.0] * NX
        failed = equations(p[i]).rhs(float(t[i]), x[i].tolist(), row, [0.0] * NC) in FAILED
        xdot[i] = numpy.nan if failed else row
    return xdot


def _vectorised(function: Any) -> Any:
    """Return `function` for arrays instead of numbers."""
    import numpy

    names = {
        "tan": "tan",
        "asin": "arcsin",
        "acos": "arccos",
        "atan": "arctan",
        "sinh": "sinh",
        "cosh": "cosh",
        "tanh": "tanh",
        "exp": "exp",
        "log": "log",
        "sqrt": "sqrt",
        "floor": "floor",
        "sign": "sign",
        "atan2": "arctan2",
        "pow": "power",
        "fabs": "fabs",
        "select": "where",
        "both": "logical_and",
        "either": "logical_or",
        "inverse": "logical_not",
    }
    arrays: dict[str, Any] = {ours: getattr(numpy, theirs) for ours, theirs in names.items()}
    arrays["sine_cosine"] = lambda a: (numpy.sin(a), numpy.cos(a))
    arrays["minimum"] = lambda a, b: numpy.where(b < a, b, a)
    arrays["maximum"] = lambda a, b: numpy.where(b > a, b, a)
    if "TABLES" in globals():
        arrays["TABLES"] = TABLES
        arrays["piece"] = lambda table, a: numpy.maximum(numpy.searchsorted(table, a, "right") - 1, 0)
        arrays["entry"] = lambda table, place: numpy.asarray(table)[numpy.asarray(place, dtype=int)]
    return type(function)(function.__code__, arrays)
