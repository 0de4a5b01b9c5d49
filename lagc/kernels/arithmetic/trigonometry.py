"""Sine and cosine with the same bits on every machine.

They consist of sums, products and comparisons, and have an error below one unit in the last place. An
angle is reduced to a multiple of pi/2 and a remainder hi + lo of at most pi/4, for which there are two
polynomials. `tools/trigonometry.py` computes the constants.

W. J. Cody, W. Waite, Software Manual for the Elementary Functions, Prentice-Hall 1980: pi/2 in parts.
M. Hanek, R. Payne, Radian reduction for trigonometric functions, SIGNUM Newsletter 18, 1983: large angles.
T. J. Dekker, A floating-point technique for extending the available precision, Numer. Math. 18, 1971.
"""

from math import fabs, inf

from lagc.kernels.language.vocabulary import *

EIGHTH_TURN = 0.785  # pi/4, rounded down: smaller angles are not reduced
# Squares of: the largest remainder of the polynomials; the angle above which the parts of pi/2 have too few
# digits; the share of an angle below which a remainder has lost digits; a remainder of arithmetic with more
# digits than a double, where a sum with ROUNDER is rounded to 2^-11 only.
WIDEST_SQUARE = 0.79 * 0.79
FAR_SQUARE = 1e5 * 1e5
NEAR_SQUARE = 3e-8 * 3e-8
UNROUNDED_SQUARE = 1e-3 * 1e-3
ROUNDER = 6755399441055744.0  # 1.5 2^52: a sum with it is rounded to an integer
QUARTERS_PER_RADIAN = 0.6366197723675814  # 2/pi
# pi/2 in parts of 33 bits, whose products with small integers are exact
FIRST_PART = 1.5707963267341256
FIRST_REST = 6.077100506506192e-11
SECOND_PART = 6.077100506303966e-11
SECOND_REST = 2.0222662487959506e-21
# pi/2 again, and its first 26 bits
HALF_PI = 1.5707963267948966
HALF_PI_REST = 6.123233995736766e-17
HALF_PI_ABOVE = 1.5707963407039642
HALF_PI_BELOW = -1.3909067675399456e-08
SPLITTER = 134217729.0  # 2^27 + 1
RADIX = 16777216.0  # 2^24
PER_RADIX = 1.0 / 16777216.0
# sin x = x + x^3 (SINE_0 + SINE_1 x^2 ...), cos x = 1 - x^2/2 + x^4 (COSINE_0 + COSINE_1 x^2 ...)
SINE_0 = -0.16666666666666627
SINE_1 = 0.008333333333321128
SINE_2 = -0.00019841269828771918
SINE_3 = 2.7557313330117316e-06
SINE_4 = -2.5050701073205687e-08
SINE_5 = 1.5893466232363824e-10
COSINE_0 = 0.04166666666666659
COSINE_1 = -0.0013888888888872167
COSINE_2 = 2.480158728827483e-05
COSINE_3 = -2.7557314007400403e-07
COSINE_4 = 2.0875676847661014e-09
COSINE_5 = -1.1357264885953852e-11
# digits of 2/pi to the base 2^24, after four zeros
TWO_OVER_PI = (
    0.0, 0.0, 0.0, 0.0, 10680707.0, 7228996.0, 1387004.0, 2578385.0, 16069853.0,
    12639074.0, 9804092.0, 4427841.0, 16666979.0, 11263675.0, 12935607.0, 2387514.0, 4345298.0, 14681673.0,
    3074569.0, 13734428.0, 16653803.0, 1880361.0, 10960616.0, 8533493.0, 3062596.0, 8710556.0, 7349940.0,
    6258241.0, 3772886.0, 3769171.0, 3798172.0, 8675211.0, 12450088.0, 3874808.0, 9961438.0, 366607.0,
    15675153.0, 9132554.0, 7151469.0, 3571407.0, 2607881.0, 12013382.0, 4155038.0, 6285869.0, 7677882.0,
    13102053.0, 15825725.0, 473591.0, 9065106.0, 15363067.0, 6271263.0, 9264392.0, 5636912.0, 4652155.0,
)  # fmt: skip


def rounding_error_of_sum(a: Real, b: Real, total: Real) -> Real:
    """Return the rounding error of the sum of a and b (D. E. Knuth, The Art of Computer Programming 2,
    section 4.2.2)."""
    share = total - a
    return (a - (total - share)) + (b - share)


def reduce_near(x: Real, rest: Vec[TWO]) -> Real:
    """Reduce x, |x| < 1e5, by the multiple n of pi/2, which is returned. For angles near such a multiple,
    and for machines that do not round to the nearest double."""
    # n to the nearest by truncation, which does not depend on the rounding mode.
    n = float(whole(fabs(x) * QUARTERS_PER_RADIAN + 0.5))
    if x < 0.0:
        n = -n
    # x - n pi/2 in three parts; the first two products are exact (33 bits times a small integer), and the
    # errors of both sums are kept.
    a = x - n * FIRST_PART
    b = -(n * SECOND_PART)
    c = -(n * SECOND_REST)
    total = a + b
    hi = total + c
    lo = rounding_error_of_sum(a, b, total) + rounding_error_of_sum(total, c, hi)
    rest[0] = hi + lo
    rest[1] = lo - (rest[0] - hi)
    return n


def times_half_pi(a: Real, more: Real, rest: Vec[TWO]) -> None:
    """Compute (a + more) pi/2, with an exact product of the first two (T. J. Dekker)."""
    # Dekker's product: both factors split into halves of 26 bits, whose products are exact.
    shifted = SPLITTER * a
    above = shifted - (shifted - a)
    below = a - above
    value = a * HALF_PI
    error = (
        (above * HALF_PI_ABOVE - value) + above * HALF_PI_BELOW + below * HALF_PI_ABOVE
    ) + below * HALF_PI_BELOW
    error += a * HALF_PI_REST + more * HALF_PI
    rest[0] = value + error
    rest[1] = error - (rest[0] - value)


def reduce_far(x: Real, rest: Vec[TWO]) -> Real:
    """Reduce any x; return n modulo 4, and NaN as the remainder of a number that is not finite. The digits
    of |x| = 2^24k (y0 + y1 2^-24 + ...) are multiplied by those of 2/pi. Multiples of 2^24 and digits below
    2^-144 are left out: no double is nearer to a multiple of pi/2 than 2^-62."""
    if not fabs(x) < inf:
        rest[0] = x - x
        rest[1] = 0.0
        return 0.0
    # |x| as four digits to the base 2^24, the first of weight 2^24k.
    y = fabs(x)
    k = 0
    while y >= RADIX:
        y *= PER_RADIX
        k += 1
    digits = vector(FOUR)
    for i in range(4):
        digits[i] = float(whole(y))
        y = (y - digits[i]) * RADIX
    # Seven digits of |x| 2/pi, from the last one on, with carries: all sums are integers below 2^53.
    product = vector(SEVEN)
    carried = 0.0
    for i in range(6, -1, -1):
        value = carried
        for j in range(4):
            value += digits[j] * TWO_OVER_PI[k + i - j + 3]
        carried = float(whole(value * PER_RADIX))
        product[i] = value - carried * RADIX
    # The integer part gives the quadrant, the rest is the remainder over pi/2.
    n = float(whole(product[0]) & 3)
    if product[1] >= 0.5 * RADIX:  # to the nearest
        n += 1.0
        product[1] -= RADIX
    # The digits as hi + lo, largest first, so that each sum loses nothing.
    first = product[1] + product[2] * PER_RADIX
    second = (product[3] + product[4] * PER_RADIX) * PER_RADIX * PER_RADIX
    third = (product[5] + product[6] * PER_RADIX) * PER_RADIX * PER_RADIX * PER_RADIX * PER_RADIX
    hi = first + second
    lo = second - (hi - first) + third
    times_half_pi((hi + lo) * PER_RADIX, (lo - ((hi + lo) - hi)) * PER_RADIX, rest)
    if x < 0.0:
        n = -n
        rest[0] = -rest[0]
        rest[1] = -rest[1]
    return n


@inline
def polynomials(hi: Real, lo: Real) -> Pair:
    """Return the sine and cosine of a remainder hi + lo."""
    # The polynomials at hi, by Estrin's scheme, and lo to first order: sin(hi + lo) = sin hi + lo cos hi.
    z = hi * hi
    half = 0.5 * z
    rough = 1.0 - half
    zz = z * z
    zzz = z * zz
    p = (SINE_0 + z * (SINE_1 + z * SINE_2)) + zzz * (SINE_3 + z * (SINE_4 + z * SINE_5))
    r = (COSINE_0 + z * (COSINE_1 + z * COSINE_2)) + zzz * (COSINE_3 + z * (COSINE_4 + z * COSINE_5))
    return hi + (z * hi * p + lo * rough), rough + (((1.0 - rough) - half) + (zz * r - hi * lo))


@inline
def turn(n: Real, sine: Real, cosine: Real) -> Pair:
    """Return the sine and cosine of an angle that is n pi/2 larger."""
    quarters = whole(n)
    s = cosine if quarters & 1 != 0 else sine
    c = -sine if quarters & 1 != 0 else cosine
    return -s if quarters & 2 != 0 else s, -c if quarters & 2 != 0 else c


@inline
def reduce(x: Real, rest: Vec[TWO]) -> Real:
    """Reduce x by the multiple n of pi/2, which is returned, in two parts (Cody and Waite); an angle below an
    eighth turn is its own remainder. It is valid if `is_reduced`."""
    n = (x * QUARTERS_PER_RADIAN + ROUNDER) - ROUNDER
    above = x - n * FIRST_PART  # the product is exact
    below = n * FIRST_REST
    rest[0] = above - below
    rest[1] = (above - rest[0]) - below
    return n


@inline
def is_reduced(x: Real, hi: Real) -> bool:
    """Return whether the remainder of an angle above an eighth turn has all digits."""
    xx = x * x
    z = hi * hi
    return xx < FAR_SQUARE and z >= NEAR_SQUARE * xx + UNROUNDED_SQUARE and z <= WIDEST_SQUARE


def sine_cosine(x: Real) -> Pair:
    """Return sin x and cos x."""
    n = 0.0
    rest = vector(TWO)
    rest[0] = x
    rest[1] = 0.0
    if x > EIGHTH_TURN or x < -EIGHTH_TURN:
        n = reduce(x, rest)
        # More parts where digits cancel, all of 2/pi for large angles.
        if not is_reduced(x, rest[0]):
            n = reduce_near(x, rest) if x * x < FAR_SQUARE else reduce_far(x, rest)
    elif x * x == 0.0:
        return x, 1.0  # zero keeps its sign
    pair = vector(TWO)
    pair[0:2] = polynomials(rest[0], rest[1])
    pair[0:2] = turn(n, pair[0], pair[1])
    return pair[0], pair[1]


def sine_cosine_two(x: Real, y: Real, pairs: Vec[FOUR]) -> None:
    """Compute sin x, cos x, sin y, cos y with the bits of `sine_cosine`, in loops over both that C
    compilers vectorize. Two angles that need no reduction are faster one by one."""
    if fabs(x) <= EIGHTH_TURN and fabs(y) <= EIGHTH_TURN:
        pairs[0:2] = sine_cosine(x)
        pairs[2:4] = sine_cosine(y)
        return
    angle = vector(TWO)
    n = vector(TWO)
    hi = vector(TWO)
    lo = vector(TWO)
    sine = vector(TWO)
    cosine = vector(TWO)
    pair = vector(TWO)
    angle[0] = x
    angle[1] = y
    for i in range(2):
        n[i] = reduce(angle[i], pair)
        hi[i] = pair[0]
        lo[i] = pair[1]
    # If one of them needs another reduction, both go one by one.
    if not (is_reduced(x, hi[0]) and is_reduced(y, hi[1])):
        pairs[0:2] = sine_cosine(x)
        pairs[2:4] = sine_cosine(y)
        return
    for i in range(2):
        pair[0:2] = polynomials(hi[i], lo[i])
        sine[i] = pair[0]
        cosine[i] = pair[1]
    for i in range(2):
        pair[0:2] = turn(n[i], sine[i], cosine[i])
        pairs[2 * i] = pair[0]
        pairs[2 * i + 1] = pair[1]


def sine_cosine_near(x: Real, pair: Out[TWO]) -> bool:
    """Compute sin x and cos x with the bits of `sine_cosine`, without branches, for vectors of angles. Return
    whether the angle needs no further reduction; else they are not valid."""
    rest = vector(TWO)
    n = reduce(x, rest)
    pair[0:2] = polynomials(rest[0], rest[1])
    sine = x if x * x == 0.0 else pair[0]  # zero keeps its sign
    pair[0:2] = turn(n, sine, pair[1])
    small = x <= EIGHTH_TURN and x >= -EIGHTH_TURN
    return small or is_reduced(x, rest[0])
