"""The names of a tableau, as `explicit_runge_kutta` and `dispatch` use them: see `tableaus`."""

from typing import Any, Protocol

from lagc.kernels.language.records import Options, State, Work
from lagc.kernels.language.sizes import NGROUP, NX
from lagc.kernels.language.trial import TangentWork, Trial
from lagc.kernels.language.words import IVec, Length, Params, Real, Row, Rows, Status, Vec

C: tuple[str, ...]
A: tuple[Row, ...]
B: Row
ERROR: tuple[Row, ...]
EXTRA_C: tuple[str, ...]
EXTRA_A: tuple[Row, ...]
DENSE: tuple[Row, ...]
STABILITY: tuple[str, ...]
INVERSE: tuple[Row, ...]
FORTH: tuple[Row, ...]
BACK: tuple[Row, ...]
SHIFT: str
SHIFTS: tuple[str, ...]
ESTIMATE: Row
SHRINK: str
GROW: str
END_RATE: int


class Method(Protocol):
    NUMBER: int
    PROJECTS: int
    CONTROLS: int
    SENSITIVE: int
    IMPLICIT: int
    SERIES: int
    END_RATE: int
    ORDER: int
    USES_END_RATE: int
    C: tuple[str, ...]
    EXTRA_C: tuple[str, ...]
    ERROR: tuple[Row, ...]
    STABILITY: tuple[str, ...]
    EXPONENT: str
    BETA: str
    SHRINK: str
    GROW: str

    def stages(self, p: Params, t: Real, x: Vec[NX], h: Real, s: State, w: Work) -> Status: ...
    def error(self, h: Real, s: State, w: Work) -> Real: ...
    def add_stability(self, s: State, w: Work) -> None: ...
    def error_parts(self, s: State, w: Work) -> None: ...
    def next_size(self, s: State, a: Trial) -> Real: ...
    def reduced_size(self, a: Trial) -> Real: ...
    def keep_stages(self, s: State) -> None: ...
    def estimate_roundoff(self, p: Params, t: Real, x: Vec[NX], h: Real, s: State, w: Work) -> None: ...
    def restore_stages(self, s: State) -> None: ...
    def begin_step(self, p: Params, s: State, o: Options, a: Trial, w: Work) -> Status: ...
    def keep_series(self, s: State) -> None: ...
    def restore_series(self, s: State, w: Work) -> Status: ...
    def stage_deviation(self, i: int, h: Real, s: State) -> Real: ...
    def dense_output(
        self, p: Params, t: Real, x: Vec[NX], z: Vec[NX], h: Real, s: State, w: Work
    ) -> Status: ...
    def dense_at(self, part: Real, s: State, x: Vec[NX]) -> None: ...
    def dense_state(self, part: Real, i: int, s: State) -> Real: ...
    def tangent_stages(
        self, p: Params, s: State, m: Length, columns: IVec[Any], now: Rows[NX], after: Rows[NX],
        table: Rows[NX], noise: Rows[NGROUP], w: Work, v: TangentWork,
    ) -> Status: ...  # fmt: skip
    def tangent_extra(
        self, p: Params, s: State, m: Length, columns: IVec[Any], now: Rows[NX], table: Rows[NX],
        noise: Rows[NGROUP], w: Work, v: TangentWork,
    ) -> Status: ...  # fmt: skip
    def tangent_error(self, h: Real, v: TangentWork) -> Real: ...
    def tangent_dense(
        self, share: Real, h: Real, k: Length, now: Rows[NX], after: Rows[NX], table: Rows[NX],
        found: Vec[NX], v: TangentWork,
    ) -> None: ...  # fmt: skip


METHODS: tuple[Method, ...]


def is_method(number: int, method: Method) -> bool:  # type: ignore[empty-body]
    """Return whether a method has this number, which is not asked if a model has this method alone."""
