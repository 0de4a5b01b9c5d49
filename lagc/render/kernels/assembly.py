"""The kernels that a model needs, of those that are shipped."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import isfinite
from typing import Any

from lagc.optimize.program import Interface
from lagc.records import dataclass

CONSTANT_SIZES = {"TWO": 2, "FOUR": 4, "SEVEN": 7, "NK": 16, "NKEPT": 13, "ND": 8, "NSETS": 3}
# Sizes that are expressions of others, or the same in every model.
DERIVED = {
    "NM": "LAGC_NV * (LAGC_NV + 1) / 2", "NG": "LAGC_NC * LAGC_NV", "NR": "LAGC_NV + LAGC_NC",
    "NREACH": "LAGC_NC + LAGC_NH", "NROW": "LAGC_NU + 1", "NSETU": "3 * LAGC_NU",
    **{name: str(value) for name, value in CONSTANT_SIZES.items()},
}  # fmt: skip


@dataclass(frozen=True)
class Chosen:
    """Parts in their order: `functions` with the text of this model's switches; `names` of all that is
    used: kernels, constants, tables, functions of the model."""

    parts: tuple[tuple[Mapping[str, Any], Mapping[str, Any]], ...]
    names: frozenset[str]


def chosen(parts: Iterable[Mapping[str, Any]], switches: Mapping[str, bool], roots: Iterable[str]) -> Chosen:
    """The functions `roots` and all that they call.  KeyError for a name that is none."""
    functions = {part["name"]: part for part in parts if part["kind"] == "function"}
    leaves: dict[str, Mapping[str, Any]] = {}
    names: set[str] = set()
    wanted = list(roots)
    while wanted:
        name = wanted.pop()
        if name in leaves:
            continue
        leaf = functions[name]["tree"]
        while isinstance(leaf, list):
            leaf = leaf[1 if switches[leaf[0]] else 2]
        if "missing" in leaf:
            raise KeyError(f"{name}: {leaf['missing']}")
        leaves[name] = leaf
        names.update(leaf["uses"], leaf["calls"])
        wanted += [call for call in leaf["calls"] if call in functions]
    return Chosen(
        tuple((functions[n], leaves[n]) for n in functions if n in leaves), frozenset(names | leaves.keys())
    )


def sizes_of(interface: Interface) -> dict[str, int]:
    """The sizes of a model: see `lagc.kernels.sizes`."""
    columns, begins = interface.condition_columns, (0, *interface.condition_ends)
    rows = [columns[begin:end] for begin, end in zip(begins, interface.condition_ends)]
    nq, nv, nc, nh = interface.nq, interface.nv, interface.nc, interface.nh
    quaternions, fields = len(interface.quaternions), (*interface.parameters, *interface.inputs)
    nu, ne = len(interface.start_levels), len(rows) + quaternions
    return {
        "NQ": nq, "NV": nv, "NZ": interface.nz, "NX": interface.nx, "NC": nc, "NH": nh, "NP": len(fields),
        "NQUAT": quaternions, "NKIND": max(interface.kinds, default=0) + 1, "NWORK": interface.work_size,
        "NM": nv * (nv + 1) // 2, "NG": nc * nv, "NR": nv + nc, "NREACH": nc + nh,
        "NCOND": len(rows), "NRATE": len(interface.rate_names),
        "NPOSITION": sum(max(row, default=0) < nq for row in rows),
        "NBOUNDED": sum(isfinite(f.minimum) or isfinite(f.maximum) for f in fields),
        "NLIMITS": len(interface.limits), "NU": nu, "NE": ne, "NJ": max(len(columns) + 4 * quaternions, 1),
        "NROW": nu + 1, "NSETU": 3 * nu, **CONSTANT_SIZES,
    }  # fmt: skip


def switches_of(interface: Interface, complete: bool) -> dict[str, bool]:
    """What is decided when code is printed: `N > 0` of each size, and the names of `static.SWITCHES`."""
    return {
        **{name: value > 0 for name, value in sizes_of(interface).items()},
        "STRAIGHT": interface.solve == "straight", "HAS_DISPLACE": "displace" in interface.functions,
        "COMPLETE": complete,
    }  # fmt: skip


def tables_of(interface: Interface) -> dict[str, Sequence[Any]]:
    """What kernels know of a model besides sizes: see `lagc.kernels.tables`."""
    fields = (*interface.parameters, *interface.inputs)
    bounded = [i for i, f in enumerate(fields) if isfinite(f.minimum) or isfinite(f.maximum)]
    ends, columns = list(interface.condition_ends), list(interface.condition_columns)
    for k in interface.quaternions:
        ends.append(len(columns) + 4)
        columns += range(k, k + 4)
    return {
        "kind": interface.kinds, "quaternion": interface.quaternions, "bounded": bounded,
        "level": interface.start_levels, "unit": interface.start_units,
        "angle": [int(i in interface.angles) for i in range(len(interface.start_levels))],
        "ends": ends, "column": columns or [0],
        "bounds": [(fields[i].minimum, fields[i].maximum) for i in bounded],
        "derived_bounds": [(f.minimum, f.maximum) for f in interface.limits],
    }  # fmt: skip
