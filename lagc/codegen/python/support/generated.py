"""The names of generated modules that support files use: sizes, constants, records, kernels, functions.

Type checkers take any name from here; nothing imports it at run time.
"""

from typing import Any


class State:
    """The state of a trajectory, which kernels read and write."""

    t: float
    x: list[float]

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(name)


def __getattr__(name: str) -> Any:
    raise AttributeError(name)
