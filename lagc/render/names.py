"""Identifiers of generated code: a user's names, made harmless and unique, in a fixed order."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Iterable

# Of C, C++ and Python.
_KEYWORDS = """
    auto break case char const continue default do double else enum extern float for goto if inline int
    long register restrict return short signed sizeof static struct switch typedef union unsigned void
    volatile while alignas alignof and and_eq asm bitand bitor bool catch char8_t char16_t char32_t class
    co_await co_return co_yield compl concept const_cast consteval constexpr constinit decltype delete
    dynamic_cast explicit export false friend mutable namespace new noexcept not not_eq nullptr operator
    or or_eq private protected public reinterpret_cast requires static_assert static_cast template this
    thread_local throw true try typeid typename typeof typeof_unqual using virtual wchar_t xor xor_eq
    False None True as assert async await def del elif except finally from global import in is lambda
    nonlocal pass raise with yield match type
"""
# Functions and macros of the headers of C and POSIX, names of the generated support, words of compilers.
_LIBRARY = """
    acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh erf erfc exp exp2 expm1 fabs fdim
    floor fma fmax fmin fmod frexp hypot ilogb ldexp lgamma llrint llround log log10 log1p log2 logb lrint
    lround modf nan nearbyint nextafter nexttoward pow remainder remquo rint round scalbln scalbn signbit
    sin sinh sqrt tan tanh tgamma trunc fpclassify isfinite isinf isnan isnormal isgreater isless
    isunordered j0 j1 jn y0 y1 yn gamma gamma_r signgam drem significand finite scalb pow10 abs labs div
    exit abort index rindex time clock signal memcpy memset memmove strlen printf main min max select sign
    both either inverse math self float_t double_t size_t ptrdiff_t NULL EOF NAN INFINITY HUGE HUGE_VAL
    HUGE_VALF HUGE_VALL MATH_ERRNO math_errhandling MAXFLOAT DOMAIN OVERFLOW UNDERFLOW SING PLOSS TLOSS
    X_TLOSS I TRUE FALSE BUFSIZ CHAR_BIT ERANGE EDOM errno stdin stdout stderr complex imaginary noreturn
    offsetof va_list linux unix i386 near far huge small interface INTERFACE IN OUT OPTIONAL ERROR CONST
    VOID DELETE OVERFLOW_ M_E M_LOG2E M_LOG10E M_LN2 M_LN10 M_PI M_PI_2 M_PI_4 M_1_PI M_2_PI M_2_SQRTPI
    M_SQRT2 M_SQRT1_2 FP_NAN FP_INFINITE FP_ZERO FP_SUBNORMAL FP_NORMAL FP_FAST_FMA FP_ILOGB0 FP_ILOGBNAN
    DBL_MAX DBL_MIN DBL_EPSILON FLT_MAX FLT_MIN FLT_EPSILON INT_MAX INT_MIN
"""
RESERVED = frozenset(_KEYWORDS.split()) | frozenset(_LIBRARY.split())
# Macros that the headers of some C library define without being asked to.
_MACRO = re.compile(
    r"(M_|FP_|HUGE_|SNAN|MATH_|U?INT|EXIT_|W[A-Z]{4})[A-Za-z0-9_]*|[A-Z0-9_]*_(MAX|MIN|WIDTH|ENDIAN|ORDER)"
    r"|FD_SETSIZE|NFDBITS"
)
_HEADERS = """
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign
    stdarg stdatomic stdbool stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar
    wchar wctype memory malloc unistd new con aux nul prn
"""
HEADERS = frozenset(_HEADERS.split())  # names that a model's files must not take


def identifier(name: str) -> str:
    """`name` with letters, digits and single underscores only, not reserved: `der(theta)` is
    `der_theta`, `link[2].phi` is `link_2_phi`."""
    spelled = "".join(_spell(c) for c in unicodedata.normalize("NFC", name))
    plain = re.sub(r"_+", "_", re.sub(r"[^A-Za-z0-9_]", "_", spelled)).strip("_")
    if not plain or plain[0].isdigit():
        plain = f"n{plain}"
    return plain + "_" if is_reserved(plain) else plain


def is_reserved(name: str) -> bool:
    """Whether C or Python or a header of C has a use of its own for `name`."""
    return name in RESERVED or _MACRO.fullmatch(name) is not None


class Names:
    """Distinct identifiers, given in the order asked for; `taken` are never given, nor is a name
    that begins with one of `prefixes`, nor, for `variables`, one that the generated functions may
    give to a temporary or an entry of an array."""

    def __init__(
        self, taken: Iterable[str] = (), prefixes: Collection[str] = (), variables: bool = False
    ) -> None:
        self.taken = set(taken)
        self.prefixes = tuple(prefixes)
        self.variables = variables

    def give(self, name: str) -> str:
        base = identifier(name)
        temporary = self.variables and re.fullmatch(r"(t|c|p|x|a|lam|d|w|r)\d+", base)
        endless = base in self.taken and is_reserved(f"{base}_")  # whatever number is put behind it
        if temporary or endless or base.startswith(self.prefixes):
            base = f"the_{base}"
        found, number = base, 2
        while found in self.taken or is_reserved(found):
            found = f"{base.rstrip('_')}_{number}" if number > 2 or base.endswith("_") else f"{base}_"
            number += 1
        self.taken.add(found)
        return found


def prefix(model: str) -> str:
    """What every public symbol of the generated C begins with, less the underscore: FourBar's is
    `four_bar`."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", identifier(model).rstrip("_")).lower()


def stem(model: str) -> str:
    """The name of the generated files, less their ending."""
    name = prefix(model)
    return f"{name}_model" if name in HEADERS or name in RESERVED else name


def comment(text: str) -> str:
    """`text` on one line, harmless inside a comment of C or Python: no end of comment, line
    continuation, trigraph, control or bidirectional character, in ASCII."""
    spelled = "".join(_spell(c) if ord(c) > 126 else c if c >= " " else " " for c in text)
    spelled = spelled.replace("\\", "/")
    return re.sub(r"\?(?=\?)", "? ", re.sub(r"([*/])(?=[*/])", _apart, spelled)).strip()


def _apart(match: re.Match[str]) -> str:
    """A star and a slash side by side get a space between them; two of a kind do not."""
    char, following = match[1], match.string[match.end()]
    return char if char == following else f"{char} "


def _spell(char: str) -> str:
    """A character that is not ASCII by its Unicode name, where it is a letter."""
    if char.isascii():
        return char
    if char in "·×⋅":
        return "*"
    if char in "²³":
        return "^2" if char == "²" else "^3"
    if char == "°":
        return "deg"
    if not char.isalpha():
        return "?" if char.isprintable() else " "
    name = unicodedata.name(char, "")
    plain = unicodedata.normalize("NFD", char)[0]
    if plain.isascii():
        return plain
    if name.startswith("GREEK SMALL LETTER "):
        return name.split()[3].lower().replace("lamda", "lambda")
    if name.startswith("GREEK CAPITAL LETTER "):
        return name.split()[3].capitalize().replace("Lamda", "Lambda")
    return f"u{ord(char):x}"
