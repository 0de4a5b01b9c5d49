"""The equations of motion of a generated module, with parameters and a workspace."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from lagc.codegen.python.support.generated import (
    NALL,
    NC,
    NP,
    STRAIGHT,
    Work,
    bind,
    factor_safely,
    fn_limits,
    is_bound,
    rhs_at,
    system_at,
)  # fmt: skip

# -- what follows is part of generated modules --


class Equations:
    """The equations of motion with parameters and inputs, the first NP entries of `p`, and a workspace,
    `work`.  One thread at a time may use an object."""

    def __init__(self, p: Sequence[float]):
        if len(p) != NP:
            raise ValueError(f"p has {len(p)} entries, not {NP}")
        self.p, self.work = [*p, *[0.0] * (NALL - NP)], Work()
        self.work.culprit = -1
        self.bind()

    def bind(self) -> None:
        """Compute the prepared numbers.  Call it after each change of a parameter in `p`; a change of an
        input needs no call."""
        if NALL > NP:
            bind(self.p)

    @property
    def culprit(self) -> int:
        """The culprit of the last status: an index of v or x, or a constraint equation."""
        return int(self.work.culprit)

    @property
    def fallbacks(self) -> int:
        """Number of linear solves that used the slower, rank-revealing factorization."""
        return int(self.work.fallbacks)

    @property
    def redundant_rows(self) -> tuple[int, ...]:
        """Constraint rows that depended on others in any evaluation so far."""
        return tuple([i for i, lost in enumerate(self.work.redundant) if lost]) if NC else ()

    @property
    def shared_contacts(self) -> tuple[int, ...]:
        """Contacts whose forces were one choice of many in any evaluation so far."""
        return tuple([i for i, shares in enumerate(getattr(self.work, "shared", ())) if shares])

    def rhs(self, t: float, x: list[float], xdot: list[float], lam: list[float]) -> int:
        """Compute xdot[NX] and lam[NC] at (t, x); return a status.  Earlier evaluations do not matter."""
        work = self.work
        if NC:
            work.rank_deficient = False
        status: int = rhs_at(self.p, t, x, xdot, lam, work)
        return status

    def first(self, t: float, x: list[float], xdot: list[float], lam: list[float]) -> int:
        """Do the same as at the beginning of a trajectory, where dependent rows are looked for first."""
        work = self.work
        if NC:
            work.rank_deficient = False
            if STRAIGHT:
                factor_safely(self.p, t, x, work)
                work.fallbacks -= 1
        status: int = rhs_at(self.p, t, x, xdot, lam, work)
        return status

    def system(self, t: float, x: list[float]) -> tuple[list[float], ...]:
        """Return qdot[NQ], M packed by lower rows, r[NV], G[NC*NV] by rows, gamma[NC].

        Each call reuses the lists."""
        work = self.work
        system_at(self.p, t, x, work)
        return work.qdot, work.M, work.force, work.G, work.gamma

    def check(self) -> None:
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
