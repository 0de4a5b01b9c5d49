"""The size of generated code is proportional to that of the model, counted in operations, accesses and
characters."""

import math
from collections.abc import Callable, Mapping

import pytest

from lagc.codegen.c.emit import render
from lagc.codegen.loop_segments import KEPT, Segment, segments
from lagc.codegen.python.emit import render as in_python
from lagc.codegen.sizes import tables_of
from lagc.compiler.pipeline import program as compiled
from lagc.compiler.stages import Choice
from lagc.host import model_library
from lagc.lowering.program import LEAVES, Program


def program(name: str, n: int) -> Program:
    return compiled(model_library.read(name), Choice(parameters={"n": n}))


FAMILIES = [
    ("classic/chain", 60, 120, 1.1), ("classic/spring_chain", 150, 300, 1.1),
    ("large/relative_chain", 50, 100, 1.1), ("large/rope", 30, 60, 1.1), ("large/ball_chain", 15, 30, 1.1),
    ("large/mobile", 51, 101, 1.1), ("large/lattice", 150, 300, 1.1), ("large/net", 100, 196, 1.1),
    ("large/n_body", 8, 16, 2.1),
]  # fmt: skip


@pytest.mark.full
@pytest.mark.parametrize(("name", "few", "many", "most"), FAMILIES, ids=[family[0] for family in FAMILIES])
def test_code_is_proportional_to_the_bodies(name: str, few: int, many: int, most: float) -> None:
    """Of n bodies; those that attract each other have n^2 forces."""
    less, more = (program(name, math.isqrt(n) if name == "large/net" else n) for n in (few, many))
    growth = many / few
    assert 1.8 < more.interface.operations / less.interface.operations < growth**most
    short, long = (sum(map(len, render(p).values())) for p in (less, more))
    assert long < growth * short


def accesses(found: list[Segment]) -> int:
    """Of what is kept, and of tables of indices."""
    loops = [(access, s.run.count) for s in found if s.run.count > 1 for access in (*s.reads, *s.writes)]
    return sum([count * ((a.array == KEPT) + (a.stride is None)) for a, count in loops])


@pytest.mark.full
@pytest.mark.parametrize(
    ("name", "n"), [("large/lattice", 500), ("large/net", 12), ("classic/spring_chain", 300)]
)
def test_operations_on_one_value_are_in_one_segment(name: str, n: int) -> None:
    """In the order in which operations are made there are one to two a operation."""
    f = program(name, n).functions["rhs"]
    assert f.runs
    found, _ = segments(f)
    assert accesses(found) < 0.6 * f.cost


@pytest.mark.sample(1)
@pytest.mark.parametrize(("name", "n"), [("classic/chain", 60), ("large/net", 8), ("large/rope", 30)])
def test_stored_values_are_not_kept(name: str, n: int) -> None:
    found, _ = segments(program(name, n).functions["rhs"])
    copies = [s for s in found if all([o.op in LEAVES for o in s.body.operations])]
    assert copies and not [access for s in copies for access in s.reads if access.array == KEPT]


@pytest.mark.full
@pytest.mark.parametrize("written", [render, in_python])
def test_many_unknowns_of_conditions_are_written_as_stretches(
    written: Callable[[Program], Mapping[str, str]],
) -> None:
    """Each rung of a ladder holds all links above it: n^2 of them, in text of length n."""
    less, more = program("large/truss", 60), program("large/truss", 120)
    short, long = (sum(map(len, written(p).values())) for p in (less, more))
    assert long < 2.1 * short
    own = less.interface
    assert len(own.condition_columns) > 60**2
    known = tables_of(own)
    stretches = zip(known["stretch_begins"], known["stretch_ends"])
    assert tuple(j for first, end in stretches for j in range(first, end)) == own.condition_columns
