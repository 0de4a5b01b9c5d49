"""Beginning and end of a call: changes that the caller made, and the evaluation of the first rate."""

from lagc.kernels.contact.kept_blocks import forget_blocks
from lagc.kernels.contact.slips import turn_slips
from lagc.kernels.contact.touching import rates_at
from lagc.kernels.dynamics.rhs import factor_safely
from lagc.kernels.events.contact_events import start_contacts
from lagc.kernels.events.modes import update_edges
from lagc.kernels.events.when_clauses import start_modes
from lagc.kernels.integrators.dispatch import end_rate_row
from lagc.kernels.language.vocabulary import *


def forget_stages(s: State) -> None:
    """Let an implicit step begin without stages and derivatives of the last one."""
    if NNEWTON > 0:
        s.newton.kept_step = -1
        s.newton.jacobian_step = -1
        s.newton.eta = 1.0


def forget_events(s: State, t: Real, x: Vec[NX]) -> None:
    """Let a trajectory begin at (t, x) without events."""
    # All indicators count as off their crossings. The modes themselves follow in `evaluate_start`, since no
    # parameters are known.
    if NMODE > 0:
        s.changes = 0
        s.changes_at_time = 0
        s.t_changed = t
        for k in range(NMODE):
            s.slack[k] = 0.0
        s.after_event = False
        s.is_split = False
        s.event_time_error = 0.0
        s.first_order_time = 0.0
    if NWHEN > 0:
        s.conditions_known = False
        s.short_bounces = 0
    if NLEAP > 0:
        s.jumps = 0
        s.x_before_event[:] = x
    # Without a speed of rebound the next impact of a contact is its first.
    if NCON > 0:
        s.settlements = 0
        s.penetration = 0.0
        for i in range(NCON):
            s.bounce_speeds[i] = 0.0
            s.fall_heights[i] = 0.0
            s.touch_times[i] = t


def forget_last_step(s: State) -> None:
    """Let a trajectory begin without rate, dense output and parameters of a step before."""
    s.steps_before_call = 0
    s.is_new_call = True
    s.parameters_known = False
    s.method = 0
    s.rate_place = ABSENT
    s.dense_place = ABSENT
    if NC > 0:
        s.rank_deficient = False
    # The implicit method has neither Jacobian nor factors. theta = 1, slow convergence, asks for a new
    # Jacobian.
    if NNEWTON > 0:
        forget_stages(s)
        s.newton.factored = 0.0
        s.newton.theta = 1.0
        s.newton.count = 0
    if NSERIES > 0:
        s.series.step = -1
        s.series.tolerance = 0.0


@public
def begin(s: State, t: Real, x: Vec[NX]) -> None:
    """Begin a new trajectory at (t, x). x meets the constraints. *s need not be filled before."""
    # The last step is empty, t_old = t_end = t: dense output returns x itself.
    s.t = t
    s.t_old = t
    s.t_end = t
    s.x[:] = x
    s.x_old[:] = x
    s.x_end[:] = x
    # Sizes of scaling groups and ranges of states only grow from here: a state that passes zero keeps the
    # scale of its past in the error weights.
    for i in range(NGROUP):
        s.sizes[i] = 0.0
    enlarge_sizes(x, s.sizes)
    s.lowest[:] = x
    s.highest[:] = x
    # h = 0 lets the first step choose its size. A PI controller divides by the error of the step before; 1e-4
    # stands for that of the step that does not exist, as in DOPRI5.
    s.h_old = 0.0
    s.h = 0.0
    s.error_old = 1e-4
    # There is no grid of fixed steps before `begin_grid`, and no constraint has drifted.
    s.grid.begin = t
    s.grid.step = 0.0
    s.grid.rest = 0.0
    s.position_drift = 0.0
    s.velocity_drift = 0.0
    s.grid.index = 0
    s.grid.goal = 0
    s.grid.stride = 1
    # Counters and estimates of the whole trajectory.
    s.steps = 0
    s.rejected = 0
    s.rhs = 0
    s.stiff = 0
    s.stability_due = 1000
    s.rates_apart = 0.0
    s.states_apart = 0.0
    forget_last_step(s)
    # Round-off is not suspected before an error estimate fails.
    s.roundoff_estimated = False
    s.roundoff_memory = 0.0
    for i in range(NX):
        s.rate_roundoff[i] = 0.0
    s.longest_step = 0.0
    s.culprit = -1
    if NMODE > 0 or NLEAP > 0:
        forget_events(s, t, x)


def enter_call(s: State, w: Work) -> None:
    """Begin a call: prepare the workspace for this state."""
    s.is_new_call = True
    s.steps_before_call = s.steps + s.rejected
    if NC > 0:
        w.rank_deficient = s.rank_deficient
    if NMODE > 0:
        w.modes_fixed = True
    if NCON > 0:
        forget_blocks(w)


def leave_call(s: State, status: Status, w: Work) -> Status:
    """End a call: store where the last step ended."""
    if status != OK and status != INTERRUPTED:
        s.rate_place = ABSENT
    if not s.is_new_call:
        s.t_end = s.t
        s.x_end[:] = s.x
    if NC > 0:
        s.rank_deficient = w.rank_deficient
    if NMODE > 0:
        w.modes_fixed = False
    return status


def report_culprit(s: State, status: Status, w: Work) -> Status:
    """Copy the culprit of a failed evaluation to the state; return the status."""
    if failed(status) and status < STEP_UNDERFLOW:
        s.culprit = w.culprit
    if NMODE > 0:
        if status == CHATTERING or status == MISPLACED:
            s.culprit = w.culprit
    if NCON > 0 or NLOADED > 0:
        if status == PARADOX or status == PENETRATION:
            s.culprit = w.culprit
    return status


def state_changed(s: State) -> bool:
    """Return whether the caller changed the state since the last step, or there is no last step."""
    if not s.parameters_known or s.t != s.t_end:
        return True
    for i in range(NX):
        if not s.x[i] == s.x_end[i]:
            return True
    return False


def parameters_changed(p: Params, s: State) -> bool:
    """Return whether the caller changed parameters or inputs since the last step."""
    for k in range(NP):
        if not p[k] == s.p[k]:
            return True
    return False


def keep_parameters(p: Params, s: State) -> None:
    """Store the parameters of the step, the first of a call."""
    if s.is_new_call:
        s.p[:] = p
        s.parameters_known = True
        s.is_new_call = False


def evaluate_start(p: Params, s: State, direction: Real, w: Work) -> Status:
    """Compute the rate at the beginning of a step, in its modes."""
    # `again`: the rate at (t, x) is to be evaluated. `elsewhere`: modes are to be chosen as at a start.
    again = False
    if NDISC > 0:
        box_discrete(s, w)
    if NMODE > 0:
        elsewhere = False
    # Between two calls the caller may have changed t, x, p or inputs. A change of x ends what was known of
    # the motion: its round-off, and which constraint equations depend on others.
    if s.is_new_call:
        if state_changed(s):
            again = True
            if NMODE > 0:
                elsewhere = True
            s.roundoff_memory = 0.0
            enlarge_sizes(s.x, s.sizes)
            widen_ranges(s.x, s.lowest, s.highest)
            if NC > 0:
                w.rank_deficient = False
                if STRAIGHT:
                    factor_safely(p, s.t, s.x, w)  # sparse factors may miss dependent rows
                    w.fallbacks -= 1
        else:
            again = parameters_changed(p, s)
    # Kept stages predict the next ones along the same smooth motion only: not behind a change, and not behind
    # an event.
    if NNEWTON > 0:
        if again or s.newton.kept_step != s.steps:
            forget_stages(s)
        if NMODE > 0:
            if s.after_event:
                forget_stages(s)
    # A change may contradict modes and contacts: then they are chosen anew. That also evaluates the rate.
    if NMODE > 0:
        if again:
            s.rate_place = STAGES
            if NCON > 0:
                return start_contacts(p, s, direction, elsewhere, w)
            return start_modes(p, s, direction, elsewhere, w)
        # Else the modes of the last step go on, with the edges, normal directions and slip axes that belong
        # to them.
        w.modes[:] = s.modes
        update_edges(w)
        if NTWO > 0:
            w.contacts.normal_signs[:] = s.normal_signs
        if NSPACE > 0:
            turn_slips(p, s, w)
    # The rate at the beginning of a step is its first stage, k[0]. A method whose last stage is at the end of
    # the step (first same as last) has it already.
    status = OK
    if again or s.rate_place == ABSENT:
        status = rates_at(p, s.t, s.x, s.k[0], w.lam, w)
        s.rhs += 1
        if failed(status):
            return status
    elif s.rate_place == READY:
        s.k[0][:] = s.k[end_rate_row(s.method)]
    s.rate_place = STAGES
    return OK
