"""Print the constants of `lagc/kernels/arithmetic/trigonometry.py`: the parts of pi/2, the digits of 2/pi,
and the coefficients of both polynomials.

    python tools/trigonometry.py

sin x = x + x^3 p(x^2), cos x = 1 - x^2/2 + x^4 r(x^2) over |x| <= WIDEST.  Each polynomial is that of least
largest error relative to the function (E. Remez 1934), in 60 digits; then its coefficients become doubles one
after the other, the first first, and those behind it are chosen again: they make up for its rounding.
"""

from __future__ import annotations

from collections.abc import Callable

import mpmath
from mpmath import mp, mpf

DIGITS, WIDEST, DEGREE, GRID = 60, "0.79", 5, 200


def rounded(value: mpf, bits: int = 53) -> mpf:
    with mp.workprec(bits):
        return +value


def half_pi() -> dict[str, mpf]:
    """pi/2 in parts: of 33 bits and the rest; of twice 33 and the rest; of 26, 27 and the rest."""
    with mp.workdps(DIGITS):
        whole = mp.pi / 2
        first = rounded(whole, 33)
        second = rounded(whole - first, 33)
        double = rounded(whole)
        above = rounded(whole, 26)
        return {
            "QUARTERS_PER_RADIAN": rounded(1 / whole),
            "FIRST_PART": first,
            "FIRST_REST": rounded(whole - first),
            "SECOND_PART": second,
            "SECOND_REST": rounded(whole - first - second),
            "HALF_PI": double,
            "HALF_PI_REST": rounded(whole - double),
            "HALF_PI_ABOVE": above,
            "HALF_PI_BELOW": double - above,
        }


def two_over_pi(digits: int = 50) -> list[int]:
    """Its first digits to the base 2^24, behind the point; four zeros before them."""
    with mp.workprec(24 * digits + 60):
        whole = int(mpmath.floor(2 / mp.pi * mpf(2) ** (24 * digits)))
    return [whole >> 24 * (digits - k) & 0xFFFFFF for k in range(-3, digits + 1)]


def refined(fixed: list[mpf], series: list[mpf], weight: Callable[[mpf], mpf]) -> list[mpf]:
    """The coefficients behind `fixed` of the polynomial of DEGREE whose error against `series`, times
    `weight`, is least at its largest."""
    n = DEGREE + 1 - len(fixed)
    end = mpf(WIDEST) ** 2
    points = [end * (1 - mpmath.cos(mp.pi * (k + mpf("0.5")) / GRID)) / 2 for k in range(GRID)]
    known = [(z, mpmath.polyval(series[::-1], z), weight(z)) for z in points]
    places = [round((GRID - 1) * k / n) for k in range(n + 1)]
    while True:
        rows, right = [], []
        for k, i in enumerate(places):
            z, value, w = known[i]
            rows.append([z ** (len(fixed) + m) for m in range(n)] + [(-1) ** k / w])
            right.append(value - mpmath.polyval([*fixed[::-1], 0], z) / z)
        found = list(mpmath.lu_solve(mpmath.matrix(rows), mpmath.matrix(right)))[:n]
        whole = [*fixed, *found]
        moved = extrema([(mpmath.polyval(whole[::-1], z) - value) * w for z, value, w in known], n + 1)
        if moved == places:
            return found
        places = moved


def extrema(errors: list[mpf], count: int) -> list[int]:
    """Where errors of alternating sign are largest; while they are more, the smaller at an end goes."""
    found: list[int] = []
    for i, error in enumerate(errors):
        if not found or (error > 0) != (errors[found[-1]] > 0):
            found.append(i)
        elif abs(error) > abs(errors[found[-1]]):
            found[-1] = i
    while len(found) > count:
        found.pop(0 if abs(errors[found[0]]) < abs(errors[found[-1]]) else -1)
    return found


def polynomial(first: int, power: int) -> list[mpf]:
    """Of the Taylor series of sin x / x (first = 1) or cos x (0), in z = x^2, what stands behind z^power."""
    with mp.workdps(DIGITS):
        taylor = [(-1) ** k / mpmath.factorial(2 * k + first) for k in range(30)]
        fixed = list[mpf]()
        while len(fixed) <= DEGREE:
            found = refined(fixed, taylor[power:], lambda z: z**power / mpmath.polyval(taylor[::-1], z))
            fixed.append(rounded(found[0]))
        return fixed


def constants() -> dict[str, float | tuple[float, ...]]:
    """Each by its name in the kernel."""
    found: dict[str, float | tuple[float, ...]] = {name: float(value) for name, value in half_pi().items()}
    found |= {f"SINE_{k}": float(value) for k, value in enumerate(polynomial(1, 1))}
    found |= {f"COSINE_{k}": float(value) for k, value in enumerate(polynomial(0, 2))}
    return found | {"TWO_OVER_PI": tuple(float(digit) for digit in two_over_pi())}


if __name__ == "__main__":
    for name, value in constants().items():
        print(f"{name} = {value!r}")
