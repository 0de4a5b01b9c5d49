"""The equations of a stage of an implicit method, and the linear systems of its Newton method.

The unknowns are q, v and the multipliers: q' = N v + n, M v' = f + G^T lam, and the constraints at velocity
level, psi = 0 (index 2). In a model with contacts they are q and v alone: q' and v' are the rates of the
motion with the contacts that touch, in the modes of the step. The matrices are dense.
"""

from lagc.kernels.contact.touching import rates_at
from lagc.kernels.dynamics.loaded_reactions import motion_at
from lagc.kernels.language.vocabulary import *
from lagc.kernels.linear_algebra.dense_lu import factor_complex, factor_real, solve_complex, solve_real

DIFFERENCE = by_type(5e-3, 6e-6, "6e-12")  # of the size of a state, SPACING^(1/3): for central differences


def residual_at(p: Params, t: Real, lam: Vec[NC], w: Work) -> Status:
    """Compute the residual w.newton.residual of the equations at the state w.newton.x_stage and the rates
    w.newton.rates_stage."""
    if NCON > 0:
        status = rates_at(p, t, w.newton.x_stage, w.xdot, w.lam, w)
        for i in range(NQ + NV):
            w.newton.residual[i] = w.newton.rates_stage[i] - w.xdot[i]
        return OK if status == REDUNDANT else status
    w.a[:] = part(w.newton.rates_stage, NQ, NQ + NV)
    if NMODE > 0:
        fn_residual_on(p, t, w.newton.x_stage, w.modes, w.a, lam, w.qdot, w.newton.residual_rows)
    else:
        fn_residual(p, t, w.newton.x_stage, w.a, lam, w.qdot, w.newton.residual_rows)
    # q' - N v - n, then (M v' - f - G^T lam, psi).
    for i in range(NQ):
        w.newton.residual[i] = w.newton.rates_stage[i] - w.qdot[i]
    for i in range(NR):
        w.newton.residual[NQ + i] = w.newton.residual_rows[i]
    return OK


def derive_columns(p: Params, t: Real, x: Vec[NX], s: State, w: Work) -> None:
    """Compute the derivatives of the equations column by column, by (q, v, lam) and then by the
    accelerations."""
    # Column j is the derivative along unit vector j: forward mode, for models whose Jacobian has no
    # straight-line code.
    for j in range(NDIRECTION):
        w.newton.direction[j] = 0.0
    for j in range(NDIRECTION):
        w.newton.direction[j] = 1.0
        if NMODE > 0:
            fn_newton_column_on(p, t, x, w.modes, w.a, w.lam, w.newton.direction, w.newton.residual)
        else:
            fn_newton_column(p, t, x, w.a, w.lam, w.newton.direction, w.newton.residual)
        w.newton.direction[j] = 0.0
        if j < NNEWTON:
            for i in range(NNEWTON):
                s.newton.slopes[i * NNEWTON + j] = w.newton.residual[i]
        else:
            for i in range(NV):
                s.newton.mass[i * NV + j - NNEWTON] = w.newton.residual[NQ + i]


def spans_of_states(p: Params, t: Real, x: Vec[NX], h: Real, s: State, w: Work, spans: Vec[NGROUP]) -> None:
    """Set the spans of the scaling groups: the largest magnitude so far, of angles at most 1. A group at
    rest, up to round-off, has what it reaches over h."""
    # The rates tell what speeds reach, and those after an Euler step what coordinates do.
    for k in range(NGROUP):
        spans[k] = 0.0
    w.newton.x_stage[:] = x
    for i in range(NQ + NV):
        w.newton.rates_stage[i] = h * s.k[0][i]
        w.newton.x_stage[i] += w.newton.rates_stage[i]
    enlarge_sizes(w.newton.rates_stage, spans)
    s.rhs += 1
    if not failed(rates_at(p, t + h, w.newton.x_stage, w.xdot, w.lam, w)):
        for i in range(NQ + NV):
            w.newton.rates_stage[i] = h * w.xdot[i]
        enlarge_sizes(w.newton.rates_stage, spans)
    for k in range(NGROUP):
        if w.error.sizes[k] > LEAST_SIZE * spans[k]:
            spans[k] = w.error.sizes[k]
    if spans[0] > 1.0:
        spans[0] = 1.0


def differ_rates(p: Params, t: Real, x: Vec[NX], h: Real, s: State, w: Work) -> Status:
    """Compute the derivatives of the rates with contacts by central differences, and by those of one side
    where the rates on the other one do not exist."""
    spans = vector(NGROUP)
    spans_of_states(p, t, x, h, s, w, spans)
    w.newton.x_stage[:] = x
    for j in range(NQ + NV):
        # Rates of both sides; those of a side that fails are s.k[0], at x itself.
        step = DIFFERENCE * spans[scaling_group[j]]
        ahead = x[j] + step
        behind = x[j] - step
        w.newton.x_stage[j] = ahead
        status = rates_at(p, t, w.newton.x_stage, w.newton.rates_stage, w.lam, w)
        if failed(status):
            ahead = x[j]
            w.newton.rates_stage[:] = s.k[0]
        w.newton.x_stage[j] = behind
        other = rates_at(p, t, w.newton.x_stage, w.xdot, w.lam, w)
        if failed(other):
            if failed(status):
                return status
            behind = x[j]
            w.xdot[:] = s.k[0]
        w.newton.x_stage[j] = x[j]
        # A state that has no size and does not move has no effect.
        apart = ahead - behind if ahead > behind else 1.0
        for i in range(NQ + NV):
            s.newton.slopes[i * NNEWTON + j] = (w.xdot[i] - w.newton.rates_stage[i]) / apart
    s.rhs += 2 * (NQ + NV)
    # The equations are solved for the rates.
    for i in range(NV):
        for j in range(NV):
            s.newton.mass[i * NV + j] = 1.0 if i == j else 0.0
    return OK


def derive_equations(p: Params, t: Real, x: Vec[NX], s: State, w: Work) -> Status:
    """Compute the derivatives of the equations without contacts, and find dependent constraint equations."""
    if NC > 0:
        # Which equations depend on others at this state: these are left out of the stages.
        w.rows.redundant_before[:] = w.redundant
        for i in range(NC):
            w.redundant[i] = 0
        status = motion_at(p, t, x, w.xdot, w.lam, w)
        # The motion at (t, x) has its own record of redundant rows, which this call must not lose.
        for i in range(NC):
            s.newton.dependent[i] = w.redundant[i] if status == REDUNDANT else 0
            if w.rows.redundant_before[i] == 1:
                w.redundant[i] = 1
        s.rhs += 1
        if failed(status):
            return status
        s.newton.start_lam[:] = w.lam
    # Derivatives by coordinates, speeds and multipliers, and the mass matrix.
    w.a[:] = part(s.k[0], NQ, NQ + NV)
    if NDIRECTION > 0:
        derive_columns(p, t, x, s, w)
    elif NMODE > 0:
        fn_newton_on(p, t, x, w.modes, w.a, w.lam, s.newton.slopes, s.newton.mass)
    else:
        fn_newton(p, t, x, w.a, w.lam, s.newton.slopes, s.newton.mass)
    if NC > 0:
        for i in range(NC):
            if s.newton.dependent[i] == 1:  # its multiplier stays
                for j in range(NNEWTON):
                    s.newton.slopes[(NQ + NV + i) * NNEWTON + j] = 0.0
                s.newton.slopes[(NQ + NV + i) * NNEWTON + NQ + NV + i] = 1.0
    return OK


def update_jacobian(p: Params, t: Real, x: Vec[NX], h: Real, s: State, w: Work) -> Status:
    """Compute the derivatives of the equations at (t, x), whose rates are s.k[0], for a step over h."""
    if NCON > 0:
        status = differ_rates(p, t, x, h, s, w)
    else:
        status = derive_equations(p, t, x, s, w)
    if failed(status):
        return status
    # Factors of other derivatives are void.
    s.newton.jacobian_step = s.steps
    s.newton.factored = 0.0
    return OK


def factor_stages(real: Real, re: Real, im: Real, s: State) -> bool:
    """Factor J + real B and J + (re + i im) B with B = diag(1, M, 0); return whether they are regular. Where
    qdot = v, the coordinates are eliminated: their increments follow from those of the speeds."""
    first = 0 if HAS_DISPLACE else size(NQ)
    # J, less the rows and columns of the coordinates if they are eliminated.
    for i in range(NLINEAR):
        for j in range(NLINEAR):
            own = s.newton.slopes[(first + i) * NNEWTON + first + j]
            s.newton.real_factors[i * NLINEAR + j] = own
            s.newton.complex_factors[i * NLINEAR + j] = own
            s.newton.imaginary_factors[i * NLINEAR + j] = 0.0
    if HAS_DISPLACE:
        for i in range(NQ):
            s.newton.real_factors[i * NLINEAR + i] += real
            s.newton.complex_factors[i * NLINEAR + i] += re
            s.newton.imaginary_factors[i * NLINEAR + i] += im
    else:
        # Where qdot = v, a shift sigma gives dq = dv / sigma: its columns go to those of the speeds.
        square = re * re + im * im
        for i in range(NLINEAR):
            for j in range(NQ):
                own = s.newton.slopes[(NQ + i) * NNEWTON + j]
                s.newton.real_factors[i * NLINEAR + j] += own / real
                s.newton.complex_factors[i * NLINEAR + j] += own * re / square
                s.newton.imaginary_factors[i * NLINEAR + j] -= own * im / square
    # The shift times M.
    first = size(NQ) - first
    for i in range(NV):
        for j in range(NV):
            own = s.newton.mass[i * NV + j]
            s.newton.real_factors[(first + i) * NLINEAR + first + j] += real * own
            s.newton.complex_factors[(first + i) * NLINEAR + first + j] += re * own
            s.newton.imaginary_factors[(first + i) * NLINEAR + first + j] += im * own
    return factor_real(s.newton.real_factors, s.newton.real_pivots) and factor_complex(
        s.newton.complex_factors, s.newton.imaginary_factors, s.newton.complex_pivots
    )


def solve_shifted(real: Real, s: State, r: Vec[NNEWTON], w: Work) -> None:
    """Replace r by the solution of (J + real B) s = r."""
    if HAS_DISPLACE:
        for i in range(NNEWTON):
            w.newton.linear[i] = r[i]
        solve_real(s.newton.real_factors, s.newton.real_pivots, w.newton.linear)
        for i in range(NNEWTON):
            r[i] = w.newton.linear[i]
    else:
        # (J + real B)(dq, dv, dlam) = r with qdot = v: dq = (dv + r_q) / real goes into the other equations.
        inverse = 1.0 / real
        for i in range(NLINEAR):
            total = r[NQ + i]
            for j in range(NQ):
                total -= s.newton.slopes[(NQ + i) * NNEWTON + j] * (inverse * r[j])
            w.newton.linear[i] = total
        solve_real(s.newton.real_factors, s.newton.real_pivots, w.newton.linear)
        for i in range(NV):
            r[i] = inverse * (r[i] + w.newton.linear[i])
        for i in range(NLINEAR):
            r[NQ + i] = w.newton.linear[i]


def solve_turned(re: Real, im: Real, s: State, r: Vec[NNEWTON], q: Vec[NNEWTON], w: Work) -> None:
    """Replace r + i q by the solution of the system with J + (re + i im) B."""
    if HAS_DISPLACE:
        for i in range(NNEWTON):
            w.newton.linear[i] = r[i]
            w.newton.linear_imaginary[i] = q[i]
        solve_complex(
            s.newton.complex_factors,
            s.newton.imaginary_factors,
            s.newton.complex_pivots,
            w.newton.linear,
            w.newton.linear_imaginary,
        )
        for i in range(NNEWTON):
            r[i] = w.newton.linear[i]
            q[i] = w.newton.linear_imaginary[i]
    else:
        square = re * re + im * im
        away = re / square  # the real and imaginary part of 1 / (re + i im)
        back = -im / square
        # Put the residuals of the coordinates, divided by the shift, into the equations of the speeds.
        for i in range(NLINEAR):
            own = r[NQ + i]
            turned = q[NQ + i]
            for j in range(NQ):
                slope = s.newton.slopes[(NQ + i) * NNEWTON + j]
                own -= slope * (away * r[j] - back * q[j])
                turned -= slope * (away * q[j] + back * r[j])
            w.newton.linear[i] = own
            w.newton.linear_imaginary[i] = turned
        solve_complex(
            s.newton.complex_factors,
            s.newton.imaginary_factors,
            s.newton.complex_pivots,
            w.newton.linear,
            w.newton.linear_imaginary,
        )
        # The coordinates follow from the speeds, again by 1 / (re + i im).
        for i in range(NV):
            own = r[i] + w.newton.linear[i]
            turned = q[i] + w.newton.linear_imaginary[i]
            r[i] = away * own - back * turned
            q[i] = away * turned + back * own
        for i in range(NLINEAR):
            r[NQ + i] = w.newton.linear[i]
            q[NQ + i] = w.newton.linear_imaginary[i]
