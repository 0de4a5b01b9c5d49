"""The expressions of `test_arrays.py`, as the process that has only the array functions of the playground
evaluates them: `python arrays.py` prints their values in JSON, and the file of NumPy."""

import json
import math
from typing import Any

import numpy as np


def numbers(*shape: int) -> Any:
    """Return numbers that are the same for each implementation, of both signs and no order."""
    return np.array([math.sin(7.0 * k * k + 1.0) * 3.0 for k in range(math.prod(shape))]).reshape(shape)


A, B, C, V, W = numbers(4, 3), numbers(3, 5), numbers(2, 3, 4), numbers(6), numbers(6) - 0.5
S = A.T @ A
GAPS = np.array([1.0, math.nan, -3.0, math.inf, 0.0, 2.0])
TABLE = {
    "index": "A[1], A[:, 2], A[1:3, ::2], A[..., 1], V[::-2], C[:, 1], C[1, :, 2], V[-1], A[-1][0]",
    "new axes": "V[:, None] * W, V[None, :2], A[:, 1, None]",
    "chosen": (
        "A[np.array([2, 0])], V[V > 0], A[(A > 0).any(axis=1)], C[:, :, np.array([3, 3, 1])], A[A > 0]"
    ),
    "arithmetic": (
        "A + 1, 2 - A, A * A, A / 3, 1 / A, -A, A ** 2, A - A[0], V * W, abs(V), A >= A.T.T, ~(A < 0)"
    ),
    "exceptions": (
        "1.0 / GAPS, GAPS / 0.0, GAPS ** 0.5, np.sqrt(GAPS), np.log(GAPS), np.exp(V * 1e3), "
        "np.power(GAPS, -1.0)"
    ),
    "sums": (
        "A.sum(), A.sum(axis=0), C.sum(axis=(0, 2)), C.mean(axis=1), A.max(axis=1), A.min(), "
        "C.max(axis=(1, 2))"
    ),
    "without NaN": (
        "np.nanmax(GAPS), np.nanmin(GAPS), np.nanmedian(V), np.nanmax(A, axis=0), np.nan_to_num(GAPS[:3])"
    ),
    "largest": (
        "GAPS.max(), np.max(A, axis=1, initial=1.0), np.max(np.zeros((3, 0)), axis=1, initial=0.0), "
        "np.ptp(A, axis=0)"
    ),
    "products": (
        "A @ B, A @ numbers(3), numbers(4) @ A, V @ W, np.dot(V, W), np.outer(V, W), np.cross(A, "
        "A[0]), np.cross(A[0], A[1])"
    ),
    "letters": "np.einsum('rcs,rs->cs', C, numbers(2, 4)), np.einsum('b,bcs->cs', numbers(2), C)",
    "shapes": (
        "C.T, C.transpose((1, 0, 2)), np.moveaxis(C, 2, 0), C.reshape(-1, 4), A.ravel(), "
        "np.zeros((0, 3)).reshape(3, -1)"
    ),
    "together": (
        "np.concatenate([A, A[:1]]), np.column_stack([V, W]), np.column_stack([A, V[:4]]), "
        "np.vstack([A, A[0]]), np.append(V, 1.0)"
    ),
    "apart": (
        "np.delete(np.arange(5), 2), np.repeat(V[:2], 3), np.repeat(A[None], 2, 0), np.tile(V[:2], "
        "2), np.diff(V), np.triu(S, 1)"
    ),
    "made": (
        "np.full(3, 2.0), np.eye(3), np.diag(S), np.diag(V[:2]), np.arange(1, 4), np.ones(2), "
        "np.triu_indices(4, 1), np.zeros_like(A)"
    ),
    "places": (
        "np.argmax(V), np.argmin(V), np.argsort(V, kind='stable'), np.flatnonzero(V > 0), "
        "np.where(A > 0, A, 0.0), np.sign(GAPS[[0, 2, 4]])"
    ),
    "functions": (
        "np.sin(A), np.arctan2(V, W), np.floor(V), np.cosh(V), np.minimum(V, 0.5), np.maximum(V, W)"
    ),
    "truth": (
        "np.isfinite(GAPS), np.isfinite(A).all(axis=1), np.logical_and(V > 0, W > 0), np.allclose(A, "
        "A + 1e-12), np.less(V, W), np.equal(V, V)"
    ),
    "small": (
        "np.clip(V, -1, 1), np.round(V, 3), np.cumprod(V), np.trace(S), np.ndim(A), "
        "np.atleast_1d(2.0), np.broadcast_to(V[:1], 3)"
    ),
    "16 bits": ("np.frombuffer(np.round(abs(V) * 100).astype('<u2').tobytes(), '<u2', 3, 4).astype(float)"),
    "lengths": (
        "np.linalg.norm(A), np.linalg.norm(A, axis=0), np.linalg.norm(C, axis=1), np.linalg.det(S), "
        "np.linalg.matrix_rank(A, tol=1e-9)"
    ),
    "values": (
        "np.linalg.svd(A, compute_uv=False), np.linalg.svd(A.T)[1], np.linalg.eigvalsh(S), "
        "np.linalg.svd(np.outer(V, W))[1][:1]"
    ),
    "solutions": (
        "np.linalg.solve(S, V[:3]), np.linalg.lstsq(A, V[:4], rcond=1e-9)[0], np.linalg.lstsq(A.T, "
        "V[:3], rcond=1e-9)[0], np.linalg.lstsq(np.outer(V, W), V, rcond=1e-9)[0]"
    ),
    "spaces": (
        "(lambda u, s, v: (u[:, :3] * s) @ v)(*np.linalg.svd(A)), (lambda u, s, "
        "v: (u * s) @ v[:3])(*np.linalg.svd(A.T)), (lambda w, q: (q * w) @ q.T)(*np.linalg.eigh(S))"
    ),
    "bases": (
        "[np.round(abs(x @ x.T), 9) for u, s, v in [np.linalg.svd(A), np.linalg.svd(np.outer(V, "
        "W))] for x in (u, v)]"
    ),
    "many": "np.linalg.eigh(np.array([S.tolist(), (S + np.eye(3)).tolist()]))[0]",
}


def plain(x: Any) -> Any:
    if isinstance(x, tuple | list):
        return [plain(v) for v in x]
    found = x.tolist() if hasattr(x, "tolist") else x
    return json.loads(json.dumps(found))


def changed() -> list[Any]:
    """Return arrays after assignments, through views too."""
    x, y, z = numbers(3, 4), numbers(3, 4), np.zeros((2, 3))
    x[1] = 0.0
    x[:, 2] /= 2.0
    x[x > 1.0] = 1.0
    for row, other in zip(z, y):
        row[:] = other[:3]
    y[1:] *= np.array([1.0, -1.0])[:, None]
    return [x, y, z]


def evaluated() -> dict[str, Any]:
    with np.errstate(all="ignore"):
        found = {name: plain(eval(f"[{text}]")) for name, text in TABLE.items()}
    return found | {"assigned": plain(changed())}


if __name__ == "__main__":
    print(json.dumps({"file": np.__file__, "found": evaluated()}))
