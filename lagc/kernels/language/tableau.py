"""The names of a tableau, as `explicit_runge_kutta` and `dispatch` use them: see `tableaus`."""

from typing import Protocol

from lagc.kernels.language.records import State, Work
from lagc.kernels.language.sizes import NX
from lagc.kernels.language.words import Params, Real, Row, Status, Vec

C: tuple[str, ...]
A: tuple[Row, ...]
B: Row
ERROR: tuple[Row, ...]
EXTRA_C: tuple[str, ...]
EXTRA_A: tuple[Row, ...]
DENSE: tuple[Row, ...]


class Method(Protocol):
    NUMBER: int
    ORDER: int
    USES_END_RATE: int
    C: tuple[str, ...]
    EXTRA_C: tuple[str, ...]
    ERROR: tuple[Row, ...]
    EXPONENT: str
    BETA: str
    SHRINK: str
    GROW: str

    def stages(self, p: Params, t: Real, x: Vec[NX], h: Real, s: State, w: Work) -> Status: ...
    def error(self, h: Real, s: State, w: Work) -> Real: ...
    def error_parts(self, s: State, w: Work) -> None: ...
    def stage_deviations(self, h: Real, s: State, far: Vec[NX]) -> None: ...
    def dense_output(
        self, p: Params, t: Real, x: Vec[NX], z: Vec[NX], h: Real, s: State, w: Work
    ) -> Status: ...
    def dense_at(self, part: Real, s: State, x: Vec[NX]) -> None: ...


METHODS: tuple[Method, ...]
