"""A description of generated code as plain data, for programs that call it or write wrappers for it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from math import isfinite
from typing import Any

from lagc.codegen.c import header
from lagc.codegen.identifiers import prefix
from lagc.codegen.kernel_compiler.real_types import TYPES
from lagc.codegen.python.emit import member_names
from lagc.lowering.program import Field, Interface

BYTES = {"float": 4, "double": 8, "quad": 16}  # of a real


def describe(interface: Interface, declared: str | None, real: str) -> dict[str, Any]:
    """Return names, units and places of what the code holds, and of C, whose header is `declared`, its
    functions and sizes.

    The index of a state counts from the beginning of x, the offset of a parameter in bytes from that of the
    struct."""
    members = member_names(interface) if declared is None else header.members(interface)
    fields = [_field(f, member) for f, member in zip((*interface.parameters, *interface.inputs), members)]
    n = len(interface.parameters)
    discretes = [(f.name, f.unit) for f in interface.discretes]
    found: dict[str, Any] = {
        "prefix": prefix(interface.model), "model_hash": interface.model_hash,
        "parameters": fields[:n], "inputs": fields[n:],
        "coordinates": _entries([*zip(interface.q_names, interface.q_units)]),
        "speeds": _entries([*zip(interface.v_names, interface.v_units)], interface.nq),
        "discretes": _entries(discretes, interface.nx - len(discretes)),
        "outputs": _entries([(f.name, f.unit) for f in interface.outputs]),
        "constraints": _entries([*zip(interface.row_labels, interface.row_units)]),
        "contacts": [contact.name for contact in interface.contacts],
        "relations": list(interface.relations),
    }  # fmt: skip
    if declared is not None:
        for k, field in enumerate(fields):
            field["offset"] = k * BYTES[real]
        found["real"] = {"type": TYPES[real].name, "size": BYTES[real]}
        found["sizes"] = {name: value for name, value, _ in header.sizes(interface)}
        found["functions"] = functions(declared, found["prefix"])
    return found


def _field(field: Field, member: str) -> dict[str, Any]:
    """A parameter or input, in SI units."""
    found = {"name": field.name, "member": member, "unit": field.unit, "display_unit": field.display_unit,
             "value": field.value, "description": field.description}  # fmt: skip
    bounds = {"minimum": field.minimum, "maximum": field.maximum}
    return {**found, **{name: value if isfinite(value) else None for name, value in bounds.items()}}


def _entries(named: Sequence[tuple[str, str]], first: int = 0) -> list[dict[str, Any]]:
    return [{"name": name, "unit": unit, "index": k} for k, (name, unit) in enumerate(named, first)]


def functions(declared: str, own: str) -> dict[str, str]:
    """Return the declaration of each function of a header, by its name without the prefix."""
    found = re.findall(rf"^((?:const )?[a-z]\w* \*?{own}_(\w+)\([^;{{}}]*\));", declared, re.M)
    return {name: " ".join(head.split()) for head, name in found}
