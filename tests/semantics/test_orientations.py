"""Orientations of arrays of instances."""

from math import cos, sin

import pytest

import lagc

LINK = """model Link
  coordinate Orientation o;
  body b = Solid(mass = 1, inertia = {1, 2, 3}, frame = rotate(world, o), com = {0, 0, 0});
end Link;
"""


def test_each_instance_starts_as_its_own_element_says() -> None:
    text = LINK + "model M Link k[3](o(start = {{cos(0.1*i), 0, 0, sin(0.1*i)} for i in 1:3})); end M;"
    start = lagc.loads(text).compile(backend="numpy").start()
    for i in range(1, 4):
        assert list(start[4 * i - 4 : 4 * i]) == pytest.approx(
            [cos(0.1 * i), 0.0, 0.0, sin(0.1 * i)], rel=1e-14
        )


def test_all_instances_start_as_one_quaternion_says() -> None:
    text = LINK + "model M Link k[4](o(start = {0.6, 0, 0.8, 0}, rate = {1, 2, 3} [rad/s])); end M;"
    start = lagc.loads(text).compile(backend="numpy").start()
    assert list(start) == pytest.approx([0.6, 0.0, 0.8, 0.0] * 4 + [1.0, 2.0, 3.0] * 4)


def test_too_few_elements_are_refused() -> None:
    text = LINK + "model M Link k[3](o(start = {{1, 0, 0, 0}, {0, 1, 0, 0}})); end M;"
    with pytest.raises(lagc.Refused) as refused:
        lagc.loads(text).compile()
    assert [fault.code for fault in refused.value.faults] == ["LAG0306"]
