"""The kernel language: constructs outside of the subset are refused; others mean the same in C, in printed
Python, and in the source."""

import ast
import contextlib
import ctypes
import math
import os
import random
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

import lagc.kernels
from lagc.codegen.kernel_compiler.c_declarations import copies
from lagc.codegen.kernel_compiler.compiler import Compiler, Definitions, definitions
from lagc.codegen.kernel_compiler.kernel_syntax import Function, Missing, Outside, clone, module
from lagc.codegen.kernel_compiler.library import Library, library, sources
from lagc.codegen.kernel_compiler.real_types import DOUBLE
from lagc.codegen.kernel_compiler.specialization import FLAGS
from lagc.codegen.kernel_compiler.type_check import Signature
from lagc.codegen.python.functions import ARITHMETIC
from lagc.codegen.python.runtime import ROOTS, kernels
from lagc.codegen.sizes import flags_of
from lagc.compiler.shipped import COMMON
from lagc.kernels import METHODS
from tests.codegen.tools import of_model

pytestmark = pytest.mark.usefixtures("own_cache")  # kernels of these texts are kept beside lagc's own

HEAD = "from lagc.kernels.language.words import *\n"


STRAIGHT = {"STRAIGHT": True, "NC": True, "NZ": False}


def kernels_of(text: str, language: str = "double") -> Library:
    """The kernels of one file, for sizes NX, NC, NZ and the flag STRAIGHT."""
    model = {"fn_model": Signature((("Vec", "NX"),), ("None",), [True], (-1, 0, 0))}
    known = Definitions(frozenset({"NX", "NC", "NZ"}), {"level": ("IVec", "NX")}, model)
    known.add(module("a.py", text), 0, {})
    found = Library(language, {})
    found.compiler = Compiler(language, known)
    return found


def compiled(text: str) -> None:
    """Compile all kernels of a file."""
    found = kernels_of(text)
    for name, definition in found.compiler.known.named.items():
        if isinstance(definition.part, Function):
            found.part(name, STRAIGHT)


REFUSED = {
    "x: int = 1": "the level of the file",
    "def f(x: Real = 1.0) -> Real:\n    return x": "no defaults",
    "def f(x) -> Real:\n    return x": "has a type",
    "def f(x: Real):\n    return x": "has a type",
    "def f(*x: Real) -> Real:\n    return 1.0": "arguments are plain",
    "def f(x: str) -> Real:\n    return 1.0": "str is not a type",
    "def f(x: Vec[3]) -> Real:\n    return 1.0": "Vec[3] is not a type",
    "@cache\ndef f(x: Real) -> Real:\n    return x": "only decorators",
    "async def f() -> None:\n    return": "level of the file",
    "def f(x: Real) -> Real:\n    y, z = x, x\n    return y": "not in the subset",
    "def f(x: Real) -> Real:\n    try:\n        return x\n    except ValueError:\n        return x": "subset",
    "def f(x: Real) -> Real:\n    with x:\n        return x": "not in the subset",
    "def f(x: Real) -> Real:\n    raise ValueError": "not in the subset",
    "def f(x: Real) -> Real:\n    return f(x)": "no kernel that stands before",
    "def f(x: Real) -> Real:\n    return g(x)\ndef g(x: Real) -> Real:\n    return x": "no kernel",
    "def f(x: Real) -> Real:\n    return [x][0]": "not in the subset",
    "def f(x: Real) -> Real:\n    return max(x, x)": "no kernel",
    "def f(x: Real) -> Real:\n    return abs(x)": "no kernel",
    "def f(x: Real) -> Real:\n    return x ** 2": "not in the subset",
    "def f(x: Real) -> bool:\n    return 0.0 < x < 1.0": "not in the subset",
    "def f(x: Real) -> Real:\n    x = 1.0\n    return x": "the argument x is assigned",
    "def f(x: Real) -> Real:\n    x += 1.0\n    return x": "the argument x is assigned",
    "def f(x: Real) -> Real:\n    if x:\n        return x\n    return x": "a truth value",
    "def f(x: Real) -> Real:\n    if x > 0.0:\n        return x": "may end without a result",
    "def f(x: Real) -> Real:\n    for i in [1, 2]:\n        x = x\n    return x": "not in the subset",
    "def f(x: Vec[NX]) -> Real:\n    for v in x:\n        return v\n    return 1.0": "not in the subset",
    "def f(n: int) -> int:\n    for i in range(0, n, 2):\n        g = i\n    return n": "steps by 1 or -1",
    "def f(n: int) -> int:\n    m = n\n    for i in range(m):\n        m = 2\n    return m": "end of the",
    "def f(n: int) -> int:\n    for i in range(n):\n        i = 2\n    return n": "the counter i is assigned",
    "def f(n: int) -> int:\n    for i in range(n):\n        m = i\n    return i": "i is not known here",
    "def f(n: int) -> Real:\n    m = n\n    m = 0.5\n    return m": "is int before, Real here",
    "def f(n: int) -> int:\n    return n / 2": "not in the subset",
    "def f(n: int) -> int:\n    m = n\n    m /= 2\n    return m": "divided by //",
    "def f(x: Real) -> int:\n    return x": "is Real, not int",
    "def f(x: Vec[NX], y: Vec[NC]) -> None:\n    x = y": "the argument x is assigned",
    "def g(x: Vec[NX]) -> None:\n    x[0] = 1.0\ndef f(y: Vec[NC]) -> None:\n    g(y)": "takes",
    "def f(x: Vec[NX]) -> Real:\n    return x[0.5]": "an index is an integer",
    "def f(x: Real) -> Real:\n    return y": "y is not known here",
    "def f(x: Real) -> Real:\n    return x.real": "not in the subset",
    "def f(x: Real) -> Real:\n    return (lambda: x)()": "not in the subset",
    "def f(x: Real) -> Real:\n    y = 2.0\n    return x": "y is never read",
    "def f(x: Real) -> Real:\n    import os\n    return x": "not in the subset",
    "def f(x: Real) -> Real:\n    global y\n    return x": "not in the subset",
    "def f(x: Vec[Any], y: Vec[Any]) -> None:\n    x[:] = y": "how much is copied",
    "def f(x: Real) -> Real:\n    while x > 0.0:\n        pass\n    return x": "not in the subset",
    "@struct\nclass A:\n    x: Real\n    def f(self): ...": "fields only",
    "@struct\nclass A:\n    x: Real = 1.0": "fields only",
    "@struct\nclass A:\n    x: str": "not a type",
    "@struct\nclass A:\n    if 1 > 0:\n        x: Real": "not a flag",
    "A = [1, 2]": "a constant is a number",
    "A = (1, 2)": "a constant is a number",
    "A = 1\nA = 2": "A is there already",
    "def level(x: Real) -> Real:\n    return x": "level is there already",
    "def table7(x: Real) -> Real:\n    return x": "table7 is there already",
    "A = (1.0, 2.0)\ndef a(x: Real) -> Real:\n    return x": "a is there already",
    "def f(x: Pair) -> Real:\n    return 1.0": "a Pair is a result only",
    "def f(x: Real) -> Real:\n    return x, x": "not in the subset",
    "def f(x: Real) -> Pair:\n    return x": "not assigned",
    "def f(x: Real) -> Pair:\n    return x, x > 1.0": "is bool, not Real",
    "def g(x: Real) -> Pair:\n    return x, x\ndef f(x: Real) -> None:\n g(x)": "put into two entries",
    "def g(x: Real) -> Pair:\n return x, x\ndef f(x: Real) -> Real:\n y = g(x)\n return x": "a Pair is put",
    "def g(x: Real) -> Pair:\n return x, x\ndef f(v: Vec[NX]) -> None:\n v[0:3] = g(1.0)": "a Pair is put",
    "def g(x: Real) -> Real:\n return x\ndef f(v: Vec[NX]) -> None:\n v[0:2] = g(1.0)": "only a vector",
    "def f(x: int) -> int:\n    return whole(x)": "no kernel",
}  # fmt: skip


@pytest.mark.parametrize("text", REFUSED)
def test_other_constructs_are_refused_with_their_place(text: str) -> None:
    with pytest.raises(Outside, match=r"a\.py:[1-9][0-9]*: ") as found:
        compiled(text)
    assert REFUSED[text] in str(found.value)


@pytest.mark.full
def test_every_kernel_belongs_to_some_models() -> None:
    """With all flags, or all but one: no kernel calls what no model has beside it."""
    every = dict.fromkeys([*definitions().sizes, *FLAGS, *map(str.upper, METHODS)], True)
    choices = [every, *({**every, flag: False} for flag in ("NM", "STRAIGHT", "NCON", "NMODE", "NLOADED"))]
    for name in definitions().signatures.keys() & definitions().named.keys():
        for flags in choices:
            with contextlib.suppress(Missing):
                assert library("double").part(name, flags).text.endswith("}\n")
                break
        else:
            raise AssertionError(name)


def test_the_key_of_shipped_kernels_covers_all_sources() -> None:
    known = {os.path.realpath(path) for path in sources()}
    package = Path(lagc.kernels.__file__).parent
    there = [*package.rglob("*.py"), *(package.parent / "codegen" / "kernel_compiler").glob("*.py")]
    assert known == {os.path.realpath(path) for path in (*there, package.parent / "codegen" / "sizes.py")}


MEANS = '''
LIMIT = 0.5
MOST = 7
WEIGHTS = (1.5, -0.25, 3e-7, 2.0)  # of four


def inner(a: Vec[NX], b: Vec[NX]) -> Real:
    """The product."""
    total = 0.0
    for i in range(NX):
        total += a[i] * b[i]
    return total


def sign(x: Real) -> int:
    if x > LIMIT:
        return 1
    elif x < -LIMIT:
        return -1
    return 0


def scaled(a: Vec[NX], b: Vec[NX], y: Vec[NX], n: int) -> Real:
    """Everything at once."""
    own = vector(NX)
    own[:] = a
    for i in range(NX):
        y[i] = own[i] * b[i] - LIMIT * (own[i] - b[i])
    count = 0
    k = 0
    while True:
        k += 1
        if k > MOST or (k > n and count >= 0):
            break
        if k % 2 == 0:
            continue
        count += k // 2 - sign(a[k % 3]) * (k >> 1 & 1)
    for j in range(2 + sign(a[0])):
        count += j
    for i in range(NX - 1, -1, -1):
        y[i] += float(count) * (own[i] / b[i]) if b[i] != 0.0 or not own[i] > 0.0 else fabs(own[i])
    y[1:3] = part(own, 0, 2)
    y[0] += floor(float(n) / 3.0 - 1.5)
    state: Length = 12345 + n
    for i in range(NX):
        state = (1103515245 * state + 12345) & 2147483647
    y[3] += float(state) / 2147483648.0
    largest = -inf
    for i in range(NX):
        if y[i] > largest:
            largest = y[i]
    if STRAIGHT:
        largest = sqrt(largest * largest)
    if NZ > 0 and n > 0:
        largest = 0.0
    return largest + inner(a, b) * sqrt(0.25) if NC > 0 else largest


def parted(x: Real, k: int) -> Pair:
    """What stands before the point and behind it, with a weight."""
    if not fabs(x) < 1e9:
        return x, 0.0
    before = float(whole(x))
    return before, (x - before) * WEIGHTS[whole(fabs(x)) + k & 3]
'''


@pytest.mark.sample(1)
@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not there")
@pytest.mark.parametrize("straight", [True, False])
def test_c_and_python_mean_the_same(straight: bool, tmp_path: Path) -> None:
    """Random vectors, with zeros, infinities and NaN, through both: to the last bit, and as Python has it."""
    roots, flags = ["scaled", "parted"], {**STRAIGHT, "STRAIGHT": straight}
    use, in_python = (kernels_of(MEANS, language).chosen(roots, flags) for language in ("double", "python"))
    text = DOUBLE.includes + "#include <stddef.h>\n#define LAGC_NX 4\n#define LAGC_NC 1\n"
    text += "#define LAGC_LIMIT 0.5\n#define LAGC_MOST 7\n"
    text += "static const double lagc_weights[] = {1.5, -0.25, 3e-7, 2.0};\n"
    kernels_ = "\n".join(part.text for part in use.functions)
    text += "\n".join([*copies(kernels_), kernels_]).replace("lagc_real", "double")
    text += "double scaled(const double *a, const double *b, double *y, int n)\n"
    text += "{ return lagc_scaled(a, b, y, n); }\n"
    text += "void parted(double x, int k, double *pair);\n"
    text += "void parted(double x, int k, double *pair) { lagc_parted(x, k, pair); }\n"
    (tmp_path / "a.c").write_text(text)
    words = [
        "gcc", "-std=c99", "-O2", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-ffp-contract=off", "-fPIC",
        "-shared",
    ]  # fmt: skip
    done = subprocess.run([*words, "a.c", "-o", "a.so", "-lm"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    library_ = ctypes.CDLL(str(tmp_path / "a.so"))
    compiled = library_.scaled
    compiled.restype = ctypes.c_double
    space: dict[str, Any] = {"NX": 4, "NC": 1, "LIMIT": 0.5, "MOST": 7, "WEIGHTS": (1.5, -0.25, 3e-7, 2.0)}
    exec(ARITHMETIC + "\n".join(part.text for part in in_python.functions), space)
    plain = _as_it_stands(straight)
    chance = random.Random(3)
    for _ in range(300):
        a, b = ([_number(chance) for _ in range(4)] for _ in range(2))
        n, results = chance.randrange(0, 9), []
        own = (ctypes.c_double * 4)(*[0.0] * 4)
        first = compiled((ctypes.c_double * 4)(*a), (ctypes.c_double * 4)(*b), own, n)
        results.append([first, *own])
        for names in (space, plain):
            y = [0.0] * 4
            results.append([names["scaled"](a, b, y, n), *y])
        assert all(_same(results[0], other) for other in results[1:]), (a, b, n, results)
        for x in (1e3 * a[0], b[1]):
            pair = (ctypes.c_double * 2)()
            library_.parted(ctypes.c_double(x), n, pair)
            for names in (space, plain):
                assert _same(list(pair), list(names["parted"](x, n))), (x, n, *pair)


NESTED = '''
@struct
class Law:
    """A part of a workspace."""

    forces: Vec[NX]
    count: int
    if NC > 0:
        largest: Real


@struct
class Shop:
    total: Real
    if STRAIGHT:
        law: Law


def push(law: Law, by: Real) -> None:
    """Raise all forces."""
    for i in range(NX):
        law.forces[i] += by
    law.count += 1


def worked(shop: Shop, x: Vec[NX]) -> Real:
    law = shop.law
    law.forces[:] = x
    push(law, 0.5)
    push(shop.law, 0.25)
    if NC > 0:
        law.largest = law.forces[0]
        for i in range(NX):
            if law.forces[i] > shop.law.largest:
                law.largest = law.forces[i]
        shop.total += law.largest
    for i in range(NX):
        shop.total += law.forces[i] * shop.law.forces[i]
    return shop.total * float(law.count)

'''


@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not there")
def test_records_within_records_mean_the_same(tmp_path: Path) -> None:
    """A name for the record inside, it as an argument, and its members by the whole path are one record."""
    use = kernels_of(NESTED).chosen(["worked"], STRAIGHT)
    assert [part.name for part in use.records] == ["Law", "Shop"]
    text = DOUBLE.includes + "#define LAGC_NX 3\n"
    text += "typedef struct { double forces[3]; int count; double largest; } lagc_law;\n"
    text += "typedef struct { double total; lagc_law law; } lagc_shop;\n"
    kernels_ = "\n".join(part.text for part in use.functions)
    text += "\n".join([*copies(kernels_), kernels_]).replace("lagc_real", "double")
    text += "double worked(const double *x) { lagc_shop s; memset(&s, 0, sizeof s);"
    text += " return lagc_worked(&s, x); }\n"
    (tmp_path / "a.c").write_text(text)
    words = ["gcc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off", "-fPIC", "-shared"]
    done = subprocess.run([*words, "a.c", "-o", "a.so"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    compiled = ctypes.CDLL(str(tmp_path / "a.so")).worked
    compiled.restype = ctypes.c_double
    space: dict[str, Any] = {"NX": 3, "NC": 1, "STRAIGHT": True}
    exec(ARITHMETIC + "\n".join(kernels(kernels_of(NESTED, "python").chosen(["worked"], STRAIGHT))), space)
    x = [0.1, -3.0, 2.5]
    law = [v + 0.75 for v in x]
    value = (max(law) + sum(v * v for v in law)) * 2.0
    results = [compiled((ctypes.c_double * 3)(*x)), space["worked"](space["Shop"](), x)]
    assert results[0] == results[1] == pytest.approx(value, rel=1e-15)
    without = kernels_of(NESTED).chosen(["push"], {**STRAIGHT, "STRAIGHT": False})
    assert [part.name for part in without.records] == ["Law"]
    with pytest.raises(Missing, match="Shop has no law"):
        kernels_of(NESTED).chosen(["worked"], {**STRAIGHT, "STRAIGHT": False})


def _number(chance: random.Random) -> float:
    return chance.choice((0.0, -0.0, math.inf, math.nan, *(chance.gauss(0.0, 1.0) for _ in range(30))))


def _same(one: list[float], other: list[float]) -> bool:
    return all(a == b or (a != a and b != b) for a, b in zip(one, other))


def _as_it_stands(straight: bool) -> dict[str, Any]:
    space: dict[str, Any] = {
        "NX": 4, "NC": 1, "NZ": 0, "STRAIGHT": straight, "Vec": dict, "Real": float, "Pair": tuple,
        "Any": Any, "whole": int,
    }  # fmt: skip
    more = "def vector(n):\n    return [0.0] * n\ndef part(v, a, b):\n    return v[a:b]\n"
    text = MEANS.replace("own[i] / b[i]", "quotient(own[i], b[i])")
    exec(ARITHMETIC + more + re.sub(r": Vec\[NX\]", "", text), space)
    return space


@pytest.mark.sample(2, 6)
@pytest.mark.parametrize("name", COMMON)
def test_no_kernel_of_python_divides_by_what_may_be_zero(name: str) -> None:
    """C returns infinity or NaN where Python raises: `/` is left to divisors that are numbers or
    constants."""
    use = library("python").chosen(ROOTS, flags_of(of_model(name).interface, True))
    constants = {part.name for part in use.constants}
    for part in use.functions:
        for node in ast.walk(ast.parse(part.text)):
            if isinstance(node, ast.BinOp | ast.AugAssign) and isinstance(node.op, ast.Div):
                divisor = node.right if isinstance(node, ast.BinOp) else node.value
                names = {n.id for n in ast.walk(divisor) if isinstance(n, ast.Name)}
                assert names <= constants, ast.unparse(node)
            assert not (isinstance(node, ast.Name) and node.id == "sqrt"), part.name


def test_a_tree_is_copied_without_what_other_programs_leave_in_shared_nodes() -> None:
    """Python has one node for `ast.Load()`; a debugger sets its parent, and so closes a circle."""
    tree = ast.parse("a = b")
    load = tree.body[0].value.ctx  # type: ignore[attr-defined]
    load.parent = tree
    try:
        assert ast.dump(clone(tree)) == ast.dump(tree)
    finally:
        del load.parent
