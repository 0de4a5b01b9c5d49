"""Many runs side by side: the right-hand side and the stages of a step over vectors of the compiler.

The functions of a finished source are printed once more with vectors in the place of doubles; each lane of a
vector belongs to another run, with its own parameters, time and step size.  The driver stays the scalar one,
an attempt at a time, and a lane that has ended takes the next run.  A lane whose right-hand side is not
regular, or whose angles are far, does its attempt again with the scalar functions.  So each run has the bits
that it has alone.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from importlib import import_module

from lagc.codegen.c.header import members
from lagc.codegen.kernel_compiler.c import copies
from lagc.codegen.kernel_compiler.lanes import LANES, LanePrinter
from lagc.codegen.kernel_compiler.library import Library, library
from lagc.codegen.kernel_compiler.parts import Part
from lagc.codegen.kernel_compiler.real_types import DOUBLE
from lagc.codegen.sizes import CONSTANT_SIZES, flags_of, sizes_of
from lagc.lowering.program import Interface

METHOD = "dop853"
WIDTHS = {8: "avx512f,avx512dq,avx512vl", 4: "avx2"}  # lanes, and what a processor needs
ONE, TWO = ("sqrt", "exp", "log", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh"), ("pow", "atan2")
SINES = ("sine_cosine", "sine_cosine_two")
# Kernels of the driver and all that they may call: a model that needs more has no lanes.
CALLS: dict[str, set[str]] = {
    "step_once": {"evaluate_start", "failed", "report_culprit", "choose_step_size", "fade_roundoff",
                  "find_step", "accept_step"},
    "find_step": {"plans_attempt", "try_step", "failed", "report_culprit", "accepts_attempt",
                  "hides_event"},
    "finish_step": {"not_finite", "failed", "rhs_at"},
    "rhs_at": {"fn_rhs", "rhs_any_rank", "not_finite"},
}  # fmt: skip

_VECTORS = """\
typedef double Wide __attribute__((vector_size(8 * LANES)));
typedef long long Mask __attribute__((vector_size(8 * LANES)));
static inline Wide wide_pick(Mask m, Wide a, Wide b) { return (Wide)(((Mask)a & m) | ((Mask)b & ~m)); }
"""
_TURN = """\
/* Angles that need another reduction get NaN, which makes the rates NaN. */
static inline void wide_sine_cosine(Wide x, Wide *pair)
{
    const Mask far = ~wide_sine_cosine_near(x, pair);
    pair[0] = (Wide)((Mask)pair[0] | far);
    pair[1] = (Wide)((Mask)pair[1] | far);
}
static inline void wide_sine_cosine_two(Wide x, Wide y, Wide *pairs)
{
    wide_sine_cosine(x, pairs);
    wide_sine_cosine(y, pairs + 2);
}
"""
_RATES = """\
static inline Status wide_rhs_at(const WideParams *p, Wide t, const Wide *x, Wide *xdot, Wide *lam,
    WideWork *w)
{
    wide_fn_rhs(p, t, x, xdot, lam, w->health);
    Wide sum = xdot[0] - xdot[0];
    for (int i = 1; i < NX; i++) {
        sum += xdot[i] - xdot[i];
    }
    w->bad |= ~((w->health[0] >= SINGULAR) & (w->health[1] <= LARGEST_RESIDUAL) & (sum == 0.0));
    return OK;
}
"""
_ATTEMPT = """\
/* Compute stages, end rate and error of an attempt of each run; `good`: whether its results
 * are those of the scalar functions; 0 before: the lane is empty. */
static void wide_attempt(LaneRun *const *runs, const double *params, const double *times, const Options *o,
    int *good)
{
    WideParams p;
    WideState s;
    WideWork w;
    Wide x[NX], t, h, end, sums[2];
    memcpy(&p, params, sizeof p);
    for (int n = 0; n < LANES; n++) {
        const LaneRun *run = runs[n];
        for (int i = 0; i < NX; i++) {
            x[i][n] = run->s.x[i];
            s.k[0][i][n] = run->s.k[0][i];
        }
        t[n] = run->s.t;
        h[n] = run->a.h;
        end[n] = run->a.t_new;
    }
    w.bad = s.rhs = (Mask)(t - t);
    (void)wide_dop853_stages(&p, t, x, h, &s, &w);
    (void)wide_rhs_at(&p, end, s.x_new, s.k[END_RATE], w.lam, &w);
    for (int i = 0; i < NX; i++) {
        w.error.weights[i] = x[i];
    }
    for (int n = 0; n < LANES; n++) {
        LaneRun *run = runs[n];
        good[n] = good[n] && (w.bad[n] == 0);
        if (good[n]) {
            for (int i = 0; i < NX; i++) {
                run->s.x_new[i] = s.x_new[i][n];
                run->s.k[END_RATE][i] = s.k[END_RATE][i][n];
            }
            set_error_weights(&run->s, o, run->a.h, &run->w);
            for (int i = 0; i < NQ + NV; i++) {
                w.error.weights[i][n] = run->w.error.weights[i];
            }
        }
    }
    wide_dop853_error_sums(h, &s, &w, sums);
    for (int n = 0; n < LANES; n++) {
        LaneRun *run = runs[n];
        if (!good[n]) {
            continue;
        }
        run->a.error = dop853_error_of_sums(sums[0][n], sums[1][n]);
        /* The other stages serve an estimate of round-off, the test of stiffness, and dense output. */
        const int used = GUARDED(run->a.error > 1.0) || (run->s.stability_due <= TESTED)
            || (times[run->done] < run->a.t_new);
        for (int j = 1; (j < END_RATE) && used; j++) {
            for (int i = 0; i < NX; i++) {
                run->s.k[j][i] = s.k[j][i][n];
            }
        }
    }
}
"""
_GUARD = """\
    if (hides_event(&run->p, &run->s, status, o, a, &run->w) != 0) {
        return;
    }
"""
_RUN = """\
typedef struct {
    Params p;
    State s;
    Work w;
    Trial a;
    long number;
    size_t done;
    int is_planned; /* the step has begun */
    Status status;
} LaneRun;
typedef struct {
    LaneRun runs[MOST_LANES];
    double params[sizeof(Params) / sizeof(double) * MOST_LANES]; /* a row for each, over the lanes */
} LaneRuns;
"""
_DRIVER = """\
/* Record the times that are passed, and plan the next attempt; return whether there is one. */
static int lane_plans_attempt(LaneRun *run, const double *times, size_t n, double *states, const Options *o,
    long most)
{
    const double t1 = times[n - 1];
    State *s = &run->s;
    if (!run->is_planned) {
        const Trial none = {0};
        while ((run->status == OK) && (run->done < n) && (times[run->done] <= s->t)) {
            run->status = interpolate_at(s, times[run->done], o, states + (run->done * NX), &run->w);
            run->done++;
        }
        if ((run->status == OK) && (run->done < n) && ((s->steps + s->rejected) >= most)) {
            run->status = INTERRUPTED;
        }
        if ((run->status != OK) || (run->done == n)) {
            return 0;
        }
        if ((s->dense_place == STAGES) || (s->dense_place == OPEN)) {
            s->dense_place = ABSENT;
        }
        run->a = none;
        run->a.direction = 1.0;
        run->status = evaluate_start(&run->p, s, 1.0, &run->w);
        if (failed(run->status) != 0) {
            return 0;
        }
        choose_step_size(&run->p, s, t1, o, &run->a, &run->w);
        fade_roundoff(s, &run->w);
        run->is_planned = 1;
    }
    if (plans_attempt(&run->p, s, t1, t1, o, &run->a, &run->w) == 0) {
        run->status = run->a.status;
        return 0;
    }
    return 1;
}

/* End an attempt whose stages are known, or else do it here. */
static void lane_ends_attempt(LaneRun *run, double t1, const Options *o, int good)
{
    Trial *a = &run->a;
    Status status = OK;
    a->leaves_end_rate = good;
    if (good) {
        run->s.rhs += EVALUATIONS;
        status = finish_attempt(&run->p, &run->s, o, a, &run->w);
    } else {
        status = try_step(&run->p, &run->s, o, a, &run->w);
    }
GUARD    if (accepts_attempt(&run->p, &run->s, t1, status, o, a, &run->w) != 0) {
        run->s.rhs += good;
        a->leaves_end_rate = 0;
        accept_step(&run->p, &run->s, t1, o, a, &run->w);
        run->is_planned = 0;
    }
}

size_t NAME_runs_size(void) { return sizeof(LaneRuns); }

/* Return how many runs this processor does side by side; 0: none. */
int NAME_lanes(void)
{
    __builtin_cpu_init();
CHOICE    return 0;
}

/* Record `count` runs, each from its params and x[NX] at time 0, at n times: states[n*NX] and a status.
 * INTERRUPTED: the run needs more than `most` attempts. */
void NAME_record_runs(const Params *p, const double *x, long count, const Options *o, const double *times,
    size_t n, double *states, int *statuses, long most, LaneRuns *room)
{
    const int lanes = NAME_lanes();
    LaneRun *const runs = room->runs, *active[MOST_LANES];
    int good[MOST_LANES];
    long next = 0;
    for (int k = 0; k < lanes; k++) {
        runs[k].number = -1;
    }
    for (;;) {
        int some = -1;
        for (int k = 0; k < lanes; k++) {
            LaneRun *run = &runs[k];
            active[k] = NULL;
            while (active[k] == NULL) {
                if (run->number < 0) {
                    if (next == count) {
                        break;
                    }
                    run->number = next;
                    run->p = p[next];
                    for (size_t j = 0; j < sizeof(Params) / sizeof(double); j++) {
                        room->params[(j * (size_t)lanes) + (size_t)k] = ((const double *)&run->p)[j];
                    }
                    run->done = 0;
                    run->is_planned = 0;
                    run->w = (const Work){0};
                    NAME_begin(&run->s, 0.0, x + (next * NX));
                    run->status = check_record(&run->p, &run->s, o, times, n, &run->done, 0, times[n - 1],
                        1.0);
                    enter_call(&run->s, &run->w);
                    next++;
                }
                double *own = states + ((size_t)run->number * n * NX);
                if (lane_plans_attempt(run, times, n, own, o, most) != 0) {
                    active[k] = run;
                    some = k;
                } else {
                    statuses[run->number] = run->status;
                    run->number = -1;
                }
            }
        }
        if (some < 0) {
            return;
        }
        for (int k = 0; k < lanes; k++) { /* an empty lane does what another does */
            good[k] = active[k] != NULL;
            active[k] = good[k] ? active[k] : active[some];
        }
        ATTEMPTS
        for (int k = 0; k < lanes; k++) {
            if (active[k] == &runs[k]) {
                lane_ends_attempt(active[k], times[n - 1], o, good[k]);
            }
        }
    }
}
"""


def lanes(
    interface: Interface, sources: Mapping[str, str], widths: Mapping[int, str] = WIDTHS
) -> dict[str, str] | None:
    """Return the `sources` of a model with a further file, for x86-64, that makes runs in lanes of these
    `widths`; None for a model that has events, constraints, or functions without vectors."""
    # The driver and the rates are those of a smooth model if they call nothing else.
    (name,) = [file.removesuffix(".h") for file in sources if file.endswith(".h")]
    flags = flags_of(interface, False)
    called = {f: _called(library(DOUBLE.language).part(f, flags)) for f in CALLS}
    rates = _rates(sources[f"{name}.c"])
    functions = {*re.findall(r"\b([a-z]\w*)\(", rates)} - {"fn_rhs"}
    smooth = all(called[f] <= known for f, known in CALLS.items()) and functions <= {*SINES, *ONE, *TWO}
    if not (flags[METHOD.upper()] and rates and smooth) or re.search(r"\?|\bint\b|\bstatic const\b", rates):
        return None
    # The functions over vectors, for any width: types, functions of C lane by lane, kernels, rates.
    kernels = library(LANES)
    wide = [_each(f, 1 + (f in TWO)) for f in sorted(functions & {*ONE, *TWO})]
    if functions & {*SINES}:
        wide += [part.text for part in kernels.chosen(["sine_cosine_near"], flags).functions] + [_TURN]
    wide += [_wide(rates), _RATES]
    wide += [kernels.part(f"{METHOD}_{part}", flags).text for part in ("stages", "error_sums")]
    wide = [*_records(kernels, interface, flags, wide), *copies("".join(wide)), *wide, _ATTEMPT]
    guards = "hides_event" in called["find_step"]
    text = _VECTORS + "\n".join(wide).replace("lagc_real", "Wide").replace("lagc_", "wide_")
    text = text.replace("LAGC_", "")
    # Constants of the method: the row of the rate at the end of a step, and evaluations before it.
    tableau = import_module(f"lagc.kernels.integrators.tableaus.{METHOD}")
    words = {"GUARDED": "1 || " * guards, "END_RATE": tableau.END_RATE, "EVALUATIONS": len(tableau.C) - 1,
             "MOST_LANES": max(WIDTHS), "GUARD": _GUARD * guards}  # fmt: skip
    text, run, driver = (_filled(part, words) for part in (text, _RUN, _DRIVER))
    made = [f'#include "{name}.c"\n', run]
    # Once for each width, with a choice between them when it runs.
    for width, needed in widths.items():
        own = re.sub(r"\b(Wide|Mask|wide)(?=\w*\b)", rf"\g<1>{width}", text).replace("LANES", str(width))
        target = f'static __attribute__((target("{needed}"))) '
        made.append(re.sub(r"^static (?:inline )?(?!const)", target, own, flags=re.M))
    choice = "".join(
        f"    if ({_has(needed)}) {{\n        return {width};\n    }}\n" for width, needed in widths.items()
    )
    attempts = " else ".join(
        f"if (lanes == {width}) {{\n            wide{width}_attempt(active, room->params, times, o, good);\n"
        "        }"
        for width in widths
    )
    made.append(_filled(driver, {"CHOICE": choice, "ATTEMPTS": attempts, "NAME": name}))
    return {**sources, f"{name}_lanes.c": "\n".join(made)}


def _filled(text: str, words: Mapping[str, object]) -> str:
    return re.sub("|".join(words), lambda found: str(words[found[0]]), text)


def _has(needed: str) -> str:
    return " && ".join(f'__builtin_cpu_supports("{part}")' for part in needed.split(","))


def _called(part: Part) -> set[str]:
    """Return the kernels and functions of the model that a kernel calls."""
    functions = [name for name in part.needs if name.islower()]  # others are constants and records
    return {*functions, *(name for name in part.names if name.startswith("fn_"))}


def _records(
    kernels: Library, interface: Interface, flags: Mapping[str, bool], functions: Iterable[str]
) -> list[str]:
    """Return the records that functions over vectors use, with the members that they use."""
    fields = [*members(interface), *([f"prepared[{interface.prepared}]"] if interface.prepared else [])]
    used = set(re.findall(r"(?:->|\.)([A-Za-z]\w*)", "".join(functions)))
    sizes = {n: str(max(size, 1)) for n, size in {**CONSTANT_SIZES, **sizes_of(interface)}.items()}
    printer = LanePrinter(sizes, {})
    found = [f"typedef struct {{ Wide {', '.join(fields)}; }} WideParams;\n"]
    for part in kernels.chosen(["State", "Work"], flags).records:
        own = [printer.declared(tuple(kind), name) for name, kind, *_ in part.members if name in used]
        own += ["Mask bad"] if part.name == "Work" else []  # lanes without the rates of the scalar function
        found += [f"typedef struct {{ {'; '.join(own)}; }} Wide{part.name};\n"] if own else []
    return found


def _rates(source: str) -> str:
    """Return the right-hand side as C prints it, without comments and notes on what is unused."""
    found = re.search(r"^static void fn_rhs\([^()]*\)\n\{\n.*?^\}\n", source, re.M | re.S)
    return re.sub(r" */\*.*?\*/\n|\(void\)\(?\w+\)?;", "", found[0] if found else "", flags=re.S)


def _wide(rates: str) -> str:
    """Return the right-hand side over vectors: types and functions have other names, and a number alone is
    spread."""
    text = re.sub(r"\bParams\b", "WideParams", re.sub(r"\bdouble\b", "Wide", rates))
    text = re.sub(r"\b([a-z]\w*)\(", r"wide_\1(", text)
    return re.sub(r"(?<=[\w\]] = )(-?\d+\.\d*(?:e[+-]?\d+)?|-?\d+e[+-]?\d+);", r"\1 - (Wide){0};", text)


def _each(name: str, arguments: int) -> str:
    """Return a function of the C library over vectors, lane by lane."""
    letters = "ab"[:arguments]
    formal, actual = ", ".join(f"Wide {a}" for a in letters), ", ".join(f"{a}[n]" for a in letters)
    return (
        f"static inline Wide wide_{name}({formal})\n{{\n    Wide found = a;\n"
        f"    for (int n = 0; n < LANES; n++) {{\n        found[n] = {name}({actual});\n    }}\n"
        "    return found;\n}\n"
    )
