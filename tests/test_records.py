"""Light dataclasses are dataclasses."""

import copy
import dataclasses
import pickle
import random
import subprocess
import sys
from typing import Any

import pytest

from lagc.base import records
from lagc.base.records import dataclass, field, names, replace


@dataclass(frozen=True, slots=True)
class Fixed:
    a: int
    b: str = "x"
    c: list[int] = field(default_factory=list, repr=False)

    def twice(self) -> int:
        return 2 * self.a


@dataclass
class Loose:
    a: int
    b: int = 3


@dataclasses.dataclass(frozen=True, slots=True)
class Standard:
    a: int
    b: str = "x"
    c: list[int] = dataclasses.field(default_factory=list, repr=False)


def test_made_compared_and_shown_as_the_standard_ones() -> None:
    make: Any = Fixed  # the type checker would find what is wrong on purpose below
    standard: Any = Standard
    one = Fixed(1, c=[2])
    assert (one.a, one.b, one.c, one.twice()) == (1, "x", [2], 2)
    assert Fixed(1).c is not Fixed(1).c
    assert one == Fixed(1, "x", [2]) != Fixed(1)
    assert repr(one) == repr(Standard(1, c=[2])).replace("Standard", "Fixed")
    assert one != Standard(1, c=[2])
    with pytest.raises(TypeError, match="'a'"):
        make()
    assert hash(make(1, "x", ())) == hash(standard(1, "x", ()))


def test_frozen_and_slotted() -> None:
    one: Any = Fixed(1)
    with pytest.raises(dataclasses.FrozenInstanceError):
        one.a = 2
    assert not hasattr(one, "__dict__")
    loose = Loose(1)
    loose.b = 4
    assert loose == Loose(1, 4)
    with pytest.raises(TypeError):
        hash(loose)


def test_copied_and_pickled() -> None:
    one = Fixed(1, "y", [3])
    assert pickle.loads(pickle.dumps(one)) == copy.deepcopy(one) == copy.copy(one) == one


def test_the_standard_functions_know_them() -> None:
    one = Fixed(1, "y", [3])
    assert dataclasses.is_dataclass(Fixed)
    assert [f.name for f in dataclasses.fields(Fixed)] == list(names(Fixed)) == ["a", "b", "c"]
    assert dataclasses.asdict(one) == {"a": 1, "b": "y", "c": [3]}
    assert dataclasses.replace(one, a=2) == replace(one, a=2) == Fixed(2, "y", [3])


def test_a_class_that_inherits_keeps_its_own_name() -> None:
    class Under(Loose):
        pass

    assert Under(1) == Under(1) != Loose(1)


@pytest.mark.parametrize("slow", ["dataclasses", "inspect"])
def test_a_run_does_without_the_slow_ones(slow: str) -> None:
    program = f"import sys, lagc.cli.main, lagc.cli.sim, lagc.api; sys.exit({slow!r} in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], timeout=60).returncode == 0


def test_whatever_arguments_are_given_the_standard_class_agrees() -> None:
    """Before the method is written, and after."""
    chance = random.Random(5)
    for _ in range(60):
        space: dict[str, Any] = {"__annotations__": {}}
        twin: dict[str, Any] = {"__annotations__": {}}
        names_ = ("a", "b", "c", "d")[: chance.randint(1, 4)]
        required = chance.randint(0, len(names_))
        for k, name in enumerate(names_):
            space["__annotations__"][name] = twin["__annotations__"][name] = "object"
            if k >= required:
                given: Any = chance.choice([{"default": 3}, {"default_factory": list}])
                space[name], twin[name] = field(**given), dataclasses.field(**given)
        frozen, slots = chance.random() < 0.5, chance.random() < 0.5
        light: Any = dataclass(frozen=frozen, slots=slots)(type("X", (), space))
        standard: Any = dataclasses.dataclass(frozen=frozen, slots=slots)(type("X", (), twin))
        for _ in range(2 * records.FEW):
            values = list(range(chance.randint(0, 5)))
            named = {name: 7 for name in "abcde" if chance.random() < 0.2}
            found = []
            for each in (light, standard):
                try:
                    one = each(*values, **named)
                    found.append([getattr(one, name) for name in each.__match_args__])
                except TypeError:
                    found.append([TypeError])
            assert found[0] == found[1]
