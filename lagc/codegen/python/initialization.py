"""The kernels of the search for a consistent start as Python for any conditions, which need no model.

They are the same for all that have the same kinds of conditions; as code they are kept in the cache.
"""

from __future__ import annotations

from functools import cache
from types import CodeType

from lagc.host import cache as store
from lagc.host.cache import tool_fingerprint

ROOTS = ("prepare", "reach_start", "meet_all")
SWITCHES = ("NCOND", "NRATE", "NQUAT", "NPOSITION", "NP", "NPIECE")


@cache
def code(kinds: tuple[bool, ...]) -> CodeType:
    """What makes the kernels in a namespace that has their sizes, tables and `fn_` functions.  `kinds`: of
    each of SWITCHES, whether there is any."""
    return store.code(lambda: text(dict(zip(SWITCHES, kinds))), __file__, tool_fingerprint(), repr(kinds))


def text(switches: dict[str, bool]) -> str:
    from lagc.codegen.kernel_compiler.linker import chosen
    from lagc.codegen.kernel_compiler.shipped import parts
    from lagc.codegen.python.functions import ARITHMETIC
    from lagc.codegen.python.runtime import kernels, numbers

    # conditions are asked with parameters alone
    use = chosen(parts(), {**switches, "NPREPARED": False, "NSUM": False}, ROOTS)
    return "\n\n".join([ARITHMETIC, numbers(use.names), *kernels(use)])
