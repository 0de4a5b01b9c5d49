"""Sizes and flags of a model.  They are known when its code is printed."""

from lagc.kernels.language.words import SizeType

# fmt: off
STRAIGHT: bool  # the right-hand side has sparse factors as straight-line code
HAS_DISPLACE: bool  # qdot = N v with N not the unit matrix
COMPLETE: bool  # with bounds of parameters and initialization, which a run of lagc does itself


class NQ(metaclass=SizeType): ...  # coordinates
class NV(metaclass=SizeType): ...  # speeds
class NZ(metaclass=SizeType): ...  # work integrals
class NX(metaclass=SizeType): ...  # of the state x: NINT + NDISC
class NINT(metaclass=SizeType): ...  # integrated states: NQ + NV + NZ; without NDISC it is NX
class NDISC(metaclass=SizeType): ...  # discrete variables, the last of x: clauses `when` alone change them
class NC(metaclass=SizeType): ...  # constraint equations
class NH(metaclass=SizeType): ...  # of these the holonomic ones, which come first
class NP(metaclass=SizeType): ...  # parameters and inputs
class NPREPARED(metaclass=SizeType): ...  # numbers that `bind` computes; they follow the parameters
class NREAD(metaclass=SizeType): ...  # parameters that `bind` reads, copied behind the prepared numbers
class NALL(metaclass=SizeType): ...  # NP + NPREPARED
class NQUAT(metaclass=SizeType): ...  # unit quaternions
class NY(metaclass=SizeType): ...  # outputs
class NQUANTITY(metaclass=SizeType): ...  # NQ + NV + NY + NDISC: what a verified run compares
class NGROUP(metaclass=SizeType): ...  # scaling groups of coordinates and speeds
class NWORK(metaclass=SizeType): ...  # entries of the sparse factors
class NHEALTH(metaclass=SizeType): ...  # measures of the quality of a sparse solve
class NM(metaclass=SizeType): ...  # entries of the mass matrix, packed by rows; 0: it is never formed
class NG(metaclass=SizeType): ...  # entries of G: NC NV
class NR(metaclass=SizeType): ...  # NV + NC
class NMANY(metaclass=SizeType): ...  # NR / 200 + 1: round-off of sums grows with their number of terms
class NREACH(metaclass=SizeType): ...  # NC + NH + NGROUP
class NCOND(metaclass=SizeType): ...  # initial equations of the model
class NRATE(metaclass=SizeType): ...  # stated rates that are not speeds
class NMASSLESS(metaclass=SizeType): ...  # speeds without inertia, as of a filter
class NBOUNDED(metaclass=SizeType): ...  # parameters with bounds
class NLIMITS(metaclass=SizeType): ...  # bounded values computed from parameters
class NU(metaclass=SizeType): ...  # unknowns of the initialization: NQ + NV + NRATE
class NTIED(metaclass=SizeType): ...  # NH + NC
class NE(metaclass=SizeType): ...  # its equations: NCOND + NQUAT
class NJ(metaclass=SizeType): ...  # their derivatives
class NSUM(metaclass=SizeType): ...  # sums that several derivatives of initial equations share
class NSTRETCH(metaclass=SizeType): ...  # runs of consecutive unknowns in these equations
class NPARTS(metaclass=SizeType): ...  # derivatives by unknowns and sums
class NPARTED(metaclass=SizeType): ...  # NCOND + NSUM
class NWHOLE(metaclass=SizeType): ...  # NU + NSUM
class NMODE(metaclass=SizeType): ...  # relations with a mode
class NTIMED(metaclass=SizeType): ...  # of these the ones of time alone, which come first
class NFREE(metaclass=SizeType): ...  # the others, which depend on the state
class NBOX(metaclass=SizeType): ...  # ends of a box of time and states
class NENDS(metaclass=SizeType): ...  # 2 NFREE
class NENCLOSED(metaclass=SizeType): ...  # states of (q, v) that bounds in a box depend on
class NFEAT(metaclass=SizeType): ...  # terms that may be narrow
class NBOUNDS(metaclass=SizeType): ...  # 2 NFEAT
class NPOLE(metaclass=SizeType): ...  # divisors that may come near zero
class NNEAR(metaclass=SizeType): ...  # 2 NPOLE
class NGUARD(metaclass=SizeType): ...  # NFEAT + NPOLE
class NLATE(metaclass=SizeType): ...  # relations that accelerations or reactions decide, before contacts
class NKNOWN(metaclass=SizeType): ...  # NV + NC + NCROW: accelerations, multipliers, forces of contacts
class NLOADED(metaclass=SizeType): ...  # multipliers that loads depend on
class NHELD(metaclass=SizeType): ...  # of these, multipliers of constraints that actuators hold
class NPUSHED(metaclass=SizeType): ...  # contacts whose normal forces loads depend on
class NLOADS(metaclass=SizeType): ...  # NLOADED + NPUSHED
class NLOADSLOPES(metaclass=SizeType): ...  # NLOADS NV
class NLOADCOLUMNS(metaclass=SizeType): ...  # NLOADED (NV + NC)
class NLOADMATRIX(metaclass=SizeType): ...  # NLOADED NLOADED
class NCURVED(metaclass=SizeType): ...  # NLOADS if they are not linear in them; else 0
class NSEARCH(metaclass=SizeType): ...  # NFREE + NGUARD
class NEDGES(metaclass=SizeType): ...  # 2 NMODE if a relation is stepwise, as floor(z) is; else 0
class NWHEN(metaclass=SizeType): ...  # clauses `when`
class NJUMP(metaclass=SizeType): ...  # values that they assign
class NACTS(metaclass=SizeType): ...  # limit of their actions at one event
class NROW(metaclass=SizeType): ...  # NU + 1: an equation with its right-hand side
class NCON(metaclass=SizeType): ...  # contacts
class NBLOCK(metaclass=SizeType): ...  # blocks of contacts: systems whose motions do not depend on each other
class NMOVED(metaclass=SizeType): ...  # NQ + NV: coordinates and speeds
class NAPART(metaclass=SizeType): ...  # NBLOCK - 1: blocks beside the first
class NIMPULSE(metaclass=SizeType): ...  # contacts whose impulses are asked for
class NSLIP(metaclass=SizeType): ...  # their slip rows: 0, 1 or 2 each
class NSPACE(metaclass=SizeType): ...  # contacts with two slip rows
class NTWO(metaclass=SizeType): ...  # two-sided contacts: joints and constraints with friction
class NNORMAL(metaclass=SizeType): ...  # components of their normal forces
class NPOISSON(metaclass=SizeType): ...  # contacts with Poisson's law of impact
class NSAMPLED(metaclass=SizeType): ...  # relations whose indicators are sampled
class NBESIDE(metaclass=SizeType): ...  # NCROW - 1: rows of contacts beside one
class NPLAIN(metaclass=SizeType): ...  # relations that are no contacts
class NCROW(metaclass=SizeType): ...  # NCON + NSLIP: their rows
class NGRADIENTS(metaclass=SizeType): ...  # NCROW NV
class NRESPONSES(metaclass=SizeType): ...  # NCROW (NV + NC)
class NLEAP(metaclass=SizeType): ...  # clauses `when` and contacts: what changes the state at an event
class NDELASSUS(metaclass=SizeType): ...  # NCROW NCROW
class NDIRECT(metaclass=SizeType): ...  # 2 NCON
class NNORMALEFFECTS(metaclass=SizeType): ...  # NNORMAL NCROW
class NNORMALROWS(metaclass=SizeType): ...  # NNORMAL NKNOWN


# The same for every model.
class TWO(metaclass=SizeType): ...
class THREE(metaclass=SizeType): ...
class FOUR(metaclass=SizeType): ...
class SEVEN(metaclass=SizeType): ...
class NK(metaclass=SizeType): ...  # stages that are kept in a step, of the method with the most
class ND(metaclass=SizeType): ...  # coefficient vectors of the dense output
class NNEWTON(metaclass=SizeType): ...  # unknowns of a stage, NQ + NV + NLAM; 0: no implicit method
class NLAM(metaclass=SizeType): ...  # multipliers among them: NC, or 0 in a model with contacts
class NSLOPES(metaclass=SizeType): ...  # NNEWTON NNEWTON
class NDIRECTION(metaclass=SizeType): ...  # NNEWTON + NV where derivatives are columns; else 0
class NLINEAR(metaclass=SizeType): ...  # unknowns of its linear systems: without q where qdot = v
class NFACTORS(metaclass=SizeType): ...  # NLINEAR NLINEAR
class NMASS(metaclass=SizeType): ...  # NV NV
class NSERIES(metaclass=SizeType): ...  # NX + 3: numbers of an order; 0: no method with series is carried
class NVALUE(metaclass=SizeType): ...  # values of a state that the coefficients of its series are made of
class NLANE(metaclass=SizeType): ...  # sums of products of coefficients
class NSQUARE(metaclass=SizeType): ...  # those of squares
class NCONVOLVED(metaclass=SizeType): ...  # both
class NTERM(metaclass=SizeType): ...  # terms of a series, at most
