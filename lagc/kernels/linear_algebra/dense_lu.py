"""LU factorization of dense matrices with partial pivoting, real and complex.

G. H. Golub, C. F. Van Loan, Matrix Computations, 2013, section 3.4. A complex matrix is two real ones.
"""

from math import fabs

from lagc.kernels.language.vocabulary import *


def factor_real(a: Vec[NSLOPES], pivots: IVec[NNEWTON]) -> bool:
    """Replace a by its factors L and U; return whether it is regular."""
    for k in range(NNEWTON):
        best = k
        for i in range(k + 1, NNEWTON):
            if fabs(a[i * NNEWTON + k]) > fabs(a[best * NNEWTON + k]):
                best = i
        pivots[k] = best
        if best != k:
            for j in range(NNEWTON):
                other = a[k * NNEWTON + j]
                a[k * NNEWTON + j] = a[best * NNEWTON + j]
                a[best * NNEWTON + j] = other
        if not fabs(a[k * NNEWTON + k]) > 0.0:
            return False
        for i in range(k + 1, NNEWTON):
            factor = a[i * NNEWTON + k] / a[k * NNEWTON + k]
            a[i * NNEWTON + k] = factor
            if factor != 0.0:
                for j in range(k + 1, NNEWTON):
                    a[i * NNEWTON + j] -= factor * a[k * NNEWTON + j]
    return True


def solve_real(a: Vec[NSLOPES], pivots: IVec[NNEWTON], r: Vec[NNEWTON]) -> None:
    """Replace r by the solution of L U s = r."""
    for k in range(NNEWTON):
        other = r[pivots[k]]
        r[pivots[k]] = r[k]
        r[k] = other
    for k in range(NNEWTON):
        for j in range(k):
            r[k] -= a[k * NNEWTON + j] * r[j]
    for k in range(NNEWTON - 1, -1, -1):
        for j in range(k + 1, NNEWTON):
            r[k] -= a[k * NNEWTON + j] * r[j]
        r[k] /= a[k * NNEWTON + k]


def magnitude(re: Real, im: Real) -> Real:
    """Return a size of a complex number."""
    return fabs(re) + fabs(im)


def factor_complex(re: Vec[NSLOPES], im: Vec[NSLOPES], pivots: IVec[NNEWTON]) -> bool:
    """Replace re + i im by its factors; return whether it is regular. The diagonal of U is inverted."""
    for k in range(NNEWTON):
        best = k
        for i in range(k + 1, NNEWTON):
            if magnitude(re[i * NNEWTON + k], im[i * NNEWTON + k]) > magnitude(
                re[best * NNEWTON + k], im[best * NNEWTON + k]
            ):
                best = i
        pivots[k] = best
        if best != k:
            for j in range(NNEWTON):
                other = re[k * NNEWTON + j]
                re[k * NNEWTON + j] = re[best * NNEWTON + j]
                re[best * NNEWTON + j] = other
                other = im[k * NNEWTON + j]
                im[k * NNEWTON + j] = im[best * NNEWTON + j]
                im[best * NNEWTON + j] = other
        largest = magnitude(re[k * NNEWTON + k], im[k * NNEWTON + k])
        if not largest > 0.0:
            return False
        own = re[k * NNEWTON + k] / largest
        turned = im[k * NNEWTON + k] / largest
        length = largest * (own * own + turned * turned)
        re[k * NNEWTON + k] = own / length
        im[k * NNEWTON + k] = -turned / length
        for i in range(k + 1, NNEWTON):
            own = re[i * NNEWTON + k] * re[k * NNEWTON + k] - im[i * NNEWTON + k] * im[k * NNEWTON + k]
            turned = re[i * NNEWTON + k] * im[k * NNEWTON + k] + im[i * NNEWTON + k] * re[k * NNEWTON + k]
            re[i * NNEWTON + k] = own
            im[i * NNEWTON + k] = turned
            if own != 0.0 or turned != 0.0:
                for j in range(k + 1, NNEWTON):
                    re[i * NNEWTON + j] -= own * re[k * NNEWTON + j] - turned * im[k * NNEWTON + j]
                    im[i * NNEWTON + j] -= own * im[k * NNEWTON + j] + turned * re[k * NNEWTON + j]
    return True


def solve_complex(
    re: Vec[NSLOPES], im: Vec[NSLOPES], pivots: IVec[NNEWTON], r: Vec[NNEWTON],
    s: Vec[NNEWTON],
) -> None:  # fmt: skip
    """Replace r + i s by the solution."""
    for k in range(NNEWTON):
        own = r[pivots[k]]
        turned = s[pivots[k]]
        r[pivots[k]] = r[k]
        s[pivots[k]] = s[k]
        r[k] = own
        s[k] = turned
    for k in range(NNEWTON):
        for j in range(k):
            r[k] -= re[k * NNEWTON + j] * r[j] - im[k * NNEWTON + j] * s[j]
            s[k] -= re[k * NNEWTON + j] * s[j] + im[k * NNEWTON + j] * r[j]
    for k in range(NNEWTON - 1, -1, -1):
        for j in range(k + 1, NNEWTON):
            r[k] -= re[k * NNEWTON + j] * r[j] - im[k * NNEWTON + j] * s[j]
            s[k] -= re[k * NNEWTON + j] * s[j] + im[k * NNEWTON + j] * r[j]
        own = r[k]
        r[k] = own * re[k * NNEWTON + k] - s[k] * im[k * NNEWTON + k]
        s[k] = own * im[k * NNEWTON + k] + s[k] * re[k * NNEWTON + k]
