"""Taylor series of variable order: the polynomial of a step from recurrences of its coefficients.

R. E. Moore, Interval Analysis, Prentice-Hall 1966, chapter 11; A. Jorba, M. Zou, A software package for the
numerical integration of ODEs by means of high-order Taylor methods, Experimental Mathematics 14 (2005) 99-117
(JZ).  Coefficients are those in the time over a size `series_scale`, near that of the step: they neither
overflow nor lose digits.
"""

from math import fabs, inf, sqrt

from lagc.kernels.language.vocabulary import *

LEAST_ORDER = 4.0
COUNTED = 3  # orders before the last one that the radius of convergence is estimated from, too
FALL = 1.3  # -ln of the ratio of successive terms at the end of a step
SHORTENED = 1e-3  # factor of a scale that makes coefficients overflow
MOST_SHORTENED = 16  # times
DIFFERENT = 0.1  # of the error weights: a series that does not follow the right-hand side


def natural_log(a: Real) -> Real:
    """Return ln(a) to about 1e-5 of it, for 0 < a < inf, by square roots and the series of artanh."""
    # ln a = 2^k ln(a^(1/2^k)), and ln a = 2 artanh((a - 1) / (a + 1)).
    scale = 2.0
    own = a
    while own > 2.0 or own < 0.5:
        own = sqrt(own)
        scale *= 2.0
    part = (own - 1.0) / (own + 1.0)
    square = part * part
    return scale * part * (1.0 + square * (1.0 / 3.0 + square * (0.2 + square / 7.0)))


def exponential(y: Real) -> Real:
    """Return e^y to about 1e-5 of it, by its series and squares."""
    halved = 0
    # e^y = (e^(y / 2^k))^(2^k).
    own = y
    while fabs(own) > 0.25:
        own *= 0.5
        halved += 1
    value = 1.0 + own * (1.0 + own * (0.5 + own * (1.0 / 6.0 + own / 24.0)))
    for j in range(halved):
        value *= value
    return value


def set_order(tolerance: Real, s: State) -> None:
    """Set the order for a relative tolerance, which the term before the last one has at the end of a step. A
    step of order p over e^-c of the radius of convergence meets a tolerance of e^-L for p = L / c, about. The
    least work is at c = 2 if it grows as p^2 (JZ 3.2.1) and at 1 if it grows as p: sums of products are the
    smaller part of it here."""
    # The order is chosen again only if the tolerance changes.
    if tolerance == s.series.tolerance:
        return
    s.series.tolerance = tolerance
    # p = 1 + L / 1.3, within the terms that there is room for.
    digits = -natural_log(tolerance)
    order = 1.0 + digits / FALL
    if order < LEAST_ORDER:
        order = LEAST_ORDER
    if order > float(size(NTERM)) - 1.0:
        order = float(size(NTERM)) - 1.0
    s.series.order = whole(order)
    # The ratio of successive terms at the end of the step, and its power for the first of the orders that are
    # looked at.
    fall = digits / (float(s.series.order) - 1.0)
    s.series.ratio = exponential(fall if fall > 1.0 else 1.0)
    s.series.fall = 1.0
    for k in range(s.series.order - COUNTED):
        s.series.fall *= s.series.ratio


def expand(p: Params, t: Real, x: Vec[NX], scale: Real, s: State, w: Work) -> Status:
    """Compute the coefficients of the motion from (t, x) in s.series.coefficients: row k is scale^k / k!
    times derivative k. Its first rates are left in w.xdot."""
    s.series.step = -1
    s.series.scale = scale
    s.rhs += 1
    # The model's own function gives the first rates, and the values that its recurrences need.
    if NMODE > 0:
        fn_series_on(p, t, x, w.modes, w.xdot, w.series.values)
    else:
        fn_series(p, t, x, w.xdot, w.series.values)
    s.series.coefficients[0][:] = x
    for i in range(NINT):
        w.series.scaled[i] = scale * w.xdot[i]
    order = s.series.order
    for i in range(NINT):
        s.series.coefficients[1][i] = scale * w.xdot[i]
    # Coefficient k + 1 from those up to k: products are convolutions of the factors' coefficients, the rest
    # is a recurrence of the model.
    for k in range(1, order):
        inverse = 1.0 / float(k)
        w.series.scaled[NX] = float(k)
        w.series.scaled[NX + 1] = inverse
        w.series.scaled[NX + 2] = scale if k == 1 else 0.0
        fn_convolve(k, w.series.left, w.series.right, w.series.squares, w.series.sums)
        fn_series_next(
            p,
            s.series.coefficients[k],
            w.series.scaled,
            w.series.values,
            w.series.sums,
            w.series.left[k],
            w.series.right[k],
            w.series.squares[k],
            w.series.rates_next,
        )
        # From rates of coefficients to the next coefficient of x: integration divides by k + 1.
        share = scale / float(k + 1)
        for i in range(NINT):
            w.series.scaled[i] = scale * w.series.rates_next[i]
            s.series.coefficients[k + 1][i] = share * w.series.rates_next[i]
    w.culprit = not_finite(s.series.coefficients[order], NINT)
    return NOT_FINITE if w.culprit >= 0 else OK


def follows_rates(h: Real, s: State, w: Work) -> bool:
    """Return whether the series has the rates of the right-hand side, which also holds where constraint
    equations depend on each other."""
    for i in range(NQ + NV):
        if not fabs(h * (w.xdot[i] - s.k[0][i])) <= DIFFERENT * w.error.weights[i]:
            return False
    return True


def planned_size(s: State, w: Work) -> Real:
    """Return the size of a step: the radius of convergence over s.series.ratio (JZ 3.2.2). The radius is the
    least one of four orders, since some vanish at symmetric states.  Coefficients are compared with those of
    steps of the same size, so that logarithms are small."""
    # The largest coefficient of the last orders, over the error weights.
    first = s.series.order - COUNTED
    largest = vector(FOUR)
    for k in range(COUNTED + 1):
        largest[k] = 0.0
    for i in range(NQ + NV):
        share = s.series.tolerance / w.error.weights[i]
        for k in range(COUNTED + 1):
            own = share * fabs(s.series.coefficients[first + k][i])
            if own > largest[k]:
                largest[k] = own
    # |c_k| (h/scale)^k is the tolerance at h: take roots by logarithms.
    known = False
    least = 0.0
    fall = s.series.fall
    for k in range(COUNTED + 1):
        if largest[k] > 0.0:
            room = -natural_log(fall * largest[k]) / float(first + k)
            if not known or room < least:
                least = room
            known = True
        fall *= s.series.ratio
    # A margin of e^(-0.7 / (order - 1)) (JZ 3.2.2); the size grows by the factor GROW at most.
    factor = number(GROW)
    if known:
        own = exponential(least - 0.7 / (float(s.series.order) - 1.0))
        if own < factor:
            factor = own
    return fabs(s.series.scale) * factor


def begin_step(p: Params, s: State, o: Options, a: Trial, w: Work) -> Status:
    """Compute the coefficients of a step and its size, a.size, with the last size as their scale."""
    # The order follows from the tolerance; a fixed step asks for round-off.
    tolerance = 0.0
    if o.step == 0.0:
        largest = 0.0
        for k in range(NGROUP):
            if s.sizes[k] > largest:
                largest = s.sizes[k]
        tolerance = o.rtol + (o.atol / largest if largest > 0.0 else 0.0)
    set_order(tolerance if tolerance > SPACING else SPACING, s)
    scale = a.size
    status = expand(p, s.t, s.x, scale * a.direction, s, w)
    turns = 0
    # Coefficients overflow where the scale is far beyond the radius of convergence.
    while status == NOT_FINITE and o.step == 0.0 and turns < MOST_SHORTENED:
        scale *= SHORTENED
        status = expand(p, s.t, s.x, scale * a.direction, s, w)
        turns += 1
    # The straight-line series has no pivoting: where it fails or differs from the rates, another method goes
    # on.
    if NC > 0 or NM > 0:
        if status == NOT_FINITE:
            return NOT_CONVERGED
    if failed(status):
        return status
    if NC > 0 or NM > 0:
        if not follows_rates(a.size, s, w):
            return NOT_CONVERGED
    # The coefficients tell the size, so no step is rejected for its error.
    if o.step == 0.0:
        s.series.size = planned_size(s, w)
        a.size = s.series.size
        if o.max_step > 0.0 and a.size > o.max_step:
            a.size = o.max_step
    return OK


def stages(p: Params, t: Real, x: Vec[NX], h: Real, s: State, w: Work) -> Status:
    """Evaluate the polynomial from x and its slope at the end of the step, s.x_new and
    w.series.end_slopes."""
    # Horner's rule for the value and, beside it, for the derivative, of all states side by side.
    part = h / s.series.scale
    own = vector(NX)
    change = vector(NX)
    own[:] = s.series.coefficients[s.series.order]
    change[:] = own
    for k in range(s.series.order - 1, 0, -1):
        for i in range(NINT):
            own[i] = s.series.coefficients[k][i] + part * own[i]
            change[i] = own[i] + part * change[i]
    s.x_new[:] = x
    for i in range(NINT):
        s.x_new[i] = x[i] + part * own[i]
        w.series.end_slopes[i] = change[i] / s.series.scale
    return OK


def error(h: Real, s: State, w: Work) -> Real:
    """Return the scaled error by the defect of the polynomial at the end of the step, the difference of its
    slope and the rate there: of order p it is h / (p + 1) times that."""
    total = 0.0
    share = h / (float(s.series.order) + 1.0)
    for i in range(NQ + NV):
        e = share * (w.series.end_slopes[i] - s.k[END_RATE][i]) / w.error.weights[i]
        total += e * e
    return sqrt(total / float(size(NQ) + NV)) if total < inf else inf


def next_size(s: State, a: Trial) -> Real:
    """Return the scale of the coefficients of the next step, which have its size."""
    return s.series.size


def reduced_size(a: Trial) -> Real:
    """Return half the size: the coefficients stay."""
    return 0.5 * a.size


def keep_series(s: State) -> None:
    """Keep what the coefficients of an accepted step are made with."""
    s.series.step = s.steps + 1
    s.series.kept_scale = s.series.scale
    s.series.kept_order = s.series.order


def restore_series(s: State, w: Work) -> Status:
    """Compute the coefficients of the last step again, if a later attempt has overwritten them."""
    # A failed attempt has overwritten the coefficients: the same order and scale give the same bits.
    if s.series.step == s.steps:
        return OK
    s.series.order = s.series.kept_order
    s.series.tolerance = 0.0
    status = expand(s.p, s.t_old, s.x_old, s.series.kept_scale, s, w)
    s.series.step = s.steps
    return status


def stage_deviation(i: int, h: Real, s: State) -> Real:
    """Return the largest deviation of the slope of a state at three points of the step from that of the cubic
    between its ends."""
    slopes = vector(THREE)
    part = h / s.series.scale
    inverse = 1.0 / s.series.scale
    early = 0.0
    middle = 0.0
    late = 0.0
    # Slopes at 1/4, 1/2 and 3/4 by Horner's rule.
    for k in range(s.series.order, 0, -1):
        own = float(k) * s.series.coefficients[k][i]
        early = own + 0.25 * part * early
        middle = own + 0.5 * part * middle
        late = own + 0.75 * part * late
    slopes[0] = early
    slopes[1] = middle
    slopes[2] = late
    # Slope of the cubic Hermite interpolant there.
    mean = (s.x_new[i] - s.x[i]) / h
    far = 0.0
    for j in range(3):
        c = 0.25 * float(j + 1)
        cubic = 6.0 * c * (1.0 - c) * mean + (1.0 - c) * (1.0 - 3.0 * c) * s.k[0][i]
        apart = fabs(inverse * slopes[j] - cubic - c * (3.0 * c - 2.0) * s.k[END_RATE][i])
        if apart > far:
            far = apart
    return far


def dense_state(part: Real, i: int, s: State) -> Real:
    """Return a state at a part of the last step, as `dense_at` does."""
    value = s.series.coefficients[s.series.order][i]
    for k in range(s.series.order - 1, -1, -1):
        value = s.series.coefficients[k][i] + part * s.series.part * value
    if NC > 0 or NQUAT > 0:
        value += part * s.r[0][i]
    return value


def dense_at(part: Real, s: State, x: Vec[NX]) -> None:
    """Evaluate the polynomial at a part of the last step, with that part of the projection of its end."""
    time = part * s.series.part
    x[:] = s.series.coefficients[s.series.order]
    if NDISC > 0:
        keep_discrete(s.series.coefficients[0], x)
    for k in range(s.series.order - 1, -1, -1):
        for i in range(NINT):
            x[i] = s.series.coefficients[k][i] + time * x[i]
    if NC > 0 or NQUAT > 0:
        for i in range(NINT):
            x[i] += part * s.r[0][i]


def dense_output(p: Params, t: Real, x: Vec[NX], z: Vec[NX], h: Real, s: State, w: Work) -> Status:
    """Compute what the end z of the step differs by from the polynomial."""
    s.series.part = h / s.series.scale
    if NC > 0 or NQUAT > 0:
        end = vector(NX)
        for i in range(NINT):
            s.r[0][i] = 0.0
        dense_at(1.0, s, end)
        for i in range(NINT):
            s.r[0][i] = z[i] - end[i]
    return OK
