"""Rows that cannot depend on others are told by their columns alone; the truth are exact null vectors."""

from random import Random

import pytest
import sympy

from lagc.mechanics.redundancy import entangled


@pytest.mark.parametrize("seed", range(40))
def test_rows_that_are_left_out_are_in_no_sum_that_vanishes(seed: int) -> None:
    random = Random(seed)
    m, n = random.randint(2, 7), random.randint(2, 8)
    most = [random.randint(1, 3) % n + 1 for _ in range(m)]
    rows = [{j: random.choice((-2, -1, 1, 2, 0)) for j in random.sample(range(n), k)} for k in most]
    rows.append({j: rows[0].get(j, 0) + rows[1].get(j, 0) for j in rows[0] | rows[1]})
    matrix = sympy.Matrix(m + 1, n, lambda k, j: rows[k].get(j, 0))
    left = entangled([{j: x != 0 for j, x in row.items()} for row in rows])
    assert left
    for vector in matrix.T.nullspace():
        assert {k for k in range(m + 1) if vector[k] != 0} <= set(left)


def test_rows_that_add_a_column_each_are_left_out() -> None:
    assert entangled([dict.fromkeys(range(k + 1), True) for k in range(50)]) == []
    assert entangled([{0: False}, {0: True, 1: True}, {2: True}]) == [0]
