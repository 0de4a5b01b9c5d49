"""Problem: all that integrators and projection know of a mechanical system."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

Vector = Sequence[float]


class Problem(Protocol):
    """States are plain lists of floats, x = (q, v, z).

    The equations of a compiled model are one implementation, a hand-written class in a test another.
    One that counts its `fallbacks` and knows its `redundant_rows` may have them as attributes; so may
    one whose parameters `p` may change between steps, or that remembers that rows were `lost` at the
    last state.  One with a method `tangents` (see `Equations`) has errors of steps judged without what
    projection removes, one with a method `shaken` without what is rounding.
    """

    nq: int
    nv: int
    nz: int
    nc: int
    nh: int
    quaternions: tuple[int, ...]
    kinds: tuple[int, ...]  # of each coordinate and speed: those of one unit share a size
    culprit: int

    @property
    def nx(self) -> int: ...

    def rhs(self, t: float, x: Vector, xdot: list[float], lam: list[float]) -> int:
        """Write xdot[nx] and the multipliers lam[nc]; a status.  REDUNDANT is a success."""
        ...

    def position(self, t: float, x: Vector) -> list[float]:
        """phi[nh]."""
        ...

    def velocity(self, t: float, x: Vector) -> list[float]:
        """d(phi)/dt and psi, nc rows."""
        ...

    def scales(self, t: float, x: Vector) -> list[float]:
        """The size of each row's terms (nc, > 0): residuals are judged against it."""
        ...

    def reaches(self, t: float, x: Vector, sizes: Sequence[float]) -> list[float]:
        """What each row (nc) changes by when its coordinates, or speeds, change by the size of their
        kind, and then each rate of a holonomic row (nh)."""
        ...

    def assemble(self, t: float, x: Vector) -> int:
        """Form and factor [M G^T; G 0] at (t, x) for the `solve`s that follow; a status."""
        ...

    def solve(self, r: Vector) -> list[float]:
        """s = (s1, s2) with M s1 - G^T s2 = r1, G s1 = r2, from the last `assemble`."""
        ...

    def displace(self, t: float, x: Vector, d: Vector) -> list[float]:
        """dq = N(t,q) d."""
        ...
