"""Values that are computed when they are first asked for, once, whatever the number of threads.

`functools.cached_property` computes twice where two threads ask at the same time; of an expression
graph and what is made from it there must be one.  The locks come from `_thread`: to load `threading` is 2 %
of a short run.
"""

from __future__ import annotations

from _thread import RLock
from collections.abc import Callable
from typing import Any, Generic, Protocol, TypeVar, overload

__all__ = ["RLock", "once"]

T = TypeVar("T")


class Locked(Protocol):
    lock: Any  # an RLock: one value may need another


class once(Generic[T]):
    """A property of an object with a `lock`, computed under it and then kept."""

    def __init__(self, function: Callable[[Any], T]):
        self.function, self.__doc__ = function, function.__doc__
        self.name = function.__name__

    @overload
    def __get__(self, owner: None, kind: type) -> once[T]: ...
    @overload
    def __get__(self, owner: Locked, kind: type) -> T: ...
    def __get__(self, owner: Locked | None, kind: type) -> once[T] | T:
        if owner is None:
            return self
        with owner.lock:
            kept = vars(owner)
            if self.name not in kept:
                kept[self.name] = self.function(owner)
            found: T = kept[self.name]
            return found
