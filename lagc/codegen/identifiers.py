"""Identifiers of generated code: a user's names, made harmless and unique, in a fixed order."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Iterable

from lagc.host.atomic_write import fitting
from lagc.lowering.program import Program

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
    floor fma fmax fmin fmod frexp hypot ilogb ldexp lgamma llrint llround log log10 log1p log2 logb
    lrint lround modf nan nearbyint nextafter nexttoward pow remainder remquo rint round scalbln scalbn
    signbit sin sinh sqrt tan tanh tgamma trunc fpclassify isfinite isinf isnan isnormal isgreater
    isless isunordered j0 j1 jn y0 y1 yn gamma gamma_r signgam drem significand finite scalb pow10 abs
    labs div exit abort index rindex time clock signal memcpy memset memmove strlen printf main min max
    select sign both either inverse math self float_t double_t size_t ptrdiff_t NAN math_errhandling I
    errno stdin stdout stderr complex imaginary noreturn offsetof va_list linux unix i386 near far huge
    small interface IN OUT ssize_t mode_t off_t pid_t uid_t gid_t caddr_t alloca environ isascii iscsym
    iscsymf longjmp matherr pclose popen setjmp toascii wcswcs wpopen accmode_t devmajor_t devminor_t
    fsblkcnt_t fsfilcnt_t in_addr_t in_port_t onexit_t fd_mask pthread_sigmask sys_errlist sys_nerr
    w_coredump w_retcode w_stopsig w_stopval w_termsig L_ctermid L_cuserid L_tmpnam L_tmpnam_s P_tmpdir
    FAR NEAR ERA pascal cdecl hyper
"""
RESERVED = frozenset(_KEYWORDS.split()) | frozenset(_LIBRARY.split())
# What a header of some C library may define as a macro, by its shape: INT_MAX, ERANGE, M_SQRT2f, PRId64,
# si_code.  M_cart, L_1, F_N2, J12 are names of people.
_MACRO = re.compile(
    r"(?![A-Z]_?[A-Z]?\d*$)[A-Z][A-Z0-9_]{3,}|[A-Z]_([12]_)?[A-Z]{2,}[A-Z0-9_]*(f|l|f\d+x?)?|M_E(f|l|f\d+x?)?"
    r"|E[A-Z]{2}|(PRI|SCN)[a-z][A-Z0-9]*|(ru|sa|si|sigev|sv)_[a-z][a-z0-9_]*"
    r"|B0|B[1-9]\d+|BS\d|CR\d|CS\d|FF\d|NL\d|VT\d"
)
_HEADERS = """
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign
    stdarg stdatomic stdbool stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar
    wchar wctype memory malloc unistd new con aux nul prn
"""
_TEMPORARY = re.compile(r"(t|c|p|x|a|lam|d|w|r|sc|sin|cos)\d+")
# What constants of some header begin with, as F_OK or FE_INVALID, that those of a model may be called too.
_FAMILIES = """
    backup cc clr cpuset crypt drive drv enum event f fd fe gm gmem ifcap kern lc lmem map mb mm pc prsec pwr
    r reg regs s sc sem si siid status stock tcp w wait wm wn x
"""
FAMILIES = frozenset(_FAMILIES.split())
HEADERS = frozenset(_HEADERS.split())  # names that a model's files must not take


def identifier(name: str) -> str:
    """`name` with letters, digits and single underscores only, not reserved: `der(theta)` is
    `der_theta`, `link[2].phi` is `link_2_phi`, `int` is `int_`."""
    spelled = "".join(_spell(c) for c in unicodedata.normalize("NFC", name))
    plain = re.sub(r"_+", "_", re.sub(r"[^A-Za-z0-9_]", "_", spelled)).strip("_")
    if not plain or plain[0].isdigit():
        plain = f"n{plain}"
    if plain.lower().startswith("lagc_"):  # as the support's own names, until they get the model's prefix
        plain = f"the_{plain}"
    return f"{plain}_" if is_reserved(plain) else plain


def is_reserved(name: str) -> bool:
    """Whether C or Python or a header of C has a use of its own for `name`, or may have: never for one that
    ends with an underscore."""
    return not name.endswith("_") and (name in RESERVED or _MACRO.fullmatch(name) is not None)


class Names:
    """Distinct identifiers, given in the order asked for; `taken` are never given, nor is a name
    that begins with one of `prefixes`, nor, for `variables`, one that the generated functions may
    give to a temporary or an entry of an array."""

    def __init__(
        self, taken: Iterable[str] = (), prefixes: Collection[str] = (), variables: bool = False
    ) -> None:
        self.taken = set(taken)
        self.prefixes = tuple(prefixes)
        self.lead = "its_" if "the_".startswith(self.prefixes) else "the_"
        self.variables = variables
        self.numbers: dict[str, int] = {}  # the last that was put behind a name

    def give(self, name: str) -> str:
        base = identifier(name)
        if f"{base}_".startswith(self.prefixes) or (self.variables and _TEMPORARY.fullmatch(base)):
            base = f"{self.lead}{base}"
        found = base
        if found in self.taken and not base.endswith("_"):
            found = f"{base}_"
        while found in self.taken:
            self.numbers[base] = self.numbers.get(base, 1) + 1
            found = identifier(f"{base}_{self.numbers[base]}")
        self.taken.add(found)
        return found


def prefix(model: str) -> str:
    """What every public symbol of the generated C begins with, less the underscore, and the name of the
    generated files, less their ending: FourBar's is
    `four_bar`, F's `f_model`, as F_OK is a constant of POSIX, and Time's `time_model`, as its files are not
    to be called time.h."""
    name = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", identifier(model).rstrip("_")).lower()
    return f"{name}_model" if name in FAMILIES | HEADERS | RESERVED else fitting(name)


# Arrays of any Program, so that a name does not depend on which functions a model happens to have.
ARRAYS = ("p", "t", "x", "a", "lam", "d", "w", "r", "xdot", "health", "qdot", "M", "G", "gamma", "s", "dq",
          "phi", "psi", "prepared", "e", "y", "c", "J", "sizes", "largest", "kept")  # fmt: skip


def local_names(program: Program, taken: Iterable[str]) -> dict[tuple[str, int], str]:
    """(array, index) -> name, over all functions alike; `taken` are names of the target."""
    interface = program.interface
    arrays = {name for f in program.functions.values() for name, _ in f.outputs}
    own = prefix(interface.model)
    prefixes = ("lagc_", "LAGC_", "fn_", f"{own}_", f"{own.upper()}_")
    names = Names({*ARRAYS, *arrays, *taken}, prefixes, variables=True)
    found: dict[tuple[str, int], str] = {}
    for index, name in enumerate(interface.state_names):
        found["x", index] = names.give(name)
    if interface.nz:
        found["x", interface.nq + interface.nv] = names.give("work")
    given = len(interface.parameters) + len(interface.inputs)
    for index, field in enumerate((*interface.parameters, *interface.inputs)):
        found["p", index] = names.give(field.name)
    for function in program.functions.values():
        for operation in function.operations:
            key = operation.payload
            if operation.op == "load" and isinstance(key, tuple) and key[0] != "t" and key not in found:
                array, index = key
                if array == "p":
                    found[key] = names.give(f"prepared{index - given}")
                else:  # c0 is a condition
                    found[key] = names.give(f"size{index}") if array == "c" else f"{array}{index}"
    return found


def comment(text: str) -> str:
    """`text` on one line, harmless inside a comment of C or Python: no end of comment, line
    continuation, trigraph, control or bidirectional character, in ASCII."""
    spelled = "".join(_spell(c) if ord(c) > 127 else c if " " <= c <= "~" else " " for c in text)
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
