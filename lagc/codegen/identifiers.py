"""Identifiers of generated code: names of the user, made valid and unique in a fixed order."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Collection, Iterable

from lagc.host.atomic_write import fitting
from lagc.lowering.program import Program

# Keywords of C, C++ and Python.
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
# Functions and macros of the headers of C and POSIX, names of generated code and of compilers.
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
# Patterns of macros in headers of C libraries: INT_MAX, ERANGE, M_SQRT2f, PRId64, si_code.  They do not match
# names that users choose: M_cart, L_1, F_N2, J12.
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
# Prefixes of constants in some header, as F_OK or FE_INVALID, which constants of a model might have too.
_FAMILIES = """
    backup cc clr cpuset crypt drive drv enum event f fd fe gm gmem ifcap kern lc lmem map mb mm mremap pc
    prsec pwr r reg regs s sc sem si siid status stock tcp w wait wm wn x
"""
FAMILIES = frozenset(_FAMILIES.split())
HEADERS = frozenset(_HEADERS.split())  # names that files of a model must not have


def identifier(name: str) -> str:
    """Return `name` with letters, digits and single underscores only, and not reserved: `der(theta)`
    becomes `der_theta`, `link[2].phi` becomes `link_2_phi`, `int` becomes `int_`."""
    spelled = "".join(_spell(c) for c in unicodedata.normalize("NFC", name))
    plain = re.sub(r"_+", "_", re.sub(r"[^A-Za-z0-9_]", "_", spelled)).strip("_")
    if not plain or plain[0].isdigit():
        plain = f"n{plain}"
    if plain.lower().startswith(
        "lagc_"
    ):  # names of the runtime begin so, until they get the prefix of the model
        plain = f"the_{plain}"
    return f"{plain}_" if is_reserved(plain) else plain


def is_reserved(name: str) -> bool:
    """Return whether C, Python or a C header uses `name`, or may use it. A name that ends with an
    underscore is never reserved."""
    return not name.endswith("_") and (name in RESERVED or _MACRO.fullmatch(name) is not None)


class Names:
    """Distinct identifiers, in the order in which they are requested. `taken` are never returned, nor
    names that begin with one of `prefixes`. With `variables`, names that generated functions may give to
    temporaries or array entries are not returned either."""

    def __init__(
        self, taken: Iterable[str] = (), prefixes: Collection[str] = (), variables: bool = False
    ) -> None:
        self.taken = set(taken)
        self.prefixes = tuple(prefixes)
        self.lead = "its_" if "the_".startswith(self.prefixes) else "the_"
        self.variables = variables
        self.numbers: dict[str, int] = {}  # last suffix of each name

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
    """Return the prefix of all public C symbols, without its underscore, which is also the name of the
    generated files. FourBar gives `four_bar`; F gives `f_model`, as F_OK is a constant of POSIX; Time
    gives `time_model`, as time.h is a header."""
    name = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", identifier(model).rstrip("_")).lower()
    return f"{name}_model" if name in FAMILIES | HEADERS | RESERVED else fitting(name)


# Arrays of all Programs, so that a name does not depend on the functions that a model has.
ARRAYS = ("p", "t", "x", "a", "lam", "d", "w", "r", "xdot", "health", "qdot", "M", "G", "gamma", "s", "dq",
          "phi", "psi", "prepared", "e", "y", "c", "J", "sizes", "largest", "kept")  # fmt: skip


def local_names(program: Program, taken: Iterable[str]) -> dict[tuple[str, int], str]:
    """Return the name of each (array, index), the same in all functions of a program; `taken` are names of
    the target language."""
    interface = program.interface
    arrays = {name for f in program.functions.values() for name, _ in f.outputs}
    arrays |= {"contact_forces"} if interface.contacts else set()
    own = prefix(interface.model)
    prefixes = ("lagc_", "LAGC_", "fn_", f"{own}_", f"{own.upper()}_")
    names = Names({*ARRAYS, *arrays, *taken}, prefixes, variables=True)
    found: dict[tuple[str, int], str] = {}
    for index, name in enumerate(interface.state_names):
        found["x", index] = names.give(name)
    if interface.nz:
        found["x", interface.nq + interface.nv] = names.give("work")
    for index, field in enumerate(interface.discretes, interface.nx - len(interface.discretes)):
        found["x", index] = names.give(field.name)
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
                else:  # c0 is the name of a truth value
                    found[key] = names.give(f"size{index}") if array == "c" else f"{array}{index}"
    return found


def comment(text: str) -> str:
    """Return `text` on one line, in ASCII, and safe inside a comment of C or Python: without end of
    comment, line continuation, trigraph, control or bidirectional character."""
    spelled = "".join(_spell(c) if ord(c) > 127 else c if " " <= c <= "~" else " " for c in text)
    spelled = spelled.replace("\\", "/")
    return re.sub(r"\?(?=\?)", "? ", re.sub(r"([*/])(?=[*/])", _spaced, spelled)).strip()


def _spaced(match: re.Match[str]) -> str:
    """Put a space between a star and a slash side by side."""
    char, following = match[1], match.string[match.end()]
    return char if char == following else f"{char} "


def _spell(char: str) -> str:
    """Replace a letter that is not ASCII by its Unicode name, and some signs by text."""
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
