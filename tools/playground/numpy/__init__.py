"""The part of NumPy that lagc uses in a browser, in plain Python, where NumPy itself cannot be loaded.

Pyodide has no NumPy in its package, and the playground loads nothing from elsewhere. Names, shapes and
results are those of NumPy; tests compare each function with it. What lagc does not use there is missing.
An array is a list of numbers and the places of its elements in it, so that slices are views.
"""

from __future__ import annotations

import builtins
import math
import operator
from array import array as words
from collections.abc import Callable, Iterator, Sequence
from contextlib import nullcontext
from itertools import accumulate, compress
from typing import Any

inf, nan = math.inf, math.nan
float64, intp = float, int


class dtype:
    __class_getitem__ = classmethod(lambda cls, _: cls)


class ndarray:
    __class_getitem__ = classmethod(lambda cls, _: cls)
    __slots__ = ("at", "base", "dtype", "shape")
    __array_priority__ = 1

    def __init__(self, base: list[Any], shape: Sequence[int], kind: type, at: Sequence[int] | None = None):
        self.base, self.shape, self.dtype = base, tuple(shape), kind
        self.at = range(len(base)) if at is None else at

    @property
    def flat(self) -> list[Any]:
        """All elements in the order of C; not to be changed."""
        return self.base if isinstance(self.at, range) else [self.base[i] for i in self.at]

    ndim = property(lambda self: len(self.shape))
    size = property(lambda self: len(self.at))
    T = property(lambda self: self.transpose())

    def __len__(self) -> int:
        return self.shape[0]

    def __iter__(self) -> Iterator[Any]:
        return iter(self.flat) if self.ndim == 1 else (self[k] for k in range(self.shape[0]))

    def __float__(self) -> float:
        return float(self.item())

    def __int__(self) -> int:
        return int(self.item())

    def __bool__(self) -> bool:
        return bool(self.item())

    def __repr__(self) -> str:
        return f"array({self.tolist()})"

    def item(self) -> Any:
        if self.size != 1:
            raise ValueError("the truth of an array of several elements is ambiguous")
        return self.base[self.at[0]]

    def tolist(self) -> Any:
        rows: Any = [*self.flat]
        for n in reversed(self.shape[1:]):
            rows = (
                [rows[k : k + n] for k in range(0, len(rows), n)] if n else [[]] * math.prod(self.shape[:-1])
            )
        return rows if self.shape else rows[0]

    def astype(self, kind: Any) -> ndarray:
        return ndarray([*map(int if isinstance(kind, str) else kind, self.flat)], self.shape, kind)

    def tobytes(self) -> bytes:
        """The elements as 16-bit integers, the only bytes that are asked for."""
        return words("H", self.flat).tobytes()

    def reshape(self, *shape: Any) -> ndarray:
        sizes = [*shape[0]] if len(shape) == 1 and not isinstance(shape[0], int) else [*shape]
        if -1 in sizes:
            rest = -math.prod(sizes)
            sizes[sizes.index(-1)] = self.size // rest if rest else 0
        if math.prod(sizes) != self.size:
            raise ValueError(f"cannot reshape an array of {self.size} elements into {sizes}")
        return ndarray(self.base, sizes, self.dtype, self.at)

    def ravel(self) -> ndarray:
        return self.reshape(-1)

    def transpose(self, order: Sequence[int] | None = None) -> ndarray:
        order = range(self.ndim)[::-1] if order is None else order
        steps, sizes = _steps(self.shape), [self.shape[k] for k in order]
        places = _places([range(0, n * steps[k], steps[k] or 1) for k, n in zip(order, sizes)])
        return ndarray(self.base, sizes, self.dtype, [self.at[i] for i in places])

    # -- elements

    def _chosen(self, key: Any) -> tuple[list[int], list[int], bool]:
        """Return the places and the shape of what a key chooses, and whether a list or an array is in it."""
        keys = list(key) if isinstance(key, tuple) else [key]
        if isinstance(keys[0], ndarray) and keys[0].dtype is bool and keys[0].ndim == self.ndim > 1:
            found = [*compress(self.at, keys[0].flat)]
            return found, [len(found)], True
        new = builtins.sum(k is None for k in keys)
        if keys[0] is Ellipsis:
            keys[:1] = [slice(None)] * (self.ndim - len(keys) + 1 + new)
        axis, steps, ranges, shape, copied = 0, _steps(self.shape), [], [], False
        for k in [*keys, *[slice(None)] * (self.ndim - len(keys) + new)]:
            if k is None:
                shape.append(1)
                continue
            n, step = self.shape[axis], steps[axis]
            axis += 1
            if isinstance(k, slice):
                chosen: Any = range(n)[k]
                shape.append(len(chosen))
            elif isinstance(k, ndarray | list):
                k, copied = asarray(k), True
                chosen = [*compress(range(n), k.flat)] if k.dtype is bool else k.flat
                shape.append(len(chosen))
            else:
                chosen = (range(n)[k],)
            ranges.append([step * (i if i >= 0 else i + n) for i in chosen])
        return [self.at[i] for i in _places(ranges)], shape, copied

    def __getitem__(self, key: Any) -> Any:
        if self.ndim == 1 and isinstance(key, int):
            return self.base[self.at[key]]
        places, shape, copied = self._chosen(key)
        if not shape and len(places) == 1:
            return self.base[places[0]]
        if copied:
            return ndarray([self.base[i] for i in places], shape, self.dtype)
        return ndarray(self.base, shape, self.dtype, places)

    def __setitem__(self, key: Any, value: Any) -> None:
        places, shape, _ = self._chosen(key)
        for i, x in zip(places, broadcast_to(value, shape).flat):
            self.base[i] = self.dtype(x)

    # -- arithmetic

    def __matmul__(self, other: Any) -> Any:
        other = asarray(other)
        a = self.flat if self.size else []
        n = self.shape[-1]
        rows = [a[k : k + n] for k in range(0, len(a), n)] if n else [[]] * math.prod(self.shape[:-1])
        columns = [other.flat] if other.ndim == 1 else [other[:, k].flat for k in range(other.shape[1])]
        if n != other.shape[0]:
            raise ValueError("the sizes of a product differ")
        found = [float(builtins.sum(map(operator.mul, row, column))) for row in rows for column in columns]
        shape = (*self.shape[:-1], *other.shape[1:])
        return ndarray(found, shape, float) if shape else found[0]

    def sum(self, axis: Any = None) -> Any:
        return _reduced(self, axis, builtins.sum)

    def mean(self, axis: Any = None) -> Any:
        return _reduced(self, axis, lambda x: builtins.sum(x) / len(x))

    def max(self, axis: Any = None, initial: Any = None) -> Any:
        return _reduced(self, axis, _largest, initial)

    def min(self, axis: Any = None, initial: Any = None) -> Any:
        return _reduced(self, axis, lambda x: -_largest([-v for v in x]), initial)

    def all(self, axis: Any = None) -> Any:
        return _reduced(self, axis, builtins.all)

    def any(self, axis: Any = None) -> Any:
        return _reduced(self, axis, builtins.any)


def _steps(shape: Sequence[int]) -> list[int]:
    return [math.prod(shape[k + 1 :]) for k in range(len(shape))]


def _places(ranges: Sequence[Sequence[int]]) -> list[int]:
    """Return the sums of one element of each range, the last range fastest."""
    found = [0]
    for steps in ranges:
        found = [i + k for i in found for k in steps]
    return found


def _largest(x: Sequence[Any]) -> Any:
    return nan if builtins.any(v != v for v in x) else builtins.max(x)


def _reduced(x: ndarray, axis: Any, f: Callable[[Any], Any], initial: Any = None) -> Any:
    extra = [] if initial is None else [initial]
    if axis is None:
        return f([*x.flat, *extra])
    axes = {k % x.ndim for k in (axis if isinstance(axis, tuple) else (axis,))}
    kept = [k for k in range(x.ndim) if k not in axes]
    flat, shape = x.transpose([*kept, *axes]).flat, [x.shape[k] for k in kept]
    n, count = math.prod(x.shape[k] for k in axes), math.prod(shape)
    return array([f([*flat[k * n : (k + 1) * n], *extra]) for k in range(count)]).reshape(shape)


def array(x: Any, dtype: Any = None) -> ndarray:
    shape, flat = _parts(x)
    kinds = set(map(type, flat))
    kind = dtype or (kinds.pop() if len(kinds) == 1 else int if kinds == {bool, int} else float)
    return ndarray([kind(v) for v in flat], shape, kind)


def _parts(x: Any) -> tuple[tuple[int, ...], list[Any]]:
    """Return the shape and the elements of nested sequences and arrays."""
    if isinstance(x, ndarray):
        return x.shape, x.flat
    if not isinstance(x, Sequence):
        return (), [x]
    if not x or isinstance(x[0], float | int):
        return (len(x),), [*x]
    parts = [_parts(row) for row in x]
    if len({shape for shape, _ in parts}) > 1:
        raise ValueError("rows of different sizes")
    return (len(x), *parts[0][0]), [v for _, row in parts for v in row]


def asarray(x: Any, dtype: Any = None) -> ndarray:
    return x if isinstance(x, ndarray) and dtype in (None, x.dtype) else array(x, dtype)


# -- functions of elements --------------------------------------------------------------------------


def broadcast_to(x: Any, shape: Any) -> ndarray:
    x, shape = asarray(x), (shape,) if isinstance(shape, int) else tuple(shape)
    if x.shape == shape:
        return x
    sizes = (1,) * (len(shape) - x.ndim) + x.shape
    if len(sizes) != len(shape) or builtins.any(a not in (1, n) for a, n in zip(sizes, shape)):
        raise ValueError(f"cannot broadcast {x.shape} to {shape}")
    pairs = zip(sizes, shape, _steps(sizes))
    places = _places([[0] * n if a == 1 else range(0, n * step, step) for a, n, step in pairs])
    return ndarray(x.base, shape, x.dtype, [x.at[i] for i in places])


def broadcast_arrays(*x: Any) -> list[ndarray]:
    found = [asarray(a) for a in x]
    depth = builtins.max(a.ndim for a in found)
    sizes = [(1,) * (depth - a.ndim) + a.shape for a in found]
    shape = [next((n for n in axis if n != 1), 1) for axis in zip(*sizes)]
    return [broadcast_to(a, shape) for a in found]


def _function(
    f: Callable[..., Any], kind: type | None = float, careful: Callable[..., Any] | None = None
) -> Any:
    """Return a function of arrays and numbers; where `f` has no value for one, `careful` has."""

    def of_elements(*x: Any) -> Any:
        if not builtins.any(isinstance(a, ndarray | list | tuple) for a in x):
            try:
                return f(*x)
            except (ArithmeticError, ValueError):
                return (careful or undefined)(*x)
        first, *others = x
        if isinstance(first, ndarray) and len(x) == 2 and not isinstance(x[1], ndarray | list | tuple):
            shape, flats = first.shape, [first.flat, [x[1]] * first.size]
        else:
            same = isinstance(first, ndarray) and builtins.all(
                isinstance(a, ndarray) and a.shape == first.shape for a in others
            )
            arrays = x if same else broadcast_arrays(*x)
            shape, flats = arrays[0].shape, [a.flat for a in arrays]
        try:
            found = [*map(f, *flats)]
        except (ArithmeticError, ValueError):
            found = [of_elements(*row) for row in zip(*flats)]
        return ndarray(found, shape, kind or (type(found[0]) if found else float))

    def undefined(*_: float) -> float:
        return nan

    return of_elements


def _quotient(a: float, b: float) -> float:
    return nan if a == 0 or a != a or b != b else math.copysign(inf, a) * math.copysign(1.0, b)


def _power(a: float, b: float) -> float:
    if a == 0.0:
        return inf
    if a < 0.0 and b != math.floor(b):
        return nan
    return -inf if a < 0.0 and b % 2 == 1 else inf


def _logarithm(x: float) -> float:
    return -inf if x == 0 else nan


def _larger(a: float, b: float) -> float:
    return a if a >= b or a != a else b


def _smaller(a: float, b: float) -> float:
    return a if a <= b or a != a else b


sin, cos, tan = (_function(f) for f in (math.sin, math.cos, math.tan))
arcsin, arccos, arctan, arctan2 = (_function(f) for f in (math.asin, math.acos, math.atan, math.atan2))
sinh = _function(math.sinh, careful=lambda x: math.copysign(inf, x))
cosh, exp = (_function(f, careful=lambda x: inf) for f in (math.cosh, math.exp))
tanh, sqrt, log = _function(math.tanh), _function(math.sqrt), _function(math.log, careful=_logarithm)
floor = _function(lambda x: float(math.floor(x)), careful=lambda x: x)
sign = _function(lambda x: float((x > 0) - (x < 0)) if x == x else nan)
abs = _function(builtins.abs, None)
power, divide = _function(math.pow, careful=_power), _function(operator.truediv, careful=_quotient)
maximum, minimum = _function(_larger), _function(_smaller)
less, less_equal, equal = (_function(f, bool) for f in (operator.lt, operator.le, operator.eq))
logical_and, logical_or = (
    _function(f, bool) for f in (lambda a, b: bool(a and b), lambda a, b: bool(a or b))
)
logical_not, isfinite = (_function(f, bool) for f in (operator.not_, math.isfinite))
where = _function(lambda c, a, b: a if c else b, None)
clip = _function(lambda x, low, high: builtins.min(builtins.max(x, low), high))
nan_to_num = _function(lambda x: 0.0 if x != x else builtins.min(builtins.max(x, -1.797e308), 1.797e308))
round = _function(lambda x, digits=0: builtins.round(x, digits) if math.isfinite(x) else x)


def _methods() -> None:
    """Give arrays their operators."""
    for name, f in {"add": _function(operator.add, None), "sub": _function(operator.sub, None),
                    "mul": _function(operator.mul, None), "truediv": divide, "pow": power,
                    "and": _function(operator.and_, bool), "or": _function(operator.or_, bool),
                    "lt": less, "le": less_equal, "gt": _function(operator.gt, bool),
                    "ge": _function(operator.ge, bool), "eq": equal, "ne": _function(operator.ne, bool),
                    }.items():  # fmt: skip
        setattr(ndarray, f"__{name}__", lambda a, b, f=f: f(a, b))
        setattr(ndarray, f"__r{name}__", lambda a, b, f=f: f(b, a))
    for name, g in {"neg": _function(operator.neg, None), "invert": logical_not, "abs": abs}.items():
        setattr(ndarray, f"__{name}__", lambda a, g=g: g(a))


_methods()


# -- arrays from numbers and from arrays --------------------------------------------------------------


def full(shape: Any, value: Any, dtype: Any = None) -> ndarray:
    sizes = (shape,) if isinstance(shape, int) else tuple(shape)
    kind = dtype or type(value)
    return ndarray([kind(value)] * math.prod(sizes), sizes, kind)


def zeros(shape: Any, dtype: Any = float) -> ndarray:
    return full(shape, 0, dtype)


def ones(shape: Any) -> ndarray:
    return full(shape, 1.0)


def zeros_like(x: ndarray) -> ndarray:
    return zeros(x.shape)


empty, empty_like = zeros, zeros_like


def eye(n: int) -> ndarray:
    return ndarray([float(i == k) for i in range(n) for k in range(n)], (n, n), float)


def diag(x: Any) -> ndarray:
    x = asarray(x)
    return array([x[k, k] for k in range(len(x))]) if x.ndim == 2 else eye(len(x)) * x


def arange(*ends: int) -> ndarray:
    return array([*range(*ends)], int)


def concatenate(parts: Sequence[Any]) -> ndarray:
    found = [asarray(part) for part in parts]
    kinds = {part.dtype for part in found}
    kind = kinds.pop() if len(kinds) == 1 else float
    flat = [kind(v) for part in found for v in part.flat]
    return ndarray(flat, (builtins.sum(map(len, found)), *found[0].shape[1:]), kind)


def vstack(parts: Sequence[Any]) -> ndarray:
    return concatenate([x if x.ndim > 1 else x[None] for x in map(asarray, parts)])


def column_stack(parts: Sequence[Any]) -> ndarray:
    return concatenate([x.T if x.ndim > 1 else x[None] for x in map(asarray, parts)]).T


def append(x: Any, y: Any) -> ndarray:
    return concatenate([asarray(x).ravel(), asarray(y).ravel()])


def delete(x: Any, k: int) -> ndarray:
    return asarray(x)[[i for i in range(len(x)) if i != k]]


def repeat(x: Any, n: int, axis: int = 0) -> ndarray:
    x = asarray(x)
    places = [i for i in range(x.shape[axis]) for _ in range(n)]
    return x[(*[slice(None)] * axis, places)]


def tile(x: Any, n: int) -> ndarray:
    return concatenate([x] * n) if n else asarray(x)[:0]


def moveaxis(x: ndarray, one: int, to: int) -> ndarray:
    order = [k for k in range(x.ndim) if k != one]
    order.insert(to, one)
    return x.transpose(order)


def triu_indices(n: int, k: int) -> tuple[ndarray, ndarray]:
    pairs = [(i, j) for i in range(n) for j in range(i + k, n)]
    return array([i for i, _ in pairs], int), array([j for _, j in pairs], int)


def triu(x: ndarray, k: int) -> ndarray:
    return where(array([[j >= i + k for j in range(x.shape[1])] for i in range(len(x))]), x, 0.0)


def frombuffer(block: bytes, kind: str, n: int, offset: int) -> ndarray:
    return ndarray([*words("H", block[offset : offset + 2 * n])], (n,), kind)  # type: ignore[arg-type]


# -- of whole arrays ----------------------------------------------------------------------------------


def sum(x: Any, axis: Any = None) -> Any:
    return asarray(x).sum(axis)


def max(x: Any, axis: Any = None, initial: Any = None) -> Any:
    return asarray(x).max(axis, initial)


def all(x: Any) -> bool:
    return bool(asarray(x).all())


def ptp(x: Any, axis: Any = None) -> Any:
    return asarray(x).max(axis) - asarray(x).min(axis)


def _numbers(x: Any) -> Any:
    return [v for v in x if v == v] or [nan]


def nanmax(x: Any, axis: Any = None, initial: Any = None) -> Any:
    return _reduced(asarray(x), axis, lambda v: builtins.max(_numbers(v)), initial)


def nanmin(x: Any, axis: Any = None) -> Any:
    return _reduced(asarray(x), axis, lambda v: builtins.min(_numbers(v)))


def nanmedian(x: Any) -> float:
    v = sorted(_numbers(asarray(x).flat))
    return (v[(len(v) - 1) // 2] + v[len(v) // 2]) / 2.0


def argmax(x: Any) -> int:
    flat = asarray(x).flat
    return flat.index(builtins.max(flat))


def argmin(x: Any) -> int:
    flat = asarray(x).flat
    return flat.index(builtins.min(flat))


def argsort(x: Any, kind: str = "stable") -> ndarray:
    flat = asarray(x).flat
    return array(sorted(range(len(flat)), key=flat.__getitem__), int)


def flatnonzero(x: Any) -> ndarray:
    return array([k for k, v in enumerate(asarray(x).flat) if v], int)


def diff(x: Any) -> ndarray:
    x = asarray(x)
    return x[1:] - x[:-1]


def cumprod(x: Any) -> ndarray:
    return array([*accumulate(asarray(x).flat, operator.mul)])


def allclose(x: Any, y: Any, rtol: float = 1e-5, atol: float = 1e-8) -> bool:
    return bool(less_equal(abs(asarray(x) - y), atol + rtol * abs(asarray(y))).all())


def ndim(x: Any) -> int:
    return len(_parts(x)[0])


def atleast_1d(x: Any) -> ndarray:
    return asarray(x).reshape(-1) if ndim(x) == 0 else asarray(x)


def trace(x: Any) -> float:
    return builtins.sum(diag(x).flat)


def dot(x: Any, y: Any) -> Any:
    return asarray(x) @ asarray(y)


def outer(x: Any, y: Any) -> ndarray:
    return asarray(x).ravel()[:, None] * asarray(y).ravel()


def cross(x: Any, y: Any) -> ndarray:
    a, b = ([v[..., k] for k in range(3)] for v in map(asarray, (x, y)))
    parts = [a[i] * b[j] - a[j] * b[i] for i, j in ((1, 2), (2, 0), (0, 1))]
    return array(parts).T


def einsum(form: str, x: ndarray, y: ndarray) -> Any:
    """Return the sum of products of two arrays over the letters that the result does not have."""
    given, _, kept = form.partition("->")
    letters = kept + "".join(sorted({*given} - {*kept, ","}))
    spread = []
    for names, a in zip(given.split(","), (x, y)):
        order = [names.index(c) for c in letters if c in names]
        spread.append(a.transpose(order)[tuple(slice(None) if c in names else None for c in letters)])
    return (spread[0] * spread[1]).sum(axis=tuple(range(len(kept), len(letters))))


def errstate(**_: str) -> Any:
    return nullcontext()


from numpy import linalg  # noqa: E402, F401
