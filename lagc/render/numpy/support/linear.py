"""A generated module's functions as a `Problem`: right-hand sides watched, and solved another way if bad."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf
from typing import Any

from lagc.render.numpy.support.base import FAILED, NOT_FINITE, OK, REDUNDANT
from lagc.render.numpy.support.fallback import Fallback
from lagc.render.numpy.support.sizes import NEARLY, RESTING, sizes_of

# -- what follows is part of generated modules --

LEAST_PIVOT = 1e-13  # pivot ratio of a straight solve that is good enough
LEAST_PIVOT_OF_ROWS = 1e-10  # the same with constraints: the square of what counts as dependent
LARGEST_RESIDUAL = 1e-20  # square of one that is good enough
FAINT = 1e-6  # of the longest gradient of a row: of a shorter one the terms are looked at
ROUNDING = 1e-28  # the same, beyond which a straight solve is refined


class Equations:
    """The equations of motion with parameters `p`.

    `model` maps NQ, NV, NZ, NC, NH, NWORK, STRAIGHT, QUATERNIONS, KINDS and fn_... to what a generated
    module calls so (its `globals()`).  `redundant_rows`: rows met so far that depended on others;
    `lost`: those of the last state did, and at the next less will do to call them so.  For one
    thread at a time.
    """

    def __init__(self, model: Mapping[str, Any], p: list[float]):
        self.p = p
        self.nq: int = model["NQ"]
        self.nv: int = model["NV"]
        self.nz: int = model["NZ"]
        self.nc: int = model["NC"]
        self.nh: int = model["NH"]
        self.nx = self.nq + self.nv + self.nz
        self.quaternions: tuple[int, ...] = tuple(model["QUATERNIONS"])
        self.kinds: tuple[int, ...] = tuple(model["KINDS"])
        self.culprit = -1
        self.fallbacks = 0
        self.redundant_rows: list[int] = []
        self._bounds: Mapping[str, tuple[float, float]] | None = model.get("BOUNDS")
        self._limits: Mapping[str, tuple[float, float]] = model.get("LIMITS", {})
        self._straight = bool(model["STRAIGHT"])
        self._functions = {k[3:]: v for k, v in model.items() if k.startswith("fn_")}
        self._fn_rhs: Any = self._functions.get("rhs")
        self._health = [1.0, 0.0]
        self._least = LEAST_PIVOT_OF_ROWS if self.nc else LEAST_PIVOT
        self.lost = False
        self._w = [0.0] * model["NWORK"]
        self._dense = False  # the last `assemble` is in the fallback
        self._fallback: Fallback | None = None
        nv, nc = self.nv, self.nc
        self._qdot, self._force, self._gamma = [0.0] * self.nq, [0.0] * nv, [0.0] * nc
        self._mass: list[float] = []
        self._g: list[float] = []

    def check(self) -> None:
        """Raises ValueError, naming the parameter that is not finite or out of its bounds, or the value made
        of some, where bounds are known (a run of lagc has seen to them)."""
        if self._bounds is None:
            return
        if len(self.p) != len(self._bounds):
            raise ValueError(f"p has {len(self.p)} entries, not {len(self._bounds)}")
        for (name, (low, high)), value in zip(self._bounds.items(), self.p):
            if not (abs(value) < inf and low <= value <= high):
                raise ValueError(f"the parameter {name!r} is finite, from {low!r} to {high!r}: not {value!r}")
        derived = [0.0] * len(self._limits)
        if derived:
            self._functions["limits"](self.p, derived)
        for (name, (low, high)), value in zip(self._limits.items(), derived):
            if not low <= value <= high:
                raise ValueError(f"the value {name!r} is from {low!r} to {high!r}: not {value!r}")

    def rhs(self, t: float, x: Sequence[float], xdot: list[float], lam: list[float]) -> int:
        """xdot[nx] and lam[nc] at (t, x); a status."""
        health = self._health
        if self._straight and not self.lost:
            self._fn_rhs(self.p, t, x, xdot, lam, health)
            if health[0] >= self._least and health[1] <= LARGEST_RESIDUAL:
                if health[1] > ROUNDING:
                    self._refined(t, x, xdot, lam)
                if not_finite(xdot) < 0:
                    return OK
        return self._solve_dense(t, x, xdot, lam)

    def afresh(self, t: float, x: Sequence[float], xdot: list[float], lam: list[float]) -> int:
        """`rhs` of its arguments alone, whatever rows were found to be dependent before."""
        self.lost = False
        return self.rhs(t, x, xdot, lam)

    def inspect(self, t: float, x: Sequence[float]) -> None:
        """See whether rows are dependent at a start, where straight factors need not show it."""
        if self._straight and self.nc:
            self._factor_dense(t, x)
            self.fallbacks -= 1

    def position(self, t: float, x: Sequence[float]) -> list[float]:
        return self._call("position", self.nh, t, x)

    def velocity(self, t: float, x: Sequence[float]) -> list[float]:
        return self._call("velocity", self.nc, t, x)

    def scales(self, t: float, x: Sequence[float]) -> list[float]:
        return self._call("scales", self.nc, t, x)

    def reaches(self, t: float, x: Sequence[float], sizes: Sequence[float]) -> list[float]:
        values = [0.0] * (self.nc + self.nh)
        self._functions["reaches"](self.p, t, x, sizes, values)
        return values

    def shaken(self, t: float, x: Sequence[float], count: int) -> tuple[float, list[float], list[float]]:
        """Time, state and parameters changed by four units of their last place, another way for each
        `count`."""
        turn, n = 2 * count + 3, self.nq + self.nv
        y = [a * NEARLY[(i + 1) * turn >> 1 & 1] for i, a in enumerate(x[:n])]
        p = [a * NEARLY[(n + i + 1) * turn >> 1 & 1] for i, a in enumerate(self.p)]
        return t * NEARLY[turn >> 1 & 1], [*y, *x[n:]], p

    def assemble(self, t: float, x: Sequence[float]) -> int:
        """Factors of [M G^T; G 0] at (t, x) for `solve`; a status."""
        if self._straight and not self.lost:
            self._functions["assemble"](self.p, t, x, self._w)
            self._functions["factor"](self._w, self._health)
            if self._health[0] >= self._least and self._health[1] <= LARGEST_RESIDUAL:
                self._dense = False
                return OK
        self._dense = True
        return self._factor_dense(t, x)

    def solve(self, r: Sequence[float]) -> list[float]:
        """s = (s1, s2) with M s1 - G^T s2 = r1, G s1 = r2, from the last `assemble`."""
        nv = self.nv
        if self._dense:
            assert self._fallback is not None
            _, s1, s2 = self._fallback.solve(list(r[:nv]), list(r[nv:]))
            return s1 + s2
        s = [0.0] * (nv + self.nc)
        self._functions["solve"](self._w, r, s)
        return s

    def tangents(self, t: float, x: Sequence[float], parts: list[list[float]]) -> bool:
        """Take from errors of states near x what lies along the constraints in their speeds, in the
        metric of the mass matrix: projection takes it from the state.  False where it cannot be told."""
        nq, nv, nc = self.nq, self.nv, self.nc
        lost, culprit, rows = self.lost, self.culprit, self.redundant_rows[:]
        self.system(t, x)
        status = self.assemble(t, x)
        for part in parts:
            if status in FAILED:
                break
            r = [0.0] * nv
            for i in range(nc):
                total = 0.0
                for a, b in zip(self._g[i * nv : (i + 1) * nv], part[nq:]):
                    total += a * b
                r.append(-total)
            s = self.solve(r)
            for j in range(nv):
                part[nq + j] += s[j]
        self.lost, self.culprit, self.redundant_rows = lost, culprit, rows
        return status not in FAILED

    def displace(self, t: float, x: Sequence[float], d: Sequence[float]) -> list[float]:
        """dq[nq] = N d."""
        if "displace" not in self._functions:
            return list(d)
        dq = [0.0] * self.nq
        self._functions["displace"](self.p, t, x, d, dq)
        return dq

    def system(
        self, t: float, x: Sequence[float]
    ) -> tuple[list[float], list[float], list[float], list[float], list[float]]:
        """qdot[nq], M packed by lower rows, r[nv], G[nc*nv] by rows, gamma[nc]; the lists are reused."""
        nv, nc = self.nv, self.nc
        if not self._mass:
            self._mass, self._g = [0.0] * (nv * (nv + 1) // 2), [0.0] * (nc * nv)
        found = (self._qdot, self._mass, self._force, self._g, self._gamma)
        self._functions["system"](self.p, t, x, *found)
        return found

    def _call(self, name: str, length: int, t: float, x: Sequence[float]) -> list[float]:
        values = [0.0] * length
        self._functions[name](self.p, t, x, values)
        return values

    def _finite(self, xdot: list[float], status: int) -> int:
        i = not_finite(xdot)
        if i < 0:
            return status
        self.culprit = i
        return NOT_FINITE

    def _factor_dense(self, t: float, x: Sequence[float]) -> int:
        """The fallback's factors at (t, x); remembers which rows are dependent."""
        if self._straight:
            self.fallbacks += 1
        qdot, mass, force, g, gamma = self.system(t, x)
        for values, first in ((qdot, 0), (force, self.nq)):
            i = not_finite(values)
            if i >= 0:
                own = not_finite(x)
                self.culprit = own if own >= 0 else first + i
                return NOT_FINITE
        if not_finite(mass) >= 0 or not_finite(g) >= 0 or not_finite(gamma) >= 0:
            own = not_finite(x)
            self.culprit = own if own >= 0 else self.nq
            return NOT_FINITE
        if self._fallback is None:
            self._fallback = Fallback(self.nv, self.nc)
        fallback = self._fallback
        if self.nc:
            miss, slight = self._trust(t, x)
            self._faint(t, x, g, slight)
            sizes = lambda: self._call("gamma_sizes", self.nc, t, x)  # noqa: E731
            status = fallback.factor(mass, g, self.lost, miss, slight, sizes)
        else:
            status = fallback.factor(mass, g, self.lost)
        self.lost = status == REDUNDANT
        if status != OK:
            self.culprit = fallback.culprit
        for row in sorted(fallback.order[fallback.rank :]) if self.lost else ():
            if row not in self.redundant_rows:
                self.redundant_rows.append(row)
        return status

    def _trust(self, t: float, x: Sequence[float]) -> tuple[float, list[float]]:
        """How far x is from the constraints, scaled; and, for each row, the change of its residual
        over the size of the coordinates (angles: and 1) relative to the size of its terms, at most 1."""
        own = sizes_of(self.kinds, x)
        own[0] += 1.0
        sizes, reaches = self.scales(t, x), self.reaches(t, x, own)
        miss = 0.0
        for value, size, reach in zip(self.position(t, x), sizes, reaches) if self.nh else ():
            if not abs(value) / (size + RESTING * reach) <= miss:
                miss = abs(value) / (size + RESTING * reach)
        return miss, [reach / size if reach < size else 1.0 for size, reach in zip(sizes, reaches)]

    def _faint(self, t: float, x: Sequence[float], g: list[float], slight: list[float]) -> None:
        """A gradient that is much shorter than others may be rounding of its terms: its direction says
        little then."""
        totals = []
        for i in range(self.nc):
            total = 0.0
            for a in g[i * self.nv : (i + 1) * self.nv]:
                total += abs(a)
            totals.append(total)
        if not min(totals) < FAINT * max(totals):
            return
        for i, (total, size) in enumerate(zip(totals, self._call("gradient_sizes", self.nc, t, x))):
            if 0.0 < total < slight[i] * size:
                slight[i] = total / size

    def _refined(self, t: float, x: Sequence[float], xdot: list[float], lam: list[float]) -> None:
        """The right-hand side once more with one step of iterative refinement."""
        nq, nv = self.nq, self.nv
        self.system(t, x)
        self._functions["assemble"](self.p, t, x, self._w)
        self._functions["factor"](self._w, [1.0, 0.0])
        r = self._force + self._gamma
        s = [0.0] * len(r)
        self._functions["solve"](self._w, r, s)
        self._functions["refine"](self._w, r, s)
        xdot[:nq] = self._qdot
        xdot[nq : nq + nv] = s[:nv]
        lam[:] = s[nv:]
        if self.nz:
            xdot[nq + nv] = self._power(t, x, s[:nv], lam)

    def _solve_dense(self, t: float, x: Sequence[float], xdot: list[float], lam: list[float]) -> int:
        nq, nv = self.nq, self.nv
        status = self._factor_dense(t, x)
        if status in FAILED:
            return status
        assert self._fallback is not None
        status, a, found = self._fallback.solve(self._force, self._gamma)
        if status in FAILED:
            self.culprit = self._fallback.culprit
            return status
        xdot[:nq] = self._qdot
        xdot[nq : nq + nv] = a
        lam[:] = found
        if self.nz:
            xdot[nq + nv] = self._power(t, x, a, lam)
        return self._finite(xdot, status)

    def _power(self, t: float, x: Sequence[float], a: list[float], lam: list[float]) -> float:
        function = self._functions.get("power")
        if function is None:
            return 0.0
        given = {"p": self.p, "t": t, "x": x, "a": a, "lam": lam}
        names = function.__code__.co_varnames[: function.__code__.co_argcount - 1]
        e = [0.0]
        function(*(given[name] for name in names), e)
        return e[0]


def not_finite(values: Sequence[float]) -> int:
    """The index of the first value that is infinite or not a number; -1."""
    total = sum(values)
    if total - total == 0.0:
        return -1
    for i, a in enumerate(values):
        if a - a != 0.0:
            return i
    return -1
