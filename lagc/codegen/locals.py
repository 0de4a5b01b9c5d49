"""The names that entries of input arrays have in generated functions: the user's own."""

from __future__ import annotations

from collections.abc import Iterable

from lagc.codegen.identifiers import Names, prefix
from lagc.lowering.program import Program

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
