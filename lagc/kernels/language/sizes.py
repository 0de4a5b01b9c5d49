"""The sizes and switches of a model: known when its code is printed."""

from __future__ import annotations

from lagc.kernels.language.words import SizeType

# fmt: off
STRAIGHT: bool  # the right-hand side is straight-line code
HAS_DISPLACE: bool  # qdot is not v
COMPLETE: bool  # with what a run of lagc does itself: bounds of parameters, the search for a start


class NQ(metaclass=SizeType): ...  # coordinates
class NV(metaclass=SizeType): ...  # speeds
class NZ(metaclass=SizeType): ...  # work integrals
class NX(metaclass=SizeType): ...  # of the state, NQ + NV + NZ
class NC(metaclass=SizeType): ...  # rows of constraints
class NH(metaclass=SizeType): ...  # holonomic ones of them, the first
class NP(metaclass=SizeType): ...  # parameters and inputs
class NPREPARED(metaclass=SizeType): ...  # numbers that `bind` makes of the parameters, behind these
class NREAD(metaclass=SizeType): ...  # the parameters that it reads: the last of these numbers are copies
class NALL(metaclass=SizeType): ...  # NP + NPREPARED
class NQUAT(metaclass=SizeType): ...  # unit quaternions
class NGROUP(metaclass=SizeType): ...  # kinds of coordinates and speeds
class NWORK(metaclass=SizeType): ...  # entries of the straight factors
class NHEALTH(metaclass=SizeType): ...  # what is told of a straight solve, and by what it is watched
class NM(metaclass=SizeType): ...  # of the mass matrix, packed by rows; 0: it is never formed
class NG(metaclass=SizeType): ...  # of G: NC NV
class NR(metaclass=SizeType): ...  # NV + NC
class NMANY(metaclass=SizeType): ...  # NR / 200 + 1: rounding of sums of so many terms
class NREACH(metaclass=SizeType): ...  # NC + NH + NGROUP
class NCOND(metaclass=SizeType): ...  # conditions of a start that the model has
class NRATE(metaclass=SizeType): ...  # stated rates that are no speeds
class NPOSITION(metaclass=SizeType): ...  # conditions that positions take part in
class NBOUNDED(metaclass=SizeType): ...  # parameters with bounds
class NLIMITS(metaclass=SizeType): ...  # values made of parameters that have bounds
class NPIECE(metaclass=SizeType): ...  # pieces of the conditions that may be evaluated alone
class NU(metaclass=SizeType): ...  # unknowns of a start: NQ + NV + NRATE
class NE(metaclass=SizeType): ...  # its conditions: NCOND + NQUAT
class NJ(metaclass=SizeType): ...  # derivatives of these
class NSUM(metaclass=SizeType): ...  # sums by which derivatives of conditions are given, too
class NSTRETCH(metaclass=SizeType): ...  # unknowns of these that follow each other
class NPARTS(metaclass=SizeType): ...  # derivatives by unknowns and sums
class NPARTED(metaclass=SizeType): ...  # NCOND + NSUM
class NWHOLE(metaclass=SizeType): ...  # NU + NSUM
class NMODE(metaclass=SizeType): ...  # switches
class NTIMED(metaclass=SizeType): ...  # of these, those that time alone changes, the first
class NFREE(metaclass=SizeType): ...  # the others
class NBOX(metaclass=SizeType): ...  # ends of a box of time and states
class NENDS(metaclass=SizeType): ...  # 2 NFREE
class NFEAT(metaclass=SizeType): ...  # terms that may be narrow
class NBOUNDS(metaclass=SizeType): ...  # 2 NFEAT
class NPOLE(metaclass=SizeType): ...  # divisors that may come near zero
class NNEAR(metaclass=SizeType): ...  # 2 NPOLE
class NGUARD(metaclass=SizeType): ...  # NFEAT + NPOLE
class NSEARCH(metaclass=SizeType): ...  # NFREE + NGUARD
class NEDGES(metaclass=SizeType): ...  # 2 NMODE, where one counts
class NWHEN(metaclass=SizeType): ...  # clauses `when`
class NJUMP(metaclass=SizeType): ...  # new values that they give to states
class NACTS(metaclass=SizeType): ...  # the most of their acts at one moment
class NROW(metaclass=SizeType): ...  # NU + 1: of a row of these, with its right-hand side


# The same for every model.
class TWO(metaclass=SizeType): ...
class THREE(metaclass=SizeType): ...
class FOUR(metaclass=SizeType): ...
class SEVEN(metaclass=SizeType): ...
class NK(metaclass=SizeType): ...  # rates kept in a step, of the longest method
class ND(metaclass=SizeType): ...  # vectors of dense output
class NSETS(metaclass=SizeType): ...  # sets of values that are tried because linear prediction asks for them
class NSETU(metaclass=SizeType): ...  # NSETS NU
class NTREE(metaclass=SizeType): ...  # NE 2 + 2: of a tree of pairs of conditions
