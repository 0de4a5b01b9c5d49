"""LU factorization of dense matrices with partial pivoting, real and complex.

G. H. Golub, C. F. Van Loan, Matrix Computations, 2013, section 3.4. A complex matrix is two real ones.
"""

from math import fabs

from lagc.kernels.language.vocabulary import *


def factor_real(a: Vec[NFACTORS], pivots: IVec[NLINEAR]) -> bool:
    """Replace a by its factors L and U; return whether it is regular."""
    # Column k: the largest entry on or below the diagonal comes first; whole rows are exchanged, with their
    # factors.
    for k in range(NLINEAR):
        best = k
        for i in range(k + 1, NLINEAR):
            if fabs(a[i * NLINEAR + k]) > fabs(a[best * NLINEAR + k]):
                best = i
        pivots[k] = best
        if best != k:
            for j in range(NLINEAR):
                other = a[k * NLINEAR + j]
                a[k * NLINEAR + j] = a[best * NLINEAR + j]
                a[best * NLINEAR + j] = other
        if not fabs(a[k * NLINEAR + k]) > 0.0:
            return False
        # Gaussian elimination of the rows below. Zero factors, as in block structures, are skipped.
        for i in range(k + 1, NLINEAR):
            factor = a[i * NLINEAR + k] / a[k * NLINEAR + k]
            a[i * NLINEAR + k] = factor
            if factor != 0.0:
                for j in range(k + 1, NLINEAR):
                    a[i * NLINEAR + j] -= factor * a[k * NLINEAR + j]
    return True


def solve_real(a: Vec[NFACTORS], pivots: IVec[NLINEAR], r: Vec[NLINEAR]) -> None:
    """Replace r by the solution of L U s = r."""
    # All exchanges first, then L (unit diagonal), then U.
    for k in range(NLINEAR):
        other = r[pivots[k]]
        r[pivots[k]] = r[k]
        r[k] = other
    for k in range(NLINEAR):
        for j in range(k):
            r[k] -= a[k * NLINEAR + j] * r[j]
    for k in range(NLINEAR - 1, -1, -1):
        for j in range(k + 1, NLINEAR):
            r[k] -= a[k * NLINEAR + j] * r[j]
        r[k] /= a[k * NLINEAR + k]


def magnitude(re: Real, im: Real) -> Real:
    """Return a size of a complex number."""
    return fabs(re) + fabs(im)


def factor_complex(re: Vec[NFACTORS], im: Vec[NFACTORS], pivots: IVec[NLINEAR]) -> bool:
    """Replace re + i im by its factors; return whether it is regular. The diagonal of U is inverted."""
    for k in range(NLINEAR):
        # Partial pivoting by |re| + |im|.
        best = k
        for i in range(k + 1, NLINEAR):
            if magnitude(re[i * NLINEAR + k], im[i * NLINEAR + k]) > magnitude(
                re[best * NLINEAR + k], im[best * NLINEAR + k]
            ):
                best = i
        pivots[k] = best
        if best != k:
            for j in range(NLINEAR):
                other = re[k * NLINEAR + j]
                re[k * NLINEAR + j] = re[best * NLINEAR + j]
                re[best * NLINEAR + j] = other
                other = im[k * NLINEAR + j]
                im[k * NLINEAR + j] = im[best * NLINEAR + j]
                im[best * NLINEAR + j] = other
        # The inverse of the pivot, scaled first so that its square does not overflow.
        largest = magnitude(re[k * NLINEAR + k], im[k * NLINEAR + k])
        if not largest > 0.0:
            return False
        own = re[k * NLINEAR + k] / largest
        turned = im[k * NLINEAR + k] / largest
        length = largest * (own * own + turned * turned)
        re[k * NLINEAR + k] = own / length
        im[k * NLINEAR + k] = -turned / length
        # Subtract the row from those below: the factor is the entry times this inverse.
        for i in range(k + 1, NLINEAR):
            own = re[i * NLINEAR + k] * re[k * NLINEAR + k] - im[i * NLINEAR + k] * im[k * NLINEAR + k]
            turned = re[i * NLINEAR + k] * im[k * NLINEAR + k] + im[i * NLINEAR + k] * re[k * NLINEAR + k]
            re[i * NLINEAR + k] = own
            im[i * NLINEAR + k] = turned
            if own != 0.0 or turned != 0.0:
                for j in range(k + 1, NLINEAR):
                    re[i * NLINEAR + j] -= own * re[k * NLINEAR + j] - turned * im[k * NLINEAR + j]
                    im[i * NLINEAR + j] -= own * im[k * NLINEAR + j] + turned * re[k * NLINEAR + j]
    return True


def solve_complex(
    re: Vec[NFACTORS], im: Vec[NFACTORS], pivots: IVec[NLINEAR], r: Vec[NLINEAR],
    s: Vec[NLINEAR],
) -> None:  # fmt: skip
    """Replace r + i s by the solution."""
    # The same order as for real factors; the diagonal of U is inverted already.
    for k in range(NLINEAR):
        own = r[pivots[k]]
        turned = s[pivots[k]]
        r[pivots[k]] = r[k]
        s[pivots[k]] = s[k]
        r[k] = own
        s[k] = turned
    for k in range(NLINEAR):
        for j in range(k):
            r[k] -= re[k * NLINEAR + j] * r[j] - im[k * NLINEAR + j] * s[j]
            s[k] -= re[k * NLINEAR + j] * s[j] + im[k * NLINEAR + j] * r[j]
    for k in range(NLINEAR - 1, -1, -1):
        for j in range(k + 1, NLINEAR):
            r[k] -= re[k * NLINEAR + j] * r[j] - im[k * NLINEAR + j] * s[j]
            s[k] -= re[k * NLINEAR + j] * s[j] + im[k * NLINEAR + j] * r[j]
        own = r[k]
        r[k] = own * re[k * NLINEAR + k] - s[k] * im[k * NLINEAR + k]
        s[k] = own * im[k * NLINEAR + k] + s[k] * re[k * NLINEAR + k]
