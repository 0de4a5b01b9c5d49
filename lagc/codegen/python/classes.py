"""Equations with their parameters, states on their way, and trajectories, in generated modules: as text.

What calls the kernels; names that stand nowhere here are theirs.
"""

EQUATIONS = '''\
class Equations:
    """The equations of motion with parameters and inputs, the first NP of `p`, and room to work in, `work`.
    For one thread at a time."""

    def __init__(self, p):
        if len(p) != NP:
            raise ValueError(f"p has {len(p)} entries, not {NP}")
        self.p, self.work = [*p, *[0.0] * (NALL - NP)], Work()
        self.work.culprit = -1
        self.bind()

    def bind(self):
        """Prepare what depends on parameters alone: to be called after one in `p` was changed; inputs may
        change at any time."""
        if NALL > NP:
            bind(self.p)

    @property
    def culprit(self):
        """What a status refers to: an index of v or x, or a row."""
        return self.work.culprit

    @property
    def fallbacks(self):
        """Linear solves that took the slower, safer way."""
        return self.work.fallbacks

    @property
    def redundant_rows(self):
        """Rows met so far that depended on others."""
        return tuple([i for i, lost in enumerate(self.work.redundant) if lost]) if NC else ()

    def rhs(self, t, x, xdot, lam):
        """xdot[NX] and lam[NC] at (t, x), whatever was found before; a status."""
        work = self.work
        if NC:
            work.rank_deficient = False
        return rhs_at(self.p, t, x, xdot, lam, work)

    def first(self, t, x, xdot, lam):
        """The same as at the start of a trajectory: straight factors need not show dependent rows."""
        work = self.work
        if NC:
            work.rank_deficient = False
            if STRAIGHT:
                factor_safely(self.p, t, x, work)
                work.fallbacks -= 1
        return rhs_at(self.p, t, x, xdot, lam, work)

    def system(self, t, x):
        """qdot[NQ], M packed by lower rows, r[NV], G[NC*NV] by rows, gamma[NC]; the lists are reused."""
        work = self.work
        system_at(self.p, t, x, work)
        return work.qdot, work.M, work.force, work.G, work.gamma

    def check(self):
        """Raises ValueError, naming the parameter that is not finite or out of its bounds, or the value made
        of some, where bounds are known (a run of lagc has seen to them)."""
        bounds, limits = globals().get("BOUNDS"), globals().get("LIMITS", {})
        if bounds is None:
            return
        for (name, (low, high)), value in zip(bounds.items(), self.p):
            if not (abs(value) < inf and low <= value <= high):
                raise ValueError(f"the parameter {name!r} is finite, from {low!r} to {high!r}: not {value!r}")
        derived = [0.0] * len(limits)
        if derived:
            fn_limits(self.p, derived)
        for (name, (low, high)), value in zip(limits.items(), derived):
            if not low <= value <= high:
                raise ValueError(f"the value {name!r} is from {low!r} to {high!r}: not {value!r}")
        if NALL > NP and not is_bound(self.p):
            raise ValueError("a parameter was changed, and not bound: see `Equations.bind`")
'''

STATES = '''\
class Asked:
    """Options as kernels read them."""

    __slots__ = (
        "atol", "first_step", "halves", "max_step", "max_steps", "method", "project", "report", "rtol",
        "step",
    )  # fmt: skip

    def __init__(self, options):
        for name in self.__slots__:
            setattr(self, name, getattr(options, name))
        self.method = METHODS.index(options.method)


class Integrator(State):
    """A state on its way.  `t`, `x`: now; `t_old`, `x_old`, `h_old`: the start and size of the last step.

    Between two calls of `step`, `advance` and `at` the caller may change `t`, `x` (also in place), the
    options, and inputs and parameters (`problem.p`; `problem.bind()` after parameters): the next step begins
    with what is there then, at the cost of one evaluation where t, x or p is another, and with the size of
    step that was found before.
    One problem, `Equations`, may serve several of these in turn.  A call raises ValueError, before anything
    is done, where an option, a time or a parameter makes no sense.
    """

    def __init__(self, problem, options, t, x):
        options.check()
        if len(x) != NX:
            raise ValueError(f"x has {len(x)} entries, not {NX}")
        super().__init__()
        self.problem, self.options = problem, options
        begin(self, t, x)

    def step(self, t1):
        """One accepted step towards `t1`, at most to it, and then exactly; a status."""
        return self._sound(step(self.problem.p, self, t1, self._asked(t1), self.problem.work))

    def advance(self, t1):
        """To `t1` exactly; a status.  A step that is short only to end there does not make the next
        one short."""
        return self._sound(advance(self.problem.p, self, t1, self._asked(t1), self.problem.work))

    def at(self, t):
        """A status and the state at `t` within the last step, which was made with the parameters of then.
        ValueError at any other time."""
        x = [0.0] * NX
        status = dense(self.problem.p, self, t, Asked(self.options), x, self.problem.work)
        if status == INVALID:
            raise ValueError(f"the time {t!r} is not within the last step")
        return status, x

    def _asked(self, t1):
        """The options of a call that goes to `t1`; raises ValueError."""
        self.options.check()
        self.problem.check()
        if not (abs(t1) < inf and abs(self.t) < inf):
            raise ValueError(f"a time is not finite: from {self.t!r} to {t1!r}")
        self.x = self.x[:]  # the caller may have kept the other
        return Asked(self.options)

    def _sound(self, status):
        if status == INVALID:
            raise refused(self.culprit)
        return status


def _integrate(problem, options, t0, x0, times, progress=None, clock=None):
    """From (t0, x0), consistent, to times[-1] exactly; states at `times` (in order) by dense output.

    `progress` is called with the time now and then, with a `clock` of seconds some 20 times a second;
    KeyboardInterrupt ends the run with what was recorded (INTERRUPTED).  ValueError where an option, a time
    or a parameter makes no sense.
    """
    run = Integrator(problem, options, t0, x0)
    asked, done = run._asked(times[-1] if times else t0), [0]
    states = [[0.0] * NX for _ in times]
    work, fallbacks, events = problem.work, problem.work.fallbacks, []
    jumps, corners = [], []

    def record_(steps, max_steps):
        """As the kernel, but where an exception ends it all is as before."""
        names = ("t", "x", "t_old", "culprit", "steps", "rejected", "rhs", "position_drift", "velocity_drift")
        before, reached = [getattr(run, name) for name in names], done[0]
        run.x, asked.max_steps = run.x[:], max_steps
        try:
            seen = run.changes if NMODE else 0
            status = record(problem.p, run, asked, times, len(times), states, done, steps, work)
            if NMODE and asked.report and run.changes > seen:
                events.extend((run.t, k) for k in NOTED if run.changed[k])
                if len(corners) < MOST_CORNERS:
                    jumped = NWHEN and run.jumps > len(jumps)
                    corners.append((run.t, run.x_before_event[:] if jumped else run.x[:], run.x[:]))
                if NWHEN:
                    events.extend((run.t, NMODE + k) for k in run.acted[: run.acts])
                    jumps.extend([run.t] * (run.jumps - len(jumps)))
                asked.report = len(events) < MOST_EVENTS
            return status
        except BaseException:
            for name, value in zip(names, before):
                setattr(run, name, value)
            done[0] = reached
            raise

    def told(status):
        return Trajectory(
            times=list(times[: done[0]]), states=states[: done[0]], t=run.t, x=run.x[:], status=status,
            culprit=-1 if status == OK else run.culprit, steps=run.steps, rejected=run.rejected, rhs=run.rhs,
            step=run.t - run.t_old, fallbacks=work.fallbacks - fallbacks,
            redundant_rows=problem.redundant_rows, position_drift=run.position_drift,
            velocity_drift=run.velocity_drift, sizes=run.sizes[:], event_roundoff=run.event_roundoff[:] if NMODE else (),
            events=events, jumps=jumps, corners=corners, changes=run.changes if NMODE else 0,
        )  # fmt: skip

    return recorded(run, options, record_, told, progress, clock)
'''
