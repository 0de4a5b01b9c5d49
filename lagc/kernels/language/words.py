"""The language of kernels: a typed subset of Python, with the types and functions declared here.

A kernel is a function with annotated arguments and a scalar or pair as its result; it passes everything else
through records.  It consists of assignments, arithmetic, `if`, `while`, `for i in range`, `break`,
`continue`, `return`, and calls of earlier kernels, of functions of the model, and of `fabs`, `floor`, `sqrt`.
Division by zero and the square root of a negative number give what C gives.  `if NC > 0:` and `if STRAIGHT:`
are decided when a kernel is printed.  There are no tuples, defaults, closures, recursion or exceptions, and
no memory except local vectors.

    v[:] = w            copies a vector; v[a:b] = part(w, c, d) a part of one
    r = w.dq            a name for a vector, or a row of a matrix, of a record: nothing is copied
    l = w.law           a name for a record that is a member of another; it is passed to kernels as w.law
    v = vector(NX)      a local vector, to be filled before it is read; p = params() likewise
    a = Trial()         a local record of zeros
    present(v)          whether an optional vector or record (NULL) is given
    p[i]                a parameter or input by its index
    size(NX)            a size as a number that a local may hold
    whole(a)            a Real below 2^31 truncated to a Count
    return a, b         the result of a kernel that returns a Pair; functions of the model call it
    v[0:2] = kernel(x)  puts a Pair into a vector
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Generic, TypeVar, overload

from lagc.kernels import Status as Status

Real = float  # double, float or __float128
Count = int  # a long: steps, evaluations
Length = int  # a size_t: lengths that a caller gives
Pair = tuple[float, float]
N = TypeVar("N")
R = TypeVar("R")
T = TypeVar("T")


class SizeType(type):
    """The class of sizes.  A size is a number, and a type so that Vec[NV] and Vec[NX] differ."""

    def __index__(self) -> int: ...  # type: ignore[empty-body]
    def __float__(self) -> float: ...  # type: ignore[empty-body]
    def __add__(self, other: Size) -> int: ...  # type: ignore[empty-body]
    def __radd__(self, other: Size) -> int: ...  # type: ignore[empty-body]
    def __sub__(self, other: Size) -> int: ...  # type: ignore[empty-body]
    def __rsub__(self, other: Size) -> int: ...  # type: ignore[empty-body]
    def __mul__(self, other: Size) -> int: ...  # type: ignore[empty-body]
    def __rmul__(self, other: Size) -> int: ...  # type: ignore[empty-body]
    def __lt__(self, other: Size) -> bool: ...  # type: ignore[empty-body]
    def __le__(self, other: Size) -> bool: ...  # type: ignore[empty-body]
    def __gt__(self, other: Size) -> bool: ...  # type: ignore[empty-body]
    def __ge__(self, other: Size) -> bool: ...  # type: ignore[empty-body]
    def __eq__(self, other: object) -> bool: ...  # type: ignore[empty-body]
    def __hash__(self) -> int: ...  # type: ignore[empty-body]


Size = int | SizeType


class Vec(Generic[N]):
    """N reals.  Vec[Any] has any length, which is passed separately."""

    def __getitem__(self, i: Size) -> float: ...  # type: ignore[empty-body]
    @overload
    def __setitem__(self, i: Size, value: float) -> None: ...
    @overload
    def __setitem__(self, i: slice, value: Vec[Any] | Slice | Pair) -> None: ...
    def __setitem__(self, i: Size | slice, value: float | Vec[Any] | Slice | Pair) -> None: ...


class IVec(Generic[N]):
    """N integers."""

    def __getitem__(self, i: Size) -> int: ...  # type: ignore[empty-body]
    @overload
    def __setitem__(self, i: Size, value: int) -> None: ...
    @overload
    def __setitem__(self, i: slice, value: IVec[Any]) -> None: ...
    def __setitem__(self, i: Size | slice, value: int | IVec[Any]) -> None: ...


class Mat(Generic[R, N]):
    """R rows of N reals; a row is a vector that is shared, not copied."""

    def __getitem__(self, i: Size) -> Vec[N]: ...  # type: ignore[empty-body]


class Rows(Generic[N]):
    """Rows of N reals, as many as the caller gives; one block in C."""

    def __getitem__(self, i: Size) -> Vec[N]: ...  # type: ignore[empty-body]


class Cell(Generic[T]):
    """One number of the caller: cell[0]."""

    def __getitem__(self, i: int) -> T: ...  # type: ignore[empty-body]
    def __setitem__(self, i: int, value: T) -> None: ...


class Slice: ...


class Params:
    """Parameters and inputs of the model; a struct of reals in C."""

    def __getitem__(self, i: Size) -> float: ...  # type: ignore[empty-body]
    @overload
    def __setitem__(self, i: Size, value: float) -> None: ...
    @overload
    def __setitem__(self, i: slice, value: Params) -> None: ...
    def __setitem__(self, i: Size | slice, value: float | Params) -> None: ...


Out = Vec  # an argument that a function of the model writes
Row = dict[int, str]  # of a tableau: stage -> coefficient that is not zero, as text


def struct(cls: type[R]) -> type[R]:
    """A class with fields only; a struct in C."""
    return cls


def public(function: R) -> R:
    """Declare a kernel in the header, with its docstring."""
    return function


def inline(function: R) -> R:
    """Declare a small kernel that C compilers shall print where it is called."""
    return function


def vector(n: type[N]) -> Vec[N]: ...  # type: ignore[empty-body]
def indices(n: type[N]) -> IVec[N]: ...  # type: ignore[empty-body]
def params() -> Params: ...  # type: ignore[empty-body]
def size(n: SizeType) -> int: ...  # type: ignore[empty-body]
def whole(a: Real) -> Count: ...  # type: ignore[empty-body]
def part(v: Vec[Any], first: Size, end: Size) -> Slice: ...  # type: ignore[empty-body]
def present(v: object) -> bool: ...  # type: ignore[empty-body]
def static(values: Iterable[R]) -> Iterable[R]: ...  # type: ignore[empty-body]
def by_type(single: float, double: float, quad: str) -> float: ...  # type: ignore[empty-body]
def combination(row: Row, k: Mat[Any, N], i: Size) -> float: ...  # type: ignore[empty-body]
def number(text: str) -> float: ...  # type: ignore[empty-body]
def Code(value: int) -> int: ...  # type: ignore[empty-body]
