"""Fast dataclasses, and properties that are computed once.

`dataclass` and `field` behave as in `dataclasses` for the features used here (frozen, slots, defaults, repr).
Importing `dataclasses` takes 20 % of a short run, and defining one dataclass 0.5 ms; here it takes 0.04 ms,
because methods are generated when they are first called.  Type checkers, `dataclasses.fields`, `replace` and
`asdict` treat these records as dataclasses.

`once` is a cached property that is safe with threads: `functools.cached_property` computes twice if two
threads ask at the same time, and there must be one expression graph.  The lock comes from `_thread`, since
loading `threading` takes 2 % of a short run.
"""

from __future__ import annotations

from _thread import RLock
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar, overload

_MISSING: Any = object()
FEW = 100  # objects of a class: generating its `__init__` costs as much as 150 objects without it


class _Slot:
    """The options of one field."""

    __slots__ = ("default", "factory", "repr")

    def __init__(self, default: Any, factory: Any, repr: bool):
        self.default, self.factory, self.repr = default, factory, repr


def _field(*, default: Any = _MISSING, default_factory: Any = _MISSING, repr: bool = True) -> Any:
    return _Slot(default, default_factory, repr)


def _dataclass(cls: Any = None, /, *, frozen: bool = False, slots: bool = False) -> Any:
    if cls is None:
        return lambda found: _made(found, frozen, slots)
    return _made(cls, frozen, slots)


def _made(cls: Any, frozen: bool, slots: bool) -> Any:
    fields: dict[str, _Slot] = {}
    for name in cls.__annotations__:
        value = cls.__dict__.get(name, _MISSING)
        fields[name] = value if isinstance(value, _Slot) else _Slot(value, _MISSING, True)
        if isinstance(value, _Slot):
            delattr(cls, name)
            if value.default is not _MISSING:
                setattr(cls, name, value.default)
    if slots:
        cls = _slotted(cls, tuple(fields))
    own = cls.__dict__
    for name, described in (
        ("__match_args__", tuple(fields)),
        ("__dataclass_fields__", _StandardFields(fields)),
    ):
        setattr(cls, name, described)
    if frozen:
        cls.__setattr__, cls.__delattr__ = _refuse, _refuse
        if slots:
            cls.__getstate__, cls.__setstate__ = _get_state, _set_state
    if own.get("__init__") is None:
        cls.__init__ = _rare(cls, fields, frozen)
    for name, write in {"__repr__": _repr, "__eq__": _eq, "__hash__": _hash}.items():
        if name == "__hash__" and not frozen:
            cls.__hash__ = None
        elif own.get(name) is None:
            setattr(cls, name, _later(cls, name, write, fields, frozen))
    return cls


def _slotted(cls: Any, names: tuple[str, ...]) -> Any:
    space = {k: v for k, v in cls.__dict__.items() if k not in (*names, "__dict__", "__weakref__")}
    space["__slots__"] = names
    made = type(cls)(cls.__name__, cls.__bases__, space)
    made.__qualname__ = cls.__qualname__
    return made


Writer = Callable[[str, dict[str, _Slot], bool, dict[str, Any]], str]


def _later(cls: Any, name: str, write: Writer, fields: dict[str, _Slot], frozen: bool) -> Any:
    """Return the method `name` of `cls`; at its first call it replaces itself by generated code."""

    def method(self: Any, *values: Any, **named: Any) -> Any:
        space: dict[str, Any] = {"_set": object.__setattr__}
        exec(write(cls.__qualname__, fields, frozen, space), space)
        real = space[name]
        real.__qualname__, real.__module__ = f"{cls.__qualname__}.{name}", cls.__module__
        setattr(cls, name, real)
        return real(self, *values, **named)

    return method


def _rare(cls: Any, fields: dict[str, _Slot], frozen: bool) -> Any:
    """Return an `__init__` for few objects; after FEW calls, or if the arguments do not fit, it is
    generated."""
    written = _later(cls, "__init__", _init, fields, frozen)
    left = FEW

    def __init__(self: Any, *values: Any, **named: Any) -> Any:
        nonlocal left
        left -= 1
        given = dict(zip(fields, values), **named) if left >= 0 else {}
        if left < 0 or len(given) < len(values) + len(named) or not given.keys() <= fields.keys():
            return written(self, *values, **named)
        for name, slot in fields.items():
            value = given.get(name, slot.default)
            if value is _MISSING:
                if slot.factory is _MISSING:
                    return written(self, *values, **named)
                value = slot.factory()
            object.__setattr__(self, name, value)

    return __init__


def _init(_: str, fields: dict[str, _Slot], frozen: bool, space: dict[str, Any]) -> str:
    heads, lines = ["self"], []
    for name, slot in fields.items():
        value = name
        if slot.factory is not _MISSING:
            space[f"_make_{name}"], space["_MISSING"] = slot.factory, _MISSING
            heads.append(f"{name}=_MISSING")
            value = f"_make_{name}() if {name} is _MISSING else {name}"
        elif slot.default is not _MISSING:
            space[f"_default_{name}"] = slot.default
            heads.append(f"{name}=_default_{name}")
        else:
            heads.append(name)
        lines.append(f"    _set(self, {name!r}, {value})" if frozen else f"    self.{name} = {value}")
    return f"def __init__({', '.join(heads)}):\n" + "\n".join(lines or ["    pass"])


def _repr(title: str, fields: dict[str, _Slot], _: bool, __: dict[str, Any]) -> str:
    shown = ", ".join(f"{name}={{self.{name}!r}}" for name, slot in fields.items() if slot.repr)
    return f"def __repr__(self):\n    return f{f'{title}({shown})'!r}"


def _eq(_: str, fields: dict[str, _Slot], __: bool, ___: dict[str, Any]) -> str:
    mine, yours = _tuple("self", fields), _tuple("other", fields)
    return ("def __eq__(self, other):\n    if other.__class__ is not self.__class__:\n"
            f"        return NotImplemented\n    return {mine} == {yours}")  # fmt: skip


def _hash(_: str, fields: dict[str, _Slot], __: bool, ___: dict[str, Any]) -> str:
    return f"def __hash__(self):\n    return hash({_tuple('self', fields)})"


def _tuple(owner: str, fields: dict[str, _Slot]) -> str:
    return "(" + "".join(f"{owner}.{name}, " for name in fields) + ")"


def _refuse(self: Any, name: str, value: Any = None) -> None:
    from dataclasses import FrozenInstanceError

    raise FrozenInstanceError(f"cannot change field {name!r}")


def _get_state(self: Any) -> list[Any]:
    return [getattr(self, name) for name in self.__match_args__]


def _set_state(self: Any, values: list[Any]) -> None:
    for name, value in zip(self.__match_args__, values):
        object.__setattr__(self, name, value)


class _StandardFields:
    """The descriptor of `__dataclass_fields__`, which the standard library makes when it is asked for."""

    def __init__(self, fields: dict[str, _Slot]):
        self.fields = fields

    def __get__(self, _: object, cls: Any) -> Any:
        import dataclasses

        space = {name: _standard(dataclasses, slot) for name, slot in self.fields.items()}
        space["__annotations__"] = dict.fromkeys(self.fields, "object")
        twin: Any = dataclasses.dataclass(type(cls.__name__, (), space))
        return twin.__dataclass_fields__


def _standard(dataclasses: Any, slot: _Slot) -> Any:
    if slot.factory is not _MISSING:
        return dataclasses.field(default_factory=slot.factory, repr=slot.repr)
    default = dataclasses.MISSING if slot.default is _MISSING else slot.default
    return dataclasses.field(default=default, repr=slot.repr)


def _names(record: Any) -> tuple[str, ...]:
    found: tuple[str, ...] = record.__match_args__
    return found


def _replace(record: Any, /, **changes: Any) -> Any:
    values = {name: getattr(record, name) for name in record.__match_args__}
    return record.__class__(**{**values, **changes})


if TYPE_CHECKING:
    from dataclasses import dataclass, field, replace
else:
    dataclass, field, replace = _dataclass, _field, _replace

names = _names
__all__ = ["RLock", "dataclass", "field", "names", "once", "replace"]


T = TypeVar("T")


class Locked(Protocol):
    lock: Any  # an RLock, because one value may need another


class once(Generic[T]):
    """A property of an object with a `lock`, computed under the lock and then kept."""

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
