"""The classes of generated modules, as text: equations with parameters, and states of trajectories.

They call the kernels; names that are not defined here are kernels.
"""

EQUATIONS = '''\
class Equations:
    """The equations of motion with parameters and inputs, the first NP entries of `p`, and a workspace,
    `work`.  One thread at a time may use an object."""

    def __init__(self, p):
        if len(p) != NP:
            raise ValueError(f"p has {len(p)} entries, not {NP}")
        self.p, self.work = [*p, *[0.0] * (NALL - NP)], Work()
        self.work.culprit = -1
        self.bind()

    def bind(self):
        """Compute the prepared numbers.  Call it after each change of a parameter in `p`; a change of an
        input needs no call."""
        if NALL > NP:
            bind(self.p)

    @property
    def culprit(self):
        """The culprit of the last status: an index of v or x, or a constraint equation."""
        return self.work.culprit

    @property
    def fallbacks(self):
        """Number of linear solves that used the slower, rank-revealing factorization."""
        return self.work.fallbacks

    @property
    def redundant_rows(self):
        """Constraint rows that depended on others in any evaluation so far."""
        return tuple([i for i, lost in enumerate(self.work.redundant) if lost]) if NC else ()

    def rhs(self, t, x, xdot, lam):
        """Compute xdot[NX] and lam[NC] at (t, x); return a status.  Earlier evaluations do not matter."""
        work = self.work
        if NC:
            work.rank_deficient = False
        return rhs_at(self.p, t, x, xdot, lam, work)

    def first(self, t, x, xdot, lam):
        """Do the same as at the beginning of a trajectory, where dependent rows are looked for first."""
        work = self.work
        if NC:
            work.rank_deficient = False
            if STRAIGHT:
                factor_safely(self.p, t, x, work)
                work.fallbacks -= 1
        return rhs_at(self.p, t, x, xdot, lam, work)

    def system(self, t, x):
        """Return qdot[NQ], M packed by lower rows, r[NV], G[NC*NV] by rows, gamma[NC].

        Each call reuses the lists."""
        work = self.work
        system_at(self.p, t, x, work)
        return work.qdot, work.M, work.force, work.G, work.gamma

    def check(self):
        """Raise ValueError, with its name, if a parameter, or a value computed from parameters, is not finite
        or outside of its bounds.  Without bounds in this module (in a run of lagc) do nothing."""
        bounds, limits = globals().get("BOUNDS"), globals().get("LIMITS", {})
        if bounds is None:
            return
        for (name, (low, high)), value in zip(bounds.items(), self.p):
            if not (abs(value) < inf and low <= value <= high):
                raise ValueError(f"the parameter {name!r} must be from {low!r} to {high!r}: not {value!r}")
        derived = [0.0] * len(limits)
        if derived:
            fn_limits(self.p, derived)
        for (name, (low, high)), value in zip(limits.items(), derived):
            if not low <= value <= high:
                raise ValueError(f"the value {name!r} must be from {low!r} to {high!r}: not {value!r}")
        if NALL > NP and not is_bound(self.p):
            raise ValueError("a parameter changed: call `Equations.bind`")
'''

STATES = '''\
class KernelOptions:
    """Options, as the kernels read them."""

    __slots__ = (
        "alone", "atol", "first_step", "halves", "max_step", "max_steps", "method", "project", "report",
        "rtol", "step",
    )  # fmt: skip

    def __init__(self, options):
        for name in self.__slots__:
            setattr(self, name, getattr(options, name))
        self.method = METHODS[options.method]


class Integrator(State):
    """The state of a trajectory: `t` and `x`; `t_old`, `x_old` and `h_old` of the last step.

    Between calls of `step`, `advance` and `at` the caller may change `t`, `x` (also in place), the options,
    and inputs and parameters (`problem.p`; call `problem.bind()` after parameters).  The next step begins
    with these values, with the step size found before; it costs one more evaluation if t, x or p changed.
    One problem, `Equations`, may serve several trajectories in turn.  A call raises ValueError, and changes
    nothing, if an option, a time or a parameter is not valid.
    """

    def __init__(self, problem, options, t, x):
        options.check()
        if len(x) != NX:
            raise ValueError(f"x has {len(x)} entries, not {NX}")
        super().__init__()
        self.problem, self.options = problem, options
        begin(self, t, x)

    def step(self, t1):
        """Make one step towards `t1`, which it does not pass; return a status."""
        return self._checked(step(self.problem.p, self, t1, self._kernel_options(t1), self.problem.work))

    def advance(self, t1):
        """Integrate to `t1` exactly; return a status.  A step that is shortened to end there does not shorten
        the next one."""
        return self._checked(advance(self.problem.p, self, t1, self._kernel_options(t1), self.problem.work))

    def at(self, t):
        """Return a status and the state at `t`, a time of the last step, with the parameters of that step.
        Raises ValueError for any other time."""
        x = [0.0] * NX
        status = dense(self.problem.p, self, t, KernelOptions(self.options), x, self.problem.work)
        if status == INVALID:
            raise ValueError(f"the time {t!r} is not within the last step")
        return status, x

    def _kernel_options(self, t1):
        """Return the options of a call to `t1`.  Raises ValueError if they are not valid."""
        self.options.check()
        self.problem.check()
        if not (abs(t1) < inf and abs(self.t) < inf):
            raise ValueError(f"a time is not finite: from {self.t!r} to {t1!r}")
        self.x = self.x[:]  # the caller may keep a reference to the old list
        return KernelOptions(self.options)

    def _checked(self, status):
        if status == INVALID:
            raise invalid_call(self.culprit)
        return status


def _integrate(problem, options, t0, x0, times, progress=None, clock=None):
    """Integrate from the consistent state (t0, x0) to times[-1]; return a Trajectory with the states at
    `times`, which are in order.

    `progress` is called with the current time, with a `clock` in seconds about 20 times a second.
    KeyboardInterrupt ends the run with status INTERRUPTED.  Raises ValueError if an option, a time or a
    parameter is not valid.
    """
    run = Integrator(problem, options, t0, x0)
    kernel_options, done = run._kernel_options(times[-1] if times else t0), [0]
    states = [[0.0] * NX for _ in times]
    work, fallbacks, events = problem.work, problem.work.fallbacks, []
    jumps, corners = [], []
@BEGIN@
    def record_steps(steps, max_steps):
        """Call the kernel `record`; an exception leaves everything as it was before."""
        names = ("t", "x", "t_old", "culprit", "steps", "rejected", "rhs", "position_drift", "velocity_drift")
        before, reached = [getattr(run, name) for name in names], done[0]
        run.x, kernel_options.max_steps = run.x[:], max_steps
        try:
            seen = run.changes if NMODE else 0@SEEN@
            status = record(problem.p, run, kernel_options, times, len(times), states, done, steps, work)
            if NMODE and kernel_options.report and run.changes > seen:
                events.extend((run.t, k) for k in NOTED if run.changed[k])
                if len(corners) < MOST_CORNERS:
                    jumped = NWHEN and run.jumps > len(jumps)@STRUCK@
                    corners.append((run.t, run.x_before_event[:] if jumped else run.x[:], run.x[:]))
                if NWHEN:
                    events.extend((run.t, NMODE + k) for k in run.acted[: run.acts])
                    jumps.extend([run.t] * (run.jumps - len(jumps)))
@TOLD@                kernel_options.report = len(events) < MOST_EVENTS
            return status
        except BaseException:
            for name, value in zip(names, before):
                setattr(run, name, value)
            done[0] = reached
            raise

    def result(status):
        return @TRAJECTORY@(
            times=list(times[: done[0]]), states=states[: done[0]], t=run.t, x=run.x[:], status=status,
            culprit=-1 if status == OK else run.culprit, steps=run.steps, rejected=run.rejected, rhs=run.rhs,
            stiff=run.stiff, step=run.t - run.t_old, fallbacks=work.fallbacks - fallbacks,
            redundant_rows=problem.redundant_rows, position_drift=run.position_drift,
            velocity_drift=run.velocity_drift, sizes=run.sizes[:],
            lowest=run.lowest[:], highest=run.highest[:],
            events=events, jumps=jumps, corners=corners, changes=run.changes if NMODE else 0,@CONTACTS@
        )  # fmt: skip

    return record_in_slices(run, options, record_steps, result, progress, clock)
'''

_OF_CONTACTS = {  # places of STATES
    "@BEGIN@": "    contacts = []\n",
    "@SEEN@": "\n            settled = run.settlements",
    "@STRUCK@": " or run.settlements > settled",
    "@TOLD@": """\
                if run.settlements > settled:
                    contacts.extend(contact_events(run))
                if len(contacts) >= MOST_EVENTS:
                    kernel_options.report = False
""",
    "@CONTACTS@": "\n            contacts=contacts, penetration=run.penetration,",
    "@TRAJECTORY@": "ContactTrajectory",
}
_OF_OTHERS = {**dict.fromkeys(_OF_CONTACTS, ""), "@TRAJECTORY@": "Trajectory"}


def states(contacts: bool) -> str:
    """Return the class and the function that integrate."""
    found = STATES
    for place, text in (_OF_CONTACTS if contacts else _OF_OTHERS).items():
        found = found.replace(place, text)
    return found
