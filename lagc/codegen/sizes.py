"""The sizes, flags, methods and tables of a model, as its kernels use them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from itertools import accumulate, chain, pairwise
from math import isfinite
from typing import Any

from lagc.kernels import IMPLICIT, METHODS, MOST_ACTS, SERIES
from lagc.lowering.program import Interface

CONSTANT_SIZES = {"TWO": 2, "THREE": 3, "FOUR": 4, "SEVEN": 7, "NK": 16, "ND": 8, "NTERM": 41}
SPELLED = {name: str(number) for name, number in CONSTANT_SIZES.items()}  # in C, where they have no name
# Sizes that other sizes determine.
DERIVED: dict[str, Callable[[Mapping[str, int]], int]] = {
    "NM": lambda n: n["NV"] * (n["NV"] + 1) // 2, "NG": lambda n: n["NC"] * n["NV"],
    "NR": lambda n: n["NV"] + n["NC"], "NTIED": lambda n: n["NH"] + n["NC"],
    "NREACH": lambda n: n["NC"] + n["NH"] + n["NGROUP"],
    "NROW": lambda n: n["NU"] + 1,
    "NMANY": lambda n: (n["NV"] + n["NC"]) // 200 + 1,
    "NPARTED": lambda n: n["NCOND"] + n["NSUM"], "NWHOLE": lambda n: n["NU"] + n["NSUM"],
    "NALL": lambda n: n["NP"] + n["NPREPARED"],
    "NSLOPES": lambda n: n["NNEWTON"] * n["NNEWTON"], "NFACTORS": lambda n: n["NLINEAR"] * n["NLINEAR"],
    "NMASS": lambda n: n["NV"] * n["NV"],
    "NCROW": lambda n: n["NCON"] + n["NSLIP"],
    "NGRADIENTS": lambda n: (n["NCON"] + n["NSLIP"]) * n["NV"],
    "NRESPONSES": lambda n: (n["NCON"] + n["NSLIP"]) * (n["NV"] + n["NC"]),
    "NDELASSUS": lambda n: (n["NCON"] + n["NSLIP"]) * (n["NCON"] + n["NSLIP"]),
    "NDIRECT": lambda n: n["NCON"] * 2,
}  # fmt: skip


def sizes_of(interface: Interface) -> dict[str, int]:
    """Return the sizes of a model (`lagc.kernels.language.sizes`)."""
    nq, nv, fields = interface.nq, interface.nv, (*interface.parameters, *interface.inputs)
    # Initialization has sizes of its own; in a model with everything they are those of the run.
    start = sizes_of_start(nq, nv, len(interface.rate_names), interface.condition_ends,
                           interface.condition_columns, interface.quaternions,
                           len(interface.massless))  # fmt: skip
    sums = max(len(interface.part_ends) - len(interface.condition_ends), 0)
    # Contacts: rows of a contact are its normal and its slips; the normal forces of two-sided ones are sums
    # of `known` quantities.
    values, lanes, squares, *_ = interface.series
    relations, free = len(interface.relations), len(interface.relations) - interface.timed_relations
    loaded, pushed = len(interface.loading_rows), len(interface.pushed_contacts)
    normals = sum(c.normals for c in interface.contacts)
    rows = sum(1 + c.slips for c in interface.contacts)
    known, multipliers = nv + interface.nc + rows, 0 if interface.contacts else interface.nc
    # Names and meanings are those of `kernels/language/sizes`.
    own = {
        "NQ": nq, "NV": nv, "NZ": interface.nz, "NX": interface.nx, "NINT": nq + nv + interface.nz,
        "NDISC": len(interface.discretes), "NC": interface.nc, "NH": interface.nh,
        "NP": len(fields), "NY": len(interface.outputs),
        "NGROUP": max(interface.kinds, default=0) + 1, "NWORK": interface.work_size,
        "NHEALTH": max(interface.health, 2),
        "NBOUNDED": sum(isfinite(f.minimum) or isfinite(f.maximum) for f in fields),
        "NMODE": relations, "NTIMED": interface.timed_relations, "NFREE": free, "NENDS": 2 * free,
        "NWHEN": len(interface.whens), "NJUMP": sum(len(c.states) for c in interface.whens),
        "NACTS": MOST_ACTS * len(interface.whens),
        "NFEAT": interface.features, "NBOUNDS": 2 * interface.features,
        "NPOLE": interface.poles, "NNEAR": 2 * interface.poles,
        "NGUARD": interface.features + interface.poles,
        "NENCLOSED": len(interface.enclosed), "NSEARCH": free + interface.features + interface.poles,
        "NEDGES": 2 * relations if "edges" in interface.functions else 0,
        "NLOADED": loaded, "NHELD": sum(interface.held_rows),
        "NPUSHED": pushed, "NLOADS": loaded + pushed,
        "NLOADSLOPES": (loaded + pushed) * nv, "NLOADCOLUMNS": loaded * (nv + interface.nc),
        "NLOADMATRIX": loaded * loaded, "NCURVED": loaded + pushed if interface.curved_loads else 0,
        "NBLOCK": len(interface.blocks), "NAPART": max(len(interface.blocks) - 1, 0), "NMOVED": nq + nv,
        "NIMPULSE": sum(c.impulse >= 0 for c in interface.contacts), "NLATE": interface.late_relations,
        "NKNOWN": known, "NPOISSON": sum(c.poisson for c in interface.contacts),
        "NCON": len(interface.contacts), "NSLIP": sum(c.slips for c in interface.contacts),
        "NSPACE": sum(c.slips == 2 for c in interface.contacts),
        "NTWO": sum(c.normals > 0 for c in interface.contacts),
        "NNORMAL": normals, "NNORMALROWS": normals * known,
        "NNORMALEFFECTS": normals * rows,
        "NBESIDE": max(rows - 1, 0), "NPLAIN": relations - rows, "NSAMPLED": rows + interface.late_relations,
        "NLEAP": len(interface.whens) + len(interface.contacts),
        "NBOX": 2 * (1 + nq + nv) + len(interface.discretes),
        "NQUANTITY": nq + nv + len(interface.outputs) + len(interface.discretes),
        "NLIMITS": len(interface.limits), "NPREPARED": interface.prepared, "NREAD": len(interface.read),
        "NSUM": sums, "NPARTS": len(interface.part_columns),
        "NNEWTON": nq + nv + multipliers if interface.stiff else 0, "NLAM": multipliers,
        "NDIRECTION": nq + 2 * nv + interface.nc if "newton_column" in interface.functions else 0,
        "NSERIES": interface.nx + 3 if interface.expands else 0,
        "NVALUE": values, "NLANE": lanes, "NSQUARE": squares, "NCONVOLVED": lanes + squares,
        "NLINEAR": (nq if "displace" in interface.functions else 0) + nv + multipliers,
    }  # fmt: skip
    found = _derived({**own, **start, **own})  # initialization has no work integrals
    if "system" not in interface.functions:
        found["NM"] = 0  # without a dense system the mass matrix is never formed
    return found


def sizes_of_start(nq: int, nv: int, rates: int, ends: Sequence[int], columns: Sequence[int],
                   quaternions: Sequence[int], massless: int = 0) -> dict[str, int]:  # fmt: skip
    """Return the sizes of the initialization; `ends` and `columns` describe the initial equations of the
    model."""
    rows = [columns[begin:end] for begin, end in zip((0, *ends), ends)]
    begins, _ = stretches(*with_quaternions(ends, columns, quaternions))
    return _derived({
        "NQ": nq, "NV": nv, "NX": nq + nv, "NRATE": rates, "NMASSLESS": massless, "NU": nq + nv + rates,
        "NCOND": len(rows), "NQUAT": len(quaternions), "NE": len(rows) + len(quaternions),
        "NJ": max(len(columns) + 4 * len(quaternions), 1), "NSUM": 0, "NPARTS": 0,
        "NSTRETCH": len(begins), **CONSTANT_SIZES,
    })  # fmt: skip


def _derived(sizes: dict[str, int]) -> dict[str, int]:
    """Add the sizes that are expressions of others."""
    found = dict(sizes)
    for name, formula in DERIVED.items():
        with suppress(KeyError):
            found[name] = formula(sizes)
    return found


def flags_of(interface: Interface, complete: bool) -> dict[str, bool]:
    """Return the flags of a model: `N > 0` for each size, the methods that it carries, and the names in
    `specialization.FLAGS`."""
    return {
        **{name: value > 0 for name, value in sizes_of(interface).items()},
        **{name.upper(): name in methods_of(interface) for name in METHODS},
        "STRAIGHT": interface.solve == "straight", "HAS_DISPLACE": "displace" in interface.functions,
        "COMPLETE": complete,
    }  # fmt: skip


def methods_of(interface: Interface) -> tuple[str, ...]:
    """Return the integration methods that a model carries."""
    left_out = (*(() if interface.stiff else IMPLICIT), *(() if interface.expands else SERIES))
    asked = interface.methods or METHODS
    return tuple([m for m in METHODS if m in asked and m not in left_out])


def tables_of(interface: Interface) -> dict[str, Sequence[Any]]:
    """Return the tables of a model (`lagc.kernels.language.model_tables`)."""
    fields = (*interface.parameters, *interface.inputs)
    bounded = [i for i, f in enumerate(fields) if isfinite(f.minimum) or isfinite(f.maximum)]
    # Initial equations: where the derivatives of each end, and runs of consecutive unknowns.
    ends, columns = with_quaternions(
        interface.condition_ends, interface.condition_columns, interface.quaternions
    )
    begins, stops = stretches(ends, columns)
    angles = frozenset(interface.angles)
    # One entry for each table of `kernels/language/model_tables`, flat, in the order of the interface.
    return {
        "scaling_group": interface.kinds, "quaternion": interface.quaternions, "bounded": bounded,
        "sources": interface.read, "has_unit": [int(f.unit not in ("", "1")) for f in fields],
        "level": interface.start_levels, "unit": interface.start_units,
        "angle": [int(i in angles) for i in range(len(interface.start_levels))],
        "massless": marked(interface.nq, interface.massless, len(interface.start_levels)),
        "ends": ends, "stretch_begins": begins, "stretch_ends": stops,
        "part_ends": interface.part_ends, "part_column": interface.part_columns,
        "has_edges": interface.counted_relations,
        "enclosed_state": interface.enclosed,
        "clauses_only": [int(aside) for aside in interface.relations_aside],
        "terminates": [int(c.reason is not None) for c in interface.whens],
        "reinit_clause": [k for k, c in enumerate(interface.whens) for _ in c.states],
        **blocks_of(interface),
        "contact_first": [
            k + sum(c.slips for c in interface.contacts[:k]) for k in range(len(interface.contacts))
        ],
        "loading_row": interface.loading_rows, "load_held": interface.held_rows,
        "pushed_contact": interface.pushed_contacts,
        "impulse_state": [c.impulse for c in interface.contacts],
        "contact_slips": [c.slips for c in interface.contacts],
        "contact_unit": [[c.unit for c in interface.contacts].index(c.unit) for c in interface.contacts],
        "contact_normals": [c.normals for c in interface.contacts],
        "normal_first": [
            sum(c.normals for c in interface.contacts[:k]) for k in range(len(interface.contacts))
        ],
        "contact_bounds_rate": [int(c.bounds_rate) for c in interface.contacts],
        "contact_poisson": [int(c.poisson) for c in interface.contacts],
        "reinit_target": [state for c in interface.whens for state in c.states],
        "bounds": [(fields[i].minimum, fields[i].maximum) for i in bounded],
        "derived_bounds": [(f.minimum, f.maximum) for f in interface.limits],
    }  # fmt: skip


def blocks_of(interface: Interface) -> dict[str, list[int]]:
    """Return the tables of the blocks of contacts."""
    nq, nv, blocks = interface.nq, interface.nv, interface.blocks
    owner = {i: number for number, block in enumerate(blocks) for i in block.contacts}
    tied = {i: number for number, block in enumerate(blocks) for i in block.rows}
    return {
        "contact_block": [owner[i] for i in range(len(interface.contacts))],
        "row_block": [owner[i] for i, c in enumerate(interface.contacts) for _ in range(c.slips + 1)],
        "equation_block": [tied.get(i, -1) for i in range(interface.nc)],
        "block_timed": [int(block.timed) for block in blocks],
        **in_blocks("contact", [block.contacts for block in blocks], len(interface.contacts)),
        **in_blocks("speed", [block.speeds for block in blocks], nv),
        **in_blocks(
            "state", [(*block.coordinates, *(nq + j for j in block.speeds)) for block in blocks], nq + nv
        ),
    }


def in_blocks(name: str, blocks: Sequence[Sequence[int]], count: int) -> dict[str, list[int]]:
    """Return the members of blocks in a row, those of no block last, and where each block begins and ends."""
    members = list(chain.from_iterable(blocks))
    ends = list(accumulate(map(len, blocks), initial=0))
    rest = sorted({*range(count)} - {*members})
    return {f"block_{name}": [*members, *rest], f"{name}_begin": ends[:-1], f"{name}_end": ends[1:]}


def marked(nq: int, speeds: Sequence[int], count: int) -> list[int]:
    """Return 1 for these speeds among `count` unknowns of the initialization, else 0."""
    return [int(i - nq in speeds) for i in range(count)]


def stretches(ends: Sequence[int], columns: Sequence[int]) -> tuple[list[int], list[int]]:
    """Return the first and last of consecutive unknowns of each initial equation. If no equation has
    unknowns there is one empty stretch, as C has no empty tables."""
    breaks = {k for k, (j, other) in enumerate(pairwise(columns), 1) if other != j + 1}
    if ends and not columns:
        return [0], [0]
    places = sorted({*breaks, 0, len(columns), *ends})
    return [columns[k] for k in places[:-1]], [columns[k - 1] + 1 for k in places[1:]]


def with_quaternions(
    ends: Iterable[int], columns: Iterable[int], quaternions: Iterable[int]
) -> tuple[list[int], list[int]]:
    """Return the end of the derivatives of each initial equation, and the unknown of each derivative:
    those of the model, then an equation for each unit quaternion."""
    found, unknowns = list(ends), list(columns)
    for first in quaternions:
        found.append(len(unknowns) + 4)
        unknowns += range(first, first + 4)
    return found, unknowns
