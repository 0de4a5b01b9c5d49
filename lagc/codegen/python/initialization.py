"""The kernels of the initialization as Python code for any initial equations, without a model.

The code is the same for all that have the same flags, and is kept in the cache.
"""

from __future__ import annotations

from functools import cache
from types import CodeType

from lagc.host import cache as store
from lagc.host.cache import tool_fingerprint

ROOTS = ("prepare", "reach_start", "select_equations", "evaluate")
FLAGS = ("NCOND", "NRATE", "NQUAT", "NMASSLESS")


@cache
def code(kinds: tuple[bool, ...]) -> CodeType:
    """Return code that defines the kernels in a namespace with sizes, tables and `fn_` functions. `kinds`:
    for each of FLAGS whether there are any."""
    return store.code(lambda: text(dict(zip(FLAGS, kinds))), __file__, tool_fingerprint(), repr(kinds))


def text(flags: dict[str, bool]) -> str:
    from lagc.codegen.kernel_compiler.library import library
    from lagc.codegen.python.functions import ARITHMETIC
    from lagc.codegen.python.runtime import PYTHON, kernels, numbers

    # initial equations are evaluated with parameters alone
    use = library(PYTHON).chosen(ROOTS, {**flags, "NPREPARED": False, "NSUM": False})
    return "\n\n".join([ARITHMETIC, numbers(use.constants), *kernels(use)])
