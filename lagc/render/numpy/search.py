"""The kernels of the search for a consistent start as Python for any conditions, which need no model.

They are the same for all that have the same kinds of conditions; as code they are kept in the cache.
"""

from __future__ import annotations

from functools import cache
from types import CodeType

from lagc import cache as store
from lagc.cache.sources import tool_fingerprint

ROOTS = ("prepare", "reach_start")
RECORDS = ("StartWork", "Place")
SWITCHES = ("NCOND", "NRATE", "NQUAT", "NPOSITION")


@cache
def code(kinds: tuple[bool, ...]) -> CodeType:
    """What makes the kernels in a namespace that has their sizes, tables and `fn_` functions.  `kinds`: of
    each of SWITCHES, whether there is any."""
    return store.code(lambda: text(dict(zip(SWITCHES, kinds))), __file__, tool_fingerprint(), repr(kinds))


def text(switches: dict[str, bool]) -> str:
    from lagc.render.kernels.assembly import chosen
    from lagc.render.kernels.shipped import parts
    from lagc.render.numpy.functions import ARITHMETIC
    from lagc.render.numpy.runtime import record

    use = chosen(parts(), switches, ROOTS)
    found = [ARITHMETIC]
    for part in parts():
        number = part["kind"] in ("int", "Real", "Code") and part["name"] in use.names
        if number or part["kind"] == "Status":
            found.append(f"{part['name']} = {part['python']}\n")
        elif part["kind"] == "record" and part["name"] in RECORDS:
            members = [m for m in part["members"] if all(switches[switch] == value for switch, value in m[2])]
            found.append(record(part["name"], part["doc"], [(name, kind) for name, kind, *_ in members]))
    return "\n\n".join([*found, *(leaf["python"] for _, leaf in use.parts)])
